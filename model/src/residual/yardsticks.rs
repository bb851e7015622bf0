//! Yardsticks: predictions of the residual torque of the physics by a ridge regression and, in builds with the
//! feature `trees`, by boosted trees on the same inputs.
//!
//! They are no part of the model that a control loop runs. Each is chosen on folds within those on which the
//! judged ones were fitted, and judged on the folds that judge the units. The ones that are kept are fitted on
//! all data.

use super::predicted::{Learner, summed};
use super::task::Task;
use super::trial::{Trial, hold_back};
use super::{Pace, ResidualError, paced_table, predict_from};
use crate::directory::{DirectoryError, ModelFile, YARDSTICKS, sha256};
use crate::session::Session;
use compensator::training::{Job, Samples, Split, Trees, choose_ridge, fit_ridge};
#[cfg(feature = "trees")]
use compensator::training::{choose_trees, grow_trees};
use feedforward::network::{Compensator, Unit};
use ndarray::Array2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Version of `yardsticks.json`.
const SCHEMA: &str = "yardsticks/1";

/// Ridge regression and boosted trees of every joint, to compare the compensator's networks with.
#[derive(Clone, Debug, PartialEq)]
pub struct Yardsticks {
    /// Errors of yardsticks and networks on the folds held back, by joint.
    pub held_back: Vec<HeldBack>,
    /// Ridge regression of each joint, stored as a linear unit.
    pub ridge: Compensator,
    /// Boosted trees of each joint; empty where the build that trained had none.
    pub trees: Vec<Trees>,
}

/// Weighted RMS errors of one joint on the folds held back, N·m; none where there is no such error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldBack {
    /// Name of the joint that is judged.
    pub joint: String,
    /// Error of the physics alone.
    pub physics: Option<f64>,
    /// Error of the physics with one network at its best epoch, which was chosen on these folds.
    pub unit: Option<f64>,
    /// Error with the same network at its last epoch, which was not chosen on these folds.
    pub unit_at_last_epoch: Option<f64>,
    /// Error of the physics with the ridge regression.
    pub ridge: Option<f64>,
    /// Error of the physics with the boosted trees.
    pub trees: Option<f64>,
    /// Chosen ridge, relative to the mean diagonal of the normal matrix.
    pub ridge_parameter: f64,
    /// Number of trees that was chosen.
    pub tree_count: usize,
}

/// Splits of the trajectories for choosing, judging and fitting the yardsticks.
pub(super) struct Splits {
    /// Split on which ridge parameter and number of trees are chosen.
    choose: Split,
    /// Split on which the chosen yardsticks are judged.
    judge: Split,
    /// Split in which all trajectories are fitted.
    everything: Split,
}

impl Splits {
    /// Splits of trajectories by fold.
    ///
    /// # Errors
    /// Fewer than three folds: one judges, one chooses, one is fitted.
    pub fn new(folds: &[usize]) -> Result<Self, ResidualError> {
        let all: Vec<usize> = (0..folds.len()).collect();
        let judge = hold_back(folds, &all);
        let choose = judge.as_ref().and_then(|j| hold_back(folds, &j.train));
        match (judge, choose) {
            (Some(judge), Some(choose)) => Ok(Self {
                choose,
                judge,
                everything: Split {
                    train: all,
                    validation: Vec::new(),
                },
            }),
            _ => Err(ResidualError::Folds),
        }
    }
}

/// Yardsticks of one joint: ridge and trees.
struct Joint {
    held_back: HeldBack,
    ridge: Unit,
    trees: Option<Trees>,
}

