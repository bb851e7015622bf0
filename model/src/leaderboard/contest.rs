//! Comparison of all models on one recording.

use super::board::{Given, Leaderboard};
use super::bootstrap::{Judged, Stretches, judge};
use super::entry::{Entry, Training, WHOLE, enter, rank};
use super::error::LeaderboardError;
use super::inference;
use crate::baseline::FORWARD;
use crate::baseline::published::Task;
use crate::directory::{ModelFile, Timing};
use crate::evaluation::{EvaluateOptions, Evaluation, evaluate, read_options};
use crate::inversion::PHYSICS_FORWARD;
use crate::residual::{self, Yardsticks};
use crate::tables::{RIDGE, TREES};
use compensator::training::Trees;
use datasets::{Part, read};
use feedforward::network::Compensator;
use feedforward::{Feedforward, LoadError};
use ndarray::{Array2, Axis};
use std::path::{Path, PathBuf};

/// Request for a comparison: the models, and the recording to score them on.
#[derive(Clone, Copy, Debug)]
pub struct Contest<'a> {
    /// Model directories, of one robot.
    pub directories: &'a [PathBuf],
    /// Path of the recording to score on.
    pub data: &'a Path,
    /// Path of the robot's drive file.
    pub drive: Option<&'a Path>,
    /// Cut-off of the motion's low-pass, Hz, in place of each model's own.
    pub cutoff_hz: Option<f64>,
}

/// Leaderboard of the models: each is scored as by `eval`, and its costs are measured.
///
/// # Errors
/// Models of different robots, or what `eval` refuses.
pub fn hold(contest: &Contest) -> Result<Leaderboard, LeaderboardError> {
    let mut given = Vec::new();
    for directory in contest.directories {
        given.push((directory.as_path(), ModelFile::load(directory)?));
    }
    one_robot(&given)?;
    let mut board: Option<Leaderboard> = None;
    for (directory, file) in &given {
        let options = read_options(file, contest.drive, Part::Test, true)?;
        let recording = read(contest.data, &options)?;
        let options = EvaluateOptions {
            cutoff_hz: contest.cutoff_hz,
        };
        let scored = evaluate(directory, file, recording, &options)?;
        let board = board.get_or_insert_with(|| Leaderboard::empty(file, &scored));
        let model = Contestant::new(directory, file, &scored)?;
        for row in model.rows()? {
            enter(&mut board.rows, row);
        }
        for row in [model.forward_baseline()?, model.physics_forward()?] {
            row.into_iter()
                .for_each(|row| enter(&mut board.forward, row));
        }
        board.models.push(Given {
            directory: model.name,
            notes: scored.report.notes.clone(),
        });
    }
    let mut board = board.ok_or(LeaderboardError::Nothing)?;
    for p in &board.published {
        let rows = match p.task {
            Task::Inverse => &mut board.rows,
            Task::Forward => &mut board.forward,
        };
        rows.push(Entry::published(p));
    }
    rank(&mut board.rows);
    rank(&mut board.forward);
    Ok(board)
}

/// Refuses models of different robots.
fn one_robot(given: &[(&Path, ModelFile)]) -> Result<(), LeaderboardError> {
    let Some((first, model)) = given.first() else {
        return Err(LeaderboardError::Nothing);
    };
    let name = |file: &ModelFile| format!("{} ({})", file.physics.robot, file.joints.join(", "));
    let differs = given.iter().find(|(_, other)| {
        (&other.physics.robot, &other.joints) != (&model.physics.robot, &model.joints)
    });
    match differs {
        None => Ok(()),
        Some((directory, other)) => Err(LeaderboardError::Robots {
            first: first.to_path_buf(),
            of_first: name(model),
            other: directory.to_path_buf(),
            of_other: name(other),
        }),
    }
}

/// Yardstick of a model: its name, its torque (samples, joints), and its number of weights or leaves.
type Yardstick = (&'static str, Array2<f64>, usize);

/// Model to be compared, with its scores on the recording.
struct Contestant<'a> {
    /// Model directory, as given.
    name: String,
    /// Path of the model directory.
    directory: &'a Path,
    /// Contents of `model.json`.
    file: &'a ModelFile,
    /// Evaluation of the model on the recording.
    scored: &'a Evaluation,
    /// Recorded torque, N·m (N), shape (samples, joints).
    measured: &'a Array2<f64>,
    /// Compensator of the model; none without one.
    compensator: Option<Compensator>,
    /// Wall time of the training; none where it was not stored.
    timing: Option<Timing>,
    /// Whether the model was fitted on this recording.
    fitted_on_it: bool,
}

impl<'a> Contestant<'a> {
    /// Model of a directory with its scores.
    ///
    /// # Errors
    /// Recording without torque, or a file of the directory that cannot be read.
    fn new(
        directory: &'a Path,
        file: &'a ModelFile,
        scored: &'a Evaluation,
    ) -> Result<Self, LeaderboardError> {
        let Some(measured) = &scored.recording.tau else {
            return Err(LeaderboardError::NoTorque(scored.recording.source.clone()));
        };
        Ok(Self {
            name: directory.display().to_string(),
            directory,
            file,
            scored,
            measured,
            compensator: residual::load(directory, file)?,
            timing: Timing::load(directory)?,
            fitted_on_it: file.provenance.fitted(&scored.recording).is_some(),
        })
    }

