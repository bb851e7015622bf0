//! What is known of a case to an observer who is told the true motion, the torque channel and the background, but neither
//! the withheld effect nor the plant's parameters: the basis of an upper bound on every diagnosis.

mod gear;
mod motion;
mod torque;

pub use torque::Mechanism;

use super::experiment::Chosen;
use super::hard::robot;
use super::nearly::nearly;
use super::rehearsal::Rehearsal;
use crate::effects::{Demand, Origin, Scene, Words};
use crate::lag::Lag;
use motion::Motion;
use physics::robot::RobotError;
use plant::arm::Arm;
use plant::reference::Session;
use plant::run::Trace;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;
use torque::Moved;

/// Torque log on the clock of the trace, and the law of its errors.
#[derive(Debug, Clone)]
pub struct TorqueLog {
    /// Torque of each row of the trace and each joint, as the log would have it, N·m.
    pub torque: Vec<f64>,
    /// Root mean square of each joint's torque without noise, N·m.
    pub rms: Vec<f64>,
    /// First row of each trajectory, and the end.
    pub bounds: Vec<usize>,
    /// Time between rows of the trace, s.
    pub tick: f64,
    /// Number of rows of the trace per row of the log.
    pub every: usize,
    /// Filter of each joint's torque.
    pub lag: Vec<Lag>,
    /// Standard deviation of each joint's noise, N·m.
    pub noise: Vec<f64>,
    /// Correlation of the noise from one row of the trace to the next.
    pub colour: f64,
    /// Step of each joint's logged number, N·m; 0 without steps.
    pub quantum: Vec<f64>,
    /// Whether each number is an outlier.
    pub outlier: Vec<bool>,
    /// Index of a joint with a bias, and the bias's standard deviation, N·m.
    pub bias: Option<(usize, f64)>,
}

/// Law by which the plant differs from the described robot.
#[derive(Debug, Clone, Copy)]
pub(super) enum Around {
    /// As in plain cases.
    Nearly,
    /// As in hard cases, with these widths of inertials and friction.
    Widths(f64, f64),
}

/// Withheld effect as the generator drew it.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// Function that drew the shape.
    pub origin: Origin,
    /// Random words of the draw; the last sets the share.
    pub words: Vec<u64>,
    /// Size of the effect, in the unit of its mechanism.
    pub size: f64,
}

/// What an observer may be told of a case, and the withheld effects as drawn, from which the observer's own search starts.
pub struct Witness {
    /// The torque log.
    pub log: TorqueLog,
    /// Torque of each background effect before the filter, by row of the trace and joint, N·m.
    pub background: Vec<Vec<f64>>,
    /// Withheld effects.
    pub withheld: Vec<Drawn>,
    nominal: Arm,
    around: Around,
    session: Session,
    rests: Vec<Range<f64>>,
    demand: Demand,
    inertia: Vec<f64>,
    moved: Moved,
}

/// Parts of a witness before anything is computed from them.
pub(super) struct Telling {
    pub nominal: Arm,
    pub plain: Arm,
    pub session: Session,
    pub trace: Trace,
    pub log: TorqueLog,
    pub background: Vec<Vec<f64>>,
    pub withheld: Vec<Drawn>,
    pub around: Around,
    pub rests: Vec<Range<f64>>,
}

/// The draws of withheld effects.
pub(super) fn drawn(withheld: &[Chosen]) -> Vec<Drawn> {
    let of = |c: &Chosen| {
        let source = c.source.clone()?;
        Some(Drawn {
            origin: source.origin,
            words: source.words,
            size: c.size,
        })
    };
    withheld.iter().filter_map(of).collect()
}

impl Telling {
    /// The witness.
    ///
    /// # Errors
    /// The bodies make no possible robot.
    pub(super) fn witness(self) -> Result<Witness, RobotError> {
        Ok(Witness {
            demand: Rehearsal::new(&self.plain, &self.session)?.demand,
            inertia: self.plain.inertia()?,
            moved: Moved::new(
                self.plain.clone(),
                Motion::new(&self.plain, &self.session, &self.trace)?,
            ),
            nominal: self.nominal,
            session: self.session,
            log: self.log,
            background: self.background,
            withheld: self.withheld,
            around: self.around,
            rests: self.rests,
        })
    }
}

impl Witness {
    /// Number of joints of the robot.
    pub fn dof(&self) -> usize {
        self.moved.plain.dof()
    }

    /// The plant without effects.
    pub fn plain(&self) -> &Arm {
        &self.moved.plain
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
        self.moved.added(mechanisms, trajectories)
    }

    /// A plant as the generator draws it around the described robot.
    pub fn another(&self, rng: &mut ChaCha8Rng) -> Arm {
        match self.around {
            Around::Nearly => nearly(&self.nominal, rng),
            Around::Widths(inertial, friction) => {
                let mut arm = self.nominal.clone();
                for joint in &mut arm.joints {
                    robot::alter(joint, inertial, friction, rng);
                }
                arm
            }
        }
    }

    /// The mechanism that the generator draws from these words, then from `rng`; none where the arm has no place for it.
    pub fn mechanism(&self, origin: Origin, words: &[u64], rng: &mut dyn Rng) -> Option<Mechanism> {
        let scene = Scene {
            arm: &self.moved.plain,
            session: &self.session,
            demand: &self.demand,
            inertia: &self.inertia,
        };
        let draw = |words: &[u64], rng: &mut dyn Rng| {
            let shape = origin.draw(&scene, &self.rests, &mut Words::new(words, rng))?;
            let words = shape.source.as_ref()?.words.clone();
            Some((shape, words))
        };
        let (shape, used) = draw(words, rng)?;
        // The last word sets the share, from the lowest to the highest.
        let end = |word: u64, rng: &mut dyn Rng| {
            let mut words = used.clone();
            *words.last_mut()? = word;
            draw(&words, rng).map(|(shape, _)| shape.share)
        };
        let shares = [end(0, rng)?, end(u64::MAX, rng)?];
        Some(Mechanism::new(origin, shape, shares, used))
    }

    /// Position, velocity and acceleration of all joints in a row of the trace.
    pub fn state(&self, row: usize) -> [&[f64]; 3] {
        self.moved.motion.state(self.moved.motion.recorded[row])
    }

    /// Torque of the plant without effects on the true motion, by row of the trace and joint, N·m.
    pub fn plain_torque(&self) -> Vec<f64> {
        let rows = self.moved.motion.recorded.iter();
        rows.flat_map(|&k| self.moved.motion.base(k).iter().copied())
            .collect()
    }
}
