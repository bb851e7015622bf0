//! Possible bodies with the fitted torques that are otherwise nearest to the description's.
//!
//! A recording shows some combinations of inertial parameters. A fit leaves the others to its arithmetic, which
//! can give jaws the mass of a forearm. Here one term is the data's information. The other is the divergence of
//! each body from its description, tr(J₀⁻¹J) − ln det(J₀⁻¹J) − 4 in nats, with J the pseudo-inertia (Lee,
//! Wensing and Park, "Geometric robot dynamic identification: a convex programming approach", IEEE T-RO 36(2),
//! 2020). It is independent of units, zero for the description's own body, and infinite at the border of
//! possible bodies.

use nalgebra::{DMatrix, DVector, Matrix4};
use physics::robot::{Inertia, PARAMETERS_PER_LINK};

/// Most Newton steps for one part of the information.
const STEPS: usize = 200;

/// Factor by which the weight of the data's information grows from one minimisation to the next. It starts where the
/// misfit counts as one nat. Barrier methods use factors like it.
const GROWTH: f64 = 10.0;

/// Squared length of a Newton step, in its own metric, below which the minimum counts as reached.
const REACHED: f64 = 1e-16;

/// Least second moment of a described body over its largest: a rod or plate gets a little thickness.
const THINNEST: f64 = 1e-4;

/// The bodies that minimise ½ (x − t)ᵀ H (x − t) + Σ divergence(body ‖ its description). Each of `described` has a place in
/// `sums`: the index of the ten parameters of x that it is a part of, so that a link and its load are two bodies whose sum is
/// seen. `target` and `information` (10 N, 10 N × 10 N) are t and H of these sums. Of a `known` body mass and first moment stay as
/// described, and its inertia alone is sought.
pub(super) fn nearest(
    described: &[Inertia],
    sums: &[usize],
    known: Option<usize>,
    target: &[f64],
    information: &DMatrix<f64>,
) -> Vec<Inertia> {
    let bases = bases();
    let bodies: Vec<Described> = described.iter().map(Described::new).collect();
    let n = PARAMETERS_PER_LINK * bodies.len();
    // x = S y of parameters over their sizes y.
    let mut part = DMatrix::zeros(target.len(), n);
    for (b, (body, &sum)) in bodies.iter().zip(sums).enumerate() {
        for p in 0..PARAMETERS_PER_LINK {
            part[(PARAMETERS_PER_LINK * sum + p, PARAMETERS_PER_LINK * b + p)] = body.sizes[p];
        }
    }
    let seen = part.transpose() * information * &part;
    let target = DVector::from_column_slice(target);
    let mut y = DVector::from_iterator(n, bodies.iter().flat_map(|b| b.own));
    let misfit = |y: &DVector<f64>| {
        let left = &part * y - &target;
        0.5 * left.dot(&(information * &left))
    };
    // A fit that no body near the description has is reached along the minima for a growing part of the information: from
    // far away Newton steps end at the border of what is possible.
    let mut weight = misfit(&y).max(1.0).recip();
    loop {
        let value = |y: &DVector<f64>| -> Option<f64> {
            let mut sum = weight * misfit(y);
            for (b, body) in bodies.iter().enumerate() {
                sum += body.divergence(&bases, block(y, b))?;
            }
            Some(sum)
        };
        let slopes = |y: &DVector<f64>| -> Option<(DVector<f64>, DMatrix<f64>)> {
            let mut gradient = part.transpose() * (information * (&part * y - &target)) * weight;
            let mut hessian = &seen * weight;
            for (b, body) in bodies.iter().enumerate() {
                let (g, h) = body.derivatives(&bases, block(y, b))?;
                let at = PARAMETERS_PER_LINK * b;
                let mut own = gradient.rows_mut(at, PARAMETERS_PER_LINK);
                own += &g;
                let size = (PARAMETERS_PER_LINK, PARAMETERS_PER_LINK);
                let mut own = hessian.view_mut((at, at), size);
                own += &h;
            }
            for fixed in known.into_iter().flat_map(first_moments) {
                gradient[fixed] = 0.0;
                hessian.row_mut(fixed).fill(0.0);
                hessian.column_mut(fixed).fill(0.0);
                hessian[(fixed, fixed)] = 1.0;
            }
            Some((gradient, hessian))
        };
        y = minimum(y, value, slopes);
        if weight >= 1.0 {
            break;
        }
        weight = (weight * GROWTH).min(1.0);
    }
    bodies
        .iter()
        .enumerate()
        .map(|(b, body)| {
            let y = block(&y, b);
            Inertia::from_parameters(&std::array::from_fn(|p| y[p] * body.sizes[p]))
        })
        .collect()
}

