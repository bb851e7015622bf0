//! The motion that a drive plans towards its command: no faster acceleration than its setting.

/// Position and velocity of a planned motion after a step, with their derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Planned {
    /// Position, rad.
    pub position: f64,
    /// Velocity, rad/s.
    pub velocity: f64,
    /// Derivatives of the velocity by the distance to the command, by the velocity before, by the acceleration.
    pub by: [f64; 3],
}

/// One step of `h` s towards `command`: the velocity from which the motion can still be stopped there,
/// v = √((ah/2)² + 2a|d|) − ah/2 with the distance d (so that the last step ends on it), reached with no more than
/// the acceleration a.
pub fn plan(position: f64, velocity: f64, command: f64, a: f64, h: f64) -> Planned {
    let d = command - position;
    let (half, side) = (0.5 * a * h, d.signum());
    let root = (half * half + 2.0 * a * d.abs()).sqrt();
    // Within one step's reach the command is met exactly.
    let (wanted, by_d, by_a) = if d.abs() <= a * h * h {
        (d / h, 1.0 / h, 0.0)
    } else {
        let by_a = side * ((0.5 * half * h + d.abs()) / root - 0.5 * h);
        (side * (root - half), a / root, by_a)
    };
    let change = wanted - velocity;
    let (velocity, by) = if change.abs() <= a * h {
        (wanted, [by_d, 0.0, by_a])
    } else {
        (
            velocity + change.signum() * a * h,
            [0.0, 1.0, change.signum() * h],
        )
    };
    Planned {
        position: position + h * velocity,
        velocity,
        by,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_takes_the_time_of_a_triangle() {
        // 1 rad at 4 rad/s²: accelerate for 0.5 s, brake for 0.5 s.
        let (mut p, mut v, h) = (0.0, 0.0, 1e-3);
        let mut reached = 0.0;
        for k in 0..2000 {
            let next = plan(p, v, 1.0, 4.0, h);
            (p, v) = (next.position, next.velocity);
            assert!(p < 1.0 + 1e-9 && v < 2.0 + 1e-2);
            if p < 1.0 - 1e-6 {
                reached = f64::from(k) * h;
            }
        }
        assert!((reached - 1.0).abs() < 0.02, "{reached}");
        assert!((p - 1.0).abs() < 1e-9 && v.abs() < 1e-9);
    }

    #[test]
    fn derivatives_are_differences() {
        for (d, v) in [(0.3, 1.0), (-0.2, -1.24), (0.01, 0.279), (1e-7, 1e-4)] {
            let (a, h, e) = (4.0, 1e-3, 1e-8);
            let at = |d: f64, v: f64, a: f64| plan(0.0, v, d, a, h).velocity;
            let by = plan(0.0, v, d, a, h).by;
            assert!(
                ((at(d + e, v, a) - at(d - e, v, a)) / (2.0 * e) - by[0]).abs()
                    < 1e-5 * (1.0 + by[0].abs())
            );
            assert!(((at(d, v + e, a) - at(d, v - e, a)) / (2.0 * e) - by[1]).abs() < 1e-6);
            assert!(((at(d, v, a + e) - at(d, v, a - e)) / (2.0 * e) - by[2]).abs() < 1e-6);
        }
    }
}
