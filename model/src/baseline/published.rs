//! Results published on the KR300 benchmark, for comparison with own results in terminal and page.
//!
//! None was measured by this project. Protocols differ: read `protocol` before comparing.

use physics::robot::Builtin;

/// Task of a model: what it predicts from what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// Inverse task: torque from q, q̇, q̈ at the same sample.
    Inverse,
    /// Forward task: position from torque, in simulation.
    Forward,
}

/// Part of the benchmark's files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Training part: 39,988 samples.
    Train,
    /// Test part: 3,636 samples.
    Test,
}

/// Published result of a model; its figures are over all samples of the official files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published {
    /// Task of the published result.
    pub task: Task,
    /// Name of the model, in a few words.
    pub model: &'static str,
    /// Part of the benchmark that was scored.
    pub part: Part,
    /// NRMSE of joints 1 to 6, where published.
    pub nrmse: Option<[f64; 6]>,
    /// R² of joints 1 to 6 in percent, where published.
    pub r2: Option<[f64; 6]>,
    /// Mean of the NRMSE over joints.
    pub mean_nrmse: f64,
    /// Mean R² over joints in percent, where published.
    pub mean_r2: Option<f64>,
    /// Inputs of the model, and deviations from the benchmark paper's protocol; empty where it does not deviate.
    pub protocol: &'static str,
    /// Publication that states the figures, and where in it.
    pub source: &'static str,
}

const TABLE_4: &str = "Weigand, Götz, Ulmen, Ruskowski (2022), DOI 10.26204/DATA/5, Table 4";
const TABLE_5: &str = "Weigand, Götz, Ulmen, Ruskowski (2022), DOI 10.26204/DATA/5, Table 5";
const TABLE_VI: &str =
    "Neural Computing and Applications (2024), DOI 10.1007/s00521-024-10732-y, Table VI";
const FROM_FIRST_SAMPLE: &str = "simulation from the first position";
const OWN_SPLIT: &str = "simulation from the first position; own split, 36387 samples for training and 3600 for validation";

/// All published rows, task by task. For the inverse task we know of no published result beside the baseline of the
/// benchmark paper itself.
pub const PUBLISHED: &[Published] = &[
    Published {
        task: Task::Inverse,
        model: "linear matrix A",
        part: Part::Train,
        nrmse: Some([0.418, 0.595, 0.555, 0.673, 0.679, 0.551]),
        r2: Some([82.502, 64.615, 69.228, 54.72, 53.902, 69.635]),
        mean_nrmse: 0.5785,
        mean_r2: Some(65.767),
        protocol: "",
        source: TABLE_5,
    },
    Published {
        task: Task::Inverse,
        model: "linear matrix A",
        part: Part::Test,
        nrmse: Some([0.447, 0.681, 0.549, 0.705, 0.71, 0.559]),
        r2: Some([79.982, 53.607, 69.841, 50.253, 49.615, 68.723]),
        mean_nrmse: 0.6085,
        mean_r2: Some(62.0035),
        protocol: "",
        source: TABLE_5,
    },
    Published {
        task: Task::Forward,
        model: "linear state space (n4sid, 12 states)",
        part: Part::Train,
        nrmse: Some([0.635, 0.717, 0.726, 0.866, 0.865, 0.838]),
        r2: Some([59.733, 48.603, 47.323, 25.083, 25.099, 29.852]),
        mean_nrmse: 0.7745,
        mean_r2: Some(39.2822),
        protocol: "",
        source: TABLE_4,
    },
    Published {
        task: Task::Forward,
        model: "linear state space (n4sid, 12 states)",
        part: Part::Test,
        nrmse: Some([0.638, 0.829, 0.876, 0.894, 0.869, 0.845]),
        r2: Some([59.236, 31.293, 23.179, 20.098, 24.534, 28.513]),
        mean_nrmse: 0.82517,
        mean_r2: Some(31.1422),
        protocol: "",
        source: TABLE_4,
    },
    Published {
        protocol: FROM_FIRST_SAMPLE,
        ..forward("NARX network, k = 10", 0.146)
    },
    Published {
        protocol: FROM_FIRST_SAMPLE,
        ..forward("LSTM-MLP, k = 0", 0.158)
    },
    Published {
        protocol: FROM_FIRST_SAMPLE,
        ..forward("LSTM-MLP, k = 10", 0.142)
    },
    Published {
        protocol: OWN_SPLIT,
        ..forward("LSTM-MLP with multi-head attention", 0.125)
    },
    Published {
        protocol: "60 samples known, the next 60 predicted; quoted there from another paper",
        ..forward("ReLiNet", 0.548)
    },
    Published {
        protocol: "60 samples known, the next 60 predicted; quoted there from another paper",
        ..forward("LSTM", 0.409)
    },
];

const fn forward(model: &'static str, mean_nrmse: f64) -> Published {
    Published {
        task: Task::Forward,
        model,
        part: Part::Test,
        nrmse: None,
        r2: None,
        mean_nrmse,
        mean_r2: None,
        protocol: "",
        source: TABLE_VI,
    }
}

impl Part {
    /// Name of the part in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Test => "test",
        }
    }
}

/// Published rows to be shown beside the scores of a robot on these parts. Only the benchmark's own robot, the
/// built-in one, has any.
pub fn beside(robot: Option<Builtin>, parts: &[Part]) -> Vec<&'static Published> {
    PUBLISHED
        .iter()
        .filter(|p| robot == Some(Builtin::Kr300) && parts.contains(&p.part))
        .collect()
}

/// Published results of one task and part of the benchmark.
pub fn rows(task: Task, part: Part) -> impl Iterator<Item = &'static Published> {
    PUBLISHED
        .iter()
        .filter(move |p| p.task == task && p.part == part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The printed means follow from the printed joints, and R² from NRMSE, to the printed digits:
    /// a slip of the pen in a number would show.
    #[test]
    fn rows_agree_with_themselves() {
        for p in PUBLISHED {
            assert!(!p.source.is_empty() && p.mean_nrmse > 0.0);
            let (Some(nrmse), Some(r2), Some(mean_r2)) = (p.nrmse, p.r2, p.mean_r2) else {
                continue;
            };
            let mean = |v: [f64; 6]| v.iter().sum::<f64>() / 6.0;
            assert!((mean(nrmse) - p.mean_nrmse).abs() < 1e-4, "{}", p.model);
            assert!((mean(r2) - mean_r2).abs() < 1e-3, "{}", p.model);
            for (e, r) in std::iter::zip(nrmse, r2) {
                // Half a unit of NRMSE's third decimal, in percent of R².
                assert!(
                    (100.0 * (1.0 - e * e) - r).abs() < 0.2 * e,
                    "{} {r}",
                    p.model
                );
            }
        }
    }

    #[test]
    fn the_papers_baselines_are_found() {
        let means = |task, part| rows(task, part).map(|p| p.mean_nrmse).next();
        assert_eq!(means(Task::Inverse, Part::Test), Some(0.6085));
        assert_eq!(means(Task::Forward, Part::Train), Some(0.7745));
        assert_eq!(rows(Task::Inverse, Part::Test).count(), 1);
    }
}
