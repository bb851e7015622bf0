//! Recorded motions and their roles.

use crate::cases::again::Again;
use plant::arm::Arm;
use plant::reference::{Command, Moves, Multisine, Pace, Segment, Session};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// Role of a trajectory in a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Training: effects are fitted on it.
    Train,
    /// Test: it is held out.
    Test,
}

/// A session with the roles of its trajectories.
pub struct Day {
    /// Session with the motion of the day.
    pub session: Session,
    /// Role of each trajectory of the session.
    pub roles: Vec<Role>,
}

/// Time between trajectories, s.
const GAP: f64 = 2.0;
/// Speed of a joint that rests, rad/s.
const AT_REST: f64 = 1e-9;

/// One day with both kinds of trajectories between each other, or two days with one kind each. `resting`: most trajectories
/// are moves with rests of one second and more. `again`: motions that are fitted are executed twice.
pub fn draw(
    arm: &Arm,
    [resting, other_day]: [bool; 2],
    again: Option<Again>,
    rng: &mut ChaCha8Rng,
) -> Vec<Day> {
    let (train, test) = (rng.random_range(2..9usize), rng.random_range(2..4usize));
    let length = (10.0 * rng.random_range(8.0..15.0f64)).round() / 10.0;
    let haste = rng.random_range(0.5..0.85);
    let moving = if resting {
        0.75
    } else if rng.random_bool(0.35) {
        0.3
    } else {
        0.0
    };
    let mut day = |roles: Vec<Role>| {
        let segments = roles.iter().enumerate().map(|(i, _)| {
            // Rests are needed in both files.
            let moves = rng.random_bool(moving) || (resting && i < 2);
            let segment = if moves {
                let moves = Moves::draw(arm, length, haste, rng);
                let moves = if resting {
                    moves.with_rests(|| rng.random_range(0.8..1.8))
                } else {
                    moves
                };
                Segment::Moves(moves)
            } else {
                let slow = rng.random_bool(0.12);
                let pace = if slow { Pace::slow() } else { Pace::lively() };
                Segment::Multisine(Multisine::draw(arm, &pace, length, rng))
            };
            (segment, length)
        });
        let mut segments: Vec<(Segment, f64)> = segments.collect();
        if let Some(again) = again {
            let fitted = (0..roles.len()).filter(|&i| roles[i] == Role::Train);
            again.repeat(&mut segments, &fitted.collect::<Vec<_>>());
        }
        Day {
            session: Session::new(segments, GAP, arm.dof()),
            roles,
        }
    };
    if other_day {
        return vec![day(vec![Role::Train; train]), day(vec![Role::Test; test])];
    }
    let all = train + test;
    let mut roles = vec![Role::Train; all];
    for i in 0..test {
        // Spread over the session; of a resting arm the second trajectory is one of them.
        roles[(1 + i * all / test).min(all - 1)] = Role::Test;
    }
    vec![day(roles)]
}

impl Day {
    /// Rows of the trace of the trajectories with this role.
    pub fn rows(&self, bounds: &[usize], role: Role) -> Vec<Range<usize>> {
        let spans = bounds.windows(2).map(|w| w[0]..w[1]);
        let own = self.roles.iter().zip(spans).filter(|(r, _)| **r == role);
        own.map(|(_, span)| span).collect()
    }

    /// Stretches of time (s) in trajectories with this role in which every joint rests for at least `least` seconds.
    pub fn rests(&self, role: Role, least: f64) -> Vec<Range<f64>> {
        const STEP: f64 = 0.02;
        let mut found = Vec::new();
        let mut command = Command::new(self.session.dof());
        let spans = self.session.starts.iter().zip(&self.session.lengths);
        for ((start, length), _) in spans.zip(&self.roles).filter(|(_, r)| **r == role) {
            let mut since: Option<f64> = None;
            for k in 0..=(length / STEP) as usize {
                let t = start + k as f64 * STEP;
                self.session.sample(t, &mut command);
                let rests = command.qd.iter().all(|v| v.abs() < AT_REST);
                let last = k == (length / STEP) as usize;
                match since {
                    None if rests => since = Some(t),
                    Some(s) if !rests || last => {
                        found.extend((t - s > least).then_some(s..t));
                        since = None;
                    }
                    _ => {}
                }
            }
        }
        found
    }
}
