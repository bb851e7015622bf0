//! Input of the dictionary's columns from one recording: motion at the fine rate, and torques that the present
//! model predicts on it. It holds no measured torque.

use crate::motion::channel::Channel;
use crate::motion::motor::{Band, Motor, Tangent, Tangents, Wide};
use crate::motion::part::Part;
use crate::motion::passage::History;
use nalgebra::Vector3;
use ndarray::{Array1, Array2, ArrayView1, Axis, Zip};
use physics::batch::{by_row, rigid_torque};
use physics::dynamics::inverse_dynamics_with_gravity;
use physics::effects::{
    Coupling, EarlySign, FrictionShape, Harmonic, PositionFriction, Sliding, Term,
};
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use rayon::prelude::*;
use signal::Motion;
use std::sync::Arc;

/// Velocity below which the sign of a motion is softened, rad/s (m/s), where the recording does not say better: well
/// below what docs/formats.md allows, so that the reversal keeps its shape.
pub const SOFT_SIGN: f64 = 0.001;

/// Highest velocity of softening that docs/formats.md allows for the sign of the model as given, rad/s (m/s).
const SOFTEST: f64 = 0.005;

/// Sizes of a recording by joint, to which the grids of shape parameters are relative.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Velocity below which the sign of friction is softened, rad/s (m/s).
    pub softness: Vec<f64>,
    /// Lead of Coulomb friction: time by which it reverses before the motion, s.
    pub lead: Vec<f64>,
    /// Root mean square velocity, rad/s (m/s).
    pub speed: Vec<f64>,
    /// Lowest and highest position of each joint, rad (m).
    pub range: Vec<(f64, f64)>,
    /// Root mean square of the torque to be explained in absolute terms (the measured one), N·m.
    pub torque: Vec<f64>,
    /// First and last time stamp of the session, s.
    pub session: (f64, f64),
    /// Sampling interval of the fine motion, s.
    pub step: f64,
    /// Delay of the recorded torque, where it is known.
    pub channel: Option<Arc<Channel>>,
    /// Integrated autocorrelation time of each joint's residual, rows, where a search has shown it.
    pub correlation_rows: Option<Arc<[f64]>>,
}

impl Scale {
    /// Sizes with the sign as docs/formats.md defines it for the model as given: no lead, and no softer than it allows.
    pub fn at_once(&self) -> Self {
        let mut own = self.clone();
        own.lead.fill(0.0);
        own.softness.iter_mut().for_each(|s| *s = s.min(SOFTEST));
        own
    }
}

/// Motion of one recording with the torque that the present model predicts on it; no measured torque. Tables have
/// shape (samples of the fine rate, joints).
pub struct Scene<'a> {
    /// Robot with the parameters of the present model.
    pub robot: &'a Robot,
    /// Motion of the recording at the fine rate.
    pub motion: &'a Motion,
    /// Sizes of the recording that is fitted.
    pub scale: &'a Scale,
    /// Softened sign of Coulomb friction.
    pub sign: Array2<f64>,
    /// Torque of the rigid body, N·m (N).
    pub rigid: Array2<f64>,
    /// Torque of friction (viscous and Coulomb), rotor inertia, counterbalance, springs, and further terms of
    /// an identified model, N·m (N).
    pub drive: Array2<f64>,
    /// Torque of the model as given, N·m (N), where the torque is known to be recorded late.
    pub given: Option<Array2<f64>>,
    tangents: Tangents,
    wide: Option<Wide<'a>>,
    passage: History<'a>,
    /// The scene of which this is a part, and the first sample there.
    whole: Option<(&'a Scene<'a>, usize)>,
}

