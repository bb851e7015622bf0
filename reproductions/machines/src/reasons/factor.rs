//! A torque factor that is wrong on one axis, as far as the axes share parameters.

use super::{Kind, Reason};
use crate::MachineError;
use crate::identification::{AxisRows, Identified};
use identify::least_squares::{SolveOptions, Triangle, solve};
use ndarray::{Array1, Array2};

/// Scales within this are those that a nominal torque constant leaves open.
const USUAL: [f64; 2] = [0.8, 1.25];
/// Standard deviations by which a scale has to lie outside, or an inertia below zero.
const SURE: f64 = 3.0;
/// The scale has to leave less than this part of the weighted squared error.
const BETTER: f64 = 0.7;

/// The axis whose torque, in another scale, agrees with the others; and inertias below zero.
pub(super) fn torque_factor(identified: &Identified) -> Result<Option<Reason>, MachineError> {
    let names = identified.machine.axes();
    let (estimate, rows) = (&identified.estimate, &identified.rows);
    for column in identified.machine.model().positive() {
        let (value, std) = (estimate.values[column], estimate.std[column]);
        if value + SURE * std < 0.0 {
            let parameter = &identified.machine.parameters()[column];
            return Ok(Some(Reason {
                kind: Kind::TorqueFactor,
                axis: None,
                value,
                message: format!(
                    "{} comes out as {value:.3} {}, which nothing has: a torque or position has the wrong sign; see \
                     direction in the drive file",
                    parameter.name, parameter.unit
                ),
            }));
        }
    }
    let mut best: Option<(usize, f64, f64)> = None;
    for axis in 0..rows.dof() {
        let Some((scale, left)) = scale_of(rows, &estimate.residual, axis)? else {
            continue;
        };
        if left < BETTER && best.is_none_or(|(_, _, b)| left < b) {
            best = Some((axis, scale, left));
        }
    }
    Ok(best.map(|(axis, scale, _)| Reason {
        kind: Kind::TorqueFactor,
        axis: Some(axis),
        value: 1.0 / scale,
        message: format!(
            "the recorded torque of {} is {:.2} times what the other axes' parameters make it; check its torque factor \
             (rated current, torque constant, gear ratio, screw lead)",
            names[axis].name,
            1.0 / scale
        ),
    }))
}

/// The scale s with which s·τ of one axis agrees best with the model that the other axes share, where it is certain and not
/// usual, and the part of the weighted squared error that it leaves.
///
/// s is one more unknown: A_j β − s τ_j = 0 beside A_i β = τ_i. Noise in τ_j pulls s down by the square of its share,
/// which is small where the scale matters.
fn scale_of(
    rows: &AxisRows,
    sigma: &[f64],
    axis: usize,
) -> Result<Option<(f64, f64)>, MachineError> {
    let width = rows.axis(0).columns();
    let (mut parts, mut before) = (Vec::new(), 0.0);
    for (i, sigma) in sigma.iter().enumerate() {
        let triangle = rows.axis(i).scaled(1.0 / sigma);
        before += (rows.axis(i).rows()) as f64;
        parts.push(if i == axis {
            with_scale(&triangle)?
        } else {
            triangle.embed(&(0..width).collect::<Vec<_>>(), width + 1)?
        });
    }
    let estimate = solve(&Triangle::stack(&parts)?, &SolveOptions::default())?;
    let (scale, std) = (estimate.parameters[width], estimate.std[width]);
    // In the recorded torque's own scale.
    let own = parts[axis].residual_sum_of_squares(&estimate.parameters)? / (scale * scale);
    let others: f64 = parts
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != axis)
        .map(|(_, part)| part.residual_sum_of_squares(&estimate.parameters))
        .sum::<Result<f64, _>>()?;
    let sure = scale > SURE * std
        && (scale + SURE * std < 1.0 / USUAL[1] || scale - SURE * std > 1.0 / USUAL[0]);
    Ok(sure.then_some((scale, (own + others) / before)))
}

/// The axis's equations with its torque as a further column: [A, −τ] (β, s) = 0.
fn with_scale(triangle: &Triangle) -> Result<Triangle, MachineError> {
    let p = triangle.columns();
    let (r, z) = (triangle.r(), triangle.z());
    let rows = Array2::from_shape_fn((p + 1, p + 1), |(i, j)| match (i < p, j < p) {
        (true, true) => r[(i, j)],
        (true, false) => -z[i],
        (false, true) => 0.0,
        (false, false) => -triangle.unexplained().sqrt(),
    });
    Ok(Triangle::of(rows.view(), Array1::zeros(p + 1).view())?)
}
