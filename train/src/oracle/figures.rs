//! Scores of a model on the scale between the physics' error and the least attainable error.

use super::mechanisms::Left;
use super::plant::Plant;
use datasets::metrics::{Scope, Scores};
use model::directory::ModelFile;
use model::evaluation::{Evaluation, Share};
use model::failure::Failure;
use ndarray::Array2;
use serde::Serialize;

/// Contents of `train oracle --json`.
#[derive(Serialize)]
pub struct Figures {
    /// Schema of the file: `oracle/1`.
    pub schema: &'static str,
    /// Names of the joints, base first.
    pub joints: Vec<String>,
    /// Cut-off of the motion at which the true equations do best, Hz; none: the model's own.
    pub cutoff_hz: Option<f64>,
    /// Scores over all samples, and over those in motion.
    pub scopes: Vec<Scale>,
    /// Residual of each mechanism.
    pub mechanisms: Vec<Left>,
}

/// Scores over the samples of one scope.
#[derive(Serialize)]
pub struct Scale {
    /// Scope: all samples, or those in motion.
    pub scope: Scope,
    /// Scores of the torque that the plant exerted against the recorded one: the sensor's noise.
    pub floor: Scores,
    /// Scores of the true equations on the recorded motion up to each sample, temperature unknown.
    pub attainable: Scores,
    /// Scores of the model's physics alone.
    pub physics: Scores,
    /// Scores of the whole model, where it has a compensator.
    pub whole: Option<Scores>,
    /// Share of (physics² − attainable²) that the compensator removes, by joint and over all joints.
    pub share: Option<Share>,
}

impl Figures {
    /// Figures from the tables of all torques.
    pub fn new(
        file: &ModelFile,
        plant: &Plant,
        evaluation: &Evaluation,
        (attainable, cutoff_hz): (Array2<f64>, Option<f64>),
        mechanisms: Vec<Left>,
    ) -> Result<Self, Failure> {
        let qd = &evaluation.session.parts[0].at_samples.qd;
        let recorded = plant.recorded();
        let scale = |scope| {
            let score = |torque: &Array2<f64>| {
                Scores::of(recorded.view(), torque.view(), qd.view(), scope)
                    .map_err(|e| Failure::other(e.to_string()))
            };
            let whole = file
                .compensator
                .is_some()
                .then(|| score(&evaluation.torque));
            let [floor, attainable, physics] =
                [&plant.exerted, &attainable, &evaluation.physics].map(score);
            let (attainable, physics, whole) = (attainable?, physics?, whole.transpose()?);
            let share = whole.as_ref().map(|w| Share::of(&physics, w, &attainable));
            Ok::<_, Failure>(Scale {
                scope,
                floor: floor?,
                attainable,
                physics,
                whole,
                share,
            })
        };
        Ok(Self {
            schema: "oracle/1",
            joints: file.joints.clone(),
            cutoff_hz,
            scopes: Scope::BOTH
                .into_iter()
                .map(scale)
                .collect::<Result<_, _>>()?,
            mechanisms,
        })
    }
}
