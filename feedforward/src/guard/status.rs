//! Status of a tick, as a bit set.

use std::ops::{BitOr, BitOrAssign};

/// Flags of one tick. The numbers are those of `residyn.h`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Status(u32);

impl Status {
    /// A value of the motion or the time is not finite; the last torque is held.
    pub const BAD_INPUT: Self = Self(1);
    /// The model's torque is not finite; the last torque is held.
    pub const BAD_TORQUE: Self = Self(1 << 1);
    /// The time lies before that of the last tick; the last torque is held, and the clock restarts from this time.
    pub const BACKWARD: Self = Self(1 << 2);
    /// A tick less than half a period after the last sample; the last torque is held.
    pub const STALE: Self = Self(1 << 3);
    /// A period or more passed without a tick.
    pub const LATE: Self = Self(1 << 4);
    /// An old torque stood for longer than it may: the torque goes to zero, until the next start.
    pub const OVERRUN: Self = Self(1 << 5);
    /// A torque was cut at its limit.
    pub const TORQUE_LIMITED: Self = Self(1 << 6);
    /// A torque was not let change so fast.
    pub const RATE_LIMITED: Self = Self(1 << 7);
    /// A position lies outside the robot's limits.
    pub const POSITION_OUTSIDE: Self = Self(1 << 8);
    /// A compensator is faded, for the motion lies outside its training.
    pub const FADED: Self = Self(1 << 9);
    /// A compensator is off, for the motion lies far outside its training.
    pub const UNCOMPENSATED: Self = Self(1 << 10);
    /// The torque grows to the model's after a start.
    pub const STARTING: Self = Self(1 << 11);
    /// The torque goes to zero after a stop.
    pub const STOPPING: Self = Self(1 << 12);
    /// The torque is zero: before the first start, or after a stop.
    pub const STOPPED: Self = Self(1 << 13);

    /// Bits of the status as a number.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether all flags of `other` are set.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl BitOr for Status {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Status {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}
