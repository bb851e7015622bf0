//! Guard between a model and the drives: it limits the torque that a loop may send, whatever its input.
//!
//! A [`Guard`] asks its model once per tick and gives a torque within the limits and the rate limits. It starts
//! and stops without a jump, and holds the last torque where the input is no valid motion. [`Status`] tells
//! what happened.

mod pace;
mod settings;
mod status;
#[cfg(test)]
mod tests;

pub use pace::Pace;
pub use settings::{Settings, SettingsError};
pub use status::Status;

use crate::Feedforward;
use pace::{Clock, Tick};

/// A model with a guard for its torque. [`Guard::tick`] does not allocate.
#[derive(Debug, Clone)]
pub struct Guard {
    model: Feedforward,
    settings: Settings,
    clock: Clock,
    phase: Phase,
    /// Torque of the last tick, N·m or N.
    sent: Vec<f64>,
    /// Torque at the beginning of the ramp, N·m or N.
    from: Vec<f64>,
    asked: Vec<f64>,
    ahead: Ahead,
    gravity: Vec<f64>,
    /// Periods for which the last torque has been held.
    held: usize,
}

/// Phase of a guard; a ramp holds its elapsed time, s.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Stopped,
    Starting(f64),
    Running,
    Stopping(f64),
}

impl Guard {
    /// A guard that is stopped, with the robot's effort limits.
    pub fn new(mut model: Feedforward) -> Self {
        let n = model.dof();
        let joints = model.dynamics().robot().joints();
        let settings = Settings::new(joints.iter().map(|j| j.limits.effort).collect());
        Self {
            settings,
            clock: Clock::default(),
            phase: Phase::Stopped,
            sent: vec![0.0; n],
            from: vec![0.0; n],
            asked: vec![0.0; n],
            ahead: Ahead::new(n),
            gravity: vec![0.0; n],
            held: 0,
            model,
        }
    }

    /// Model that the guard asks for torque.
    pub fn model(&self) -> &Feedforward {
        &self.model
    }

    /// The model, to reset it or to ask for parts of its torque.
    pub fn model_mut(&mut self) -> &mut Feedforward {
        &mut self.model
    }

    /// Limits and times of the guard.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Sets limits and times; they hold from the next tick on.
    ///
    /// # Errors
    /// A wrong number of limits, a negative one, NaN, or a time that is negative or not finite.
    pub fn set(&mut self, settings: Settings) -> Result<(), SettingsError> {
        settings.check(self.model.dof())?;
        self.settings = settings;
        Ok(())
    }

    /// Starts a ramp from the last torque to the model's; the caller's time starts anew.
    pub fn start(&mut self) {
        self.clock = Clock::default();
        self.held = 0;
        self.ramp(Phase::Starting(0.0));
    }

    /// Starts a ramp from the last torque to zero.
    pub fn stop(&mut self) {
        if !matches!(self.phase, Phase::Stopped | Phase::Stopping(_)) {
            self.ramp(Phase::Stopping(0.0));
        }
    }

    fn ramp(&mut self, phase: Phase) {
        self.from.copy_from_slice(&self.sent);
        self.phase = phase;
    }

    /// Timing of the caller's ticks since the last start.
    pub fn pace(&self) -> Pace {
        self.clock.pace
    }

    /// Torque to send at `time` (s, of any clock that does not jump) for the motion of this tick. Slices have one value per joint.
    ///
    /// # Panics
    /// When a slice has another length.
    pub fn tick(
        &mut self,
        time: f64,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        tau: &mut [f64],
    ) -> Status {
        assert_eq!(tau.len(), self.sent.len(), "one value per joint is needed");
        let mut status = self.ask(time, q, qd, qdd);
        let usable = !HELD.iter().any(|flag| status.has(*flag));
        if usable {
            self.held = 0;
        } else {
            self.held = self.held.saturating_add(1);
            if self.held as f64 * self.model.period() > self.settings.hold {
                status |= Status::OVERRUN;
            }
        }
        if status.has(Status::OVERRUN) {
            self.stop();
        }
        self.send(usable, &mut status);
        tau.copy_from_slice(&self.sent);
        status
    }

