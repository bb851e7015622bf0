//! Ridge regression on the windows a unit would see: the plain alternative, in closed form.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use feedforward::network::Architecture;

use super::ensemble::{Job, Prepared, Report, Trained};
use crate::Error;

/// Ridge parameters tried, relative to the mean diagonal of the normal matrix.
const GRID: [f64; 7] = [1e-8, 1e-6, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];

/// Fits y = wᵀx + b on flattened windows of the job's architecture's length, the ridge chosen on the
/// validation trajectories (the smallest where there are none). The bias is not shrunk.
///
/// The result is a [`Trained`] unit of a linear architecture, judged as every other.
///
/// # Errors
/// As [`super::train`], and [`Error::Singular`].
pub fn train_ridge(job: &Job) -> Result<Trained, Error> {
    let timestep = job.config.architecture.timestep();
    let mut job = job.clone();
    job.config.architecture = Architecture::Perceptron {
        hidden: Vec::new(),
        timestep,
    };
    let prepared = Prepared::new(&job)?;
    let (normal, moment) = normal_equations(&prepared, timestep);
    let n = moment.nrows() - 1;
    let scale = (0..n).map(|j| normal[(j, j)]).sum::<f64>() / n as f64;
    let grid = if job.split.validation.is_empty() {
        &GRID[..1]
    } else {
        &GRID[..]
    };
    let mut best: Option<Trained> = None;
    for ridge in grid {
        let mut shifted = normal.clone();
        (0..n).for_each(|j| shifted[(j, j)] += ridge * scale.max(f64::MIN_POSITIVE));
        let factor = shifted.llt(Side::Lower).map_err(|_| Error::Singular)?;
        let solution = factor.solve(&moment);
        let weights = (0..=n).map(|j| solution[(j, 0)] as f32).collect();
        let (unit, with, without) = prepared.judge(prepared.unit(vec![weights]))?;
        let report = Report {
            history: vec![Vec::new()],
            best_epoch: vec![0],
            validation_rmse: with,
            validation_rmse_off: without,
        };
        let better = best
            .as_ref()
            .is_none_or(|b| with < b.report.validation_rmse);
        if better {
            best = Some(Trained { unit, report });
        }
    }
    best.ok_or(Error::Singular)
}

/// XᵀWX and XᵀWy over windows with a constant last column, summed sample by sample in f64.
fn normal_equations(prepared: &Prepared, timestep: usize) -> (Mat<f64>, Mat<f64>) {
    let job = prepared.job;
    let d = job.columns.len();
    let n = d * timestep + 1;
    let mut normal = Mat::<f64>::zeros(n, n);
    let mut moment = Mat::<f64>::zeros(n, 1);
    let mut raw = vec![0.0; d];
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
            for step in 0..timestep {
                let source = (row + step + 1).saturating_sub(timestep).max(range.start);
                job.samples.gather(source, &job.columns, &mut raw);
                for (j, &x) in raw.iter().enumerate() {
                    block[(filled, step * d + j)] = root * f64::from(prepared.input.apply(j, x));
                }
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

/// Rows per block of the products.
const ROWS: usize = 1024;
