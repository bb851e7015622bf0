//! Payload fixed to the last link: both are one body, whose inertia about its own centre of mass grows by the payload's. Whatever the
//! payload's mass and first moment, that body is a possible one, and the mass matrix stays positive.

use nalgebra::{Matrix3, Vector3};
use physics::robot::PARAMETERS_PER_LINK;

/// Inertial parameters of a body: mass, first moment, inertia about the joint's origin (xx, xy, yy, xz, yz, zz).
type Body = [f64; PARAMETERS_PER_LINK];

/// Inertial parameters of the last link together with the payload of the five values [`crate::arm::Arm::payload`]. `link`: those of
/// the link alone.
pub(crate) fn carrying(link: &Body, payload: &[f64; 5]) -> Body {
    let mut out = plus(link, payload);
    let apart = about_origin(&out) - about_origin(link);
    add(&mut out, &apart);
    out
}

/// Derivative of [`carrying`] along a change of the link and of the payload's values.
pub(crate) fn carrying_by([link, change]: [&Body; 2], [payload, by]: [&[f64; 5]; 2]) -> Body {
    let mut out = plus(change, by);
    let apart = about_origin_by(&plus(link, payload), &out) - about_origin_by(link, change);
    add(&mut out, &apart);
    out
}

/// Sum of a body and a payload, without the inertia by what their centres of mass are apart.
fn plus(link: &Body, payload: &[f64; 5]) -> Body {
    let [m, x, y, z, i] = *payload;
    let mut out = [m, x, y, z, i, 0.0, i, 0.0, 0.0, i];
    out.iter_mut().zip(link).for_each(|(o, l)| *o += l);
    out
}

/// Inertia about the origin of a body's mass at its centre of mass: (|h|² 1 − h hᵀ) / m for the mass m and the first moment h. A body
/// without mass has none.
fn about_origin(body: &Body) -> Matrix3<f64> {
    about(body, &first_moment(body), &first_moment(body))
}

/// Derivative of [`about_origin`] along a change of the body.
fn about_origin_by(body: &Body, change: &Body) -> Matrix3<f64> {
    let (h, dh) = (first_moment(body), first_moment(change));
    let by_mass = about(body, &h, &h) * (change[0] / body[0].max(f64::MIN_POSITIVE));
    about(body, &h, &dh) + about(body, &dh, &h) - by_mass
}

/// (a·b 1 − a bᵀ) / m for the body's mass m; 0 for a body without mass.
fn about(body: &Body, a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    if body[0] <= 0.0 {
        return Matrix3::zeros();
    }
    (Matrix3::identity() * a.dot(b) - a * b.transpose()) / body[0]
}

fn first_moment(body: &Body) -> Vector3<f64> {
    Vector3::new(body[1], body[2], body[3])
}

/// Adds a symmetric inertia to that of a body.
fn add(body: &mut Body, inertia: &Matrix3<f64>) {
    let places = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
    let own = body[4..].iter_mut();
    own.zip(places).for_each(|(b, at)| *b += inertia[at]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A disc of 0.4 kg, 5 cm off the joint's origin.
    const LINK: Body = [0.4, 0.02, 0.0, 0.0, 8e-4, 0.0, 1.4e-3, 0.0, 0.0, 1.4e-3];

    fn payload() -> impl Strategy<Value = [f64; 5]> {
        let moment = -0.5..0.5;
        (0.0..2.0, moment.clone(), moment.clone(), moment, 0.0..0.1)
            .prop_map(|(m, x, y, z, i)| [m, x, y, z, i])
    }

    proptest! {
        #[test]
        fn link_and_payload_are_a_possible_body(payload in payload()) {
            let body = carrying(&LINK, &payload);
            let [.., xx, xy, yy, xz, yz, zz] = body;
            let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            let central = inertia - about_origin(&body);
            let [a, b, c] = central.symmetric_eigenvalues().into();
            let slack = 1e-9;
            let triangle = a + b > c - slack && b + c > a - slack && c + a > b - slack;
            prop_assert!(triangle, "{a} {b} {c}");
        }

        #[test]
        fn derivatives_are_differences(payload in payload(), part in 0usize..5) {
            let (mut unit, step) = ([0.0; 5], 1e-6);
            unit[part] = 1.0;
            let moved = |by: f64| {
                let link = LINK.map(|v| v * (1.0 + by));
                let payload: [f64; 5] = std::array::from_fn(|k| payload[k] + by * unit[k]);
                carrying(&link, &payload)
            };
            let own = carrying_by([&LINK, &LINK], [&payload, &unit]);
            let (up, down) = (moved(step), moved(-step));
            for k in 0..PARAMETERS_PER_LINK {
                let difference = (up[k] - down[k]) / (2.0 * step);
                let near = (own[k] - difference).abs() < 1e-5 * (1.0 + difference.abs());
                prop_assert!(near, "{k}: {} {difference}", own[k]);
            }
        }
    }
}
