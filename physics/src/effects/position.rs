//! Friction that changes with the joint's position: worn or eccentric gears, seals.

use super::{FrictionShape, Harmonic};
use serde::{Deserialize, Serialize};

/// sin(order·q) or cos(order·q) times a friction shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PositionFriction {
    /// How friction changes over position.
    pub harmonic: Harmonic,
    /// What changes.
    pub friction: FrictionShape,
}
