//! Distribution of a link's inertia among the bodies that are fixed to each other in it.

use crate::robot::Inertia;
use nalgebra::{Matrix4, SMatrix, SVector};

/// Independent elements of a pseudo-inertia.
const ELEMENTS: usize = 10;

/// Least second moment of a body over its largest: a rod, a plate or a point of mass gets this little thickness.
const THINNEST: f64 = 1e-6;

/// Newton steps, at most, and the squared length of one in its own metric at which the minimum is reached.
const STEPS: usize = 200;
const REACHED: f64 = 1e-18;

/// Inertias of `bodies`, all in the link's frame, that together make `whole`: among all such inertias the ones nearest
/// to `bodies`.
///
/// The distance is Σ tr(J₀⁻¹J) − ln det(J₀⁻¹J) of the pseudo-inertias J (Lee, Wensing and Park, "Geometric robot
/// dynamic identification: a convex programming approach", IEEE T-RO 36(2), 2020), infinite at the border of possible
/// bodies. Where no body can have `whole`, the heaviest body takes what the others leave.
pub(super) fn share(whole: &Inertia, bodies: &[Inertia]) -> Vec<Inertia> {
    let mut shared = nearest(whole, bodies).unwrap_or_else(|| bodies.to_vec());
    let heaviest = (0..bodies.len()).max_by(|&a, &b| bodies[a].mass.total_cmp(&bodies[b].mass));
    if let Some(heaviest) = heaviest {
        let others = shared.iter().enumerate().filter(|(b, _)| *b != heaviest);
        shared[heaviest] = others.fold(*whole, |rest, (_, body)| {
            rest.plus(&Inertia::from_parameters(&body.parameters().map(|v| -v)))
        });
    }
    shared
}

/// The minimum by Lagrange's multipliers Λ of Σ J = W: J = (J₀⁻¹ − Λ)⁻¹, and Λ maximises Σ ln det(J₀⁻¹ − Λ) + tr(ΛW).
fn nearest(whole: &Inertia, bodies: &[Inertia]) -> Option<Vec<Inertia>> {
    if bodies.len() < 2 {
        return None;
    }
    let all = bodies.iter().map(Inertia::pseudo_inertia);
    // In a metric in which all bodies together are one: no units are left.
    let root = thick(&all.clone().sum::<Matrix4<f64>>()).cholesky()?.l();
    let inverse = root.try_inverse()?;
    let within = |j: Matrix4<f64>| inverse * j * inverse.transpose();
    let target = within(whole.pseudo_inertia());
    target.cholesky()?;
    let stiff = all.map(|j| thick(&within(j)).try_inverse());
    let stiff = stiff.collect::<Option<Vec<Matrix4<f64>>>>()?;
    let basis = basis();
    let value = |multiplier: &Matrix4<f64>| -> Option<f64> {
        let mut sum = -(multiplier * target).trace();
        for own in &stiff {
            let factor = (own - multiplier).cholesky()?;
            sum -= 2.0 * factor.l().diagonal().map(f64::ln).sum();
        }
        Some(sum)
    };
    let shared = |multiplier: &Matrix4<f64>| -> Option<Vec<Matrix4<f64>>> {
        let all = stiff.iter();
        all.map(|own| (own - multiplier).try_inverse()).collect()
    };
    let mut multiplier = Matrix4::zeros();
    for _ in 0..STEPS {
        let own = shared(&multiplier)?;
        let over = own.iter().sum::<Matrix4<f64>>() - target;
        let gradient = SVector::<f64, ELEMENTS>::from_fn(|p, _| (over * basis[p]).trace());
        let turned = own.iter().map(|j| basis.map(|e| j * e));
        let turned: Vec<[Matrix4<f64>; ELEMENTS]> = turned.collect();
        let hessian = SMatrix::<f64, ELEMENTS, ELEMENTS>::from_fn(|p, q| {
            turned.iter().map(|t| (t[p] * t[q]).trace()).sum()
        });
        let step = hessian.cholesky()?.solve(&gradient);
        let fall = gradient.dot(&step);
        if fall <= REACHED {
            break;
        }
        let parts = basis.iter().zip(step.iter());
        let way = parts.fold(Matrix4::zeros(), |sum, (e, s)| sum + e * *s);
        let now = value(&multiplier)?;
        let mut length = 1.0;
        let next = loop {
            let next = multiplier - way * length;
            match value(&next) {
                Some(v) if v <= now - 1e-4 * length * fall => break Some(next),
                _ if length < 1e-12 => break None,
                _ => length *= 0.5,
            }
        };
        // Rounding lets no step fall any more.
        let Some(next) = next else { break };
        multiplier = next;
    }
    let own = shared(&multiplier)?.into_iter();
    let back = own.map(|j| Inertia::from_pseudo_inertia(&(root * j * root.transpose())));
    Some(back.collect())
}

