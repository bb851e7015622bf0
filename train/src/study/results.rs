//! Contents of `train study --json`.

use serde::Serialize;

/// RMSE of every joint, N·m, for one value of the quantity that a comparison varies.
#[derive(Serialize)]
pub struct Variant<T> {
    pub value: T,
    /// RMSE of every joint as mean over folds or over seeds, N·m.
    pub rmse: Vec<f64>,
    /// Standard deviation of one seed's, where there are several; else empty.
    pub between_seeds: Vec<f64>,
}

impl<T> Variant<T> {
    /// Result of a variant with one RMS error for each joint.
    pub fn once(value: T, rmse: Vec<f64>) -> Self {
        Self {
            value,
            rmse,
            between_seeds: Vec::new(),
        }
    }

    /// Figures of several seeds, one list for each.
    pub fn over_seeds(value: T, seeds: &[Vec<f64>]) -> Self {
        let n = seeds.len() as f64;
        let joints = 0..seeds.first().map_or(0, Vec::len);
        let mean = |j: usize| seeds.iter().map(|s| s[j]).sum::<f64>() / n;
        let spread = |j: usize| {
            let squares = seeds.iter().map(|s| (s[j] - mean(j)).powi(2));
            (squares.sum::<f64>() / (n - 1.0)).sqrt()
        };
        Self {
            value,
            rmse: joints.clone().map(mean).collect(),
            between_seeds: if seeds.len() > 1 {
                joints.map(spread).collect()
            } else {
                Vec::new()
            },
        }
    }
}

/// RMS errors of fully connected and LSTM units with the same number of hidden nodes, joint 1, N·m.
#[derive(Serialize)]
pub struct Nodes {
    pub nodes: usize,
    pub fully_connected: f64,
    pub lstm: f64,
}

/// Errors of the published unit on a recording of high speed that nothing was fitted on.
#[derive(Serialize)]
pub struct Verification {
    pub max_torque: Vec<f64>,
    pub physics: Vec<f64>,
    pub compensated: Vec<f64>,
    /// ‖τ_m − τ_p‖/‖τ_m‖ in percent (equation 27), physics on the identification recording.
    pub relative_error_identification: f64,
    /// Relative error of the physics on the verification recording, percent.
    pub relative_error: f64,
    pub relative_error_compensated: f64,
}

/// Contents of `train study --json`.
#[derive(Serialize, Default)]
pub struct Report {
    pub schema: &'static str,
    pub seed: u64,
    pub quick: bool,
    pub joints: Vec<String>,
    pub folds: usize,
    /// Number of networks that the comparisons on the first fold average.
    pub repeats: u64,
    pub hidden: usize,
    pub epochs: usize,
    pub windows_per_epoch: usize,
    /// `physics`, `attention`, `no_attention`, `attainable` (the plant's own equations on the recorded motion); mean over folds of
    /// held-out trajectories.
    pub table_6: Vec<Variant<&'static str>>,
    /// Results of the UR5 paper's smoothing of the torque and of its split by samples, which leaks, apart and together.
    pub papers_way: Vec<Variant<&'static str>>,
    pub inputs: Vec<Variant<&'static str>>,
    pub timesteps: Vec<Variant<usize>>,
    pub nodes: Vec<Nodes>,
    pub table_8: Option<Verification>,
}

#[cfg(test)]
mod tests {
    use super::Variant;

    #[test]
    fn seeds_are_averaged() {
        let v = Variant::over_seeds("icm", &[vec![1.0, 4.0], vec![3.0, 4.0]]);
        assert_eq!(v.rmse, [2.0, 4.0]);
        assert_eq!(v.between_seeds, [2.0_f64.sqrt(), 0.0]);
        assert!(
            Variant::over_seeds("icm", &[vec![1.0]])
                .between_seeds
                .is_empty()
        );
    }
}
