//! What was run and what it came to.

use crate::measures::{Settle, Tracking};
use crate::track::{Mode, Settings, Trace};
use serde::Serialize;

/// A robot on a motion, in every mode.
#[derive(Debug, Clone, Serialize)]
pub struct Experiment {
    /// Robot.
    pub robot: String,
    /// Motion, in words.
    pub motion: String,
    /// Joints.
    pub joints: Vec<String>,
    /// Unit of each joint's position: rad or m.
    pub units: Vec<&'static str>,
    /// Loop.
    pub settings: Settings,
    /// When it counts as settled; none where nothing settles.
    pub settle: Option<Settle>,
    /// Mode by mode.
    pub outcomes: Vec<Outcome>,
    /// A source's figure beside ours.
    pub published: Option<Compared>,
}

/// What a mode came to.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// Mode.
    pub mode: Mode,
    /// Errors and settling.
    #[serde(flatten)]
    pub tracking: Tracking,
    /// The run.
    #[serde(skip)]
    pub trace: Trace,
}

/// A published pair of figures, without and with a dynamic model, and ours: cascade alone, and physics.
#[derive(Debug, Clone, Serialize)]
pub struct Compared {
    /// What it is.
    pub figure: &'static str,
    /// Published, without and with.
    pub published: [f64; 2],
    /// Ours, without and with; none where a robot did not settle.
    pub ours: [Option<f64>; 2],
}

/// All of a run of `eval --closed-loop`.
#[derive(Debug, Clone, Serialize)]
pub struct Demonstration {
    /// `closed-loop/1`.
    pub schema: &'static str,
    /// Robot by robot, motion by motion.
    pub experiments: Vec<Experiment>,
    /// What the figures depend on.
    pub notes: Vec<String>,
}

impl Experiment {
    /// The outcome of a mode.
    pub fn outcome(&self, mode: Mode) -> Option<&Outcome> {
        self.outcomes.iter().find(|o| o.mode == mode)
    }
}