/// Minimum of a convex function by damped Newton steps. Where rounding allows no descent, the point reached.
fn minimum(
    mut y: DVector<f64>,
    value: impl Fn(&DVector<f64>) -> Option<f64>,
    slopes: impl Fn(&DVector<f64>) -> Option<(DVector<f64>, DMatrix<f64>)>,
) -> DVector<f64> {
    let Some(mut now) = value(&y) else {
        return y;
    };
    for _ in 0..STEPS {
        let Some((gradient, hessian)) = slopes(&y) else {
            break;
        };
        let Some(factor) = hessian.cholesky() else {
            break;
        };
        let step = factor.solve(&gradient);
        let fall = gradient.dot(&step);
        if fall <= REACHED {
            break;
        }
        let mut length = 1.0;
        let found = loop {
            let next = &y - &step * length;
            match value(&next) {
                Some(v) if v <= now - 1e-4 * length * fall => break Some((next, v)),
                _ if length < 1e-12 => break None,
                _ => length *= 0.5,
            }
        };
        match found {
            Some((next, v)) => (y, now) = (next, v),
            None => break,
        }
    }
    y
}

/// Places of a body's mass and first moment.
fn first_moments(body: usize) -> std::ops::Range<usize> {
    let at = PARAMETERS_PER_LINK * body;
    at..at + 4
}

fn block(y: &DVector<f64>, body: usize) -> [f64; PARAMETERS_PER_LINK] {
    std::array::from_fn(|p| y[PARAMETERS_PER_LINK * body + p])
}

/// Pseudo-inertias of the unit parameters.
fn bases() -> [Matrix4<f64>; PARAMETERS_PER_LINK] {
    std::array::from_fn(|p| {
        let mut unit = [0.0; PARAMETERS_PER_LINK];
        unit[p] = 1.0;
        Inertia::from_parameters(&unit).pseudo_inertia()
    })
}

/// A described body, its parameters divided by their sizes.
struct Described {
    sizes: [f64; PARAMETERS_PER_LINK],
    own: [f64; PARAMETERS_PER_LINK],
    inverse: Matrix4<f64>,
}

impl Described {
    fn new(body: &Inertia) -> Self {
        let mass = body.mass.max(f64::MIN_POSITIVE);
        let radius = (0.5 * body.about_origin.trace() / mass)
            .abs()
            .sqrt()
            .max(1e-6);
        let (m, h, i) = (mass, mass * radius, mass * radius * radius);
        let sizes = [m, h, h, h, i, i, i, i, i, i];
        let parameters = body.parameters();
        let scaled = Inertia::from_parameters(&std::array::from_fn(|p| parameters[p] / sizes[p]));
        let mut axes = scaled.pseudo_inertia().symmetric_eigen();
        let least = THINNEST * axes.eigenvalues.amax();
        axes.eigenvalues.apply(|v| *v = v.max(least));
        let possible = axes.recompose();
        let inverse = possible.try_inverse().unwrap_or_else(Matrix4::identity);
        Self {
            sizes,
            own: Inertia::from_pseudo_inertia(&possible).parameters(),
            inverse,
        }
    }

    fn pseudo(
        bases: &[Matrix4<f64>; PARAMETERS_PER_LINK],
        y: [f64; PARAMETERS_PER_LINK],
    ) -> Matrix4<f64> {
        bases
            .iter()
            .zip(y)
            .fold(Matrix4::zeros(), |sum, (e, y)| sum + e * y)
    }

    /// Divergence of the body with parameters `y` from its description, nats. None where no body can have these
    /// parameters.
    fn divergence(
        &self,
        bases: &[Matrix4<f64>; PARAMETERS_PER_LINK],
        y: [f64; PARAMETERS_PER_LINK],
    ) -> Option<f64> {
        let j = Self::pseudo(bases, y);
        let factor = j.cholesky()?;
        let logarithm = 2.0 * factor.l().diagonal().map(f64::ln).sum();
        let described = self.inverse.determinant().ln();
        Some((self.inverse * j).trace() - logarithm - described - 4.0)
    }

