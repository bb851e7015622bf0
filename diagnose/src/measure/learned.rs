//! Error that a learned compensator would still remove: units trained on the fitted recording's residual beside
//! the causes, applied to the held-out one.
//!
//! Inputs and architecture are those of `train`. The training is short: it measures how much there is to learn,
//! and does not learn all of it. A unit that does not help on the last fitted trajectories is switched off.

use crate::error::DiagnoseError;
use crate::input::frames::Frames;
use crate::settings::SaidSettings;
use compensator::training::{Control, Job, Samples, Split, Training, UnitConfig, train};
use feedforward::inputs::{CompensatorRecord, Input};
use feedforward::network::Compensator;
use model::directory::{ModelFile, sha256};
use model::residual::{Pace, Preset, ResidualError, input_table, inputs, predict_from, remember};
use model::session::Session;
use ndarray::{Array1, Array2, Axis};
use physics::robot::Robot;
use physics::torque_model::TorqueModel;
use std::ops::Range;

/// Fastest rate of the samples within a window, Hz; faster recordings are several interleaved ones.
const RATE: f64 = 62.5;
/// Number of samples that an epoch visits.
const SAMPLES: f32 = 8000.0;
/// Number of epochs for which each unit is trained.
const EPOCHS: usize = 10;
/// Fewest pieces; with fewer trajectories each is cut in time.
const FEWEST: usize = 8;
/// Number of samples of the shortest piece.
const SHORTEST: usize = 50;
/// Part of the pieces that judges whether a unit helps.
const JUDGES: f64 = 0.25;

/// Compensator trained on the residual beside the causes.
pub struct Learned {
    compensator: Compensator,
    inputs: Vec<Input>,
    period: f64,
    /// Torque that the compensator adds on the held-out recording, N·m (N), shape (samples, joints).
    pub torque: Array2<f64>,
}

impl Learned {
    /// Adds the compensator to a model's file, whose session is the fitted and the held-out recording. Returns the weights.
    ///
    /// # Errors
    /// Weights that cannot be written down.
    pub fn store(
        &self,
        file: &mut ModelFile,
        session: &Session,
        model: &TorqueModel,
    ) -> Result<Vec<u8>, DiagnoseError> {
        let bytes = self.compensator.to_bytes().map_err(ResidualError::from)?;
        file.compensator = Some(CompensatorRecord {
            inputs: self.inputs.clone(),
            period: self.period,
            sha256: sha256(&bytes),
            validation: Vec::new(),
        });
        let load = session.load(model.load_robot());
        remember(&mut file.memory, session, &self.inputs, &load, 1);
        Ok(bytes)
    }
}

/// Trains a compensator on the residual beside the causes. `left` is that residual on the fitted recording,
/// shape (samples, joints); `robot` gives the load of the transmissions. None where the held-out recording is
/// too slow for the windows.
///
/// # Errors
/// The training failed.
pub fn learned(
    frames: &Frames,
    left: &Array2<f64>,
    robot: &Robot,
    settings: &SaidSettings,
) -> Result<Option<Learned>, DiagnoseError> {
    let parts = vec![
        frames.data.prepared().clone(),
        frames.heldout.prepared().clone(),
    ];
    let period = (1.0 / RATE).max(1.0 / frames.data.report().rate_hz);
    let paces = [&frames.data, &frames.heldout].map(|f| Pace::new(f.report().rate_hz, period));
    let [Some(fitted), Some(scored)] = paces else {
        return Ok(None);
    };
    let session = Session::new(parts, &[]);
    let joints = robot.joint_names();
    let (list, seen) = inputs(Preset::Default, joints.len(), false, None, &[], &[]);
    let tables = input_table(&session, &list, &session.load(robot), &[]);
    let pieces = pieces(&session.parts[0].at_samples.segments);
    let (rows, sequences) = fitted.rows(&pieces);
    let table = tables[0].select(Axis(0), &rows);
    let targets: Vec<Array1<f32>> = (0..joints.len())
        .map(|j| rows.iter().map(|&r| left[[r, j]] as f32).collect())
        .collect();
    if pieces.len() < 2 {
        return Ok(None);
    }
    let judges = (JUDGES * pieces.len() as f64).ceil() as usize;
    let first = sequences.len() - judges * fitted.phases();
    let split = Split {
        train: (0..first).collect(),
        validation: (first..sequences.len()).collect(),
    };
    let jobs: Vec<Job> = targets
        .iter()
        .enumerate()
        .filter(|(_, t)| t.iter().any(|x| *x != t[0]))
        .map(|(joint, target)| {
            Ok(Job {
                joint,
                columns: seen[joint].clone(),
                samples: Samples::new(table.view(), target.view(), None, &sequences)?,
                split: split.clone(),
                config: config(rows.len(), settings),
                seed: joint as u64,
            })
        })
        .collect::<Result<_, ResidualError>>()?;
    let control = Control {
        threads: rayon::current_num_threads(),
        ..Control::default()
    };
    let trained = train(&jobs, &control).map_err(ResidualError::from)?;
    let compensator = Compensator {
        joints,
        inputs: list.iter().map(|i| i.name()).collect(),
        units: trained.into_iter().map(|t| t.unit).collect(),
    };
    let segments = &session.parts[1].at_samples.segments;
    let torque = predict_from(&compensator, &tables[1], segments, scored)?;
    Ok(Some(Learned {
        compensator,
        inputs: list,
        period,
        torque,
    }))
}

/// Trajectories; where there are few, each cut into stretches of time.
fn pieces(segments: &[Range<usize>]) -> Vec<Range<usize>> {
    let cuts = FEWEST.div_ceil(segments.len().max(1));
    let cut = |s: &Range<usize>| {
        let (start, length) = (s.start, s.len());
        (0..cuts).map(move |k| start + length * k / cuts..start + length * (k + 1) / cuts)
    };
    segments
        .iter()
        .flat_map(cut)
        .filter(|r| r.len() >= SHORTEST)
        .collect()
}

fn config(samples: usize, settings: &SaidSettings) -> UnitConfig {
    UnitConfig {
        training: Training::one_cycle(EPOCHS, 1e-2, SAMPLES / samples as f32),
        least_gain: settings.learned,
        // Pieces of one trajectory follow one another: their number says nothing of chance, which the verdict's own test weighs.
        sure: 0.0,
        ..UnitConfig::default()
    }
}
