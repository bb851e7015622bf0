//! What may be fitted: one number of one joint, or of the whole arm.

/// What a parameter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Torque per error of position of the drive.
    Gain,
    /// Torque per error of velocity of the drive.
    ServoDamping,
    /// Integral gain.
    Integral,
    /// Largest torque at standstill that the voltage allows.
    DriveLimit,
    /// Largest torque.
    Limit,
    /// Delay of one joint's commands.
    Delay,
    /// One delay of all joints' commands.
    CommonDelay,
    /// Time constant of the drive's command filter.
    Lag,
    /// What the drive adds to its command.
    Offset,
    /// Viscous friction.
    Damping,
    /// Coulomb friction.
    Coulomb,
    /// Friction at standstill beyond Coulomb's.
    Stribeck,
    /// Friction per torque.
    Load,
    /// Rotor inertia.
    Armature,
    /// Part of the gravity torque of the given description, without a payload, that each drive adds to its own torque:
    /// one value for the arm, from 0 (none) to 1 (all of it).
    GravityCompensation,
    /// Mass and first moment of a payload.
    Payload(usize),
    /// Factor on a link's inertial parameters.
    LinkScale,
    /// Tilt of the base about x and y.
    Tilt(usize),
    /// Zero of a joint.
    Zero,
    /// Smooth torque that no mechanism explains.
    Unknown(usize),
}

/// How a parameter is searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Its logarithm: it is positive and known by its order of magnitude.
    Log,
    /// The value itself, kept at zero or above.
    Positive,
    /// The value itself, of either sign.
    Free,
}

impl Kind {
    /// Whether it changes the rigid bodies or gravity.
    pub fn is_body(self) -> bool {
        matches!(self, Self::Payload(_) | Self::LinkScale | Self::Tilt(_))
    }

    /// Whether it belongs to the whole arm.
    pub fn is_common(self) -> bool {
        matches!(
            self,
            Self::CommonDelay | Self::GravityCompensation | Self::Payload(_) | Self::Tilt(_)
        )
    }

    /// How it is searched for.
    pub fn scale(self) -> Scale {
        match self {
            Self::Gain | Self::DriveLimit | Self::Limit | Self::LinkScale => Scale::Log,
            Self::ServoDamping
            | Self::Integral
            | Self::Delay
            | Self::CommonDelay
            | Self::Lag
            | Self::Damping
            | Self::Coulomb
            | Self::Stribeck
            | Self::Load
            | Self::Armature
            | Self::Payload(0) => Scale::Positive,
            Self::Offset
            | Self::GravityCompensation
            | Self::Payload(_)
            | Self::Tilt(_)
            | Self::Zero
            | Self::Unknown(_) => Scale::Free,
        }
    }
}

/// A parameter at its place; `joint` is 0 for those of the whole arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Parameter {
    /// Kind of the parameter.
    pub kind: Kind,
    /// Index of the joint.
    pub joint: usize,
}

impl Parameter {
    /// A parameter of a joint.
    pub fn new(kind: Kind, joint: usize) -> Self {
        Self { kind, joint }
    }
}