/// Chooses, judges and fits the yardsticks of every joint, on all cores of the pool.
pub(super) fn train(
    task: &Task,
    splits: &Splits,
    trial: &Trial,
    (joints, inputs): (&[String], Vec<String>),
    cancel: Option<&AtomicBool>,
) -> Result<Yardsticks, ResidualError> {
    let targets = &task.examples.targets;
    let [choosing, judging, fitting] =
        [&splits.choose, &splits.judge, &splits.everything].map(|split| task.jobs(targets, split));
    let (choosing, judging, fitting) = (choosing?, judging?, fitting?);
    let of = |k: usize| {
        if cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Err(compensator::Error::Interrupted.into());
        }
        let network = trial.units.get(k).map(|(network, _)| &network.report);
        joint(
            [&choosing[k], &judging[k], &fitting[k]],
            |ridge, trees, ridge_parameter, tree_count| HeldBack {
                joint: joints[judging[k].joint].clone(),
                physics: network.and_then(|r| r.validation_rmse_off),
                unit: network.and_then(|r| r.validation_rmse),
                unit_at_last_epoch: trial.last_epoch.get(k).copied().flatten(),
                ridge,
                trees,
                ridge_parameter,
                tree_count,
            },
        )
    };
    let found: Vec<Joint> = (0..judging.len())
        .into_par_iter()
        .map(of)
        .collect::<Result<_, ResidualError>>()?;
    let mut made = Yardsticks {
        held_back: Vec::new(),
        ridge: Compensator {
            joints: joints.to_vec(),
            inputs,
            units: Vec::new(),
        },
        trees: Vec::new(),
    };
    for joint in found {
        made.held_back.push(joint.held_back);
        made.ridge.units.push(joint.ridge);
        made.trees.extend(joint.trees);
    }
    Ok(made)
}

/// Yardsticks of one joint: chosen, judged, and fitted to everything. `figures` makes the errors from those of ridge
/// and trees, the ridge parameter and the number of trees.
fn joint(
    [choose, judge, fit]: [&Job; 3],
    figures: impl FnOnce(Option<f64>, Option<f64>, f64, usize) -> HeldBack,
) -> Result<Joint, ResidualError> {
    let parameter = choose_ridge(choose)?;
    let judged = fit_ridge(judge, parameter)?;
    let mut ridge = fit_ridge(fit, parameter)?.unit;
    ridge.enabled = judged.unit.enabled;
    let (trees, error) = trees([choose, judge, fit])?.unzip();
    let count = trees.as_ref().map_or(0, Trees::count);
    Ok(Joint {
        held_back: figures(
            judged.report.validation_rmse,
            error.flatten(),
            parameter,
            count,
        ),
        ridge,
        trees,
    })
}

/// Trees with their error on the judging folds.
#[cfg(feature = "trees")]
fn trees([choose, judge, fit]: [&Job; 3]) -> Result<Option<(Trees, Option<f64>)>, ResidualError> {
    let count = choose_trees(choose)?;
    let (judged, error) = grow_trees(judge, count)?;
    let (mut trees, _) = grow_trees(fit, count)?;
    trees.enabled = judged.enabled;
    Ok(Some((trees, error)))
}

/// Boosted trees of a joint. This build is without the feature `trees`, so there are none.
#[cfg(not(feature = "trees"))]
fn trees(_: [&Job; 3]) -> Result<Option<(Trees, Option<f64>)>, ResidualError> {
    Ok(None)
}

/// Contents of `yardsticks.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    /// Name and version of the format.
    schema: String,
    /// SHA-256 of the file of the compensator to which the yardsticks were compared.
    compensator_sha256: String,
    /// SHA-256 of the ridge regression's file.
    ridge_sha256: String,
    /// Errors on the folds held back, by joint.
    held_back: Vec<HeldBack>,
    /// Boosted trees of each joint.
    trees: Vec<Trees>,
}

