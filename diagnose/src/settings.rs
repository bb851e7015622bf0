//! Thresholds of the search.

use crate::catalogue::effect::Effect;

/// How far parameters may leave the given values when they are identified again, in tolerances: of these, what predicts
/// best where the fit did not see. The freest comes first, and stays where another is not better by `BETTER`.
pub const FREEDOMS: [f64; 4] = [100.0, 30.0, 10.0, 3.0];

/// How gaps are weighed.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Deviation of the given inertial parameters that is nothing to report, relative.
    pub inertial_tolerance: f64,
    /// The same for friction coefficients.
    pub friction_tolerance: f64,
    /// Rows per independent sample.
    pub correlated_rows: f64,
    /// Price of a coefficient, nats.
    pub cost: f64,
    /// Gain from which a cause is named, nats.
    pub enough: f64,
    /// Part of an earlier cause's gain that a further cause must exceed.
    pub leftover: f64,
    /// The same for the same effect on another joint.
    pub leftover_same: f64,
    /// Part of its joints' squared error, and gain in nats, from which a cause stands for itself, whatever earlier
    /// ones gained.
    pub plain: (f64, f64),
    /// Error that a cause must remove on some joint, relative to the joint's torque.
    pub visible: f64,
    /// Share of the whole gap that a cause must remove.
    pub share: f64,
    /// Error below which a joint counts as explained, relative to its torque.
    pub floor: f64,
    /// Effect that is left out of the catalogue, for the proof.
    pub withheld: Option<Effect>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            inertial_tolerance: 0.025,
            friction_tolerance: 0.12,
            correlated_rows: 25.0,
            cost: 4.0,
            enough: 10.0,
            leftover: 0.12,
            leftover_same: 0.35,
            plain: (0.1, 60.0),
            visible: 0.015,
            share: 0.015,
            floor: 0.006,
            withheld: None,
        }
    }
}
