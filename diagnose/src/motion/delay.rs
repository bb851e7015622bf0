//! Signals shifted in time, or behind a first-order filter.

use ndarray::{Array1, ArrayView1};
use signal::Motion;

/// Delay of a recorded torque: a shift, then a first-order filter, as of a motor current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Late {
    /// Shift of the torque, s; negative where it is early.
    pub shift: f64,
    /// Time constant of the filter, s; zero without one.
    pub constant: f64,
}

impl Late {
    /// Delay by a shift alone, s.
    pub fn shifted(shift: f64) -> Self {
        Self {
            shift,
            constant: 0.0,
        }
    }

    /// Delay by a filter alone, time constant in s.
    pub fn filtered(constant: f64) -> Self {
        Self {
            shift: 0.0,
            constant,
        }
    }

    /// Total delay of a slowly changing torque, s.
    pub fn delay(&self) -> f64 {
        self.shift + self.constant
    }

    /// Delay with both times multiplied by `factor`.
    pub fn times(self, factor: f64) -> Self {
        Self {
            shift: factor * self.shift,
            constant: factor * self.constant,
        }
    }

    /// A torque at the motion's time stamps with this delay.
    pub fn of(&self, motion: &Motion, x: ArrayView1<f64>) -> Array1<f64> {
        let shifted = if self.shift == 0.0 {
            x.to_owned()
        } else {
            delayed(motion, x, self.shift)
        };
        if self.constant == 0.0 {
            shifted
        } else {
            filtered(motion, shifted.view(), self.constant)
        }
    }
}

/// x(t − delay) by linear interpolation within each segment; constant beyond its ends.
pub fn delayed(motion: &Motion, x: ArrayView1<f64>, delay: f64) -> Array1<f64> {
    let time = &motion.time;
    let mut out = Array1::zeros(x.len());
    for s in &motion.segments {
        let mut k = s.start;
        for i in s.clone() {
            let t = time[i] - delay;
            while k + 2 < s.end && time[k + 1] < t {
                k += 1;
            }
            let b = (k + 1).min(s.end - 1);
            let share = if b > k {
                ((t - time[k]) / (time[b] - time[k])).clamp(0.0, 1.0)
            } else {
                0.0
            };
            out[i] = x[k] + share * (x[b] - x[k]);
        }
    }
    out
}

/// x behind a first-order filter, T·ẏ + y = x, settled at the start of each segment; x is taken as linear between samples.
fn filtered(motion: &Motion, x: ArrayView1<f64>, constant: f64) -> Array1<f64> {
    let time = &motion.time;
    let mut out = x.to_owned();
    // Intervals are mostly alike.
    let (mut h, mut kept) = (0.0, 1.0);
    for s in &motion.segments {
        for i in s.start + 1..s.end {
            let own = (time[i] - time[i - 1]) / constant;
            if own != h {
                (h, kept) = (own, (-own).exp());
            }
            // Behind a ramp of slope r the filter settles r·T late.
            let slope = (x[i] - x[i - 1]) / h;
            out[i] = x[i] - slope + (out[i - 1] - x[i - 1] + slope) * kept;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn both_are_late_by_the_delay_and_only_the_filter_rounds() {
        let n = 500;
        let rest = Array2::zeros((n, 1));
        let motion = Motion {
            time: (0..n).map(|i| 0.004 * i as f64).collect(),
            q: rest.clone(),
            qd: rest.clone(),
            qdd: rest,
            segments: std::iter::once(0..n).collect(),
        };
        let ramp = Array1::from_shape_fn(n, |i| 3.0 * 0.004 * i as f64);
        let jump = Array1::from_shape_fn(n, |i| if i < 250 { -1.0 } else { 1.0 });
        let late = [
            Late::shifted(0.02),
            Late::filtered(0.02),
            Late {
                shift: 0.008,
                constant: 0.012,
            },
        ];
        for late in &late {
            let behind = ramp[n - 1] - late.of(&motion, ramp.view())[n - 1];
            assert!((behind - 3.0 * late.delay()).abs() < 1e-9);
        }
        let between = |late: &Late| {
            let x = late.of(&motion, jump.view());
            x.iter().filter(|x| x.abs() < 0.99).count()
        };
        assert!(between(&late[0]) <= 1 && between(&late[1]) > between(&late[2]));
        assert!(between(&late[2]) > 10);
    }
}
