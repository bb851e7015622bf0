//! The motion as commanded, on which the size of an effect is set before anything is simulated.

use super::oracle::rms;
use crate::effects::{Demand, Place, Withheld};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Robot, RobotError};
use plant::arm::Arm;
use plant::build::Build;
use plant::mechanism::Instant;
use plant::reference::{Command, Session};

/// Step of the rehearsal, s.
const STEP: f64 = 0.004;
/// Step in rows between evaluations of effects that have no memory.
const STRIDE: usize = 8;

/// Commanded motion of a session and the plain plant's torque on it.
pub struct Rehearsal {
    arm: Arm,
    start: f64,
    rows: Vec<Command>,
    /// Rows inside a trajectory.
    inside: Vec<bool>,
    /// Rigid-body torque, N·m, by row and joint.
    rigid: Vec<Vec<f64>>,
    /// Torque and motion that the session demands of each joint.
    pub demand: Demand,
}

impl Rehearsal {
    /// Rehearses a session with the plain plant.
    ///
    /// # Errors
    /// The plant is not a possible robot.
    pub fn new(arm: &Arm, session: &Session) -> Result<Self, RobotError> {
        let n = arm.dof();
        let (robot, build) = (arm.robot()?, Build::plain(arm));
        let mut workspace = Workspace::new(&robot);
        let (start, end) = session.span();
        let count = ((end - start) / STEP) as usize;
        let zero = vec![0.0; n];
        let mut new = Self {
            arm: arm.clone(),
            start,
            rows: Vec::with_capacity(count),
            inside: Vec::with_capacity(count),
            rigid: Vec::with_capacity(count),
            demand: Demand {
                torque: zero.clone(),
                gravity: zero.clone(),
                greatest: zero.clone(),
                velocity: zero.clone(),
                power: zero.clone(),
            },
        };
        let demand = &mut new.demand;
        let mut weight = vec![0.0; n];
        let mut used = 0.0;
        for k in 0..count {
            let t = start + k as f64 * STEP;
            let mut c = Command::new(n);
            session.sample(t, &mut c);
            let mut tau = vec![0.0; n];
            inverse_dynamics(&robot, &mut workspace, &c.q, &c.qd, &c.qdd, &mut tau);
            inverse_dynamics(&robot, &mut workspace, &c.q, &zero, &zero, &mut weight);
            let spans = session.starts.iter().zip(&session.lengths);
            let inside = spans.clone().any(|(s, l)| (*s..s + l).contains(&t));
            if inside {
                used += 1.0;
                for j in 0..n {
                    let friction = build.friction[j].torque(c.qd[j]);
                    let whole = tau[j] + friction;
                    demand.torque[j] += whole * whole;
                    demand.gravity[j] += weight[j] * weight[j];
                    demand.greatest[j] = demand.greatest[j].max(whole.abs());
                    demand.velocity[j] += c.qd[j] * c.qd[j];
                    demand.power[j] += friction * c.qd[j];
                }
            }
            new.rows.push(c);
            new.rigid.push(tau);
            new.inside.push(inside);
        }
        for j in 0..n {
            for x in [
                &mut demand.torque,
                &mut demand.gravity,
                &mut demand.velocity,
            ] {
                x[j] = (x[j] / used).sqrt();
            }
            demand.power[j] /= used;
        }
        Ok(new)
    }

    /// Root mean square of the effect's torque per motor, N·m, were the motion as commanded.
    ///
    /// # Errors
    /// The effect makes the plant an impossible robot.
    pub fn effect(&self, effect: &dyn Withheld, size: f64) -> Result<Vec<f64>, RobotError> {
        let mut build = Build::plain(&self.arm);
        effect.apply(size, &mut build)?;
        let Some(part) = effect.yielding() else {
            return self.without_dynamics(&mut build);
        };
        match part.place() {
            Place::Gear(joint) => {
                let usual = self.demand.torque[joint];
                let by = |k: usize| part.deflection(size, self.rigid[k][joint], usual);
                self.displaced(&self.arm.robot()?, joint, by, false)
            }
            Place::Mount => {
                let robot = build.arm.robot()?;
                let moment = self.mount_moment(&robot);
                let usual = rms(moment.iter().copied());
                let by = |k: usize| part.deflection(size, moment[k], usual);
                self.displaced(&robot, 0, by, true)
            }
        }
    }

    /// Moment about the mount's hinge in each row.
    fn mount_moment(&self, robot: &Robot) -> Vec<f64> {
        let n = robot.dof();
        let mut workspace = Workspace::new(robot);
        let mut tau = vec![0.0; n];
        let with_hinge =
            |x: &[f64]| -> Vec<f64> { std::iter::once(0.0).chain(x.iter().copied()).collect() };
        let rows = self.rows.iter().map(|c| {
            let (q, qd, qdd) = (with_hinge(&c.q), with_hinge(&c.qd), with_hinge(&c.qdd));
            inverse_dynamics(robot, &mut workspace, &q, &qd, &qdd, &mut tau);
            tau[0]
        });
        rows.collect()
    }

