//! Shapes of a joint's torque error over its position and direction.

/// Speed over which the sign of motion is softened, rad/s (m/s).
const SOFT: f64 = 0.01;
/// Number of harmonics of the joint's position.
const HARMONICS: usize = 2;
/// Number of shapes of a joint's torque error.
pub(super) const SHAPES: usize = 2 * (1 + 2 * HARMONICS);

/// Direction of motion at a velocity in rad/s (m/s), −1 to 1.
pub(super) fn direction(qd: f64) -> f64 {
    qd / qd.hypot(SOFT)
}

/// Shapes of a torque error: a constant and two harmonics of the position `q`, rad (m), each once symmetric and once antisymmetric in the
/// direction of motion; none exceeds 1.
pub(super) fn shapes(q: f64, qd: f64) -> [f64; SHAPES] {
    let way = direction(qd);
    let mut shapes = [0.0; SHAPES];
    let mut places = shapes.as_chunks_mut().0.iter_mut();
    let mut put = |value: f64| {
        if let Some(place) = places.next() {
            *place = [value, value * way];
        }
    };
    put(1.0);
    for h in 1..=HARMONICS {
        let (sin, cos) = (h as f64 * q).sin_cos();
        put(sin);
        put(cos);
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At a quarter turn: sine 1, cosine 0, of twice the angle 0 and −1; nothing of direction at rest, all of it in motion.
    #[test]
    fn by_hand() {
        let close = |q: f64, qd: f64, expected: [f64; SHAPES]| {
            for (a, b) in shapes(q, qd).into_iter().zip(expected) {
                assert!((a - b).abs() < 1e-4, "{a} {b}");
            }
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        close(
            quarter,
            0.0,
            [1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0],
        );
        close(
            quarter,
            -2.0,
            [1.0, -1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 1.0],
        );
    }
}