impl<'a> Scene<'a> {
    /// Evaluates the model on a motion.
    pub fn new(robot: &'a Robot, passage: impl Into<History<'a>>, scale: &'a Scale) -> Self {
        let passage = passage.into();
        let motion = passage.motion();
        let mut sign = Array2::zeros(motion.qd.dim());
        for (j, column) in sign.columns_mut().into_iter().enumerate() {
            let own = EarlySign {
                velocity: scale.softness[j],
                lead: scale.lead[j],
            };
            Zip::from(column)
                .and(motion.qd.column(j))
                .and(motion.qdd.column(j))
                .for_each(|s, &qd, &qdd| *s = own.at(qd, qdd));
        }
        let rigid = rigid_torque(robot, &motion.q, &motion.qd, &motion.qdd);
        let wide = passage.wide().map(|motion| Wide {
            motion,
            rigid: rigid_torque(robot, &motion.q, &motion.qd, &motion.qdd),
            tangents: Tangents::new(robot.dof()),
        });
        let drive = drive_of(robot, motion, &sign);
        let given = scale.channel.as_ref().map(|c| {
            rigid_torque(&c.given, &motion.q, &motion.qd, &motion.qdd)
                + drive_of(&c.given, motion, &sign)
        });
        let mut scene = Self {
            robot,
            motion,
            scale,
            sign,
            rigid,
            drive,
            given,
            tangents: Tangents::new(robot.dof()),
            wide,
            passage,
            whole: None,
        };
        for (joint, terms) in scene.passage.beside().iter().enumerate() {
            let torque = scene.terms(joint, terms);
            for table in std::iter::once(&mut scene.drive).chain(&mut scene.given) {
                let mut column = table.column_mut(joint);
                column += &torque;
            }
        }
        scene
    }

    /// The scene of some of its trajectories.
    pub fn part<'p>(&'p self, part: &'p Part) -> Scene<'p> {
        let cut = |t: &Array2<f64>| {
            t.slice_axis(Axis(0), part.samples.clone().into())
                .to_owned()
        };
        Scene {
            robot: self.robot,
            motion: &part.motion,
            scale: self.scale,
            sign: cut(&self.sign),
            rigid: cut(&self.rigid),
            drive: cut(&self.drive),
            given: self.given.as_ref().map(cut),
            tangents: Tangents::new(self.dof()),
            wide: self
                .wide
                .as_ref()
                .zip(part.wide.as_ref())
                .map(|(w, motion)| Wide {
                    motion,
                    rigid: cut(&w.rigid),
                    tangents: Tangents::new(self.dof()),
                }),
            passage: self.passage.part(&part.motion),
            whole: Some((self, part.samples.start)),
        }
    }