    /// First and second derivatives of the divergence.
    fn derivatives(
        &self,
        bases: &[Matrix4<f64>; PARAMETERS_PER_LINK],
        y: [f64; PARAMETERS_PER_LINK],
    ) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let inverse = Self::pseudo(bases, y).cholesky()?.inverse();
        let turned = bases.map(|e| inverse * e);
        let gradient = DVector::from_fn(PARAMETERS_PER_LINK, |p, _| {
            (self.inverse * bases[p]).trace() - turned[p].trace()
        });
        let hessian = DMatrix::from_fn(PARAMETERS_PER_LINK, PARAMETERS_PER_LINK, |p, q| {
            (turned[p] * turned[q]).trace()
        });
        Some((gradient, hessian))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    fn jaw() -> Inertia {
        Inertia::from_com(
            0.012,
            Vector3::new(0.01, 0.0, 0.03),
            Matrix3::from_diagonal(&Vector3::new(6e-6, 5e-6, 3e-6)),
        )
    }

    /// What is seen is met; what is not stays, whatever the fit says of it.
    #[test]
    fn unseen_directions_stay_at_the_description() {
        let mut target = jaw().parameters();
        // Seen: the first moment about one axis, which is 40 % more. Unseen: a mass that no jaw has.
        target[3] *= 1.4;
        target[0] = 0.18;
        let mut information = DMatrix::zeros(10, 10);
        information[(3, 3)] = (1e-7_f64).powi(-2);
        let found = nearest(&[jaw()], &[0], None, &target, &information)[0];
        assert!(
            (found.first_moment.z / target[3] - 1.0).abs() < 1e-3,
            "{found:?}"
        );
        assert!(found.is_consistent(0.0) && (0.3..3.0).contains(&(found.mass / 0.012)));
        let nothing = nearest(&[jaw()], &[0], None, &target, &DMatrix::zeros(10, 10))[0];
        assert!((nothing.mass / 0.012 - 1.0).abs() < 1e-6, "{nothing:?}");
    }

    /// A described mass that is a placeholder gives way to the body that the fit needs, five hundred times heavier.
    #[test]
    fn a_placeholder_gives_way() {
        let at = Vector3::new(0.1, 0.0, 0.0);
        let light = Inertia::from_com(0.001, at, Matrix3::identity() * 0.01);
        let heavy = Inertia::from_com(1.0, at, Matrix3::identity() * 0.01);
        let mut information = DMatrix::zeros(10, 10);
        for seen in [1, 6] {
            information[(seen, seen)] = 1e10;
        }
        let target = heavy.parameters();
        let found = nearest(&[light], &[0], None, &target, &information)[0].parameters();
        for seen in [1, 6] {
            assert!((found[seen] / target[seen] - 1.0).abs() < 0.01, "{found:?}");
        }
    }

    /// The sum of a link and its load is seen; each is a body, and the link is nearly its description's.
    #[test]
    fn a_load_is_a_body_of_its_own() {
        let link = Inertia::from_com(
            1.1,
            Vector3::new(0.0, 0.01, 0.05),
            Matrix3::from_diagonal(&Vector3::new(0.004, 0.005, 0.002)),
        );
        let load = Inertia::from_com(
            0.5,
            Vector3::new(0.0, 0.02, 0.2),
            Matrix3::identity() * 3e-4,
        );
        let target = link.plus(&load).parameters();
        let information = DMatrix::identity(10, 10) * 1e10;
        let guess = Inertia::from_com(
            0.5,
            Vector3::new(0.0, 0.02, 0.2),
            Matrix3::identity() * 1e-4,
        );
        let found = nearest(&[link, guess], &[0, 0], None, &target, &information);
        let sum = found[0].plus(&found[1]).parameters();
        for (a, b) in sum.iter().zip(target) {
            assert!((a - b).abs() < 1e-4, "{a} {b}");
        }
        assert!((found[1].mass - 0.5).abs() < 0.05 && (found[0].mass - 1.1).abs() < 0.05);
        // What is known of the load stays, whatever the link would gain by another.
        let other = Inertia {
            mass: 0.53,
            ..guess
        };
        let found = nearest(&[link, other], &[0, 0], Some(1), &target, &information);
        assert!((found[1].mass - 0.53).abs() < 1e-12);
        assert!((found[1].first_moment - guess.first_moment).amax() < 1e-12);
        let sum = found[0].plus(&found[1]).parameters();
        assert!((sum[0] - target[0]).abs() < 1e-4 && found[1].is_consistent(0.0));
    }
}
