//! What a machine carries.

/// A body on the last axis: at the end of a crank, on a carriage, on the line of a SCARA's quill, on a Delta's plate, in a PUMA's hand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Carried {
    /// kg.
    pub mass: f64,
    /// About its centre, in every direction, kg·m²; about the last axis where that turns the body.
    pub inertia: f64,
}
