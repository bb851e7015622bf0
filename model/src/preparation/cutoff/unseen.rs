//! Out-of-fold error of rigid body and friction for one preparation.

use super::error::CutoffError;
use super::friction;
use super::rate::for_recording;
use crate::identify::design::{Data, rigid_columns};
use crate::identify::error::IdentifyError;
use crate::identify::estimators;
use crate::identify::out_of_fold::OutOfFold;
use crate::identify::target::Target;
use crate::session::Session;
use ::identify::base::BaseParameters;
use ::identify::least_squares::LeastSquaresError;
use datasets::check::moves;
use datasets::prepare::{PrepareOptions, prepare};
use datasets::{Folds, Recording};
use ndarray::{Array2, Axis};
use physics::effects::Term;
use physics::robot::Robot;

/// Largest number of rows that are fitted.
const ROWS: usize = 5000;
/// Number of folds of the search.
const FOLDS: usize = 6;

/// Recordings and folds on which preparations are compared.
pub(super) struct Search<'a> {
    robot: &'a Robot,
    base: BaseParameters,
    recordings: Vec<&'a Recording>,
    /// Folds, the same for all that is compared.
    folds: Folds,
    /// Variance of the recorded torque of each joint, (N·m)²; none for one that does not move.
    variances: Vec<Option<f64>>,
}

/// Squared error over the torque's variance, by fold (row) and moving joint (column). A column sums to the joint's squared NRMSE.
pub(super) struct Unseen(Array2<f64>);

impl Unseen {
    /// Mean over joints of the NRMSE out of fold.
    pub(super) fn error(&self) -> f64 {
        let joints = self.0.sum_axis(Axis(0));
        joints.mapv(f64::sqrt).mean().unwrap_or(f64::NAN)
    }

    /// Difference of the error to that of `best`, in standard errors of the difference, which come from the folds' spread.
    pub(super) fn above(&self, best: &Self) -> f64 {
        let nrmse = best.0.sum_axis(Axis(0)).mapv(f64::sqrt);
        // To first order the difference of the errors is a sum over folds.
        let parts = (&self.0 - &best.0) / (&nrmse * 2.0 * nrmse.len() as f64);
        let parts = parts.sum_axis(Axis(1));
        let count = parts.len() as f64;
        parts.sum() / (count.sqrt() * parts.std(1.0))
    }
}

impl<'a> Search<'a> {
    /// Search on `sample`; `gap`: time around a fold that is left out with it, s.
    pub(super) fn new(robot: &'a Robot, sample: &'a [Recording], gap: f64) -> Self {
        let recordings: Vec<&Recording> = sample.iter().collect();
        Self {
            robot,
            base: BaseParameters::of_robot(robot, &[]),
            folds: Folds::new(&recordings, FOLDS, gap),
            variances: (0..robot.dof())
                .map(|joint| variance(&recordings, joint))
                .collect(),
            recordings,
        }
    }

    /// Out-of-fold error for one preparation; `None` where there are no rows to leave out or to fit.
    pub(super) fn unseen(&self, options: &PrepareOptions) -> Result<Option<Unseen>, CutoffError> {
        let prepared = |r: &&Recording| {
            prepare(r, &for_recording(options, r)).map_err(|source| CutoffError::Prepare {
                file: r.source.clone(),
                source,
            })
        };
        let parts = self
            .recordings
            .iter()
            .map(prepared)
            .collect::<Result<_, _>>()?;
        let session = Session::new(parts, &[]);
        let target = Target {
            tau: self
                .recordings
                .iter()
                .filter_map(|r| r.tau.as_ref())
                .collect(),
            folds: self.folds.clone(),
        };
        let samples: usize = self.recordings.iter().map(|r| r.len()).sum();
        let every = samples.div_ceil(ROWS).max(1);
        let all = 0..self.recordings.len();
        let rigid = rigid_columns(self.robot, &self.base, &session, all, every);
        let data = Data {
            robot: self.robot,
            base: &self.base,
            rigid: &rigid,
            session: &session,
            target: &target,
            moving_only: false,
            every,
        };
        let terms = friction::terms(self.robot);
        let no_load: Vec<Array2<f64>> = session
            .parts
            .iter()
            .map(|p| Array2::zeros(p.fine.q.dim()))
            .collect();
        let rate = session.parts[0].report.rate_hz / every as f64;
        let squares = squares(&data, &terms, &no_load, rate).map_err(IdentifyError::from)?;
        Ok(squares.and_then(|squares| self.normalised(&squares)))
    }

    fn normalised(&self, squares: &Array2<f64>) -> Option<Unseen> {
        let finite = |joint: usize| squares.column(joint).iter().all(|s| s.is_finite());
        let joints: Vec<(usize, f64)> = self
            .variances
            .iter()
            .enumerate()
            .filter_map(|(joint, v)| v.filter(|_| finite(joint)).map(|v| (joint, v)))
            .collect();
        (!joints.is_empty()).then(|| {
            Unseen(Array2::from_shape_fn(
                (squares.nrows(), joints.len()),
                |(fold, k)| squares[[fold, joints[k].0]] / joints[k].1,
            ))
        })
    }
}

/// Squared error on rows left out, over the number of the joint's rows, (N·m)², shape (folds, joints); NaN for
/// a joint without rows.
fn squares(
    data: &Data,
    terms: &[Vec<Term>],
    load: &[Array2<f64>],
    rate_hz: f64,
) -> Result<Option<Array2<f64>>, LeastSquaresError> {
    let systems = data.systems(terms, load, false)?;
    let (offsets, total) = estimators::offsets(data.base.len(), terms);
    let fits = OutOfFold::new(&systems, &offsets, total, &data.target.folds)?;
    let prior = friction::prior(&systems, &offsets, total, rate_hz)?;
    let squares = fits.squares(Some(&prior))?;
    Ok(squares.map(|mut squares| {
        for (mut column, system) in squares.columns_mut().into_iter().zip(&systems) {
            column /= system.rows() as f64;
        }
        squares
    }))
}

/// Variance of a joint's torque over the recordings, (N·m)²; `None` for a joint without motion or torque.
fn variance(recordings: &[&Recording], joint: usize) -> Option<f64> {
    let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
    for tau in recordings.iter().filter_map(|r| r.tau.as_ref()) {
        for t in tau.column(joint) {
            n += 1.0;
            let apart = t - mean;
            mean += apart / n;
            squares += apart * (t - mean);
        }
    }
    let moving = recordings.iter().any(|r| moves(r, joint));
    Some(squares / n).filter(|v| moving && *v > 0.0)
}
