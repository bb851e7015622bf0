//! Errors on the held-out recording.

use crate::frame::Frame;
use crate::report::{Figures, Step};
use datasets::{Recording, repeats};
use ndarray::Array2;

/// Velocity above which a sample counts as in motion, rad/s (m/s).
const MOVING: f64 = 0.01;

/// Standard deviation of the measured torque per joint; None where it does not vary.
pub fn deviations(tau: &Array2<f64>) -> Vec<Option<f64>> {
    tau.columns()
        .into_iter()
        .map(|c| Some(c.std(0.0)).filter(|s| *s > 1e-12))
        .collect()
}

/// A step of the ladder: figures of a residual at the recorded samples of a frame, all and in motion.
pub fn step(name: &str, residual: &Array2<f64>, frame: &Frame) -> Step {
    let deviation = deviations(&frame.tau);
    Step {
        step: name.to_owned(),
        all: figures(residual, &deviation, None),
        moving: Some(figures(residual, &deviation, Some(&frame.samples().qd))),
    }
}

/// The floor: spread of the torque over executions of one motion. None where no motion is repeated.
pub fn repeatability(recording: &Recording, frame: &Frame) -> Option<Step> {
    let pairs = repeats::find(recording);
    let floor = repeats::repeatability(recording, &frame.samples().qd, &pairs)?;
    let deviation = deviations(&frame.tau);
    let moving: Vec<f64> = floor.moving.iter().map(|m| m.unwrap_or(0.0)).collect();
    let moves: Vec<Option<f64>> = floor
        .moving
        .iter()
        .zip(&deviation)
        .map(|(m, d)| m.and(*d))
        .collect();
    Some(Step {
        step: "repeatability".to_owned(),
        all: relative(floor.all, &deviation),
        moving: Some(relative(moving, &moves)),
    })
}

/// Figures of a residual over all samples, or over those of each joint in motion.
pub fn figures(
    residual: &Array2<f64>,
    deviation: &[Option<f64>],
    moving_at: Option<&Array2<f64>>,
) -> Figures {
    let rmse: Vec<f64> = (0..residual.ncols())
        .map(|j| {
            let squares = residual
                .column(j)
                .iter()
                .enumerate()
                .filter(|(i, _)| moving_at.is_none_or(|qd| qd[[*i, j]].abs() > MOVING))
                .fold((0.0, 0usize), |(s, n), (_, r)| (s + r * r, n + 1));
            (squares.0 / squares.1.max(1) as f64).sqrt()
        })
        .collect();
    relative(rmse, deviation)
}

/// Figures from errors in N·m and the deviations that they are relative to.
fn relative(rmse: Vec<f64>, deviation: &[Option<f64>]) -> Figures {
    let nrmse: Vec<Option<f64>> = rmse
        .iter()
        .zip(deviation)
        .map(|(r, d)| d.map(|d| r / d))
        .collect();
    let known: Vec<f64> = nrmse.iter().flatten().copied().collect();
    Figures {
        r2: nrmse
            .iter()
            .map(|v| v.map(|v| 100.0 * (1.0 - v * v)))
            .collect(),
        mean_nrmse: known.iter().sum::<f64>() / known.len().max(1) as f64,
        rmse,
        nrmse,
    }
}

/// Sum over joints of squared NRMSE.
pub fn total(figures: &Figures) -> f64 {
    figures.nrmse.iter().flatten().map(|v| v * v).sum()
}
