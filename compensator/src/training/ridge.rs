//! Ridge regression on the windows a unit would see: the plain alternative, in closed form.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use feedforward::network::Architecture;

use super::job::{Job, Prepared, Report, Trained};
use crate::Error;

/// Ridge parameters tried, relative to the mean diagonal of the normal matrix.
const GRID: [f64; 7] = [1e-8, 1e-6, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];

/// Number of rows per block of the products.
const ROWS: usize = 1024;

/// Fits y = wᵀx + b on flattened windows of the job's architecture's length, the ridge chosen on the
/// validation trajectories (the smallest ridge without such trajectories). The bias is not shrunk.
///
/// The result is a [`Trained`] unit of a linear architecture, judged as every other.
///
/// # Errors
/// As [`super::train`], and [`Error::Singular`].
pub fn train_ridge(job: &Job) -> Result<Trained, Error> {
    best(job).map(|(_, trained)| trained)
}

/// Ridge parameter that [`train_ridge`] chooses, relative to the mean diagonal of the normal matrix.
///
/// # Errors
/// As [`train_ridge`].
pub fn choose_ridge(job: &Job) -> Result<f64, Error> {
    best(job).map(|(ridge, _)| ridge)
}

/// Fits like [`train_ridge`], with a given ridge.
///
/// # Errors
/// As [`train_ridge`].
pub fn fit_ridge(job: &Job, ridge: f64) -> Result<Trained, Error> {
    let job = linear(job);
    Equations::of(&job)?.solve(ridge)
}

/// Ridge parameter with the least validation error, and the unit fitted with it.
fn best(job: &Job) -> Result<(f64, Trained), Error> {
    let job = linear(job);
    let equations = Equations::of(&job)?;
    let grid = if job.split.validation.is_empty() {
        &GRID[..1]
    } else {
        &GRID[..]
    };
    let mut best: Option<(f64, Trained)> = None;
    for &ridge in grid {
        let trained = equations.solve(ridge)?;
        let error = trained.report.validation_rmse;
        let better = best
            .as_ref()
            .is_none_or(|(_, b)| error < b.report.validation_rmse);
        if better {
            best = Some((ridge, trained));
        }
    }
    best.ok_or(Error::Singular)
}

/// Job with a linear unit on windows of the same length, in place of the job's own.
fn linear<'a>(job: &Job<'a>) -> Job<'a> {
    let mut job = job.clone();
    job.config.architecture = Architecture::Perceptron {
        hidden: Vec::new(),
        timestep: job.config.architecture.timestep(),
    };
    job
}

/// Normal equations of a linear unit over the training windows.
struct Equations<'a, 'd> {
    /// Job with its normalisation.
    prepared: Prepared<'a, 'd>,
    /// Weighted products XᵀWX of the columns.
    normal: Mat<f64>,
    /// Weighted products XᵀWy of columns and target.
    moment: Mat<f64>,
}

impl<'a, 'd> Equations<'a, 'd> {
    /// Normal equations of a job.
    fn of(job: &'a Job<'d>) -> Result<Self, Error> {
        let prepared = Prepared::new(job)?;
        let timestep = job.config.architecture.timestep();
        let (normal, moment) = normal_equations(&prepared, timestep);
        Ok(Self {
            prepared,
            normal,
            moment,
        })
    }

    /// Unit with the solution for a ridge parameter, relative to the mean diagonal of the normal matrix.
    fn solve(&self, ridge: f64) -> Result<Trained, Error> {
        let n = self.moment.nrows() - 1;
        let scale = (0..n).map(|j| self.normal[(j, j)]).sum::<f64>() / n as f64;
        let mut shifted = self.normal.clone();
        (0..n).for_each(|j| shifted[(j, j)] += ridge * scale.max(f64::MIN_POSITIVE));
        let factor = shifted.llt(Side::Lower).map_err(|_| Error::Singular)?;
        let solution = factor.solve(&self.moment);
        let weights = (0..=n).map(|j| solution[(j, 0)] as f32).collect();
        let unit = self.prepared.unit(vec![weights]);
        let (unit, validation_rmse, validation_rmse_off) = self.prepared.judge(unit)?;
        let report = Report {
            history: vec![Vec::new()],
            best_epoch: vec![0],
            validation_rmse,
            validation_rmse_off,
        };
        Ok(Trained { unit, report })
    }
}

/// Products XᵀWX and XᵀWy over windows with a constant last column, summed in double precision.
fn normal_equations(prepared: &Prepared, timestep: usize) -> (Mat<f64>, Mat<f64>) {
    let job = prepared.job;
    let d = job.columns.len();
    let n = d * timestep + 1;
    let mut normal = Mat::<f64>::zeros(n, n);
    let mut moment = Mat::<f64>::zeros(n, 1);
    let mut raw = vec![0.0; d * timestep];
    let mut block = Mat::<f64>::zeros(ROWS, n);
    let mut right = Mat::<f64>::zeros(ROWS, 1);
    let mut filled = 0;
    let mut flush = |block: &mut Mat<f64>, right: &mut Mat<f64>, filled: &mut usize| {
        let (x, y) = (
            block.as_ref().subrows(0, *filled),
            right.as_ref().subrows(0, *filled),
        );
        normal += x.transpose() * x;
        moment += x.transpose() * y;
        *filled = 0;
    };
    for &t in &job.split.train {
        let range = job.samples.trajectories()[t].clone();
        for row in range.clone() {
            let weight = job.samples.weight(row);
            if weight <= 0.0 {
                continue;
            }
            let root = f64::from(weight).sqrt();
            job.samples.window(row, range.start, &job.columns, &mut raw);
            for (j, &x) in raw.iter().enumerate() {
                block[(filled, j)] = root * f64::from(prepared.input.apply(j % d, x));
            }
            block[(filled, n - 1)] = root;
            right[(filled, 0)] =
                root * f64::from(prepared.target.apply(0, job.samples.target(row)));
            filled += 1;
            if filled == ROWS {
                flush(&mut block, &mut right, &mut filled);
            }
        }
    }
    flush(&mut block, &mut right, &mut filled);
    (normal, moment)
}
