//! Torque beyond rigid-body dynamics: friction, memory, heat, transmissions.
//!
//! A [`Term`] is one column of a linear model: the torque on one joint, in N·m (N for prismatic
//! joints), for a parameter of one. Its shape parameters (a velocity, a width, a time) are fixed
//! inside the term and chosen on short grids. Terms are causal: [`TermBank::step`] takes one
//! sample after the other and keeps what memory needs, so that a recording evaluated at once and a
//! control loop that asks sample by sample read the same numbers.

mod bank;
mod coupling;
mod drift;
mod early_sign;
mod harmonic;
mod hysteresis;
mod load;
mod polynomial;
mod position;
mod relaxation;
mod shape;
mod sliding;
mod warmup;

pub use crate::robot::{Counterbalance, Spring};
pub use bank::{BankState, Sample, TermBank, columns};
pub use coupling::Coupling;
pub use drift::Drift;
pub use early_sign::EarlySign;
pub use harmonic::{Harmonic, Phase};
pub use hysteresis::{Dahl, Stop};
pub use load::LoadFriction;
pub use polynomial::Polynomial;
pub use position::PositionFriction;
pub use relaxation::LaggedSign;
pub use shape::FrictionShape;
pub use sliding::Sliding;
pub use warmup::WarmUp;

use crate::robot::Passive;
use serde::{Deserialize, Serialize};

/// One column of a joint's friction and memory model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Term {
    /// Bias of the torque: the column is one. Parameter in N·m.
    Offset,
    /// Reflected inertia of motor and gear: the column is q̈. Parameter in kg·m².
    RotorInertia,
    /// Friction that depends on the present velocity alone.
    Sliding(Sliding),
    /// Coulomb friction whose sign changes before that of the velocity.
    EarlySign(EarlySign),
    /// Maxwell-slip element: a spring that slides at a given displacement.
    Stop(Stop),
    /// Dahl's friction: the bristle's state times its stiffness.
    Dahl(Dahl),
    /// Rate of Dahl's friction state: damping of the bristles in presliding. Parameter in N·m·s.
    DahlRate(Dahl),
    /// Direction of motion through a first-order lag.
    LaggedSign(LaggedSign),
    /// Friction that grows with the transmitted torque.
    Load(LoadFriction),
    /// Friction that changes with the joint's position.
    Position(PositionFriction),
    /// Torque that changes slowly over the joint's position.
    Polynomial(Polynomial),
    /// Torque periodic in the joint's position.
    Harmonic(Harmonic),
    /// Torque caused by the motion of another joint.
    Coupling(Coupling),
    /// Gas or hydraulic counterbalance of the joint's own position.
    Counterbalance(Counterbalance),
    /// Linear spring of the joint's own position.
    Spring(Spring),
    /// Warm-up: another term whose coefficient fades as the robot warms up.
    WarmUp(WarmUp),
    /// Drift: another term whose coefficient changes evenly over the session.
    Drift(Drift),
}

