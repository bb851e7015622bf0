//! A loaded model, asked once per control period.

use super::residual::Residual;
use crate::clock::{Memory, last_before};
use crate::dynamics::Dynamics;
use crate::network::Inside;
use physics::effects::Sample;
use physics::torque_model::Predictor;

/// A loaded model: physics, and the compensator where there is one.
///
/// [`Feedforward::torque`] is called once per control period and keeps friction memory and windows
/// in between; it does not allocate.
///
/// ```no_run
/// let mut model = feedforward::Feedforward::load("residyn-model".as_ref(), Some(0.001))?;
/// let (q, qd, qdd, mut tau) = ([0.0; 6], [0.0; 6], [0.0; 6], [0.0; 6]);
/// model.torque(&q, &qd, &qdd, &mut tau);
/// # Ok::<(), feedforward::LoadError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Feedforward {
    pub(super) predictor: Predictor,
    pub(super) dynamics: Dynamics,
    pub(super) residual: Option<Residual>,
    pub(super) period: f64,
    pub(super) clock: Option<f64>,
    /// Time from the sample before to the next one, s; zero before the first sample.
    pub(super) elapsed: f64,
    /// Time spans of the training trajectories on the clock, s, and the memory at the end of each.
    pub(super) known: Vec<[f64; 2]>,
    pub(super) memory: Vec<Memory>,
    /// Names of the joints, base first.
    pub(super) names: Vec<String>,
    /// Motion of this period without denormal numbers, with which arithmetic is slow: positions, velocities, accelerations.
    pub(super) motion: [Vec<f64>; 3],
}

impl Feedforward {
    /// The model without its compensator.
    #[must_use]
    pub fn without_compensator(mut self) -> Self {
        self.residual = None;
        self
    }

    /// Number of joints of the robot.
    pub fn dof(&self) -> usize {
        self.names.len()
    }

    /// Names of the joints, base first.
    pub fn joint_names(&self) -> &[String] {
        &self.names
    }

    /// Whether there is a compensator.
    pub fn is_compensated(&self) -> bool {
        self.residual.is_some()
    }

    /// Rigid-body dynamics of the model for control loops, beside its torque.
    pub fn dynamics(&mut self) -> &mut Dynamics {
        &mut self.dynamics
    }

    /// Friction in the last torque, N·m or N, by joint.
    pub fn friction(&self) -> &[f64] {
        self.predictor.friction()
    }

    /// Compensator's part of the last torque, N·m or N, by joint; None without one.
    pub fn compensation(&self) -> Option<&[f64]> {
        self.residual.as_ref().map(Residual::share)
    }

    /// Position of the last sample relative to the compensator's training samples.
    ///
    /// # Panics
    /// When the robot has fewer joints.
    pub fn inside(&self, joint: usize) -> Inside {
        self.residual
            .as_ref()
            .map_or(Inside::NOTHING_LEARNED, |residual| residual.inside(joint))
    }

    /// Control period of the loop, s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Forgets friction memory and windows. `clock` is the time of the next sample on the session clock of
    /// the training recordings in s, where this loop continues it: friction memory then goes on from the
    /// training trajectory before. Without it, memory is neutral and warm-up terms take their mean.
    pub fn reset(&mut self, clock: Option<f64>) {
        let known = clock.and_then(|now| {
            let index = last_before(&self.known, now)?;
            self.memory.get(index)?;
            Some((now - self.known[index][1], index))
        });
        self.begin(clock, known);
    }

    /// Starts where the joints have been moved since the training: friction memory and windows are neutral; `clock` is the time of
    /// the next sample on the session clock of the training recordings in s, by which the gears have been warming.
    pub fn start(&mut self, clock: Option<f64>) {
        self.begin(clock, None);
    }

    /// Starts from the memory `known`: time since it was stored, s, and its index.
    fn begin(&mut self, clock: Option<f64>, known: Option<(f64, usize)>) {
        let memory = known.and_then(|(_, index)| self.memory.get(index));
        self.clock = clock;
        self.elapsed = known.map_or(0.0, |(elapsed, _)| elapsed);
        self.predictor
            .restore(memory.map_or(&[], |memory| &memory.physics));
        if let Some(residual) = &mut self.residual {
            residual.restore(memory.map_or(&[], |memory| &memory.inputs));
        }
    }

    /// Starts a new trajectory `seconds` after the last sample: friction memory and clock run on, windows
    /// start anew.
    pub fn pause(&mut self, seconds: f64) {
        if let Some(clock) = &mut self.clock {
            *clock += seconds - self.elapsed;
        }
        self.elapsed = seconds;
        if let Some(residual) = &mut self.residual {
            residual.rewind();
        }
    }

    /// Torque of every joint (N·m or N) for the motion of this control period; all slices have one
    /// entry per joint, in URDF order.
    ///
    /// Where a value of the motion is not finite every torque is NaN, and the model's memory is unchanged: the
    /// next finite sample continues from there.
    ///
    /// # Panics
    /// When a slice has another length.
    pub fn torque(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        if ![q, qd, qdd].iter().all(|x| x.iter().all(|v| v.is_finite())) {
            tau.fill(f64::NAN);
            self.miss(1);
            return;
        }
        for (own, given) in self.motion.iter_mut().zip([q, qd, qdd]) {
            own.copy_from_slice(given);
            own.iter_mut()
                .filter(|v| v.is_subnormal())
                .for_each(|v| *v = 0.0);
        }
        let [q, qd, qdd] = &self.motion;
        let dt = std::mem::replace(&mut self.elapsed, self.period);
        self.predictor.step(self.clock, dt, q, qd, qdd, tau);
        if let Some(residual) = &mut self.residual {
            let load = self.predictor.load();
            residual.add(
                &Sample {
                    clock: self.clock,
                    dt,
                    q,
                    qd,
                    qdd,
                    load,
                },
                tau,
            );
        }
        if let Some(clock) = &mut self.clock {
            *clock += self.period;
        }
    }

    /// Lets control periods pass without a sample; windows start anew after more than one period of the compensator's training.
    pub fn miss(&mut self, periods: usize) {
        let missed = periods as f64 * self.period;
        // At the start of a recording nothing lies before the next sample, however late it comes.
        if self.elapsed > 0.0 {
            self.elapsed += missed;
        }
        if let Some(clock) = &mut self.clock {
            *clock += missed;
        }
        if let Some(residual) = &mut self.residual {
            residual.miss(periods);
        }
    }
}
