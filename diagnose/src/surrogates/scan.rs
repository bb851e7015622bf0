//! Largest periodic line over position by chance: the scan over orders, repeated on every surrogate.
//!
//! Lines that are picked from the torque are picked again on each surrogate. A line's sine and cosine are two
//! sums over rows, linear in the torque. They are formed once by stretch, and a surrogate adds them with its
//! signs. The squared error that a line removes where it was fitted exceeds what it removes out of fold, so the
//! null distribution is on the cautious side.

use crate::catalogue::effect::Effect;
use crate::motion::frame::Frame;
use crate::motion::scene::Scale;
use crate::traces::order::span;
use ndarray::{Array1, Array2};
use std::f64::consts::PI;
use std::ops::Range;

/// Sums over one joint's rows at the orders of a scan.
pub(super) struct Scan {
    /// Effect that a line of this scan is: ripple, or friction that depends on position.
    pub effect: Effect,
    /// Index of the joint that is scanned.
    pub joint: usize,
    /// Σ w s², Σ w s c, Σ w c² of each order, with s and c its sine and cosine.
    squares: Vec<[f64; 3]>,
    /// Σ w s r by stretch with the residual r, shape (orders, stretches).
    sine: Array2<f64>,
    /// Σ w c r by stretch, shape (orders, stretches).
    cosine: Array2<f64>,
}

/// Scans of a joint: for lines over position (ripple), and for lines that reverse with the motion (friction).
/// `residual` and `weight` of the fitted rows, shape (rows, joints).
pub(super) fn scans(
    frame: &Frame,
    scale: &Scale,
    joint: usize,
    residual: &Array2<f64>,
    weight: &Array2<f64>,
    stretches: &[(usize, Range<usize>)],
) -> Vec<Scan> {
    let (low, high) = scale.range[joint];
    let Some([least, most]) = span(high - low, scale.speed[joint], frame.report().rate_hz) else {
        return Vec::new();
    };
    let step = 0.5 * PI / (high - low);
    let orders = ((most - least) / step) as usize;
    let (q, qd) = (
        frame.samples().q.column(joint),
        frame.samples().qd.column(joint),
    );
    let position = frame.pick(|i| q[i]);
    let softness = scale.softness[joint];
    let sign = frame.pick(|i| (qd[i] / softness).tanh());
    [false, true]
        .map(|resisting| {
            let mut scan = Scan {
                effect: if resisting {
                    Effect::PositionDependentFriction
                } else {
                    Effect::TorqueRipple
                },
                joint,
                squares: vec![[0.0; 3]; orders],
                sine: Array2::zeros((orders, stretches.len())),
                cosine: Array2::zeros((orders, stretches.len())),
            };
            let (mut sines, mut cosines) = (vec![0.0; orders], vec![0.0; orders]);
            for (b, (_, rows)) in stretches.iter().enumerate() {
                sines.fill(0.0);
                cosines.fill(0.0);
                for i in rows.clone() {
                    let w = weight[[i, joint]];
                    if w == 0.0 {
                        continue;
                    }
                    let shape = if resisting { sign[i] } else { 1.0 };
                    let r = w * shape * residual[[i, joint]];
                    let size = w * shape * shape;
                    let (turn_s, turn_c) = (step * position[i]).sin_cos();
                    let (mut s, mut c) = (least * position[i]).sin_cos();
                    for o in 0..orders {
                        sines[o] += r * s;
                        cosines[o] += r * c;
                        let [ss, sc, cc] = &mut scan.squares[o];
                        *ss += size * s * s;
                        *sc += size * s * c;
                        *cc += size * c * c;
                        (s, c) = (s * turn_c + c * turn_s, c * turn_c - s * turn_s);
                    }
                }
                scan.sine.column_mut(b).assign(&Array1::from(sines.clone()));
                scan.cosine
                    .column_mut(b)
                    .assign(&Array1::from(cosines.clone()));
            }
            scan
        })
        .into()
}

impl Scan {
    /// Largest squared error that a line removes, by column of `signs`, shape (stretches, surrogates).
    pub(super) fn largest(&self, signs: &Array2<f64>) -> Vec<f64> {
        let (sine, cosine) = (self.sine.dot(signs), self.cosine.dot(signs));
        let mut most = vec![0.0f64; signs.ncols()];
        for (o, [ss, sc, cc]) in self.squares.iter().enumerate() {
            let det = ss * cc - sc * sc;
            if det <= 1e-9 * ss * cc {
                continue;
            }
            for ((most, sy), cy) in most.iter_mut().zip(sine.row(o)).zip(cosine.row(o)) {
                *most = most.max((cc * sy * sy - 2.0 * sc * sy * cy + ss * cy * cy) / det);
            }
        }
        most
    }
}
