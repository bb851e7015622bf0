//! Torque that a mechanism adds to the plant on the true motion.

use super::gear::Gears;
use super::motion::{Motion, STEP, STRIDE};
use crate::effects::{Origin, Shape, Withheld};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::RobotError;
use plant::arm::Arm;
use plant::build::Build;
use plant::mechanism::Instant;

/// A mechanism as the generator draws it, without its size.
pub struct Mechanism {
    /// Function that drew it.
    pub origin: Origin,
    /// Index of the joint on which its share is taken; none for the joint where it is largest.
    pub joint: Option<usize>,
    /// Least and greatest share of that joint's torque, between which the logarithm is uniform.
    pub shares: [f64; 2],
    /// Share that the words gave.
    pub share: f64,
    /// Random words of the draw; the last sets the share.
    pub words: Vec<u64>,
    effect: Box<dyn Withheld>,
}

impl Mechanism {
    pub(super) fn new(origin: Origin, shape: Shape, shares: [f64; 2], words: Vec<u64>) -> Self {
        Self {
            origin,
            joint: shape.joint,
            shares,
            share: shape.share,
            words,
            effect: shape.effect,
        }
    }

    /// Least and greatest plausible size, in the unit of the mechanism.
    pub fn sizes(&self) -> [f64; 2] {
        [self.effect.smallest(), self.effect.largest()]
    }

    /// Joints that the effect belongs to in a report, on an arm with `dof` joints; none: the whole arm.
    pub fn joints(&self, dof: usize) -> Option<Vec<usize>> {
        self.effect.describe(1e-3, dof).joints
    }

    /// Whether another draw gave the same shape.
    pub fn is_like(&self, other: &Self) -> bool {
        self.joint == other.joint && format!("{:?}", self.effect) == format!("{:?}", other.effect)
    }
}

/// The plant without effects on the true motion.
pub struct Moved {
    /// The plant.
    pub plain: Arm,
    /// Its motion.
    pub motion: Motion,
    gears: Gears,
}

impl Moved {
    /// The plant on a motion.
    pub fn new(plain: Arm, motion: Motion) -> Self {
        Self {
            plain,
            motion,
            gears: Gears::default(),
        }
    }

    /// Torque that mechanisms of these sizes add together in the first `trajectories` trajectories: by joint a value for each row of the
    /// trace, N·m, none for a joint without any.
    ///
    /// # Errors
    /// The altered bodies make no possible robot.
    pub fn added(
        &self,
        mechanisms: &[(&Mechanism, f64)],
        trajectories: usize,
    ) -> Result<Vec<Option<Vec<f64>>>, RobotError> {
        let motion = &self.motion;
        let n = motion.dof;
        let end = motion.starts[trajectories];
        let mut added = vec![0.0; end * n];
        let mut build = Build::plain(&self.plain);
        for (m, size) in mechanisms {
            if m.effect.yielding().is_some() {
                self.gears.add(
                    &self.plain,
                    motion,
                    (m.effect.as_ref(), *size),
                    trajectories,
                    &mut added,
                )?;
            } else {
                m.effect.apply(*size, &mut build)?;
            }
        }
        if build.arm.joints != self.plain.joints {
            self.bodies(&build.arm, end, &mut added)?;
        }
        self.forces(&mut build, &mut added);
        self.measured(&build, trajectories, &mut added);
        let rows = &motion.recorded[..motion.bounds[trajectories]];
        let column = |j: usize| {
            let column: Vec<f64> = rows.iter().map(|k| added[k * n + j]).collect();
            column.iter().any(|x| x.abs() > 1e-12).then_some(column)
        };
        Ok((0..n).map(column).collect())
    }

    /// Adds the difference of the altered arm's rigid-body torque.
    fn bodies(&self, arm: &Arm, end: usize, added: &mut [f64]) -> Result<(), RobotError> {
        let n = self.motion.dof;
        let robot = arm.robot()?;
        let mut workspace = Workspace::new(&robot);
        let mut tau = vec![0.0; n];
        let mut last: Option<Vec<f64>> = None;
        for k in (0..end).step_by(STRIDE) {
            let [q, v, a] = self.motion.state(k);
            inverse_dynamics(&robot, &mut workspace, q, v, a, &mut tau);
            let plain = &self.motion.rigid[k * n..][..n];
            let here: Vec<f64> = tau.iter().zip(plain).map(|(t, p)| t - p).collect();
            if let Some(before) = &last {
                for (i, w) in (1..STRIDE).map(|i| (i, i as f64 / STRIDE as f64)) {
                    for j in 0..n {
                        added[(k - STRIDE + i) * n + j] += before[j] + w * (here[j] - before[j]);
                    }
                }
            }
            for j in 0..n {
                added[k * n + j] += here[j];
            }
            last = Some(here);
        }
        Ok(())
    }

    /// Adds the torque of mechanisms, rotors and changed friction.
    fn forces(&self, build: &mut Build, added: &mut [f64]) {
        let motion = &self.motion;
        let n = motion.dof;
        let plain = Build::plain(&self.plain);
        let rubs: Vec<usize> = (0..n)
            .filter(|&j| build.friction[j] != plain.friction[j])
            .collect();
        let mut force = vec![0.0; n];
        for (k, added) in added.chunks_mut(n).enumerate() {
            let [q, v, a] = motion.state(k);
            let now = Instant {
                t: motion.time[k],
                dt: STEP,
                q,
                v,
                a,
                load: &motion.rigid[k * n..][..n],
            };
            force.fill(0.0);
            for m in &mut build.mechanisms {
                m.push(&now, &mut force);
                if let Some(j) = m.joint() {
                    force[j] -= m.resist(&now, v[j]);
                }
                m.advance(&now, v);
            }
            for j in 0..n {
                added[j] += build.armature[j] * a[j] - force[j];
            }
            for &j in &rubs {
                added[j] += build.friction[j].torque(v[j]) - plain.friction[j].torque(v[j]);
            }
        }
    }

    /// Passes the whole torque through the measurement chain of the build.
    fn measured(&self, build: &Build, trajectories: usize, added: &mut [f64]) {
        let n = self.motion.dof;
        let chain = &build.measurement;
        if *chain == plant::build::Measurement::faithful(n) {
            return;
        }
        let late = chain.delay / STEP;
        for w in self.motion.starts[..=trajectories].windows(2) {
            let whole: Vec<f64> = (w[0]..w[1])
                .flat_map(|k| {
                    let own = added[k * n..][..n].iter();
                    own.zip(self.motion.base(k))
                        .map(|(a, b)| a + b)
                        .collect::<Vec<_>>()
                })
                .collect();
            let rows = w[1] - w[0];
            for k in 0..rows {
                let x = (k as f64 - late).clamp(0.0, (rows - 1) as f64);
                let (i, part) = (x as usize, x.fract());
                let next = (i + 1).min(rows - 1);
                for j in 0..n {
                    let (a, b) = (whole[i * n + j], whole[next * n + j]);
                    let noted = chain.note(j, a + part * (b - a));
                    added[(w[0] + k) * n + j] = noted - self.motion.base(w[0] + k)[j];
                }
            }
        }
    }
}
