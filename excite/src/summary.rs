//! Summary of a designed motion.

use crate::judged::{Conditions, Coverage};
use crate::plan::Plan;
use serde::Serialize;

/// Summary of a designed motion, the content of the JSON file.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Name and version of the format: `excitation/1`.
    pub schema: &'static str,
    /// Name of the robot of the motion.
    pub robot: String,
    /// Name of the method by which the motion was made; null for one from a file.
    pub method: Option<&'static str>,
    /// Criterion by which motions were chosen; null without a criterion.
    pub criterion: Option<&'static str>,
    /// Random seed of the design; null for a motion from a file.
    pub seed: Option<u64>,
    /// Properties of each trajectory.
    pub trajectories: Vec<Trajectory>,
    /// Number of motions that were evaluated.
    pub evaluations: usize,
    /// Coverage of each joint's limits.
    pub joints: Vec<Coverage>,
    /// Condition numbers of the regressor.
    pub conditions: Conditions,
    /// Standard deviation of a torque sample, N·m, by joint.
    pub noise: Vec<f64>,
    /// Whether collisions were checked: always false.
    pub collisions_checked: bool,
    /// Notes on the design for the user.
    pub notes: Vec<String>,
    /// Parameters and effects that the motion would show, with --plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<Plan>,
}

/// Properties of one trajectory.
#[derive(Clone, Debug, Serialize)]
pub struct Trajectory {
    /// Label of the trajectory in the file.
    pub label: String,
    /// Duration of the trajectory, s.
    pub seconds: f64,
    /// Position of each joint at the start, rad or m.
    pub start: Vec<f64>,
    /// Criterion of all trajectories up to this one; null without a criterion.
    pub cost: Option<f64>,
    /// Criterion at the start of this trajectory's search.
    pub start_cost: Option<f64>,
}
