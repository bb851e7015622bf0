//! Everything that is said of a motion.

use crate::judged::{Conditions, Coverage};
use crate::plan::Plan;
use serde::Serialize;

/// Everything that is said of a motion, as the JSON file has it.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// `excitation/1`
    pub schema: &'static str,
    /// The robot's name.
    pub robot: String,
    /// How the motion was made; null for one from a file.
    pub method: Option<&'static str>,
    /// What chose it; null where nothing did.
    pub criterion: Option<&'static str>,
    /// Seed; null for a motion from a file.
    pub seed: Option<u64>,
    /// Each trajectory.
    pub trajectories: Vec<Trajectory>,
    /// Motions judged.
    pub evaluations: usize,
    /// Coverage of the limits.
    pub joints: Vec<Coverage>,
    /// Condition numbers.
    pub conditions: Conditions,
    /// Standard deviation of a torque sample, N·m, by joint.
    pub noise: Vec<f64>,
    /// Nobody looks for collisions: always false.
    pub collisions_checked: bool,
    /// What a reader should know.
    pub notes: Vec<String>,
    /// What the motion would show, with --plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<Plan>,
}

/// One trajectory.
#[derive(Clone, Debug, Serialize)]
pub struct Trajectory {
    /// Label in the file.
    pub label: String,
    /// Length, s.
    pub seconds: f64,
    /// Where it starts, rad or m.
    pub start: Vec<f64>,
    /// Criterion of all trajectories up to this one; null where none was used.
    pub cost: Option<f64>,
    /// The same of what the search began with.
    pub start_cost: Option<f64>,
}
