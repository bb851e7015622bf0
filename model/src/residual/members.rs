//! Torque of each member of the ensembles alone: the effect of the seed.

use super::inputs::input_table;
use super::{Learned, Pace, ResidualError, predict_from};
use crate::physics_fit::Fit;
use feedforward::network::{Compensator, Unit};
use ndarray::Array2;

/// Residual torque of one recording of the session by each member alone, shape (samples, joints).
///
/// The m-th entry takes the m-th network of every unit; bounds and switches are the ensemble's.
///
/// # Errors
/// A compensator that does not fit its record.
pub fn member_torques(
    learned: &Learned,
    fit: &Fit,
    part: usize,
) -> Result<Vec<Array2<f64>>, ResidualError> {
    let motion = &fit.session.parts[part];
    let Some(pace) = Pace::new(motion.report.rate_hz, learned.record.period) else {
        return Ok(Vec::new());
    };
    let model = fit.file.physics.model()?;
    let load = fit.session.load(model.load_robot());
    let table = input_table(&fit.session, &learned.record.inputs, &load, &[]).swap_remove(part);
    let units = &learned.compensator.units;
    let members = units.iter().map(|u| u.members.len()).min().unwrap_or(0);
    (0..members)
        .map(|m| {
            let alone = Compensator {
                units: units.iter().map(|u| alone(u, m)).collect(),
                ..learned.compensator.clone()
            };
            predict_from(&alone, &table, &motion.at_samples.segments, pace)
        })
        .collect()
}

fn alone(unit: &Unit, member: usize) -> Unit {
    Unit {
        members: vec![unit.members[member].clone()],
        ..unit.clone()
    }
}
