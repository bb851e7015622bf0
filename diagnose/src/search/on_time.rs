//! Residual of a first fit with the part taken out that is only an early or late torque.

use crate::algebra::cholesky::Cholesky;
use crate::catalogue::time_delay;
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use ndarray::{Array1, Array2, ArrayView1};

/// Residual from which the error of a delayed torque is removed, joint by joint, at the recorded samples, shape
/// (samples, joints). Errors of a delay of a few milliseconds at every reversal would hide periodic lines over
/// position. `weight` is that of the fitted rows, shape (rows, joints).
pub(super) fn on_time(
    scene: &Scene,
    data: &Frame,
    residual: &Array2<f64>,
    weight: &Array2<f64>,
) -> Array2<f64> {
    let mut out = residual.clone();
    for (joint, mut own) in out.columns_mut().into_iter().enumerate() {
        let fine = time_delay::changes(scene, joint);
        let columns: Vec<Vec<f64>> = fine.iter().map(|c| data.to_samples(c)).collect();
        // Sizes are fitted where the search fits, on its rows and in their band.
        let rows: Vec<Array1<f64>> = columns.iter().map(|c| data.thin(c)).collect();
        let y = data.thin(&own.to_vec());
        let weight = weight.column(joint);
        let weighed = |a: &Array1<f64>, b: &Array1<f64>| (a * b).dot(&weight);
        let k = rows.len();
        let a = Array2::from_shape_fn((k, k), |(i, j)| weighed(&rows[i], &rows[j]));
        let b: Array1<f64> = rows.iter().map(|c| weighed(c, &y)).collect();
        let sizes = Cholesky::raised(a, 1e-6).solve(b.view());
        for (column, size) in columns.iter().zip(sizes) {
            own.scaled_add(-size, &ArrayView1::from(column));
        }
    }
    out
}
