//! Gains of the joints' drives from a recording without and one with a body of known parameters.
//!
//! With the recorded τ_j (a current times a wrong torque constant) and g_j the gain of its error, each sample
//! of each joint is g_j τ_j = Y_j β + F_j φ_j, and with the body + Y_b p on the right. Without a known p all of
//! it could be scaled at once; the known part of p is the scale (Gautier and Briot 2014, see
//! [`identify::total_least_squares`]). Motion counts as exact, and the model's residual as noise of the
//! recorded torque. With noise of joint j in units of its own rows the right singular vector is the
//! maximum-likelihood estimate. So rows and columns are scaled by the residual of the pass before.

mod known;
mod rows;

pub use known::{KnownBody, KnownBodyError};

use super::{Figure, PayloadError, noise, refuse_joints};
use crate::directory::ModelFile;
use crate::evaluation::EvaluateError;
use crate::preparation::units::refuse_degrees;
use crate::session::Session;
use ::identify::base::BaseParameters;
use ::identify::feasible::{Constraints, Feasibility, Nominal};
use ::identify::least_squares::{Gram, LeastSquaresError, refitted_deviations};
use ::identify::total_least_squares::{Total, total, without_noise};
use datasets::Recording;
use datasets::prepare::Prepared;
use faer::Mat;
use ndarray::Array2;
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use rows::{Block, Rows};
use serde::Serialize;

/// Settings of [`estimate`].
#[derive(Clone, Debug, PartialEq)]
pub struct GainOptions {
    /// Cut-off of the motion's low-pass, Hz, in place of the model's own.
    pub cutoff_hz: Option<f64>,
    /// Largest relative standard deviation of a gain that is reported. Default 0.1.
    pub widest: f64,
}

impl Default for GainOptions {
    fn default() -> Self {
        Self {
            cutoff_hz: None,
            widest: 0.1,
        }
    }
}

/// Factors on the recorded torque of each joint that make it N·m (N).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DriveGains {
    /// Name and version of the format: `drive_gains/1`.
    pub schema: &'static str,
    /// Names of the robot's joints, base first.
    pub joints: Vec<String>,
    /// Number of samples of the recordings without and with the body.
    pub samples: [usize; 2],
    /// Known standard parameters of the body in the last joint's frame.
    pub known: KnownBody,
    /// Gain of each joint by total least squares; none where it is not determined.
    pub gain: Vec<Option<Figure>>,
    /// Gain of each joint by ordinary least squares, which is too small where noise is large beside the body's torque.
    pub ordinary: Vec<Option<f64>>,
    /// Gain of each joint by total least squares among robots whose links are possible bodies.
    pub possible: Vec<Option<f64>>,
    /// Root mean square residual over both recordings, N·m (N) after the gain.
    pub rmse: Vec<Option<f64>>,
    /// Conditions of the figures, as text.
    pub notes: Vec<String>,
}

/// Largest number of passes. Each takes the noise from the residual of the one before.
const PASSES: usize = 30;
/// Relative change of all gains below which the passes have converged.
const STILL: f64 = 1e-5;
/// Noise in the first pass, relative to the recorded torque.
const FIRST: f64 = 0.1;

/// Estimates the gains of all joints that the body determines.
///
/// # Errors
/// See [`PayloadError`].
pub fn estimate(
    file: &ModelFile,
    without: &Recording,
    with: &Recording,
    body: &KnownBody,
    options: &GainOptions,
) -> Result<DriveGains, PayloadError> {
    let recorded = [torque(file, without)?, torque(file, with)?];
    let prepared = [without, with].map(|r| prepare(file, r, options.cutoff_hz));
    let [first, second] = prepared;
    // Both on a clock of their own: the stored model's memory is of its training.
    let session = Session::new(vec![first?, second?], &[]);
    let model = file.physics.model()?;
    let base = BaseParameters::of_robot(model.robot(), &[]);
    let rows = Rows::new(&model, &base, &session, recorded, body);
    let blocks = rows.blocks()?;
    let starts: Vec<usize> = without
        .starts()
        .into_iter()
        .chain(with.starts().into_iter().map(|s| s + without.len()))
        .collect();
    let mut chosen: Vec<usize> = (0..model.dof()).collect();
    let found = loop {
        let worst = match Fit::new(&rows, &blocks, &starts, recorded, &chosen) {
            Ok(fit) => match fit.widest() {
                (_, deviation) if deviation <= options.widest => break fit,
                (worst, _) => worst,
            },
            // A gain that ran away from pass to pass.
            Err(LeastSquaresError::BadNoise { column }) => column,
            // Nothing in the rows that ties gains to the body.
            Err(LeastSquaresError::NoScale | LeastSquaresError::Decomposition) => chosen.len(),
            Err(error) => return Err(error.into()),
        };
        if worst < chosen.len() {
            chosen.remove(worst);
        } else {
            chosen.clear();
        }
        if chosen.is_empty() {
            return Err(PayloadError::NoGain {
                file: with.source.clone(),
                percent: 100.0 * options.widest,
            });
        }
    };
    let possible = found.possible(&rows, &base, &file.physics.nominal()?)?;
    let n = model.dof();
    let spread = |values: &[f64]| -> Vec<Option<f64>> {
        let place = |j: usize| chosen.iter().position(|&c| c == j);
        (0..n).map(|j| place(j).map(|at| values[at])).collect()
    };
    let std = spread(&found.std);
    let gain = std::iter::zip(spread(&found.gain), std)
        .map(|(value, std)| {
            Some(Figure {
                value: value?,
                std: std?,
            })
        })
        .collect();
    Ok(DriveGains {
        schema: "drive_gains/1",
        joints: file.joints.clone(),
        samples: [without.len(), with.len()],
        known: *body,
        ordinary: spread(&found.ordinary),
        possible: spread(&possible),
        rmse: spread(&found.rmse),
        notes: notes(file, &chosen, body),
        gain,
    })
}