    /// Motion in the whole band of the rows, where it differs.
    pub fn wide(&self) -> Option<&'a Motion> {
        self.passage.wide()
    }

    /// Partial derivatives of the rigid torque by the position, velocity and acceleration of a joint.
    pub fn tangent(&self, joint: usize) -> &Tangent {
        self.tangents
            .by(joint, self.robot, self.motion, &self.rigid)
    }

    /// Scene with all these derivatives, in the band of the rows too, computed on all cores.
    pub fn with_tangents(self) -> Self {
        (0..self.dof()).into_par_iter().for_each(|joint| {
            self.tangent(joint);
            self.motor(joint, Band::Rows);
        });
        self
    }

    /// Motion, rigid torque and its derivatives in a band. Both bands are one where the motion's cut-off is not below the
    /// rows' band.
    fn in_band(&self, band: Band) -> (&Motion, &Array2<f64>, &Tangents) {
        let wide = self.wide.as_ref().filter(|_| band == Band::Rows);
        wide.map_or((self.motion, &self.rigid, &self.tangents), |w| {
            (w.motion, &w.rigid, &w.tangents)
        })
    }

    /// Mean inertia that a joint turns in the recording, also where this scene is a part of it, kg·m².
    pub fn inertia(&self, joint: usize, band: Band) -> f64 {
        let (motion, rigid, tangents) = self.whole().in_band(band);
        tangents.inertia(joint, self.robot, motion, rigid)
    }

    /// Motion and torques that drive the transmission of a joint, in a band.
    pub fn motor(&self, joint: usize, band: Band) -> Motor<'_> {
        let (motion, rigid, tangents) = self.in_band(band);
        let tangent = tangents.by(joint, self.robot, motion, rigid);
        Motor {
            joint,
            qdd: motion.qdd.column(joint),
            rigid: rigid.column(joint),
            tangent,
            inertia: self.inertia(joint, band),
        }
    }

    /// Recorded difference between the position of a joint's motor and of its link, up to a constant.
    pub fn departed(&self, joint: usize, band: Band) -> Option<[ArrayView1<'a, f64>; 3]> {
        let all = self.passage.sensed()?.departure(joint, band)?;
        Some(all.each_ref().map(|x| self.own(x)))
    }

    /// Recorded temperature of a joint, °C.
    pub fn temperature(&self, joint: usize) -> Option<ArrayView1<'a, f64>> {
        let all = self.passage.sensed()?.temperature(joint)?;
        Some(self.own(all))
    }

    /// The scene of the whole recording of which this may be a part.
    pub fn whole(&self) -> &Scene<'a> {
        self.whole.map_or(self, |(whole, _)| whole)
    }

    /// Values at this scene's samples of a signal of the whole recording.
    pub fn own<'s>(&self, signal: &'s Array1<f64>) -> ArrayView1<'s, f64> {
        let first = self.whole.map_or(0, |(_, first)| first);
        signal.slice_axis(Axis(0), (first..first + self.len()).into())
    }

    /// Number of samples of the motion.
    pub fn len(&self) -> usize {
        self.motion.len()
    }

    /// Whether the motion has no sample.
    pub fn is_empty(&self) -> bool {
        self.motion.is_empty()
    }

    /// Number of joints of the robot.
    pub fn dof(&self) -> usize {
        self.motion.dof()
    }

    /// Torque that the present model predicts.
    pub fn predicted(&self) -> Array2<f64> {
        &self.rigid + &self.drive
    }

    /// Change of the torque of the model as given by the recording delay; none where the delay is not known.
    pub fn lateness(&self) -> Option<Array2<f64>> {
        let (channel, given) = (self.scale.channel.as_ref()?, self.given.as_ref()?);
        let mut out = -given;
        for (joint, mut column) in out.columns_mut().into_iter().enumerate() {
            column += &channel.recorded(self.motion, joint, given.column(joint));
        }
        Some(out)
    }

    /// Sum of terms of the torque model on one joint, each with its factor. Terms of the present sample alone
    /// are evaluated column by column, by their own functions. The others are stepped, with memory from earlier
    /// samples.
    pub fn terms(&self, joint: usize, terms: &[(f64, Term)]) -> Array1<f64> {
        let mut out = Array1::zeros(self.len());
        let mut stepped = Vec::new();
        for (factor, term) in terms {
            match self.at_once(joint, term) {
                Some(column) => out.scaled_add(*factor, &column),
                None => stepped.push((*factor, term.clone())),
            }
        }
        if !stepped.is_empty() {
            out += &self.stepped(joint, &stepped);
        }
        out
    }

    /// Sum of these terms stepped sample by sample, as in a control loop.
    pub fn stepped(&self, joint: usize, terms: &[(f64, Term)]) -> Array1<f64> {
        let load = |motion: &Motion| {
            if std::ptr::eq(motion, self.motion) {
                self.rigid.clone()
            } else {
                rigid_torque(self.robot, &motion.q, &motion.qd, &motion.qdd)
            }
        };
        self.passage.terms(joint, terms, load)
    }

    /// Column of a term that depends on the present sample alone; none for a term with memory.
    fn at_once(&self, joint: usize, term: &Term) -> Option<Array1<f64>> {
        let m = self.motion;
        let q = m.q.column(joint);
        let sliding = |of: usize, shape: &Sliding| match *shape {
            // Every friction of a joint needs its sign.
            Sliding::SoftCoulomb { velocity }
                if velocity == self.scale.softness[of] && self.scale.lead[of] == 0.0 =>
            {
                self.sign.column(of).to_owned()
            }
            shape => m.qd.column(of).mapv(|v| shape.at(v)),
        };
        let harmonic = |shape: &Harmonic| q.mapv(|q| shape.at(q));
        let time = || Array1::from(m.time.clone());
        let known = self.passage.clock_known();
        Some(match term {
            Term::Offset => Array1::ones(self.len()),
            Term::RotorInertia => m.qdd.column(joint).to_owned(),
            Term::Sliding(shape) => sliding(joint, shape),
            Term::Harmonic(shape) => harmonic(shape),
            Term::Polynomial(shape) => q.mapv(|q| shape.at(q)),
            Term::Position(PositionFriction {
                harmonic: shape,
                friction: FrictionShape::Sliding(friction),
            }) => harmonic(shape) * sliding(joint, friction),
            Term::Load(load) => match &load.friction {
                FrictionShape::Sliding(friction) => {
                    let carried = self.rigid.column(joint).mapv(|t| load.factor(t));
                    carried * sliding(joint, friction)
                }
                FrictionShape::Dahl(_) => return None,
            },
            Term::Coupling(Coupling::Friction { driver, shape }) => sliding(*driver, shape),
            Term::Coupling(coupling) => {
                let rows = |t: &'a Array2<f64>| {
                    let all = t.as_slice().expect("tables are in standard layout");
                    all.chunks(m.dof())
                };
                let (q, qd, qdd) = (rows(&m.q), rows(&m.qd), rows(&m.qdd));
                let each = q.zip(qd).zip(qdd);
                each.map(|((q, qd), qdd)| coupling.at(joint, q, qd, qdd))
                    .collect()
            }
            Term::WarmUp(w) => {
                let factor = time().mapv(|t| w.factor(known.then_some(t)));
                factor * self.at_once(joint, &w.term)?
            }
            Term::Drift(d) => {
                let factor = time().mapv(|t| d.factor(known.then_some(t)));
                factor * self.at_once(joint, &d.term)?
            }
            _ => return None,
        })
    }

    /// Mean over the samples of a factor that depends on the session's clock: its value where the clock is unknown.
    pub fn mean_over_session(&self, factor: impl Fn(f64) -> f64) -> f64 {
        let time = &self.motion.time;
        time.iter().map(|&t| factor(t)).sum::<f64>() / time.len().max(1) as f64
    }

    /// Coulomb friction with the joint's softened sign.
    pub fn coulomb(&self, joint: usize) -> Sliding {
        Sliding::SoftCoulomb {
            velocity: self.scale.softness[joint],
        }
    }

    /// Torque of one link alone with the inertial parameters `body`, shape (samples, joints).
    pub fn torque_of_link(&self, link: usize, body: &[f64; PARAMETERS_PER_LINK]) -> Array2<f64> {
        let mut parameters = vec![0.0; PARAMETERS_PER_LINK * self.dof()];
        parameters[PARAMETERS_PER_LINK * link..][..PARAMETERS_PER_LINK].copy_from_slice(body);
        let alone = self.robot.with_parameters(&parameters);
        let alone = alone.expect("as many parameters as the robot has");
        let m = self.motion;
        rigid_torque(&alone, &m.q, &m.qd, &m.qdd)
    }

    /// Change of the rigid torque from the robot's gravity to `gravity`.
    pub fn gravity_change(&self, gravity: Vector3<f64>) -> Array2<f64> {
        let m = self.motion;
        by_row(self.robot, &m.q, &m.qd, &m.qdd, |r, w, q, qd, qdd, tau| {
            inverse_dynamics_with_gravity(r, w, &gravity, q, qd, qdd, tau)
        }) - &self.rigid
    }
}

/// Torque of viscous and Coulomb friction, rotor inertia, counterbalance and springs. `sign` is the softened
/// sign of Coulomb friction.
fn drive_of(robot: &Robot, motion: &Motion, sign: &Array2<f64>) -> Array2<f64> {
    let mut drive = Array2::zeros(motion.q.dim());
    for (j, joint) in robot.joints().iter().enumerate() {
        let mut out = drive.column_mut(j);
        out.scaled_add(joint.damping, &motion.qd.column(j));
        out.scaled_add(joint.friction, &sign.column(j));
        out.scaled_add(joint.rotor_inertia, &motion.qdd.column(j));
    }
    for p in robot.passive() {
        let torque = motion.q.column(p.joint()).mapv(|q| p.torque(q));
        let mut out = drive.column_mut(p.joint());
        out += &torque;
    }
    drive
}

/// Sign tanh(q̇/ε) softened below [`SOFT_SIGN`], for quantities that are not the motion of a single joint.
pub fn soft_sign(qd: f64) -> f64 {
    (qd / SOFT_SIGN).tanh()
}
