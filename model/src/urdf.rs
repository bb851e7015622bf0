//! The identified robot as a URDF.

use crate::physics_fit::Fit;
use faer::Mat;
use physics::effects::{Sliding, Term};
use physics::identify::base::BaseParameters;
use physics::identify::feasible::{Constraints, Feasibility, Nominal};
use physics::robot::{Robot, to_urdf};

/// The nominal robot with possible standard parameters whose base parameters are, within their
/// deviations, nearest to the identified ones, and with viscous and Coulomb friction. Directions that
/// the data leave open keep the nominal values.
///
/// None where no such parameters were found.
pub fn identified(fit: &Fit) -> Option<String> {
    let nominal: Robot = fit.file.physics.nominal().ok()?;
    let base = BaseParameters::of_robot(&nominal, &[]);
    let values = &fit.identified.estimate.parameters[..base.len()];
    let std = &fit.identified.estimate.std[..base.len()];
    let information = Mat::from_fn(base.len(), base.len(), |i, j| {
        if i == j {
            std[i].max(1e-9 * (1.0 + values[i].abs())).powi(-2)
        } else {
            0.0
        }
    });
    let links = nominal.dof();
    let feasibility = Feasibility::new(
        base.grouping(),
        Constraints::new(links, []),
        Nominal::of_robot(&nominal, &[]),
    )
    .ok()?;
    let parameters = feasibility
        .nearest(values, information.as_ref())
        .ok()?
        .standard;
    let coefficient = |wanted: Sliding| -> Vec<f64> {
        fit.file
            .physics
            .terms
            .iter()
            .map(|list| {
                list.iter()
                    .find(|w| w.term == Term::Sliding(wanted))
                    .map_or(0.0, |w| w.value.max(0.0))
            })
            .collect()
    };
    let robot = nominal
        .with_parameters(&parameters)
        .and_then(|r| {
            r.with_friction(
                &coefficient(Sliding::Viscous),
                &coefficient(Sliding::Coulomb),
            )
        })
        .ok()?;
    Some(to_urdf(&robot))
}
