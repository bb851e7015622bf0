//! A robot and its rigid-body dynamics.

use crate::error::{raise, refused};
use diagnose::Subject;
use model::preparation::setup::Setup;
use ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, PyArray3, PyReadonlyArray2};
use physics::dynamics::{Workspace, inverse_dynamics, mass_matrix, regressor};
use physics::robot::PARAMETERS_PER_LINK;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A serial arm: a built-in name or a description by path.
#[pyclass(frozen, module = "residyn")]
pub struct Robot {
    /// Name or path, as given.
    #[pyo3(get)]
    source: String,
    /// Joints that were chosen, as given.
    #[pyo3(get)]
    chosen: Vec<String>,
    /// Drive file, as given.
    #[pyo3(get)]
    drive: Option<PathBuf>,
    /// Gravity in the base frame, m/s², as given.
    #[pyo3(get, name = "gravity")]
    gravity: Option<[f64; 3]>,
    /// The robot, and how its recordings are read.
    pub setup: Setup,
}

impl Robot {
    /// What a diagnosis takes.
    pub fn subject(&self) -> Subject {
        Subject::Robot {
            source: self.source.clone(),
            joints: self.chosen.clone(),
            gravity: self.gravity,
        }
    }
}

/// Rows of three tables, each of which has to have the robot's joints.
fn rows(robot: &physics::robot::Robot, tables: &[&PyReadonlyArray2<f64>]) -> PyResult<usize> {
    let dof = robot.dof();
    let shape = tables[0].as_array().dim();
    if shape.1 != dof || tables.iter().any(|t| t.as_array().dim() != shape) {
        let name = robot.name();
        return Err(refused(format!(
            "q, qd and qdd have to have the shape (samples, {dof}) of {name}"
        )));
    }
    Ok(shape.0)
}

#[pymethods]
impl Robot {
    #[new]
    #[pyo3(signature = (source, *, joints=Vec::new(), drive=None, gravity=None))]
    fn new(
        source: &str,
        joints: Vec<String>,
        drive: Option<PathBuf>,
        gravity: Option<[f64; 3]>,
    ) -> PyResult<Self> {
        Ok(Self {
            source: source.to_owned(),
            setup: Setup::with_joints(source, &joints, drive.as_deref(), gravity).map_err(raise)?,
            chosen: joints,
            drive,
            gravity,
        })
    }

    /// Name that the description gives.
    #[getter]
    fn name(&self) -> &str {
        self.setup.robot.name()
    }

    /// Joint names, base first.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.setup.robot.joint_names()
    }

    /// Number of joints.
    #[getter]
    fn dof(&self) -> usize {
        self.setup.robot.dof()
    }

    /// Inertial parameters, ten per link: m, m·c (3), inertia about the joint frame's origin (6).
    #[getter]
    fn parameters(&self) -> Vec<f64> {
        self.setup.robot.parameters()
    }

    /// Names of `parameters`.
    #[getter]
    fn parameter_names(&self) -> Vec<String> {
        self.setup.robot.parameter_names()
    }

    /// Torque of the rigid body (no friction), shape (samples, joints).
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        qd: PyReadonlyArray2<'py, f64>,
        qdd: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let robot = &self.setup.robot;
        let (n, dof) = (rows(robot, &[&q, &qd, &qdd])?, robot.dof());
        let [q, qd, qdd] = [&q, &qd, &qdd].map(|t| t.as_array().to_owned());
        let mut tau = Array2::zeros((n, dof));
        py.detach(|| {
            let mut workspace = Workspace::new(robot);
            for (i, mut row) in tau.rows_mut().into_iter().enumerate() {
                let [a, b, c] = [&q, &qd, &qdd].map(|t| t.row(i).to_vec());
                let out = row.as_slice_mut().expect("standard layout");
                inverse_dynamics(robot, &mut workspace, &a, &b, &c, out);
            }
        });
        Ok(tau.into_pyarray(py))
    }

    /// Mass matrix at each position, shape (samples, joints, joints).
    fn mass_matrix<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let robot = &self.setup.robot;
        let (n, dof) = (rows(robot, &[&q])?, robot.dof());
        let mut out = ndarray::Array3::zeros((n, dof, dof));
        let mut workspace = Workspace::new(robot);
        for (row, mut m) in q.as_array().rows().into_iter().zip(out.outer_iter_mut()) {
            let m = m.as_slice_mut().expect("standard layout");
            mass_matrix(robot, &mut workspace, &row.to_vec(), m);
        }
        Ok(out.into_pyarray(py))
    }

    /// Regressor: torque per unit of each of `parameters`, shape (samples, joints, 10 joints).
    fn regressor<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        qd: PyReadonlyArray2<'py, f64>,
        qdd: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let robot = &self.setup.robot;
        let (n, dof) = (rows(robot, &[&q, &qd, &qdd])?, robot.dof());
        let mut out = ndarray::Array3::zeros((n, dof, PARAMETERS_PER_LINK * dof));
        let mut workspace = Workspace::new(robot);
        for (i, mut y) in out.outer_iter_mut().enumerate() {
            let [a, b, c] = [&q, &qd, &qdd].map(|t| t.as_array().row(i).to_vec());
            let y = y.as_slice_mut().expect("standard layout");
            regressor(robot, &mut workspace, &a, &b, &c, y);
        }
        Ok(out.into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let (name, dof) = (self.setup.robot.name(), self.setup.robot.dof());
        format!("Robot({name:?}, {dof} joints)")
    }
}