impl Yardsticks {
    /// Writes both files into the directory of the model whose compensator has the checksum `compensator_sha256`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn save(&self, directory: &Path, compensator_sha256: &str) -> Result<(), ResidualError> {
        let ridge = self.ridge.to_bytes()?;
        let stored = Stored {
            schema: SCHEMA.into(),
            compensator_sha256: compensator_sha256.into(),
            ridge_sha256: sha256(&ridge),
            held_back: self.held_back.clone(),
            trees: self.trees.clone(),
        };
        // Finite numbers in lists: nothing that a serialiser refuses.
        let mut text = serde_json::to_string(&stored).unwrap_or_default();
        text.push('\n');
        let write = |name: &str, bytes: &[u8]| {
            report::write_atomic(&directory.join(name), bytes).map_err(DirectoryError::from)
        };
        write(YARDSTICKS[1], &ridge)?;
        write(YARDSTICKS[0], text.as_bytes())?;
        Ok(())
    }

    /// Stored yardsticks of a model directory; none where it was trained without, or where they belong to
    /// another training than its compensator.
    ///
    /// # Errors
    /// A damaged file, or one of another version.
    pub fn load(directory: &Path, file: &ModelFile) -> Result<Option<Self>, ResidualError> {
        let path = directory.join(YARDSTICKS[0]);
        let Some(record) = file.compensator.as_ref().filter(|_| path.is_file()) else {
            return Ok(None);
        };
        let read = |path: &Path| {
            std::fs::read(path).map_err(|source| DirectoryError::Read {
                path: path.to_owned(),
                source,
            })
        };
        let format = |path: &Path, reason: String| DirectoryError::Format {
            path: path.to_owned(),
            reason,
        };
        let stored: Stored =
            serde_json::from_slice(&read(&path)?).map_err(|e| format(&path, e.to_string()))?;
        if stored.schema != SCHEMA {
            let found = stored.schema;
            let read = SCHEMA;
            return Err(DirectoryError::Schema { path, found, read }.into());
        }
        if stored.compensator_sha256 != record.sha256 {
            return Ok(None);
        }
        let path = directory.join(YARDSTICKS[1]);
        let bytes = read(&path)?;
        if sha256(&bytes) != stored.ridge_sha256 {
            let reason = "not the file that yardsticks.json was written with (checksum differs)";
            return Err(format(&path, reason.into()).into());
        }
        let ridge = Compensator::from_bytes(&bytes)?;
        ridge.check_joints(&file.joints)?;
        let names: Vec<String> = record.inputs.iter().map(|i| i.name()).collect();
        ridge.check_inputs(&names)?;
        if stored.trees.iter().any(|t| t.joint >= file.joints.len()) {
            let path = directory.join(YARDSTICKS[0]);
            return Err(format(&path, "trees of a joint that is not there".into()).into());
        }
        Ok(Some(Self {
            held_back: stored.held_back,
            ridge,
            trees: stored.trees,
        }))
    }

    /// Residual torque at the samples of one recording of the session, N·m (N), shape (samples, joints) each:
    /// by ridge, and by trees where there are any.
    ///
    /// # Errors
    /// As [`Yardsticks::torques`], and a model that does not fit together.
    pub fn of_recording(
        &self,
        file: &ModelFile,
        session: &Session,
        part: usize,
    ) -> Result<Vec<Array2<f64>>, ResidualError> {
        let motion = &session.parts[part].at_samples;
        match paced_table(file, &file.physics.model()?, session, part) {
            Some((table, pace)) => self.torques(&table, &motion.segments, pace),
            None => Ok(self.none(motion.q.dim())),
        }
    }

    /// Residual torque from a table of inputs, N·m (N), shape (samples, joints) each: by ridge, and by trees where there are any.
    ///
    /// # Errors
    /// Trees or units that contradict themselves.
    pub fn torques(
        &self,
        table: &Array2<f32>,
        segments: &[Range<usize>],
        pace: Pace,
    ) -> Result<Vec<Array2<f64>>, ResidualError> {
        let mut torques = vec![predict_from(&self.ridge, table, segments, pace)?];
        if !self.trees.is_empty() {
            let joints = self.ridge.joints.len();
            torques.push(summed(&self.trees, joints, table, segments, pace)?);
        }
        Ok(torques)
    }

    /// Zero torques, for a recording that is too slow for their windows.
    pub(super) fn none(&self, shape: (usize, usize)) -> Vec<Array2<f64>> {
        vec![Array2::zeros(shape); 1 + usize::from(!self.trees.is_empty())]
    }
}

impl Learner for Trees {
    fn joint(&self) -> usize {
        self.joint
    }

    fn residual(
        &self,
        samples: &Samples,
        sequences: &[usize],
    ) -> Result<Vec<f32>, compensator::Error> {
        self.predict(samples, sequences)
    }
}
