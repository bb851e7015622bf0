//! What is known of an effect beside its columns.

use super::candidate::Candidate;
use super::effect::Effect;
use super::experiment::Experiment;
use super::reported::Parameter;

/// What a recording has to have for an effect to be told from others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The joint turns round often enough.
    Reversals,
    /// The joint moves fast enough.
    Speed,
    /// The joint covers enough of its range.
    Range,
    /// A minute of motion.
    Minute,
    /// A sampling rate that shows vibration.
    Rate,
}

/// How a model directory carries a cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// As terms of the torque model.
    Terms,
    /// As the torque channel's gain.
    Gain,
    /// As the torque channel's offset.
    Offset,
    /// As the torque channel's limit.
    Limit,
    /// As a joint's zero.
    Zero,
    /// As the torque channel's delay, which all joints share.
    Delay,
    /// As gravity's direction.
    Gravity,
    /// Not at all: no torque model holds it.
    Not,
}

/// An effect's name, words and rules.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// Name in the report.
    pub name: &'static str,
    /// Name in plain words.
    pub plain: &'static str,
    /// What to set in a simulator; `{}` stands for the sizes.
    pub remedy: &'static str,
    /// Effects whose torque looks like this one's on a usual recording: a fair second answer where its own candidate is
    /// not in the catalogue. Parameters of links and of friction are confounders of whatever they can absorb.
    pub confounders: &'static [Effect],
    /// What a recording has to have.
    pub needs: &'static [Need],
    /// File of a patch that it is written to; none: the table of values alone.
    pub place: Option<&'static str>,
    /// Whether code that is generated for simulators holds it: its columns are terms of the torque model and belong to the
    /// robot.
    pub coded: bool,
    /// Whether it is a change of parameters that the model's structure has already.
    pub parameter: bool,
    /// Whether it resists the motion of its own joint.
    pub friction: bool,
    /// Whether it makes the whole prediction late or oscillate, of which other effects give some as well.
    pub dynamic: bool,
    /// Whether it shows at frequencies beyond those of the motion.
    pub vibrates: bool,
    /// Whether free inertial and friction parameters can take most of it over, so that its worth counts from the model as
    /// given.
    pub absorbable: bool,
    /// Whether it is a force from outside for a while: it is found by its trace and never fitted.
    pub outside: bool,
    /// Whether it moves the recorded torque in time.
    pub late: bool,
    /// Whether it is friction with memory.
    pub memory: bool,
    /// Whether it is compliance or play between motor and link.
    pub gear: bool,
    /// Whether its sizes are those of bodies.
    pub body: bool,
    /// How a model directory carries one of its candidates.
    pub carried: fn(&Candidate) -> Carried,
    /// Makes what users ask for out of what is linear.
    pub reported: fn(&mut Vec<Parameter>),
    /// Motion that separates it from others.
    pub experiment: Experiment,
    /// Motions that separate it from single others.
    pub experiments: &'static [(Effect, Experiment)],
    /// Why no simulator's description or code holds it, where it is not written.
    pub unwritten: &'static str,
    /// Part of its joints' squared error that it has to remove to be named.
    pub least_fraction: f64,
}

impl Info {
    /// Nothing is known yet.
    pub const NEW: Self = Self {
        name: "",
        plain: "",
        remedy: "no standard parameter: add the torque by a plug-in ({})",
        confounders: &[],
        needs: &[],
        place: None,
        coded: false,
        parameter: false,
        friction: false,
        dynamic: false,
        vibrates: false,
        absorbable: false,
        outside: false,
        late: false,
        memory: false,
        gear: false,
        body: false,
        carried: |_| Carried::Terms,
        reported: |_| (),
        experiment: Experiment::Reversals,
        experiments: &[],
        unwritten: "not a simulator's matter",
        least_fraction: f64::NEG_INFINITY,
    };
}
