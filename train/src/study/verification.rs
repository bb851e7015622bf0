//! Tables 7 and 8: a recording of high speed that nothing was fitted on.

use super::data::{Data, relative_error};
use super::results::Verification;
use super::trial::Outcome;
use compensator::training::{Samples, predict as predict_unit};
use model::failure::Failure;
use model::residual::{Pace, ResidualError};
use ndarray::Axis;

/// Tables 7 and 8: the units of the first fold on the verification recording.
pub fn verify(data: &Data, outcomes: &[Outcome]) -> Result<Verification, Failure> {
    let run = &data.verification;
    // Windows keep their length in time although this recording is faster.
    let pace = Pace::new(run.rate_hz, 1.0 / data.moves.rate_hz)
        .ok_or_else(|| Failure::other("the verification recording is too slow"))?;
    let (order, phases) = pace.rows(&run.segments);
    let every: Vec<usize> = (0..phases.len()).collect();
    let all: Vec<usize> = (0..run.segments.len()).collect();
    let inputs = run.inputs.select(Axis(0), &order);
    let (mut physics, mut compensated, mut left) = (Vec::new(), Vec::new(), Vec::new());
    for (joint, outcome) in outcomes.iter().enumerate() {
        let target = run.residual.row(joint).select(Axis(0), &order);
        let samples = Samples::new(inputs.view(), target.view(), None, &phases)
            .map_err(ResidualError::from)?;
        let paced = predict_unit(&outcome.unit, &samples, &every).map_err(ResidualError::from)?;
        let mut learned = vec![0.0; order.len()];
        for (&row, value) in order.iter().zip(paced) {
            learned[row] = f64::from(value);
        }
        physics.push(run.rmse(joint, &all, |_| 0.0));
        compensated.push(run.rmse(joint, &all, |row| learned[row]));
        left.extend(
            std::iter::zip(run.residual.row(joint), learned).map(|(r, l)| f64::from(*r) - l),
        );
    }
    Ok(Verification {
        max_torque: run
            .tau
            .columns()
            .into_iter()
            .map(|c| c.iter().fold(0.0, |m: f64, t| m.max(t.abs())))
            .collect(),
        physics,
        compensated,
        relative_error_identification: data.relative_error_identification,
        relative_error: relative_error(&run.tau, run.residual.iter().map(|r| f64::from(*r))),
        relative_error_compensated: relative_error(&run.tau, left.into_iter()),
    })
}
