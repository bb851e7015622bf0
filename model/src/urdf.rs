//! The identified robot as a URDF.

use crate::physics_fit::Fit;
use physics::effects::{Sliding, Term};
use physics::robot::{PARAMETERS_PER_LINK, Robot, to_urdf};

/// Nominal robot with the identified parameters: possible standard parameters whose base parameters are
/// nearest to the identified ones, relative to their deviations, and viscous and Coulomb friction. Directions
/// that the data leave open keep the nominal values.
///
/// None where no possible parameters were found.
pub fn identified(fit: &Fit) -> Option<String> {
    let nominal: Robot = fit.file.physics.nominal().ok()?;
    let possible = fit.possible.as_ref()?;
    let parameters = &possible.standard[..PARAMETERS_PER_LINK * nominal.dof()];
    let coefficient = |wanted: &dyn Fn(&Sliding) -> bool| -> Vec<f64> {
        fit.file
            .physics
            .terms
            .iter()
            .map(|list| {
                list.iter()
                    .find(|w| matches!(&w.term, Term::Sliding(s) if wanted(s)))
                    .map_or(0.0, |w| w.value.max(0.0))
            })
            .collect()
    };
    let robot = nominal
        .with_parameters(parameters)
        .and_then(|r| {
            r.with_friction(
                &coefficient(&|s| *s == Sliding::Viscous),
                &coefficient(&Sliding::is_coulomb),
            )
        })
        .ok()?;
    Some(to_urdf(&robot))
}