impl Term {
    /// Name of the effect that the term belongs to, as the diagnosis names it where it has a name.
    pub fn effect(&self) -> &'static str {
        match self {
            Term::Offset => "torque_offset",
            Term::RotorInertia => "rotor_inertia",
            Term::Sliding(s) => s.effect(),
            Term::EarlySign(_) => "friction_parameters",
            Term::Stop(_) | Term::Dahl(_) | Term::DahlRate(_) | Term::LaggedSign(_) => {
                "presliding_hysteresis"
            }
            Term::Load(_) => "load_dependent_friction",
            Term::Position(_) => "position_dependent_friction",
            Term::Harmonic(_) => "torque_ripple",
            Term::Coupling(_) => "joint_coupling",
            Term::Counterbalance(_) | Term::Spring(_) | Term::Polynomial(_) => "counterbalance",
            Term::WarmUp(_) | Term::Drift(_) => "friction_drift",
        }
    }

    /// Index of another joint that drives the term, if one does.
    pub fn driver(&self) -> Option<usize> {
        match self {
            Term::Coupling(c) => Some(c.driver()),
            Term::WarmUp(w) => w.term.driver(),
            Term::Drift(d) => d.term.driver(),
            _ => None,
        }
    }

    /// Passive torque that the robot's description gives, where the term is one. It is known and is not fitted.
    pub fn passive(&self) -> Option<Passive> {
        match self {
            Term::Counterbalance(c) => Some(Passive::Counterbalance(*c)),
            Term::Spring(s) => Some(Passive::Spring(*s)),
            _ => None,
        }
    }

    /// Whether the term is friction of its own joint: it opposes motion, or remembers how it did.
    pub fn is_friction(&self) -> bool {
        match self {
            Term::Sliding(_)
            | Term::EarlySign(_)
            | Term::Stop(_)
            | Term::Dahl(_)
            | Term::DahlRate(_)
            | Term::LaggedSign(_)
            | Term::Load(_)
            | Term::Position(_) => true,
            Term::WarmUp(w) => w.term.is_friction(),
            Term::Drift(d) => d.term.is_friction(),
            Term::Offset
            | Term::RotorInertia
            | Term::Harmonic(_)
            | Term::Polynomial(_)
            | Term::Coupling(_)
            | Term::Counterbalance(_)
            | Term::Spring(_) => false,
        }
    }

    /// Whether the column depends on motion before the present sample.
    pub fn remembers(&self) -> bool {
        match self {
            Term::Stop(_) | Term::Dahl(_) | Term::DahlRate(_) | Term::LaggedSign(_) => true,
            Term::Load(l) => l.friction.remembers(),
            Term::Position(p) => p.friction.remembers(),
            Term::WarmUp(w) => w.term.remembers(),
            Term::Drift(d) => d.term.remembers(),
            Term::Offset
            | Term::RotorInertia
            | Term::Sliding(_)
            | Term::EarlySign(_)
            | Term::Harmonic(_)
            | Term::Polynomial(_)
            | Term::Coupling(_)
            | Term::Counterbalance(_)
            | Term::Spring(_) => false,
        }
    }

    /// Whether the column depends on the torque that the joint's transmission carries.
    pub fn sees_load(&self) -> bool {
        match self {
            Term::Load(_) => true,
            Term::WarmUp(w) => w.term.sees_load(),
            Term::Drift(d) => d.term.sees_load(),
            Term::Offset
            | Term::RotorInertia
            | Term::Sliding(_)
            | Term::EarlySign(_)
            | Term::Stop(_)
            | Term::Dahl(_)
            | Term::DahlRate(_)
            | Term::LaggedSign(_)
            | Term::Position(_)
            | Term::Harmonic(_)
            | Term::Polynomial(_)
            | Term::Coupling(_)
            | Term::Counterbalance(_)
            | Term::Spring(_) => false,
        }
    }

    /// Readable name with the shape parameters, such as `stop(0.0017 rad)`.
    pub fn label(&self) -> String {
        match self {
            Term::Offset => "offset".into(),
            Term::RotorInertia => "rotor_inertia".into(),
            Term::Sliding(s) => s.label(),
            Term::EarlySign(e) => format!("coulomb({:.3}, {:.4} s early)", e.velocity, e.lead),
            Term::Stop(s) => format!("stop({:.3e})", s.width),
            Term::Dahl(d) => format!("dahl({:.3e})", d.stiffness),
            Term::LaggedSign(l) => format!("lagged_sign({:.3} s)", l.time_constant),
            Term::DahlRate(d) => format!("rate of dahl({:.3e})", d.stiffness),
            Term::Load(l) => l.label(),
            Term::Position(p) => format!("{}*{}", p.harmonic.label(), p.friction.label()),
            Term::Polynomial(p) => format!("legendre({})", p.degree),
            Term::Harmonic(h) => h.label(),
            Term::Coupling(c) => c.label(),
            Term::Counterbalance(_) => "counterbalance".into(),
            Term::Spring(s) => format!("spring({:.3e}, {:.3})", s.stiffness, s.rest),
            Term::WarmUp(w) => format!("warm_up({:.0} s)*{}", w.time_constant, w.term.label()),
            Term::Drift(d) => format!("drift*{}", d.term.label()),
        }
    }

    /// Unit of the term's parameter for a revolute joint.
    pub fn unit(&self) -> &'static str {
        match self {
            Term::RotorInertia => "kg·m²",
            Term::Sliding(s) => s.unit(),
            Term::Load(l) => l.unit(),
            Term::Position(p) => p.friction.unit(),
            Term::Coupling(c) => c.unit(),
            Term::Counterbalance(_) | Term::Spring(_) => "1",
            Term::WarmUp(w) => w.term.unit(),
            Term::Drift(d) => d.term.unit(),
            Term::DahlRate(_) => "N·m·s",
            _ => "N·m",
        }
    }
}

impl From<Passive> for Term {
    fn from(passive: Passive) -> Self {
        match passive {
            Passive::Counterbalance(c) => Self::Counterbalance(c),
            Passive::Spring(s) => Self::Spring(s),
        }
    }
}
