//! Data sheet of a drive.

/// Data sheet values of a joint's drive.
#[derive(Debug, Clone, Copy)]
pub struct DataSheet {
    /// Motor turns per joint turn (motor rad per m of a sliding joint).
    pub gear_ratio: f64,
    /// Torque constant of the motor, N·m/A.
    pub torque_constant: f64,
    /// Rated torque on the link side, N·m (N).
    pub rated: f64,
}
