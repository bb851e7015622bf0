//! Out-of-fold torque of the physics on its own training samples: refitted without each fold.

use crate::identify::design::rigid_columns;
use crate::physics_fit::Fit;
use ::identify::base::BaseParameters;
use datasets::Recording;
use datasets::metrics::MOVING;
use ndarray::{Array1, Array2, Axis, concatenate};
use physics::effects::Term;
use physics::torque_model::TorqueModelError;
use signal::cholesky;

/// Ridge relative to the columns' norms, as in the identification.
const RIDGE: f64 = 3e-5;

/// Normal equations over all parameters of the physics.
#[derive(Clone)]
struct Normal {
    products: Array2<f64>,
    moments: Array1<f64>,
}

impl Normal {
    /// Normal equations without rows.
    fn empty(size: usize) -> Self {
        Self {
            products: Array2::zeros((size, size)),
            moments: Array1::zeros(size),
        }
    }

    /// Adds rows of the parameters `places`, times `weight`.
    fn add(&mut self, places: &[usize], columns: &Array2<f64>, target: &Array1<f64>, weight: f64) {
        let products = columns.t().dot(columns);
        let moments = columns.t().dot(target);
        for (i, &a) in places.iter().enumerate() {
            for (k, &b) in places.iter().enumerate() {
                self.products[[a, b]] += weight * products[[i, k]];
            }
            self.moments[a] += weight * moments[i];
        }
    }

    /// Normal equations without the rows of `other`.
    fn without(&self, other: &Self) -> Self {
        Self {
            products: &self.products - &other.products,
            moments: &self.moments - &other.moments,
        }
    }

    /// Least-squares parameters; none where the columns are linearly dependent despite the ridge.
    fn solve(&self) -> Option<Array1<f64>> {
        let n = self.moments.len();
        let scale = self
            .products
            .diag()
            .mapv(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
        let mut factor: Vec<f64> = (0..n * n)
            .map(|at| {
                let (i, k) = (at / n, at % n);
                let ridge = if i == k { RIDGE * RIDGE } else { 0.0 };
                self.products[[i, k]] / (scale[i] * scale[k]) + ridge
            })
            .collect();
        cholesky::factor(&mut factor, n)?;
        let mut x = (&self.moments / &scale).to_vec();
        cholesky::solve(&factor, &mut x);
        Some(Array1::from(x) / scale)
    }
}

/// Torque of the physics at the samples of each training recording, N·m (N), shape (samples, joints). The
/// parameters were fitted without the sample's own fold. Terms, load and cut-off stay as chosen on all folds. A
/// fit with a single fold is returned unchanged.
///
/// The change of the least-squares parameters when a fold is left out is added to the fit's parameters,
/// whatever estimator gave these.
///
/// # Errors
/// A model that does not fit together.
pub fn physics_out_of_fold(
    fit: &Fit,
    data: &[Recording],
) -> Result<Vec<Array2<f64>>, TorqueModelError> {
    let parts = data.len();
    let mut torque: Vec<Array2<f64>> = fit.physics[..parts].to_vec();
    let folds = fit.fold.iter().flatten().max().map_or(0, |last| last + 1);
    if folds < 2 {
        return Ok(torque);
    }
    let model = fit.file.physics.model()?;
    let robot = model.robot();
    let base = BaseParameters::of_robot(robot, &[]);
    let load = fit.session.load(model.load_robot());
    let mut rigid = rigid_columns(robot, &base, &fit.session, 0..parts, 1);
    let fold_of_rows: Vec<Vec<usize>> = (0..parts).map(|i| by_row(fit, i)).collect();
    // Columns of each joint's parameters with their places among all.
    let mut next = base.len();
    let mut columns: Vec<(Vec<usize>, Vec<Array2<f32>>)> = Vec::new();
    for (joint, list) in model.terms().iter().enumerate() {
        let terms: Vec<Term> = list
            .iter()
            .map(|w| w.term.clone())
            .filter(|term| term.passive().is_none())
            .collect();
        let places = (0..base.len()).chain(next..next + terms.len()).collect();
        next += terms.len();
        let of_terms = fit.session.columns(joint, &terms, &load, &[]);
        let tables = std::mem::take(&mut rigid[joint])
            .into_iter()
            .zip(&of_terms)
            .map(|(rigid, terms)| concatenate![Axis(1), rigid, *terms].mapv(|v| v as f32))
            .collect();
        columns.push((places, tables));
    }
    let mut cells = vec![Normal::empty(next); folds];
    for (joint, (places, tables)) in columns.iter().enumerate() {
        let sigma = fit.identified.residual_std[joint];
        // A joint without rows, or without any error, tells of nothing.
        if sigma <= f64::MIN_POSITIVE {
            continue;
        }
        for (part, table) in tables.iter().enumerate() {
            let Some(tau) = &data[part].tau else { continue };
            let qd = fit.session.parts[part].at_samples.qd.column(joint);
            let all = fit.file.preprocessing.moving_only;
            for (fold, cell) in cells.iter_mut().enumerate() {
                let rows: Vec<usize> = (0..table.nrows())
                    .filter(|&r| fold_of_rows[part][r] == fold)
                    .filter(|&r| !all || qd[r].abs() > MOVING)
                    .collect();
                let left = rows
                    .iter()
                    .map(|&r| tau[[r, joint]] - fit.physics[part][[r, joint]])
                    .collect();
                let own = table.select(Axis(0), &rows).mapv(f64::from);
                cell.add(places, &own, &left, sigma.powi(-2));
            }
        }
    }
    let mut whole = Normal::empty(next);
    for cell in &cells {
        whole.products += &cell.products;
        whole.moments += &cell.moments;
    }
    let Some(own) = whole.solve() else {
        return Ok(torque);
    };
    for (fold, cell) in cells.iter().enumerate() {
        let Some(without) = whole.without(cell).solve() else {
            continue;
        };
        let change = without - &own;
        for (joint, (places, tables)) in columns.iter().enumerate() {
            let own: Array1<f32> = places.iter().map(|&p| change[p] as f32).collect();
            for (part, table) in tables.iter().enumerate() {
                let moved = table.dot(&own);
                for (row, value) in moved.iter().enumerate() {
                    if fold_of_rows[part][row] == fold {
                        torque[part][[row, joint]] += f64::from(*value);
                    }
                }
            }
        }
    }
    Ok(torque)
}

/// Fold of each row of a training recording.
fn by_row(fit: &Fit, part: usize) -> Vec<usize> {
    let motion = &fit.session.parts[part].at_samples;
    let mut folds = vec![0; motion.len()];
    for (segment, fold) in motion.segments.iter().zip(&fit.fold[part]) {
        folds[segment.clone()].fill(*fold);
    }
    folds
}
