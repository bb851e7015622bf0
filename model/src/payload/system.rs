//! Rows of the payload estimate: torque by the body's parameters, by errors of the stored model, and by the load of the gears.

use super::misfit::{SHAPES, direction, shapes};
use crate::directory::ModelFile;
use crate::identify::design::inertial_columns;
use crate::predict::{Sensitivity, sensitivities};
use crate::session::Session;
use ::identify::least_squares::{Accumulator, Gram, LeastSquaresError, Triangle};
use faer::{Mat, Side};
use ndarray::{Array1, Array2};
use physics::effects::Term;
use physics::robot::PARAMETERS_PER_LINK;
use physics::torque_model::TorqueModel;

/// Largest number of blocks of time for standard deviations.
const BLOCKS: usize = 96;

/// Prior deviation of the gain with which a body's torque passes a joint. A gear passes another part of it when
/// it drives than when it is driven, and a torque constant falls with current.
const GAIN: f64 = 0.02;
/// Prior deviation of friction per unit of load that the model may lack.
const LOSS: f64 = 0.1;

/// Number of columns for each joint's error beside the stored parameters: gain, loss, shapes of position and direction.
const EXTRA: usize = 2 + SHAPES;

/// Columns of every joint for the payload estimate. All but the body's parameters have unit prior deviation.
///
/// They are the body's ten parameters, and the stored model's error. Then come gain and loss of each joint, which need
/// a first estimate of the body. Last is the torque's error by position and direction, which needs a residual.
pub(super) struct System {
    /// Columns by joint, shape (samples, 10 + directions + [`EXTRA`] N).
    joints: Vec<Array2<f64>>,
    /// Torque of the model's own links, N·m (N), shape (samples, joints).
    load: Array2<f64>,
    /// Positions, rad (m), shape (samples, joints).
    position: Array2<f64>,
    /// Velocities, rad/s (m/s), shape (samples, joints).
    velocity: Array2<f64>,
}

impl System {
    /// System of one recording, whose motion is the only part of the session.
    pub(super) fn new(
        file: &ModelFile,
        model: &TorqueModel,
        session: &Session,
        friction_change: f64,
    ) -> Self {
        let first = PARAMETERS_PER_LINK * (model.dof() - 1);
        let last: Vec<usize> = (first..first + PARAMETERS_PER_LINK).collect();
        let body = inertial_columns(model.robot(), &last, session, 0..1, 1);
        let root = root_of(&with_friction_change(file, model, friction_change));
        let channel = file.preprocessing.channel.as_ref();
        let motion = &session.parts[0].at_samples;
        let extra = Array2::zeros((motion.len(), EXTRA * model.dof()));
        let joints = sensitivities(model, session, &file.memory)
            .into_iter()
            .zip(body)
            .enumerate()
            .map(|(j, (Sensitivity { places, columns }, body))| {
                let own = root.select(ndarray::Axis(0), &places);
                let gain = channel.map_or(1.0, |c| c.gain[j]);
                ndarray::concatenate![ndarray::Axis(1), body[0], columns.dot(&own), extra] * gain
            })
            .collect();
        let fine = &session.load(model.load_robot())[0];
        let mut load = Array2::zeros(motion.q.raw_dim());
        for (fine, mut load) in fine.columns().into_iter().zip(load.columns_mut()) {
            load.assign(&Array1::from(session.parts[0].to_samples(&fine.to_vec())));
        }
        Self {
            joints,
            load,
            position: motion.q.clone(),
            velocity: motion.qd.clone(),
        }
    }

    /// Sets the columns of each joint's gain and loss. Gain is the part of a body's torque that passes the joint, loss
    /// its friction per load.
    pub(super) fn allow(&mut self, body: &[f64; PARAMETERS_PER_LINK]) {
        let carried = self.torque(body);
        let first = self.width() - EXTRA * self.joints.len();
        for (j, columns) in self.joints.iter_mut().enumerate() {
            for (k, mut row) in columns.rows_mut().into_iter().enumerate() {
                let (own, more) = (self.load[[k, j]], carried[[k, j]]);
                let at = first + EXTRA * j;
                row[at] = GAIN * more;
                let way = direction(self.velocity[[k, j]]);
                row[at + 1] = LOSS * ((own + more).abs() - own.abs()) * way;
            }
        }
    }

