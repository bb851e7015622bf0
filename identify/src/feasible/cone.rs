//! The cone of possible bodies and its logarithmic barrier.

use nalgebra::{Matrix4, SMatrix, SVector};
use physics::robot::{Inertia, PARAMETERS_PER_LINK};
use std::sync::LazyLock;

/// Pseudo-inertia of each unit parameter: J(x) = Σ x_k E_k.
static BASIS: LazyLock<[Matrix4<f64>; PARAMETERS_PER_LINK]> = LazyLock::new(|| {
    std::array::from_fn(|k| {
        let mut unit = [0.0; PARAMETERS_PER_LINK];
        unit[k] = 1.0;
        pseudo_inertia(&unit)
    })
});

/// Pseudo-inertia of ten standard parameters.
pub(super) fn pseudo_inertia(x: &[f64]) -> Matrix4<f64> {
    let mut p = [0.0; PARAMETERS_PER_LINK];
    p.copy_from_slice(&x[..PARAMETERS_PER_LINK]);
    Inertia::from_parameters(&p).pseudo_inertia()
}

/// −log det J of ten parameters; `None` outside the cone.
pub(super) fn value(x: &[f64]) -> Option<f64> {
    let factor = pseudo_inertia(x).cholesky()?;
    let l = factor.l_dirty();
    Some(-2.0 * (0..4).map(|i| l[(i, i)].ln()).sum::<f64>())
}

/// Gradient and Hessian of −log det J: −tr(J⁻¹E_k), tr(J⁻¹E_k J⁻¹E_l).
pub(super) fn derivatives(x: &[f64]) -> Option<(SVector<f64, 10>, SMatrix<f64, 10, 10>)> {
    let inverse = pseudo_inertia(x).cholesky()?.inverse();
    let moved: [Matrix4<f64>; PARAMETERS_PER_LINK] = std::array::from_fn(|k| inverse * BASIS[k]);
    let gradient = SVector::from_fn(|k, _| -moved[k].trace());
    let transposed = moved.map(|m| m.transpose());
    let hessian = SMatrix::from_fn(|k, l| moved[k].dot(&transposed[l]));
    Some((gradient, hessian))
}

/// Smallest eigenvalue of J relative to the largest magnitude among them.
pub(super) fn margin(x: &[f64]) -> f64 {
    let values = pseudo_inertia(x).symmetric_eigenvalues();
    if values.amax() > 0.0 {
        values.min() / values.amax()
    } else {
        0.0
    }
}

/// A possible body near ten parameters: the eigenvalues of its pseudo-inertia, in units of `mass` and
/// `inertia`, raised to a hundredth.
pub(super) fn pushed_inside(x: &[f64], mass: f64, inertia: f64) -> [f64; PARAMETERS_PER_LINK] {
    let (m, l) = (mass.sqrt(), inertia.sqrt());
    let units = Matrix4::from_diagonal(&nalgebra::Vector4::new(l, l, l, m));
    let scale = units.map_diagonal(|u| 1.0 / u);
    let scale = Matrix4::from_diagonal(&scale);
    let mut eigen = (scale * pseudo_inertia(x) * scale).symmetric_eigen();
    eigen.eigenvalues.apply(|v| *v = v.max(0.01));
    Inertia::from_pseudo_inertia(&(units * eigen.recompose() * units)).parameters()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: [f64; 10] = [2.0, 0.1, -0.2, 0.3, 0.3, 0.01, 0.28, -0.02, 0.03, 0.2];

    #[test]
    fn derivatives_are_those_of_the_value() {
        let (gradient, hessian) = derivatives(&BODY).unwrap();
        let h = 1e-5;
        for k in 0..10 {
            let at = |step: f64| {
                let mut x = BODY;
                x[k] += step;
                x
            };
            let slope = (value(&at(h)).unwrap() - value(&at(-h)).unwrap()) / (2.0 * h);
            assert!((slope - gradient[k]).abs() < 1e-6 * gradient.amax());
            let change = derivatives(&at(h)).unwrap().0 - derivatives(&at(-h)).unwrap().0;
            let difference = change / (2.0 * h) - hessian.column(k);
            assert!(difference.amax() < 1e-5 * hessian.amax());
        }
    }

    #[test]
    fn a_massless_body_is_pushed_inside() {
        let body = pushed_inside(&[0.0; 10], 1.0, 0.01);
        assert!(margin(&body) > 0.0);
        assert_eq!(margin(&[0.0; 10]), 0.0);
        // A body well inside stays as it is.
        let same = pushed_inside(&BODY, 2.0, 0.2);
        for (a, b) in std::iter::zip(same, BODY) {
            assert!((a - b).abs() < 1e-14);
        }
    }
}
