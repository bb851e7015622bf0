//! Commanded motion: excitation that a laboratory would run, with exact derivatives.

mod blend;
mod moves;
mod multisine;

pub use blend::Blend;
pub use moves::{Move, Moves};
pub use moves::{STEP_ACCELERATION, STEP_SPEED};
pub use multisine::{Multisine, Pace};

/// Commanded position, velocity and acceleration of every joint.
#[derive(Debug, Clone, Default)]
pub struct Command {
    /// Commanded position of each joint, rad or m.
    pub q: Vec<f64>,
    /// Commanded velocity of each joint, rad/s (m/s).
    pub qd: Vec<f64>,
    /// Acceleration, rad/s² (m/s²).
    pub qdd: Vec<f64>,
}

impl Command {
    /// Standstill at zero for `dof` joints.
    pub fn new(dof: usize) -> Self {
        Self {
            q: vec![0.0; dof],
            qd: vec![0.0; dof],
            qdd: vec![0.0; dof],
        }
    }
}

/// One stretch of motion on its own clock, from 0.
#[derive(Debug, Clone)]
pub enum Segment {
    /// Fourier series run through at a varying pace.
    Multisine(Multisine),
    /// Point-to-point moves with dwells.
    Moves(Moves),
    /// Quintic from one state to another.
    Blend(Blend),
}

impl Segment {
    /// Writes the command at time `t` into `out`. Time counts from the segment's start, s.
    pub fn sample(&self, t: f64, out: &mut Command) {
        match self {
            Self::Multisine(m) => m.sample(t, out),
            Self::Moves(m) => m.sample(t, out),
            Self::Blend(m) => m.sample(t, out),
        }
    }
}

/// Trajectories on one clock with the robot moving from each end to the next start in between.
#[derive(Debug, Clone)]
pub struct Session {
    /// Start time of each segment, s, and the segment.
    pieces: Vec<(f64, Segment)>,
    /// Start time of each trajectory, s.
    pub starts: Vec<f64>,
    /// Length of each trajectory, s.
    pub lengths: Vec<f64>,
    dof: usize,
}

impl Session {
    /// Trajectories of the given lengths (s), `gap` seconds apart; the first starts at time 0 after a gap that
    /// begins at rest where the first trajectory begins.
    pub fn new(trajectories: Vec<(Segment, f64)>, gap: f64, dof: usize) -> Self {
        let state = |segment: &Segment, t: f64| {
            let mut c = Command::new(dof);
            segment.sample(t, &mut c);
            c
        };
        let mut pieces = Vec::new();
        let (mut starts, mut lengths) = (Vec::new(), Vec::new());
        let mut from: Option<Command> = None;
        let mut clock = 0.0;
        for (segment, length) in trajectories {
            let to = state(&segment, 0.0);
            let from_state = from.take().unwrap_or_else(|| Command {
                q: to.q.clone(),
                ..Command::new(dof)
            });
            let blend = Blend::new(&from_state, &to, gap);
            pieces.push((clock - gap, Segment::Blend(blend)));
            from = Some(state(&segment, length));
            pieces.push((clock, segment));
            starts.push(clock);
            lengths.push(length);
            clock += length + gap;
        }
        Self {
            pieces,
            starts,
            lengths,
            dof,
        }
    }

    /// Number of joints of the robot.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// First and last time of the session, s.
    pub fn span(&self) -> (f64, f64) {
        let end = self.starts.last().zip(self.lengths.last());
        let start = self.pieces.first().map_or(0.0, |p| p.0);
        (start, end.map_or(0.0, |(s, l)| s + l))
    }

    /// The command at time `t` (s) of the session.
    pub fn sample(&self, t: f64, out: &mut Command) {
        let next = self.pieces.partition_point(|p| p.0 <= t);
        if let Some((start, segment)) = self.pieces.get(next.saturating_sub(1)) {
            segment.sample(t - start, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// Derivatives against central differences, at times inside and across pieces.
    #[test]
    fn derivatives_are_exact_and_joints_stay_inside() {
        let arm = families::ur5();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let segments = vec![
            (
                Segment::Multisine(Multisine::draw(&arm, &Pace::lively(), 15.0, &mut rng)),
                15.0,
            ),
            (Segment::Moves(Moves::draw(&arm, 15.0, 0.5, &mut rng)), 15.0),
            (
                Segment::Multisine(Multisine::draw(&arm, &Pace::slow(), 15.0, &mut rng)),
                15.0,
            ),
        ];
        let session = Session::new(segments, 2.0, 6);
        let (start, end) = session.span();
        assert_eq!((start, end), (-2.0, 49.0));
        let (mut a, mut b, mut c) = (Command::new(6), Command::new(6), Command::new(6));
        let h = 1e-5;
        let mut t = start + 0.01;
        while t < end - 0.01 {
            session.sample(t - h, &mut a);
            session.sample(t, &mut b);
            session.sample(t + h, &mut c);
            for j in 0..6 {
                assert!((c.q[j] - a.q[j] - 2.0 * h * b.qd[j]).abs() < 1e-8, "t {t}");
                assert!(
                    (c.qd[j] - a.qd[j] - 2.0 * h * b.qdd[j]).abs() < 1e-6,
                    "t {t}"
                );
                let inside = t < 0.0 || [15.0, 32.0].iter().any(|&x| t > x && t < x + 2.0);
                if !inside {
                    assert!((b.q[j] - arm.centre[j]).abs() <= arm.reach[j] * 1.0001);
                    assert!(b.qd[j].abs() <= arm.joints[j].limits.velocity);
                }
            }
            t += 0.0317;
        }
    }
}
