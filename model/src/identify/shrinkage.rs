//! Prior from the given inertias, with its strength chosen on rows left out.
//!
//! Little motion leaves combinations of base parameters undetermined, and the robot's description is better
//! than nothing there. Each link's mass, first moments and inertias may differ from the given ones by a part of
//! the link's own size. Base parameters β = G φ then have the covariance G Σ Gᵀ. That part (no prior, or 3 % to
//! 300 %) is chosen by the error on rows left out, so that a wrong description has no influence.

use crate::identify::out_of_fold::OutOfFold;
use ::identify::base::BaseParameters;
use ::identify::least_squares::{Gram, LeastSquaresError, Triangle};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use ndarray::{Array1, Array2};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Relative prior deviations that are tried.
const PARTS: [f64; 5] = [0.03, 0.1, 0.3, 1.0, 3.0];
/// Least relative fall of the mean squared error, relative to the torque, for the prior to be used.
const LEAST_GAIN: f64 = 0.01;
/// Time over which residuals are correlated, s: rows within it count as one observation.
pub(crate) const CORRELATED: f64 = 0.2;
/// Least size of a link relative to the mean one: a massless flange may turn out to be a tool.
const SMALLEST: f64 = 0.1;

/// Given inertias as a prior: further rows of the fit.
#[derive(Clone, Debug)]
pub struct GivenInertias {
    /// Prior deviation of a link's parameters from the given ones, relative to the link's size.
    pub part: f64,
    /// Rows of unit standard deviation over the base parameters.
    rows: Triangle,
}

impl GivenInertias {
    /// Rows of the prior over `total` parameters, the base parameters first.
    ///
    /// # Errors
    /// Fewer parameters than base parameters.
    pub fn rows(&self, total: usize) -> Result<Triangle, LeastSquaresError> {
        let places: Vec<usize> = (0..self.rows.columns()).collect();
        self.rows.embed(&places, total)
    }
}

/// Chooses the strength of the prior; `None` where it does not lower the error on rows left out. `total`:
/// number of parameters, base parameters first; `deviation`: that of the measured torque by joint; `rate_hz`:
/// rate of the rows.
///
/// # Errors
/// Systems that do not fit together.
pub fn choose(
    robot: &Robot,
    base: &BaseParameters,
    fits: &OutOfFold,
    total: usize,
    deviation: &[f64],
    rate_hz: f64,
) -> Result<Option<GivenInertias>, LeastSquaresError> {
    let Some(covariance) = covariance(robot, base) else {
        return Ok(None);
    };
    let score = |rmse: &[f64]| -> f64 {
        let relative = rmse
            .iter()
            .zip(deviation)
            .filter(|(r, d)| r.is_finite() && **d > 0.0);
        relative.map(|(r, d)| (r / d).powi(2)).sum()
    };
    let Some(free) = fits.rmse(None)? else {
        return Ok(None);
    };
    let mut best = ((1.0 - LEAST_GAIN) * score(&free), None);
    for part in PARTS {
        let Some(rows) = rows(robot, base, &covariance, part, rate_hz) else {
            continue;
        };
        let given = GivenInertias { part, rows };
        if let Some(rmse) = fits.rmse(Some(&Gram::from(&given.rows(total)?)))? {
            let error = score(&rmse);
            if error < best.0 {
                best = (error, Some(given));
            }
        }
    }
    Ok(best.1)
}

/// Covariance of the base parameters when each standard parameter has its link's size as standard deviation.
/// `None` for a robot without inertias.
fn covariance(robot: &Robot, base: &BaseParameters) -> Option<Mat<f64>> {
    let parameters = robot.parameters();
    let links: Vec<&[f64]> = parameters.chunks(PARAMETERS_PER_LINK).collect();
    let mean = links.iter().map(|l| l[0]).sum::<f64>() / links.len() as f64;
    if mean <= 0.0 {
        return None;
    }
    // A length that goes with a link: its radius of gyration about the joint's frame.
    let gyration = |l: &[f64]| ((l[4] + l[6] + l[9]) / 2.0 / l[0].max(1e-12)).sqrt();
    let real = || links.iter().filter(|l| l[0] > SMALLEST * mean);
    let usual = real().map(|l| gyration(l)).sum::<f64>() / real().count().max(1) as f64;
    let mut deviation = Vec::with_capacity(parameters.len());
    for link in &links {
        let (mass, length) = if link[0] > SMALLEST * mean {
            (link[0], gyration(link).max(SMALLEST * usual))
        } else {
            (SMALLEST * mean, usual)
        };
        deviation.push(mass);
        deviation.extend([mass * length; 3]);
        deviation.extend([mass * length * length; 6]);
    }
    let g = base.grouping();
    let scaled = Mat::from_fn(g.nrows(), g.ncols(), |i, j| g[(i, j)] * deviation[j]);
    Some(&scaled * scaled.transpose())
}

/// Rows whose sum of squares is the squared distance from the given base parameters, in standard deviations.
fn rows(
    robot: &Robot,
    base: &BaseParameters,
    covariance: &Mat<f64>,
    part: f64,
    rate_hz: f64,
) -> Option<Triangle> {
    let n = base.len();
    let observations = (CORRELATED * rate_hz).max(1.0);
    let jitter = 1e-12 * (0..n).map(|i| covariance[(i, i)]).fold(0.0, f64::max);
    let scaled = Mat::from_fn(n, n, |i, j| {
        let entry = covariance[(i, j)] + if i == j { jitter } else { 0.0 };
        part * part / observations * entry
    });
    // C = L Lᵀ: the rows L⁻¹ have C⁻¹ as normal equations.
    let factor = scaled.llt(Side::Lower).ok()?;
    let whitening = factor
        .L()
        .to_owned()
        .partial_piv_lu()
        .solve(Mat::<f64>::identity(n, n));
    let given = base.base_from(&robot.parameters());
    let a = Array2::from_shape_fn((n, n), |(i, j)| whitening[(i, j)]);
    let b = Array1::from_shape_fn(n, |i| (0..n).map(|j| whitening[(i, j)] * given[j]).sum());
    Triangle::of(a.view(), b.view()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rows are the distance from the given base parameters in deviations: doubling the part halves it, and a link
    /// off by its own size is one part away from them, whatever shares its column.
    #[test]
    fn rows_measure_the_distance_from_the_given_links() {
        let robot = Robot::builtin("ur5").unwrap();
        let base = BaseParameters::of_robot(&robot, &[]);
        let covariance = covariance(&robot, &base).unwrap();
        let given = base.base_from(&robot.parameters());
        let distance = |part: f64, at: &[f64]| {
            let rows = rows(&robot, &base, &covariance, part, 1.0).unwrap();
            rows.residual_sum_of_squares(at).unwrap().sqrt()
        };
        assert!(distance(0.1, &given) < 1e-6);
        let mut heavier = robot.parameters();
        for p in &mut heavier[40..50] {
            *p *= 1.1;
        }
        let other = base.base_from(&heavier);
        let (near, far) = (distance(0.1, &other), distance(0.05, &other));
        assert!((far / near - 2.0).abs() < 1e-6, "{near} {far}");
        // Ten parameters a tenth of their size off, some of them shared: of the order of one deviation.
        assert!((0.3..3.2).contains(&near), "{near}");
    }

    #[test]
    fn a_robot_without_inertias_has_no_prior() {
        let robot = Robot::builtin("ur5").unwrap();
        let base = BaseParameters::of_robot(&robot, &[]);
        let empty = robot
            .with_parameters(&vec![0.0; robot.parameters().len()])
            .unwrap();
        assert!(covariance(&empty, &base).is_none());
    }
}
