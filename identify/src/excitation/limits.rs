//! Limits of a joint's motion, and checks of motions that cannot be done within them.

use super::error::ExcitationError;
use physics::robot::Robot;
use std::f64::consts::PI;

/// Part of its range that a joint has to be able to cover in a period: less shows nothing of its torque.
const LEAST_STROKE: f64 = 0.05;

/// Limits of a joint's motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits {
    /// Smallest position, rad or m.
    pub lower: f64,
    /// Largest position, rad or m.
    pub upper: f64,
    /// Largest speed, rad/s or m/s.
    pub velocity: f64,
    /// Largest acceleration, rad/s² or m/s².
    pub acceleration: f64,
    /// Largest jerk, rad/s³ or m/s³; infinite where it does not matter.
    pub jerk: f64,
}

/// Highest derivative that is zero where a motion starts and ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rest {
    /// Zero velocity (Han et al., eq. 34, first constraint).
    Velocity,
    /// Zero acceleration as well: no step of torque.
    Acceleration,
    /// Zero jerk as well (KR300 benchmark, eq. 2c).
    Jerk,
}

impl Rest {
    /// Fewest harmonics that leave a motion.
    pub fn least_harmonics(self) -> usize {
        match self {
            Self::Velocity => 1,
            Self::Acceleration | Self::Jerk => 2,
        }
    }
}

impl MotionLimits {
    /// Limits as a robot's description has them; infinite where it states none. A joint that turns without end moves
    /// within half a turn of zero. Descriptions know neither acceleration nor jerk.
    pub fn of_robot(robot: &Robot) -> Vec<Self> {
        let of = |joint: &physics::robot::Joint| {
            let l = &joint.limits;
            let open = joint.kind.is_rotation() && !(l.lower.is_finite() && l.upper.is_finite());
            Self {
                lower: if open { -PI } else { l.lower },
                upper: if open { PI } else { l.upper },
                velocity: l.velocity,
                acceleration: f64::INFINITY,
                jerk: f64::INFINITY,
            }
        };
        robot.joints().iter().map(of).collect()
    }

    /// Same limits, used to a share of everything: of the range about its middle, and of the other limits.
    pub fn share(self, share: f64) -> Self {
        let (middle, half) = (self.middle(), share * self.half());
        Self {
            lower: middle - half,
            upper: middle + half,
            velocity: share * self.velocity,
            acceleration: share * self.acceleration,
            jerk: share * self.jerk,
        }
    }

    /// Middle of the range of positions, rad (m).
    pub fn middle(&self) -> f64 {
        0.5 * (self.lower + self.upper)
    }

    /// Half of the range of positions, rad (m).
    pub fn half(&self) -> f64 {
        0.5 * (self.upper - self.lower)
    }

    /// Refuses limits that leave no motion.
    ///
    /// # Errors
    /// [`ExcitationError::NoRoom`].
    pub fn check(&self, joint: usize) -> Result<(), ExcitationError> {
        let sizes = [self.upper - self.lower, self.velocity, self.acceleration];
        let usable = sizes.iter().all(|s| s.is_finite() && *s > 0.0);
        if usable && self.jerk > 0.0 {
            Ok(())
        } else {
            Err(ExcitationError::NoRoom { joint })
        }
    }

    /// Refuses limits under which a periodic motion of the joint covers less than a twentieth of its range.
    ///
    /// A function of period T has a range of at most v T/2, a T²/16 or j T³/96 where its first, second or third derivative stays
    /// below v, a or j (Favard, "Sur les meilleurs procédés d'approximation", 1937).
    ///
    /// # Errors
    /// [`ExcitationError::TooSlow`], with the period from which the limits do.
    pub fn reachable(&self, joint: usize, period: f64) -> Result<(), ExcitationError> {
        self.check(joint)?;
        let needed = LEAST_STROKE * (self.upper - self.lower);
        let bounds = [
            ("velocity", self.velocity, 2.0, 1),
            ("acceleration", self.acceleration, 16.0, 2),
            ("jerk", self.jerk, 96.0, 3),
        ];
        for (limit, value, factor, power) in bounds {
            let stroke = value * period.powi(power) / factor;
            if stroke < needed {
                return Err(ExcitationError::TooSlow {
                    joint,
                    limit,
                    value,
                    period,
                    stroke,
                    needed,
                    enough: (factor * needed / value).powf(1.0 / f64::from(power)),
                });
            }
        }
        Ok(())
    }
}