    /// Rows for torque from motion: the linear baseline fitted with the model, the physics, the whole model.
    fn rows(&self) -> Result<Vec<Entry>, LeaderboardError> {
        let part = &self.scored.session.parts[0];
        let motion = &part.at_samples;
        let stretches = Stretches::of(&self.scored.recording.segments());
        let entry = |model: &str, torque: &Array2<f64>| {
            let judged = judge(self.measured, torque, &motion.qd, &stretches)?;
            Ok::<_, LeaderboardError>(self.entry(model, judged))
        };
        let linear = &self.file.linear_baseline;
        let torque = linear.predict(motion.q.view(), motion.qd.view(), motion.qdd.view())?;
        let mut rows = vec![Entry {
            parameters: Some(linear.matrix.iter().map(Vec::len).sum()),
            ..entry("linear_baseline", &torque)?
        }];
        let training = |whole| self.timing.as_ref().map(|t| Training::of(t, whole));
        let period = Some(part.report.rate_hz.recip());
        if let Some(compensator) = &self.compensator {
            rows.push(Entry {
                parameters: Some(self.file.fitted_parameters()),
                network_parameters: Some(weights(compensator)),
                // A recording too slow for the compensator is predicted by the physics alone.
                inference_us: match Feedforward::load(self.directory, period) {
                    Ok(mut whole) => inference::microseconds(&mut whole, motion),
                    Err(LoadError::Windows { .. }) => None,
                    Err(other) => return Err(other.into()),
                },
                training: training(true),
                ..entry(WHOLE, &self.scored.torque)?
            });
        }
        for (name, torque, size) in self.yardsticks()? {
            rows.push(Entry {
                parameters: Some(self.file.fitted_parameters()),
                network_parameters: Some(size),
                ..entry(name, &torque)?
            });
        }
        let mut physics = Feedforward::load_physics(self.directory, period)?;
        rows.push(Entry {
            parameters: Some(self.file.fitted_parameters()),
            inference_us: inference::microseconds(&mut physics, motion),
            training: training(false),
            ..entry("physics", &self.scored.physics)?
        });
        Ok(rows)
    }

    /// Torque of the physics with a ridge regression, and with boosted trees where there are any, on the
    /// compensator's inputs. Empty where they were not trained with it.
    fn yardsticks(&self) -> Result<Vec<Yardstick>, LeaderboardError> {
        let Some(yardsticks) = Yardsticks::load(self.directory, self.file)? else {
            return Ok(Vec::new());
        };
        let torques = yardsticks.of_recording(self.file, &self.scored.session, 0)?;
        let on = yardsticks.trees.iter().filter(|t| t.enabled);
        let sizes = [weights(&yardsticks.ridge), on.map(Trees::leaves).sum()];
        let all = [RIDGE, TREES].into_iter().zip(torques).zip(sizes);
        let with = |torque| &self.scored.physics + &torque;
        Ok(all.map(|((name, t), size)| (name, with(t), size)).collect())
    }

    /// Row for positions simulated from torque. None where the model has no baseline for it, or the recording another rate.
    fn forward_baseline(&self) -> Result<Option<Entry>, LeaderboardError> {
        let Some(baseline) = &self.file.forward_baseline else {
            return Ok(None);
        };
        let Some(s) = baseline.simulate(&self.scored.recording) else {
            return Ok(None);
        };
        let motion = &self.scored.session.parts[0].at_samples;
        let speed = motion.qd.select(Axis(0), &s.source);
        let stretches = Stretches::of(&s.trajectories);
        let judged = judge(&s.measured, &s.simulated, &speed, &stretches)?;
        Ok(Some(self.entry(FORWARD, judged)))
    }

    /// Row for positions by solving the model for the motion; none where `train forward` was not run.
    fn physics_forward(&self) -> Result<Option<Entry>, LeaderboardError> {
        let Some(q) = &self.scored.positions else {
            return Ok(None);
        };
        let recording = &self.scored.recording;
        let speed = &self.scored.session.parts[0].at_samples.qd;
        let stretches = Stretches::of(&recording.segments());
        let judged = judge(&recording.q, q, speed, &stretches)?;
        Ok(Some(self.entry(PHYSICS_FORWARD, judged)))
    }

    /// Row of a leaderboard for this model, with scores over all samples and in motion.
    fn entry(&self, model: &str, judged: [Judged; 2]) -> Entry {
        Entry {
            fitted_on_it: self.fitted_on_it,
            ..Entry::of(model, &self.name, judged)
        }
    }
}

/// Number of weights of the active units, over all members.
fn weights(compensator: &Compensator) -> usize {
    let on = compensator.units.iter().filter(|u| u.enabled);
    on.flat_map(|u| &u.members).map(Vec::len).sum()
}
