//! What every torque model is.

/// A parameter's name and unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// Unit, SI.
    pub unit: String,
}

impl Parameter {
    /// From name and unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
        }
    }
}

/// Positions that the machine cannot take: its arms do not meet there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the machine cannot take these positions")]
pub struct OutOfReach;

/// Torque of a machine's axes without friction: linear in P parameters.
pub trait TorqueModel: Send + Sync {
    /// The parameters, in the order of the columns.
    fn parameters(&self) -> Vec<Parameter>;

    /// Fills `rows` (N × P, row-major) so that `rows`·parameters is the torque at position, velocity and acceleration
    /// (N values each; rad or m, per s, per s²; N·m or N).
    ///
    /// # Errors
    /// Positions that the machine cannot take.
    ///
    /// # Panics
    /// When a slice has another size.
    fn rows(&self, q: &[f64], qd: &[f64], qdd: &[f64], rows: &mut [f64]) -> Result<(), OutOfReach>;

    /// Whether the model holds for slow motion alone: it has no inertia.
    fn is_semi_static(&self) -> bool {
        false
    }

    /// The values in the order of the controller's numbered parameters; what it numbers and a recording cannot tell
    /// comes from the geometry, and is zero where that does not say.
    fn numbered(&self, values: &[f64]) -> Vec<f64> {
        values.to_vec()
    }

    /// What follows from the values, as name, value and unit: an angle of tilt, a screw's lead.
    fn derived(&self, _values: &[f64]) -> Vec<(String, f64, String)> {
        Vec::new()
    }

    /// What of a body on the last axis the model can tell, and what each unit of it adds to the parameters (P values), the machine's
    /// own being `values`.
    fn payload(&self, values: &[f64]) -> Vec<(Parameter, Vec<f64>)>;

    /// Columns whose value cannot be negative: masses and inertias. A negative one means a sign or factor of the torque.
    fn positive(&self) -> Vec<usize> {
        Vec::new()
    }
}