    /// Torque by a displacement of one joint of `robot` against the commanded motion (quasi-static), or of a joint
    /// that stands before all others.
    fn displaced(
        &self,
        robot: &Robot,
        joint: usize,
        displacement: impl Fn(usize) -> f64,
        extra: bool,
    ) -> Result<Vec<f64>, RobotError> {
        let n = self.demand.torque.len();
        let first = usize::from(extra);
        let mut workspace = Workspace::new(robot);
        let mut tau = vec![0.0; n + first];
        let mut sum = vec![0.0; n];
        let mut used = 0.0;
        for k in (1..self.rows.len() - 1)
            .step_by(STRIDE)
            .filter(|&k| self.inside[k])
        {
            let [a, b, c] = [displacement(k - 1), displacement(k), displacement(k + 1)];
            let row = &self.rows[k];
            let widen = |x: &[f64]| -> Vec<f64> {
                std::iter::repeat_n(0.0, first)
                    .chain(x.iter().copied())
                    .collect()
            };
            let (mut q, mut qd, mut qdd) = (widen(&row.q), widen(&row.qd), widen(&row.qdd));
            q[joint] += b;
            qd[joint] += (c - a) / (2.0 * STEP);
            qdd[joint] += (a - 2.0 * b + c) / (STEP * STEP);
            inverse_dynamics(robot, &mut workspace, &q, &qd, &qdd, &mut tau);
            for j in 0..n {
                sum[j] += (tau[j + first] - self.rigid[k][j]).powi(2);
            }
            used += 1.0;
        }
        Ok(sum.iter().map(|s| (s / used).sqrt()).collect())
    }

    /// Torque of bodies, friction, mechanisms and measurement on the commanded motion itself.
    fn without_dynamics(&self, build: &mut Build) -> Result<Vec<f64>, RobotError> {
        let n = self.demand.torque.len();
        let robot = build.arm.robot()?;
        let plain = Build::plain(&self.arm);
        let altered = build.arm.joints != self.arm.joints;
        let mut workspace = Workspace::new(&robot);
        let (mut sum, mut used) = (vec![0.0; n], 0.0);
        let mut tau = vec![0.0; n];
        let delay = build.measurement.delay / STEP;
        for (k, row) in self.rows.iter().enumerate() {
            let now = Instant {
                t: self.start + k as f64 * STEP,
                dt: STEP,
                q: &row.q,
                v: &row.qd,
                a: &row.qdd,
                load: &self.rigid[k],
            };
            let mut force = vec![0.0; n];
            for m in &mut build.mechanisms {
                m.push(&now, &mut force);
                if let Some(j) = m.joint() {
                    force[j] -= m.resist(&now, row.qd[j]);
                }
                m.advance(&now, &row.qd);
            }
            if k % STRIDE != 0 || !self.inside[k] {
                continue;
            }
            used += 1.0;
            if altered {
                inverse_dynamics(&robot, &mut workspace, &row.q, &row.qd, &row.qdd, &mut tau);
            } else {
                tau.copy_from_slice(&self.rigid[k]);
            }
            let before = &self.rigid[k.saturating_sub(1)];
            for j in 0..n {
                let friction = build.friction[j].torque(row.qd[j]);
                let shifted = tau[j] - delay * (self.rigid[k][j] - before[j]);
                let torque = shifted + build.armature[j] * row.qdd[j] + friction - force[j];
                let noted = build.measurement.note(j, torque);
                sum[j] += (noted - self.rigid[k][j] - plain.friction[j].torque(row.qd[j])).powi(2);
            }
        }
        Ok(sum.iter().map(|s| (s / used).sqrt()).collect())
    }

    /// Size at which the effect makes `share` of the torque of the joint where it is largest (all joints if
    /// `joint` is none), and that joint. None where no plausible size makes about that share.
    ///
    /// # Errors
    /// The effect makes the plant an impossible robot.
    pub fn size_for(
        &self,
        effect: &dyn Withheld,
        joint: Option<usize>,
        share: f64,
    ) -> Result<Option<(f64, usize)>, RobotError> {
        let mut size = effect.smallest().min(effect.largest());
        let mut best = None;
        for _ in 0..7 {
            let rms = self.effect(effect, size)?;
            let at = joint.unwrap_or_else(|| largest(&rms));
            let found = rms[at] / self.demand.torque[at];
            if found.is_nan() || found < 1e-9 {
                return Ok(None);
            }
            best = (found > 0.6 * share && found < 1.6 * share).then_some((size, at));
            if (found / share - 1.0).abs() < 0.03 {
                break;
            }
            size = (size * (share / found).clamp(1e-3, 1e3)).min(effect.largest());
        }
        Ok(best)
    }
}

fn largest(x: &[f64]) -> usize {
    (0..x.len())
        .max_by(|&a, &b| x[a].total_cmp(&x[b]))
        .unwrap_or(0)
}
