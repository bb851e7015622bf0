//! Description of an effect beside its columns.

use super::candidate::Candidate;
use super::effect::Effect;
use super::experiment::Experiment;
use super::reported::Parameter;

/// Property that a recording must have for an effect to be told from others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Enough reversals of the joint.
    Reversals,
    /// High enough velocity of the joint.
    Speed,
    /// Large enough part of the joint's range.
    Range,
    /// At least a minute of motion.
    Minute,
    /// A sampling rate that shows vibration.
    Rate,
}

/// Place of a cause in a model directory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// Place among the terms of the torque model.
    Terms,
    /// Place in the gain of the torque channel.
    Gain,
    /// Place in the offset of the torque channel.
    Offset,
    /// Place in the limit of the torque channel.
    Limit,
    /// Place in the zero of a joint's position.
    Zero,
    /// Place in the delay of the torque channel, common to all joints.
    Delay,
    /// Place in the direction of gravity in the base frame.
    Gravity,
    /// No place: a torque model cannot hold the cause.
    Not,
}

/// Part of a robot's description that a patch corrects for an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Correction {
    /// Inertial parameters of links.
    Links,
    /// Friction coefficients of joints.
    Friction,
    /// Body fixed to the last link.
    Load,
    /// Rotor inertia of a joint, kg·m².
    Rotor,
    /// Zero of a joint's position, rad.
    Zero,
    /// Rotation of the base, rad.
    Tilt,
}

/// Description of an effect: names, texts and rules.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// Name of the effect in the report.
    pub name: &'static str,
    /// Name of the effect in plain words.
    pub plain: &'static str,
    /// Advice on the simulator's settings; `{}` is replaced by the sizes.
    pub remedy: &'static str,
    /// Effects whose torque looks like this effect's on most recordings. They are a fair second answer where the effect
    /// itself is not in the catalogue. Parameters of links and of friction are confounders of all that they can
    /// absorb.
    pub confounders: &'static [Effect],
    /// Properties that a recording must have.
    pub needs: &'static [Need],
    /// File of a patch into which the effect is written; none: only the table of values.
    pub place: Option<&'static str>,
    /// Part of the description that a patch corrects; none where a description has no place for the effect.
    pub correction: Option<Correction>,
    /// Comment in a snippet of MJCF that says what to add by hand, from the names of the joints and the sizes.
    pub by_hand: fn(&[String], &[Parameter]) -> Option<String>,
    /// Whether generated code for simulators holds it: its columns are terms of the torque model and belong to the robot.
    pub coded: bool,
    /// Whether the effect is a change of parameters that the model already has.
    pub parameter: bool,
    /// Whether the effect is friction of its own joint.
    pub friction: bool,
    /// Whether the effect shows at frequencies beyond those of the motion.
    pub vibrates: bool,
    /// Whether free inertial and friction parameters can absorb most of it. Then its share is counted from the model as given.
    pub absorbable: bool,
    /// Whether the effect is a temporary force from outside: it is found by its trace and never fitted.
    pub outside: bool,
    /// Whether the effect comes and goes, so that another motion need not show it again.
    pub passing: bool,
    /// Whether its size is relative to the described masses.
    pub by_mass: bool,
    /// Whether the effect shifts the recorded torque in time.
    pub late: bool,
    /// Whether the effect is friction with memory.
    pub memory: bool,
    /// Whether the effect is compliance or play between motor and link.
    pub gear: bool,
    /// Whether the effect's sizes are inertial parameters of bodies.
    pub body: bool,
    /// Place of one of the effect's candidates in a model directory.
    pub carried: fn(&Candidate) -> Carried,
    /// Converts linear coefficients into the quantities that users expect.
    pub reported: fn(&mut Vec<Parameter>),
    /// Motion that separates the effect from others.
    pub experiment: Experiment,
    /// Motions that separate the effect from particular other effects.
    pub experiments: &'static [(Effect, Experiment)],
    /// Reason why a planned motion is not judged by the torque of the effect.
    pub unplanned: &'static str,
    /// Reason why no simulator's description or code holds it, where it is not written.
    pub unwritten: &'static str,
    /// Least part of its joints' squared error that the effect must remove to be accepted.
    pub least_fraction: f64,
}

impl Info {
    /// Description with every default, from which each effect's is made.
    pub const NEW: Self = Self {
        name: "",
        plain: "",
        remedy: "no standard parameter: add the torque by a plug-in ({})",
        confounders: &[],
        needs: &[],
        place: None,
        correction: None,
        by_hand: |_, _| None,
        coded: false,
        parameter: false,
        friction: false,
        vibrates: false,
        absorbable: false,
        outside: false,
        passing: false,
        by_mass: false,
        late: false,
        memory: false,
        gear: false,
        body: false,
        carried: |_| Carried::Terms,
        reported: |_| (),
        experiment: Experiment::Reversals,
        experiments: &[],
        unplanned: "this motion or this robot gives it no columns",
        unwritten: "not a simulator's matter",
        least_fraction: f64::NEG_INFINITY,
    };
}
