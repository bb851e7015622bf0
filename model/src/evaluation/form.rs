//! Form in which the run-time keeps the weights, chosen on a recording that the model has not seen.

use super::{EvaluateError, Evaluation};
use crate::directory::{DirectoryError, ModelFile, sha256};
use crate::loaded::Loaded;
use crate::residual::{self, ResidualError};
use feedforward::model_file::NETWORK;
use feedforward::network::Weights;
use ndarray::Array2;
use std::path::Path;

/// Largest growth of a joint's error, as a share of it, with which a form is taken.
pub const GROWTH: f64 = 0.01;

/// A model whose run-time keeps its weights in another form.
pub struct Formed {
    /// RMS of the torque's error by joint, N·m (N), with weights in single precision and in the new form.
    pub errors: Vec<[f64; 2]>,
    /// Contents of `compensator.safetensors`.
    network: Vec<u8>,
    file: ModelFile,
}

impl Formed {
    /// Joints whose error grows by more than [`GROWTH`].
    pub fn worse(&self) -> Vec<usize> {
        worse(&self.errors)
    }

    /// Writes a model directory with what a loop needs.
    ///
    /// # Errors
    /// The directory or a file cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), EvaluateError> {
        std::fs::create_dir_all(directory).map_err(|source| DirectoryError::Folder {
            path: directory.to_owned(),
            source,
        })?;
        let path = directory.join(NETWORK);
        report::write_atomic(&path, &self.network).map_err(DirectoryError::from)?;
        Ok(self.file.save(directory)?)
    }
}

/// The model of `directory` with weights in the form `weights`, and its errors on the recording of `evaluation`. None without a
/// compensator, or without torque to compare with.
///
/// # Errors
/// See [`EvaluateError`].
pub fn form(
    directory: &Path,
    file: &ModelFile,
    evaluation: &Evaluation,
    weights: Weights,
) -> Result<Option<Formed>, EvaluateError> {
    let (Some(mut compensator), Some(tau)) = (
        residual::load(directory, file)?,
        evaluation.recording.tau.as_ref(),
    ) else {
        return Ok(None);
    };
    let model = file.physics.model()?;
    let mut errors = vec![[0.0; 2]; file.joints.len()];
    for (i, form) in [Weights::F32, weights].into_iter().enumerate() {
        for unit in &mut compensator.units {
            unit.weights = form;
        }
        let loaded = Loaded {
            file,
            model: &model,
            compensator: Some(&compensator),
        };
        let [_, torque] = loaded.torque(&evaluation.session)?;
        for (errors, rms) in errors.iter_mut().zip(rms(&(tau - &torque))) {
            errors[i] = rms;
        }
    }
    let network = compensator.to_bytes().map_err(ResidualError::from)?;
    let mut file = file.clone();
    if let Some(record) = &mut file.compensator {
        record.sha256 = sha256(&network);
    }
    Ok(Some(Formed {
        errors,
        network,
        file,
    }))
}

/// Root of the mean square of each column, over values that are finite.
fn rms(errors: &Array2<f64>) -> Vec<f64> {
    let column = |column: ndarray::ArrayView1<f64>| {
        let finite = || column.iter().filter(|e| e.is_finite());
        let square: f64 = finite().map(|e| e * e).sum();
        (square / finite().count().max(1) as f64).sqrt()
    };
    errors.columns().into_iter().map(column).collect()
}

/// Joints whose second error exceeds the first by more than [`GROWTH`].
fn worse(errors: &[[f64; 2]]) -> Vec<usize> {
    let grown = |[whole, narrow]: [f64; 2]| narrow > whole * (1.0 + GROWTH);
    (0..errors.len()).filter(|j| grown(errors[*j])).collect()
}

#[cfg(test)]
mod tests {
    use super::worse;

    #[test]
    fn one_joint_that_grows_by_more_than_a_hundredth_is_enough() {
        assert!(worse(&[[1.0, 1.009], [2.0, 1.5], [0.0, 0.0]]).is_empty());
        assert_eq!(worse(&[[1.0, 1.009], [2.0, 2.021]]), [1]);
    }
}