    /// Asks the model and stores its torque in `asked`.
    fn ask(&mut self, time: f64, q: &[f64], qd: &[f64], qdd: &[f64]) -> Status {
        let finite = |x: &[f64]| x.iter().all(|v| v.is_finite());
        if !(time.is_finite() && finite(q) && finite(qd) && finite(qdd)) {
            if time.is_finite() {
                // The period has passed; the next tick is not late for it.
                match self.clock.tick(time, self.model.period()) {
                    Tick::Next { missed } => self.model.miss(missed.saturating_add(1)),
                    Tick::Stale | Tick::Backward => {}
                }
            }
            return Status::BAD_INPUT;
        }
        let mut status = Status::default();
        match self.clock.tick(time, self.model.period()) {
            Tick::Stale => return Status::STALE,
            Tick::Backward => return Status::BACKWARD,
            Tick::Next { missed: 0 } => {}
            Tick::Next { missed } => {
                status |= Status::LATE;
                if missed as f64 * self.model.period() > self.settings.hold {
                    status |= Status::OVERRUN;
                }
                self.model.miss(missed);
            }
        }
        let (later, rate) = self.ahead.by(self.settings.drive_delay, q, qd, qdd);
        self.model.torque(later, rate, qdd, &mut self.asked);
        if self.settings.drive_adds_gravity {
            self.model.dynamics().gravity(later, &mut self.gravity);
            for (asked, gravity) in self.asked.iter_mut().zip(&self.gravity) {
                *asked -= gravity;
            }
        }
        if !finite(&self.asked) {
            return status | Status::BAD_TORQUE;
        }
        status | self.remarks(q)
    }

    /// Remarks on the last sample at positions `q`: position limits, compensators faded or off.
    pub fn remarks(&mut self, q: &[f64]) -> Status {
        let mut status = Status::default();
        for (joint, q) in q.iter().enumerate() {
            let weight = self.model.inside(joint).weight;
            if weight < 1.0 {
                status |= Status::FADED;
            }
            if weight == 0.0 {
                status |= Status::UNCOMPENSATED;
            }
            let limits = &self.model.dynamics().robot().joints()[joint].limits;
            if *q < limits.lower || *q > limits.upper {
                status |= Status::POSITION_OUTSIDE;
            }
        }
        status
    }

    /// Torque to send from the torque asked. Where the input was not usable the last torque is held, except during a stop.
    fn send(&mut self, usable: bool, status: &mut Status) {
        let period = self.model.period();
        let ramp = self.settings.ramp;
        let part = |passed: f64| if passed < ramp { passed / ramp } else { 1.0 };
        // The part of the ramp at this tick, and whether it leads to the model's torque.
        let (share, up) = match &mut self.phase {
            Phase::Stopped => {
                *status |= Status::STOPPED;
                (1.0, false)
            }
            Phase::Stopping(passed) => {
                *passed += period;
                *status |= Status::STOPPING;
                (part(*passed), false)
            }
            Phase::Starting(_) | Phase::Running if !usable => return self.limit(status),
            Phase::Starting(passed) => {
                *passed += period;
                *status |= Status::STARTING;
                (part(*passed), true)
            }
            Phase::Running => (1.0, true),
        };
        let mut settled = true;
        for (joint, sent) in self.sent.iter_mut().enumerate() {
            let target = if up { self.asked[joint] } else { 0.0 };
            let wanted = target * share + self.from[joint] * (1.0 - share);
            let step = self.settings.rate[joint] * period;
            if (wanted - *sent).abs() > step {
                *status |= Status::RATE_LIMITED;
                *sent += step.copysign(wanted - *sent);
                settled = false;
            } else {
                *sent = wanted;
            }
        }
        self.limit(status);
        self.phase = match self.phase {
            Phase::Starting(passed) if passed >= ramp => Phase::Running,
            Phase::Stopping(passed) if passed >= ramp && settled => Phase::Stopped,
            same => same,
        };
    }

    /// Cuts what is sent at the limits of the torque. One that is held may lie above them: they can be lowered at any time.
    fn limit(&mut self, status: &mut Status) {
        for (sent, limit) in self.sent.iter_mut().zip(&self.settings.torque) {
            if sent.abs() > *limit {
                *status |= Status::TORQUE_LIMITED;
                *sent = sent.clamp(-limit, *limit);
            }
        }
    }
}

/// The motion some time later, at constant acceleration.
#[derive(Debug, Clone)]
struct Ahead {
    q: Vec<f64>,
    qd: Vec<f64>,
}

impl Ahead {
    fn new(joints: usize) -> Self {
        Self {
            q: vec![0.0; joints],
            qd: vec![0.0; joints],
        }
    }

    /// Position and velocity after `time` s.
    fn by(&mut self, time: f64, q: &[f64], qd: &[f64], qdd: &[f64]) -> (&[f64], &[f64]) {
        let each = self.q.iter_mut().zip(&mut self.qd);
        for (((ahead, rate), q), (qd, qdd)) in each.zip(q).zip(qd.iter().zip(qdd)) {
            *ahead = q + time * (qd + 0.5 * time * qdd);
            *rate = qd + time * qdd;
        }
        (&self.q, &self.qd)
    }
}

/// Flags with which the last torque is held.
const HELD: [Status; 4] = [
    Status::BAD_INPUT,
    Status::BAD_TORQUE,
    Status::BACKWARD,
    Status::STALE,
];