    /// Sets the columns of each joint's error over its position and direction: a constant and harmonics. Each has the
    /// prior deviation `size`, N·m (N).
    pub(super) fn misfit(&mut self, size: &[f64]) {
        let first = self.width() - EXTRA * self.joints.len();
        for (j, columns) in self.joints.iter_mut().enumerate() {
            for (k, mut row) in columns.rows_mut().into_iter().enumerate() {
                let at = first + EXTRA * j + 2;
                let shapes = shapes(self.position[[k, j]], self.velocity[[k, j]]);
                for (s, shape) in shapes.into_iter().enumerate() {
                    row[at + s] = size[j] * shape;
                }
            }
        }
    }

    /// Whether any torque depends on the body.
    pub(super) fn sees_anything(&self) -> bool {
        let mut columns = self
            .joints
            .iter()
            .flat_map(|t| t.columns().into_iter().take(PARAMETERS_PER_LINK));
        columns.any(|c| c.iter().any(|v| v.abs() > 1e-9))
    }

    /// Torque of a body, N·m (N), shape (samples, joints).
    pub(super) fn torque(&self, body: &[f64; PARAMETERS_PER_LINK]) -> Array2<f64> {
        let mut unknowns = vec![0.0; self.width()];
        unknowns[..PARAMETERS_PER_LINK].copy_from_slice(body);
        self.of(&unknowns)
    }

    /// Residual of `target` beside the torque by `unknowns`, N·m (N), shape (samples, joints).
    pub(super) fn left(&self, target: &Array2<f64>, unknowns: &[f64]) -> Array2<f64> {
        target - &self.of(unknowns)
    }

    /// Weighted rows of all joints folded into one triangle, and their sums by block of time.
    pub(super) fn rows(
        &self,
        target: &Array2<f64>,
        scale: &Array2<f64>,
    ) -> Result<(Triangle, Vec<Gram>), LeastSquaresError> {
        let (samples, width) = (target.nrows(), self.width());
        let size = samples.div_ceil(BLOCKS).max(1);
        let mut parts = Vec::new();
        for start in (0..samples).step_by(size) {
            let mut rows = Accumulator::new(width);
            for k in start..(start + size).min(samples) {
                for (j, columns) in self.joints.iter().enumerate() {
                    let row: Vec<f64> = columns.row(k).to_vec();
                    rows.push(&row, target[[k, j]], scale[[k, j]])?;
                }
            }
            parts.push(rows.finish()?);
        }
        let blocks = parts.iter().map(Gram::from).collect();
        Ok((Triangle::stack(&parts)?, blocks))
    }

    /// Number of columns.
    fn width(&self) -> usize {
        self.joints.first().map_or(0, Array2::ncols)
    }

    /// Torque by the unknowns, N·m (N), shape (samples, joints).
    fn of(&self, unknowns: &[f64]) -> Array2<f64> {
        let x = Array1::from(unknowns.to_vec());
        let columns: Vec<Array1<f64>> = self.joints.iter().map(|c| c.dot(&x)).collect();
        let rows = columns.first().map_or(0, Array1::len);
        Array2::from_shape_fn((rows, columns.len()), |(k, j)| columns[j][k])
    }
}

/// Stored covariance, with the variance of each coefficient of friction raised by a relative change.
fn with_friction_change(file: &ModelFile, model: &TorqueModel, change: f64) -> Array2<f64> {
    let mut covariance = file.covariance_table();
    let lists = model.terms().iter().flatten();
    let fitted = lists.filter(|w| w.term.passive().is_none());
    for (k, w) in fitted.enumerate() {
        if !matches!(w.term, Term::RotorInertia) {
            let place = file.base_parameters.len() + k;
            covariance[[place, place]] += (change * w.value).powi(2);
        }
    }
    covariance
}

/// Factor L of the covariance Σ = L Lᵀ, one column for each direction that varies, shape (parameters, directions).
fn root_of(covariance: &Array2<f64>) -> Array2<f64> {
    let n = covariance.nrows();
    let deviation: Vec<f64> = covariance
        .diag()
        .iter()
        .map(|v| v.max(0.0).sqrt())
        .collect();
    // Correlations: units differ by orders of magnitude.
    let correlation = Mat::from_fn(n, n, |i, j| {
        let scale = deviation[i] * deviation[j];
        if scale > 0.0 {
            covariance[[i, j]] / scale
        } else {
            0.0
        }
    });
    let Ok(eigen) = correlation.self_adjoint_eigen(Side::Lower) else {
        // Without a decomposition the parameters count as independent.
        return Array2::from_diag(&Array1::from(deviation));
    };
    let (values, vectors) = (eigen.S(), eigen.U());
    let kept: Vec<usize> = (0..n).filter(|&k| values[k] > 1e-12).collect();
    Array2::from_shape_fn((n, kept.len()), |(i, c)| {
        deviation[i] * vectors[(i, kept[c])] * values[kept[c]].sqrt()
    })
}