/// Recorded torque of a recording that fits the model.
///
/// # Errors
/// Recording without torque, of another robot, or in degrees.
fn torque<'a>(file: &ModelFile, recording: &'a Recording) -> Result<&'a Array2<f64>, PayloadError> {
    refuse_joints(file, recording)?;
    refuse_degrees(&file.physics.nominal()?, recording)?;
    let none = || PayloadError::NoTorque(recording.source.clone());
    recording.tau.as_ref().ok_or_else(none)
}

/// Recording prepared as for the model's training.
fn prepare(
    file: &ModelFile,
    recording: &Recording,
    cutoff_hz: Option<f64>,
) -> Result<Prepared, PayloadError> {
    let prepared = file.preprocessing.prepare(recording, cutoff_hz);
    prepared.map_err(|source| {
        PayloadError::Evaluate(EvaluateError::Prepare {
            file: recording.source.clone(),
            source,
        })
    })
}

/// Estimated gains of the chosen joints, in their order.
struct Fit {
    /// Gain of each joint by total least squares.
    gain: Vec<f64>,
    /// Standard deviation of each gain.
    std: Vec<f64>,
    /// Gain of each joint by ordinary least squares.
    ordinary: Vec<f64>,
    /// RMS residual of each joint, N·m (N).
    rmse: Vec<f64>,
    /// Sums of all rows with the weights of the last pass.
    whole: Gram,
    /// Noise of the gains' columns, in the units of these sums.
    noise: Vec<f64>,
    /// Total-least-squares solution of these sums.
    total: Total,
}

impl Fit {
    /// Gains of the joints `chosen`, in passes that take the noise from the residual of the one before.
    fn new(
        rows: &Rows,
        blocks: &[Block],
        starts: &[usize],
        recorded: [&Array2<f64>; 2],
        chosen: &[usize],
    ) -> Result<Self, LeastSquaresError> {
        let joints = rows.qd.ncols();
        let mut scale = vec![[0.0; 2]; joints];
        let mut noise = vec![1.0; chosen.len()];
        for &j in chosen {
            let squares: f64 = recorded.iter().map(|t| t.column(j).dot(&t.column(j))).sum();
            let samples = recorded[0].nrows() + recorded[1].nrows();
            let size = FIRST * (squares / samples as f64).sqrt().max(f64::MIN_POSITIVE);
            scale[j] = [1.0 / size; 2];
        }
        let mut gain = vec![1.0; chosen.len()];
        let mut wrong = vec![0.0; joints];
        let mut pass = 0;
        loop {
            let parts = blocks
                .iter()
                .map(|b| rows.weighted(b, chosen, &scale))
                .collect::<Result<Vec<_>, _>>()?;
            let held = rows.held(chosen, &wrong)?;
            let whole = Gram::sum(&parts)?.plus(&held)?;
            let found = total(&whole, &noise)?;
            let new = &found.parameters[rows.width..];
            let moved = std::iter::zip(&gain, new).map(|(old, new)| (new / old - 1.0).abs());
            let still = moved.fold(0.0, f64::max) < STILL;
            gain = new.to_vec();
            pass += 1;
            let left = rows.left(chosen, &found.parameters);
            if still || pass == PASSES {
                let std = deviations(&parts, &held, &noise)?;
                let std = std.unwrap_or_else(|| vec![f64::INFINITY; chosen.len()]);
                let every: Vec<usize> = (0..whole.columns()).collect();
                let ordinary = whole
                    .fit(&every, 0.0)?
                    .ok_or(LeastSquaresError::Decomposition)?;
                return Ok(Self {
                    std,
                    ordinary: ordinary.parameters[rows.width..].to_vec(),
                    rmse: chosen.iter().map(|&j| super::rms(&left)[j]).collect(),
                    gain,
                    whole,
                    noise,
                    total: found,
                });
            }
            wrong = noise::shared(&left, starts);
            let weights = noise::weights(&left, &rows.qd, starts);
            for (at, &j) in chosen.iter().enumerate() {
                scale[j] = weights[j];
                noise[at] = noise::weighted_rms(&left, &rows.qd, &weights, j) / gain[at].abs();
            }
        }
    }

