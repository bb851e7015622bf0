//! True motion of a case on a fine grid, with the motion before each trajectory that memory of a mechanism begins with.

use crate::cases::oracle::frictions;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::RobotError;
use plant::arm::Arm;
use plant::reference::{Command, Session};
use plant::run::Trace;

/// Time between rows of the grid, s: the tick of a hard case's trace, half of a plain one's.
pub const STEP: f64 = 0.002;
/// Step in rows of the grid between evaluations of altered bodies, whose torque is smooth; linear in between.
pub const STRIDE: usize = 4;
/// Time before each trajectory in which the motion is the commanded one, s: all of the way to it.
const WARM: f64 = 2.0;

/// Motion by row of the grid, N values each.
pub struct Motion {
    /// Number of joints.
    pub dof: usize,
    /// Session time of each row, s.
    pub time: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// Rigid-body torque of the plant without effects, N·m.
    pub rigid: Vec<f64>,
    /// The same with the joints' friction.
    base: Vec<f64>,
    /// First row of each trajectory's warm-up, and the end.
    pub starts: Vec<usize>,
    /// Row of the grid of each row of the trace.
    pub recorded: Vec<usize>,
    /// First row of the trace of each trajectory, and the end.
    pub bounds: Vec<usize>,
}

impl Motion {
    /// Motion of a trace; between its rows by the cubic through both states.
    pub fn new(plain: &Arm, session: &Session, trace: &Trace) -> Result<Self, RobotError> {
        let n = trace.dof;
        let bounds = trace.bounds();
        let tick = trace.time.get(1).map_or(STEP, |t| t - trace.time[0]);
        let fine = (tick / STEP).round().max(1.0) as usize;
        let (mut time, mut q, mut v, mut a) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut starts, mut recorded) = (Vec::new(), Vec::new());
        let mut command = Command::new(n);
        let warm = (WARM / STEP) as usize;
        for w in bounds.windows(2) {
            starts.push(time.len());
            for k in (1..=warm).rev() {
                let t = trace.time[w[0]] - k as f64 * STEP;
                session.sample(t, &mut command);
                time.push(t);
                q.extend_from_slice(&command.q);
                v.extend_from_slice(&command.qd);
                a.extend_from_slice(&command.qdd);
            }
            for row in w[0]..w[1] {
                recorded.push(time.len());
                let parts = if row + 1 < w[1] { fine } else { 1 };
                for part in 0..parts {
                    let w = part as f64 / fine as f64;
                    time.push(trace.time[row] + w * tick);
                    for j in 0..n {
                        let [position, velocity] = trace.between(j, row, w, tick);
                        q.push(position);
                        v.push(velocity);
                        let next = (row + 1).min(trace.len() - 1);
                        let [now, then] = [row, next].map(|r| trace.qdd[r * n + j]);
                        a.push(now + w * (then - now));
                    }
                }
            }
        }
        starts.push(time.len());
        let robot = plain.robot()?;
        let mut workspace = Workspace::new(&robot);
        let mut rigid = vec![0.0; q.len()];
        let rows = q.chunks(n).zip(v.chunks(n)).zip(a.chunks(n));
        for (((q, v), a), tau) in rows.zip(rigid.chunks_mut(n)) {
            inverse_dynamics(&robot, &mut workspace, q, v, a, tau);
        }
        let friction = frictions(plain);
        let sum = |(i, tau): (usize, &f64)| tau + friction[i % n].torque(v[i]);
        Ok(Self {
            dof: n,
            base: rigid.iter().enumerate().map(sum).collect(),
            time,
            q,
            v,
            a,
            rigid,
            starts,
            recorded,
            bounds,
        })
    }

    /// Position, velocity and acceleration in a row of the grid.
    pub fn state(&self, k: usize) -> [&[f64]; 3] {
        let at = k * self.dof..(k + 1) * self.dof;
        [&self.q[at.clone()], &self.v[at.clone()], &self.a[at]]
    }

    /// Torque of the plant without effects in a row of the grid, N·m.
    pub fn base(&self, k: usize) -> &[f64] {
        &self.base[k * self.dof..][..self.dof]
    }
}
