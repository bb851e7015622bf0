//! Friction that changes with the joint's position: worn or eccentric gears, seals.

use super::{FrictionShape, Harmonic};
use serde::{Deserialize, Serialize};

/// sin(order·q) or cos(order·q) times a friction shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PositionFriction {
    /// Factor of the friction over position.
    pub harmonic: Harmonic,
    /// Friction shape that is modulated.
    pub friction: FrictionShape,
}
