//! The inverse baseline: τ = A [q; q̇; q̈] (equation 11) on normalised data (listing 3).

use super::{BaselineError, Normalisation, check};
use ::identify::least_squares::{Accumulator, SolveOptions, solve};
use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};

/// Linear model from motion to torque: a constant matrix A ∈ ℝ^{N×3N} with the normalisation of inputs and outputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinearInverse {
    /// Normalisation of q, q̇, q̈ (3N channels).
    pub input: Normalisation,
    /// Normalisation of τ (N channels).
    pub output: Normalisation,
    /// Rows of A, one per joint, of length 3N; without unit, between normalised quantities.
    pub matrix: Vec<Vec<f64>>,
}

impl LinearInverse {
    /// Least squares of τ on q, q̇, q̈, all of shape (samples, joints), in SI units.
    ///
    /// The paper minimises the same sum of squares with a quasi-Newton method from a random start; the
    /// minimum is unique. Where channels depend on each other (a joint that never moves), the solution
    /// of least norm is taken.
    ///
    /// # Errors
    /// Tables of different shapes, values that are not finite, fewer samples than 3N.
    pub fn fit(
        q: ArrayView2<f64>,
        qd: ArrayView2<f64>,
        qdd: ArrayView2<f64>,
        tau: ArrayView2<f64>,
    ) -> Result<Self, BaselineError> {
        check("the torque", tau, q.dim())?;
        let motion = stacked(q, qd, qdd)?;
        let (samples, inputs) = motion.dim();
        if samples < inputs.max(2) {
            let needed = inputs.max(2);
            return Err(BaselineError::TooShort {
                found: samples,
                needed,
            });
        }
        let (input, output) = (Normalisation::of(motion.view()), Normalisation::of(tau));
        let (u, y) = (input.apply(motion.view()), output.apply(tau));
        let mut matrix = Vec::with_capacity(q.ncols());
        for joint in 0..q.ncols() {
            let mut rows = Accumulator::new(inputs);
            rows.push_rows(u.view(), y.column(joint), None)?;
            matrix.push(solve(&rows.finish()?, &SolveOptions::default())?.parameters);
        }
        Ok(Self {
            input,
            output,
            matrix,
        })
    }

    /// Torque, N·m (N), for tables q, q̇, q̈ of shape (samples, joints).
    ///
    /// # Errors
    /// Tables of different shapes or of another number of joints, values that are not finite.
    pub fn predict(
        &self,
        q: ArrayView2<f64>,
        qd: ArrayView2<f64>,
        qdd: ArrayView2<f64>,
    ) -> Result<Array2<f64>, BaselineError> {
        check("the position", q, (q.nrows(), self.matrix.len()))?;
        let u = self.input.apply(stacked(q, qd, qdd)?.view());
        let y = Array2::from_shape_fn(q.dim(), |(k, joint)| {
            let inputs = std::iter::zip(u.row(k), &self.matrix[joint]);
            inputs.map(|(u, a)| u * a).sum()
        });
        Ok(self.output.undo(y.view()))
    }

    /// Part of A that acts on one of q, q̇, q̈ (0, 1, 2), in physical units: N·m per rad, rad/s or rad/s².
    pub fn gains(&self, derivative: usize) -> Array2<f64> {
        let n = self.matrix.len();
        let first = derivative.min(2) * n;
        Array2::from_shape_fn((n, n), |(i, j)| {
            let column = first + j;
            self.matrix[i][column] * self.output.std[i] / self.input.std[column]
        })
    }
}

/// [q, q̇, q̈] of shape (samples, 3N).
fn stacked(
    q: ArrayView2<f64>,
    qd: ArrayView2<f64>,
    qdd: ArrayView2<f64>,
) -> Result<Array2<f64>, BaselineError> {
    check("the position", q, q.dim())?;
    check("the velocity", qd, q.dim())?;
    check("the acceleration", qdd, q.dim())?;
    let n = q.ncols();
    Ok(Array2::from_shape_fn((q.nrows(), 3 * n), |(k, c)| {
        [q, qd, qdd][c / n][(k, c % n)]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(a: &Array2<f64>, b: &Array2<f64>) {
        let worst = (a - b).iter().fold(0.0_f64, |w, d| w.max(d.abs()));
        assert!(worst < 1e-6, "{worst}");
    }

    /// Smooth motion of two joints with independent channels.
    fn motion(samples: usize) -> [Array2<f64>; 3] {
        let wave = |derivative: i32| {
            Array2::from_shape_fn((samples, 2), |(k, j)| {
                let t = 0.1 * k as f64;
                (0..4)
                    .map(|h| {
                        let w = 0.4 + 0.7 * f64::from(h) + 0.3 * j as f64;
                        w.powi(derivative)
                            * (w * t + std::f64::consts::FRAC_PI_2 * f64::from(derivative)).sin()
                    })
                    .sum()
            })
        };
        [wave(0), wave(1), wave(2)]
    }

    #[test]
    fn a_linear_law_with_offset_is_recovered() {
        let [q, qd, qdd] = motion(300);
        let stiffness = ndarray::array![[3.0, -1.0], [0.5, 2.0]];
        let damping = ndarray::array![[10.0, 0.0], [0.0, 4.0]];
        let inertia = ndarray::array![[2.0, 0.3], [0.3, 1.0]];
        let tau = q.dot(&stiffness.t()) + qd.dot(&damping.t()) + qdd.dot(&inertia.t()) + 7.0;
        let model = LinearInverse::fit(q.view(), qd.view(), qdd.view(), tau.view()).unwrap();
        for (derivative, expected) in [stiffness, damping, inertia].iter().enumerate() {
            assert_close(&model.gains(derivative), expected);
        }
        let predicted = model.predict(q.view(), qd.view(), qdd.view()).unwrap();
        assert_close(&predicted, &tau);

        let json = serde_json::to_string(&model).unwrap();
        assert_eq!(serde_json::from_str::<LinearInverse>(&json).unwrap(), model);
    }

    #[test]
    fn a_joint_that_never_moves_does_no_harm() {
        let [mut q, mut qd, mut qdd] = motion(300);
        for table in [&mut q, &mut qd, &mut qdd] {
            table.column_mut(1).fill(0.1);
        }
        let mut tau = &q * 3.0 + &qdd * 0.5;
        tau.column_mut(1).fill(-4.0);
        let model = LinearInverse::fit(q.view(), qd.view(), qdd.view(), tau.view()).unwrap();
        let predicted = model.predict(q.view(), qd.view(), qdd.view()).unwrap();
        assert_close(&predicted, &tau);
    }

    #[test]
    fn tables_that_cannot_be_used_are_refused() {
        let [q, qd, qdd] = motion(5);
        let fit =
            |tau: &Array2<f64>| LinearInverse::fit(q.view(), qd.view(), qdd.view(), tau.view());
        assert!(matches!(
            fit(&q),
            Err(BaselineError::TooShort {
                found: 5,
                needed: 6
            })
        ));
        assert!(matches!(
            fit(&Array2::zeros((5, 3))),
            Err(BaselineError::Shape { .. })
        ));
        let nan = Array2::from_elem((5, 2), f64::NAN);
        assert_eq!(fit(&nan), Err(BaselineError::NotFinite("the torque")));
    }
}
