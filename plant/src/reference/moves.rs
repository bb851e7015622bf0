//! Point-to-point moves with dwells.

use super::Command;
use crate::arm::Arm;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// One synchronous move of all joints that ends at rest.
#[derive(Debug, Clone)]
pub struct Move {
    /// Time at which the move starts, s.
    pub start: f64,
    /// Duration of the move, s.
    pub duration: f64,
    /// Position at the start, rad (m).
    pub from: Vec<f64>,
    /// Position at the end, rad (m).
    pub to: Vec<f64>,
}

/// A sequence of moves; between them the arm rests.
#[derive(Debug, Clone)]
pub struct Moves {
    moves: Vec<Move>,
}

/// Position, velocity and acceleration of 10u³ − 15u⁴ + 6u⁵, which rests at both ends.
pub(super) fn smooth_step(u: f64) -> (f64, f64, f64) {
    let position = u * u * u * (10.0 + u * (6.0 * u - 15.0));
    let velocity = 30.0 * u * u * (1.0 - u) * (1.0 - u);
    let acceleration = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u);
    (position, velocity, acceleration)
}

/// Peak speed of the smooth step of unit length and time.
pub const STEP_SPEED: f64 = 1.875;
/// Peak acceleration of the unit step.
pub const STEP_ACCELERATION: f64 = 5.774;

impl Moves {
    /// Motion from moves in order of time.
    pub fn new(moves: Vec<Move>) -> Self {
        Self { moves }
    }

    /// Random targets in the arm's region for `length` seconds, at up to the part `haste` of the joints' speed.
    /// In every move about a quarter of the joints rest.
    pub fn draw(arm: &Arm, length: f64, haste: f64, rng: &mut ChaCha8Rng) -> Self {
        let n = arm.dof();
        let mut here: Vec<f64> = (0..n)
            .map(|j| arm.centre[j] + arm.reach[j] * rng.random_range(-0.6..0.6))
            .collect();
        let mut moves = Vec::new();
        let mut clock = rng.random_range(0.1..0.6);
        while clock < length {
            let mut to = here.clone();
            for (j, to) in to.iter_mut().enumerate() {
                if rng.random_bool(0.75) {
                    *to = arm.centre[j] + arm.reach[j] * rng.random_range(-0.9..0.9);
                }
            }
            let hurry = haste * rng.random_range(0.3..1.0f64);
            let needed = (0..n).map(|j| {
                let speed = hurry * arm.joints[j].limits.velocity;
                let way = (to[j] - here[j]).abs();
                // Reaching the top speed takes about 0.35 s at the given haste.
                let by_speed = STEP_SPEED * way / speed;
                let by_acceleration = (STEP_ACCELERATION * way * 0.35 / speed).sqrt();
                by_speed.max(by_acceleration)
            });
            let duration = needed.fold(0.3, f64::max);
            moves.push(Move {
                start: clock,
                duration,
                from: here,
                to: to.clone(),
            });
            here = to;
            clock += duration + rng.random_range(0.1..0.7);
        }
        Self { moves }
    }

    /// The moves with a further rest after each, s.
    pub fn with_rests(mut self, mut rest: impl FnMut() -> f64) -> Self {
        let mut later = 0.0;
        for m in &mut self.moves {
            m.start += later;
            later += rest();
        }
        self
    }

    /// The command at time `t`, s.
    pub fn sample(&self, t: f64, out: &mut Command) {
        let next = self.moves.partition_point(|m| m.start <= t);
        let Some(m) = self.moves.get(next.saturating_sub(1)) else {
            return;
        };
        let u = ((t - m.start) / m.duration).clamp(0.0, 1.0);
        let (p, v, a) = smooth_step(u);
        for (j, (from, to)) in m.from.iter().zip(&m.to).enumerate() {
            let way = to - from;
            out.q[j] = from + way * p;
            out.qd[j] = way * v / m.duration;
            out.qdd[j] = way * a / (m.duration * m.duration);
        }
    }
}