    /// Index among the chosen joints of the gain with the largest relative standard deviation, which is
    /// infinite for a negative gain; and that deviation.
    fn widest(&self) -> (usize, f64) {
        let relative = std::iter::zip(&self.gain, &self.std).map(|(g, s)| {
            if *g > 0.0 && s.is_finite() {
                s / g
            } else {
                f64::INFINITY
            }
        });
        let larger = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
        relative.enumerate().fold((0, f64::NEG_INFINITY), larger)
    }

    /// Positive gains with links that are possible bodies: quadratic minimum of the sums without the noise's part.
    fn possible(
        &self,
        rows: &Rows,
        base: &BaseParameters,
        nominal: &Robot,
    ) -> Result<Vec<f64>, PayloadError> {
        let gram = without_noise(&self.whole, &self.noise, &self.total);
        let rigid = PARAMETERS_PER_LINK * nominal.dof();
        let columns = gram.columns();
        let extra = columns - base.len();
        let grouping = Mat::from_fn(columns, rigid + extra, |i, j| {
            if i < base.len() && j < rigid {
                base.grouping()[(i, j)]
            } else {
                f64::from(u8::from(i >= base.len() && j == rigid + i - base.len()))
            }
        });
        // Anything that is no link is free by many times its size.
        let extras: Vec<(f64, f64)> = (base.len()..columns)
            .map(|c| (0.0, GENEROUS * self.total.parameters[c].abs().max(1.0)))
            .collect();
        let gains = rigid + rows.width - base.len()..rigid + extra;
        let feasibility = Feasibility::new(
            grouping.as_ref(),
            Constraints::new(nominal.dof(), gains),
            Nominal::of_robot(nominal, &extras),
        )?;
        let made = feasibility.fit_gram(&gram, 1.0, None)?;
        Ok(made.standard[rigid + rows.width - base.len()..].to_vec())
    }
}

/// Standard deviations of the gains: jackknife over blocks, or by noise and shapes, whichever is larger; none
/// where there are too few blocks.
fn deviations(
    parts: &[Gram],
    held: &Gram,
    noise: &[f64],
) -> Result<Option<Vec<f64>>, LeastSquaresError> {
    let estimate = |g: &Gram| total(&g.plus(held)?, noise);
    let whole = Gram::sum(parts)?;
    let first = whole.columns() - noise.len();
    let without = without_noise(&whole.plus(held)?, noise, &estimate(&whole)?);
    let formal = without.deviations()?;
    let told = refitted_deviations(parts, |g| Ok(estimate(g)?.parameters[first..].to_vec()))?;
    Ok(told.map(|t: Vec<f64>| {
        std::iter::zip(t, &formal[first..])
            .map(|(a, b)| a.max(*b))
            .collect()
    }))
}

/// Bound of all unknowns but links, relative to their estimate.
const GENEROUS: f64 = 100.0;

/// Conditions of the figures, as text.
fn notes(file: &ModelFile, chosen: &[usize], body: &KnownBody) -> Vec<String> {
    let mut notes = vec![
        "The recorded torque (or current times the torque constant of the drive file) times the gain is the torque in N·m (N); a \
         torque constant is right where its gain is 1. Gains are relative to the known body: a percent of its mass is a percent \
         of all gains."
            .to_owned(),
    ];
    if !body.unknown().is_empty() {
        notes.push(format!(
            "{} of the body's ten parameters were taken as known, the others were estimated.",
            PARAMETERS_PER_LINK - body.unknown().len()
        ));
    }
    let names = |j: usize| file.joints[j].as_str();
    let untold: Vec<&str> = (0..file.joints.len())
        .filter(|j| !chosen.contains(j))
        .map(names)
        .collect();
    if !untold.is_empty() {
        notes.push(format!(
            "Not told: {}. The body's torque, and the torque that these joints share with others, is too small there beside friction and noise.",
            untold.join(", ")
        ));
    }
    notes
}
