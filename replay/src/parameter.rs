//! Parameters that can be fitted: one number of one joint, or of the whole arm.

/// Kind of a parameter: which number of a joint, its drive or the arm it is. Units hold for a rotary joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Proportional gain of the joint's drive: torque per position error, N·m/rad.
    Gain,
    /// Derivative gain of the joint's drive: torque per velocity error, N·m·s/rad.
    ServoDamping,
    /// Integral gain of the joint's drive: torque per integral of the error.
    Integral,
    /// Limit of the drive's control output before losses by back EMF, N·m: the voltage limit as a torque at standstill.
    DriveLimit,
    /// Limit of the drive's torque, N·m, equal in both directions.
    Limit,
    /// Delay of one joint's commands beyond the common delay, s.
    Delay,
    /// Delay that the commands of all joints share, s.
    CommonDelay,
    /// Time constant of the first-order low-pass filter on the drive's command, s.
    Lag,
    /// Constant that the joint's drive adds to its commanded position, rad.
    Offset,
    /// Viscous friction coefficient of the joint, N·m·s/rad. Where only the sum with the drive's damping is known, it
    /// is that sum.
    Damping,
    /// Coulomb friction of the joint, N·m.
    Coulomb,
    /// Dry friction at standstill beyond Coulomb friction, N·m. It falls off with velocity (Stribeck effect).
    Stribeck,
    /// Velocity over which friction at standstill falls to Coulomb friction (Stribeck velocity), rad/s.
    StribeckVelocity,
    /// Dry friction per torque that the joint's gear transmits, a number without unit.
    Load,
    /// Rotor inertia of the joint's motor, reflected to the joint, kg·m².
    Armature,
    /// Part of the gravity torque of the given description, without a payload, that each drive adds to its own torque.
    /// It is one value for the arm, from 0 (none) to 1 (all of it).
    GravityCompensation,
    /// Payload at the last link: index 0 is its mass, kg; 1 to 3 are its first moment along x, y and z of that link's
    /// joint frame, kg·m.
    Payload(usize),
    /// Factor on all inertial parameters (mass, first moment, inertia) of the joint's link.
    LinkScale,
    /// Rotation of the base about its x axis (index 0) or y axis (1), rad.
    Tilt(usize),
    /// Turn of the joint's link per turn of the motor of another joint, whose index this is: by so much less than its own
    /// motor the link turns.
    Coupling(usize),
    /// Encoder offset of the joint, rad: recorded position plus offset is the true position.
    Zero,
    /// Coefficient, N·m, of one of the smooth functions that stand for an unknown torque on the joint; the index
    /// selects the function.
    Unknown(usize),
}

/// Coordinate in which a parameter is fitted, and the range of values that it allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Natural logarithm of the value, so that the value stays positive and steps are relative.
    Log,
    /// Value itself, with a lower bound at zero.
    Positive,
    /// Value itself, of either sign.
    Free,
}

impl Kind {
    /// Whether the parameter changes the rigid bodies or gravity, so that the robot has to be assembled again.
    pub fn is_body(self) -> bool {
        matches!(self, Self::Payload(_) | Self::LinkScale | Self::Tilt(_))
    }

    /// Whether the parameter belongs to the whole arm, not to one joint.
    pub fn is_common(self) -> bool {
        matches!(
            self,
            Self::CommonDelay | Self::GravityCompensation | Self::Payload(_) | Self::Tilt(_)
        )
    }

    /// Coordinate in which a parameter of this kind is fitted.
    pub fn scale(self) -> Scale {
        match self {
            Self::Gain
            | Self::DriveLimit
            | Self::Limit
            | Self::LinkScale
            | Self::StribeckVelocity => Scale::Log,
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
            | Self::GravityCompensation
            | Self::Payload(0 | 4) => Scale::Positive,
            Self::Offset
            | Self::Payload(_)
            | Self::Tilt(_)
            | Self::Coupling(_)
            | Self::Zero
            | Self::Unknown(_) => Scale::Free,
        }
    }
}

/// Parameter that can be fitted: a kind at a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Parameter {
    /// Kind of the parameter.
    pub kind: Kind,
    /// Index of the joint, from 0 at the base; 0 for parameters of the whole arm.
    pub joint: usize,
}

impl Parameter {
    /// Parameter of this kind at the joint with this index.
    pub fn new(kind: Kind, joint: usize) -> Self {
        Self { kind, joint }
    }
}
