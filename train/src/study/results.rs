//! Contents of `train study --json`.

use serde::Serialize;

/// RMSE of every joint for one value of what a comparison varies, N·m.
#[derive(Serialize)]
pub struct Variant<T> {
    pub value: T,
    pub rmse: Vec<f64>,
}

/// Fully connected and LSTM units with the same number of hidden nodes, joint 1, N·m.
#[derive(Serialize)]
pub struct Nodes {
    pub nodes: usize,
    pub fully_connected: f64,
    pub lstm: f64,
}

/// The published unit on a recording of high speed that nothing was fitted on.
#[derive(Serialize)]
pub struct Verification {
    pub max_torque: Vec<f64>,
    pub physics: Vec<f64>,
    pub compensated: Vec<f64>,
    /// ‖τ_m − τ_p‖/‖τ_m‖ in percent (equation 27), physics on the identification recording.
    pub relative_error_identification: f64,
    /// The same on the verification recording.
    pub relative_error: f64,
    pub relative_error_compensated: f64,
}

/// Contents of `train study --json`.
#[derive(Serialize)]
pub struct Report {
    pub schema: &'static str,
    pub seed: u64,
    pub quick: bool,
    pub joints: Vec<String>,
    pub folds: usize,
    pub hidden: usize,
    pub epochs: usize,
    pub windows_per_epoch: usize,
    /// `physics`, `attention`, `no_attention`; mean over folds of held-out trajectories.
    pub table_6: Vec<Variant<&'static str>>,
    pub inputs: Vec<Variant<&'static str>>,
    pub timesteps: Vec<Variant<usize>>,
    pub nodes: Vec<Nodes>,
    pub table_8: Verification,
}