/// Pseudo-inertia with a least thickness along every axis, which rods and plates do not have.
fn thick(j: &Matrix4<f64>) -> Matrix4<f64> {
    let mut axes = j.symmetric_eigen();
    let least = THINNEST * axes.eigenvalues.amax();
    axes.eigenvalues.apply(|v| *v = v.max(least));
    axes.recompose()
}

/// The symmetric matrices with one element, or two that mirror each other.
fn basis() -> [Matrix4<f64>; ELEMENTS] {
    let mut places = (0..4).flat_map(|i| (i..4).map(move |k| (i, k)));
    std::array::from_fn(|_| {
        let mut unit = Matrix4::zeros();
        if let Some((i, k)) = places.next() {
            unit[(i, k)] = 1.0;
            unit[(k, i)] = 1.0;
        }
        unit
    })
}

/// Whether a link's parameters differ by more than rounding.
pub(super) fn departs(old: &Inertia, new: &Inertia) -> bool {
    /// Change of a link's parameters, relative to their size, that is rounding.
    const ROUNDING: f64 = 1e-12;
    let (old, new) = (old.parameters(), new.parameters());
    let size = |part: std::ops::Range<usize>| -> f64 {
        let largest = old[part.clone()].iter().chain(&new[part]);
        largest.fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    let apart = |part: std::ops::Range<usize>| {
        let allowed = ROUNDING * size(part.clone());
        part.into_iter().any(|k| (old[k] - new[k]).abs() > allowed)
    };
    apart(0..1) || apart(1..4) || apart(4..10)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    /// A forearm and the jaw that is fixed to it, in the forearm's frame.
    fn bodies() -> [Inertia; 2] {
        let ball = |mass: f64, at: [f64; 3], radius: f64| {
            let about = Matrix3::identity() * (0.4 * mass * radius * radius);
            Inertia::from_com(mass, Vector3::from(at), about)
        };
        [
            ball(4.0, [0.2, 0.0, 0.02], 0.1),
            ball(1.0, [0.6, 0.03, 0.0], 0.08),
        ]
    }

    fn apart(a: &Inertia, b: &Inertia) -> f64 {
        let pairs = a.parameters().into_iter().zip(b.parameters());
        pairs.fold(0.0, |m, (a, b)| m.max((a - b).abs()))
    }

    #[test]
    fn bodies_of_an_unchanged_link_stay_as_they_are() {
        let [a, b] = bodies();
        let shared = share(&a.plus(&b), &[a, b]);
        assert!(apart(&shared[0], &a) < 1e-12 && apart(&shared[1], &b) < 1e-12);
    }

    /// Less of everything than the forearm could have lost alone: both stay bodies, near their own.
    #[test]
    fn a_change_is_shared_and_every_part_stays_a_body() {
        let [a, b] = bodies();
        let whole = a.plus(&b).parameters();
        let whole = Inertia::from_parameters(&whole.map(|v| 0.6 * v));
        let alone = whole.plus(&Inertia::from_parameters(&b.parameters().map(|v| -v)));
        assert!(!alone.is_consistent(0.0));
        let shared = share(&whole, &[a, b]);
        assert!(apart(&shared[0].plus(&shared[1]), &whole) < 1e-12);
        for (new, old) in shared.iter().zip([a, b]) {
            assert!(new.is_consistent(0.0), "{new:?}");
            let moments = new.principal_moments().into_iter();
            let ratios = moments.zip(old.principal_moments()).map(|(n, o)| n / o);
            let mut ratios = ratios.chain([new.mass / old.mass]);
            assert!(ratios.all(|r| (0.3..3.0).contains(&r)), "{new:?}");
        }
    }

    /// What no body has is the heaviest one's, as the torque has to be right.
    #[test]
    fn an_impossible_whole_is_kept() {
        let [a, b] = bodies();
        let mut whole = a.plus(&b);
        whole.mass = -1.0;
        let shared = share(&whole, &[a, b]);
        assert!(apart(&shared[1], &b) == 0.0);
        assert!(apart(&shared[0].plus(&shared[1]), &whole) < 1e-12);
    }
}
