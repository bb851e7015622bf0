//! Training tasks: settings, jobs, and directories of the checkpoints.

use super::ResidualError;
use super::examples::Examples;
use super::inputs::Preset;
use compensator::training::{Control, Job, Samples, Split, Training, UnitConfig};
use ndarray::{Array1, Array2};

/// Settings of [`train_residual`](super::train_residual).
#[derive(Clone, Debug)]
pub struct ResidualOptions {
    /// Preset of the compensator.
    pub preset: Preset,
    /// Random seed of the networks.
    pub seed: u64,
    /// Number of networks averaged per unit; None: the preset's number.
    pub members: Option<usize>,
    /// Number of epochs; None: the preset's number.
    pub epochs: Option<usize>,
    /// Whether to train on moving samples alone.
    pub moving_only: bool,
    /// Whether to train ridge regression and boosted trees on the same inputs for comparison.
    pub yardsticks: bool,
}

impl ResidualOptions {
    /// Number of networks that are trained for `joints` units, the trial included.
    pub fn networks(&self, joints: usize) -> usize {
        joints * (1 + config(self, 1).members)
    }
}

/// Settings of a unit for `samples` training samples.
///
/// The default's rates and widths were chosen on KR300 training groups alone; an epoch visits part of
/// the samples so that long recordings do not take longer than they teach.
fn config(options: &ResidualOptions, samples: usize) -> UnitConfig {
    let mut config = match options.preset {
        Preset::Ucm => {
            let ucm = UnitConfig::ucm();
            let training = Training {
                share: (30_000.0 / samples as f32).min(1.0),
                ..ucm.training.clone()
            };
            UnitConfig { training, ..ucm }
        }
        Preset::Default => {
            let (learning_rate, epochs) = if options.moving_only {
                (5e-3, 16)
            } else {
                (1e-2, 24)
            };
            UnitConfig {
                members: 3,
                training: Training::one_cycle(
                    epochs,
                    learning_rate,
                    (20_000.0 / samples as f32).min(0.5),
                ),
                ..UnitConfig::default()
            }
        }
    };
    if let Some(members) = options.members {
        config.members = members;
    }
    if let Some(epochs) = options.epochs {
        config.training.epochs = epochs;
    }
    config
}

/// Seed of a joint's first network; the joint's other networks count on from it. Seeds of different user seeds
/// are far apart, so that no network of one is trained again under the next.
fn first_seed(seed: u64, joint: usize) -> u64 {
    const APART: u64 = 1 << 32;
    seed.wrapping_mul(APART).wrapping_add(joint as u64)
}

/// Data of the training jobs.
pub(super) struct Task<'a> {
    /// Input columns of all rows, shape (rows, inputs).
    pub(super) inputs: &'a Array2<f32>,
    /// Rows that the units are trained and judged on.
    pub(super) examples: &'a Examples,
    /// Input columns of each joint's unit.
    pub(super) seen: &'a [Vec<usize>],
    pub(super) options: &'a ResidualOptions,
}

impl<'a> Task<'a> {
    /// Jobs of all joints that have a sample with non-zero weight.
    pub(super) fn jobs<'b>(
        &self,
        targets: &'b [Array1<f32>],
        split: &Split,
    ) -> Result<Vec<Job<'b>>, ResidualError>
    where
        'a: 'b,
    {
        let examples = self.examples;
        let job = |joint: usize| {
            Ok(Job {
                joint,
                columns: self.seen[joint].clone(),
                samples: Samples::new(
                    self.inputs.view(),
                    targets[joint].view(),
                    Some(examples.weights[joint].view()),
                    &examples.segments,
                )?,
                split: split.clone(),
                config: config(self.options, examples.len()),
                seed: first_seed(self.options.seed, joint),
            })
        };
        (0..targets.len())
            .filter(|&joint| examples.weights[joint].iter().any(|w| *w > 0.0))
            .map(job)
            .collect()
    }
}

/// Checkpoints of one phase of the training.
pub(super) struct Phase {
    directory: Option<std::path::PathBuf>,
}

pub(super) fn within(control: &Control, phase: &str) -> Phase {
    Phase {
        directory: control.checkpoints.map(|c| c.join(phase)),
    }
}

impl Phase {
    pub(super) fn view<'a>(&'a self, control: &Control<'a>) -> Control<'a> {
        Control {
            checkpoints: self.directory.as_deref(),
            ..*control
        }
    }
}

#[cfg(test)]
mod tests {
    use super::first_seed;

    /// Ensembles of two seeds are independent: members of a joint are `first_seed`, `first_seed + 1`, ….
    #[test]
    fn seeds_share_no_network_of_a_joint() {
        let members = |seed| (0..8).map(move |m| first_seed(seed, 2) + m);
        for other in 1..5 {
            assert!(members(0).all(|network| members(other).all(|n| n != network)));
        }
        assert_eq!(first_seed(0, 3), 3);
    }
}
