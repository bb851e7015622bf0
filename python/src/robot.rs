//! A robot and its rigid-body dynamics.

use crate::error::{raise, refused};
use diagnose::Subject;
use model::preparation::setup::Setup;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2};
use physics::dynamics::{Workspace, inverse_dynamics, mass_matrix, regressor};
use physics::robot::PARAMETERS_PER_LINK;
use physics::robot::drive::{Interpolation, Key};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Serial arm: a built-in robot by name or a description by path.
#[pyclass(frozen, module = "residyn")]
pub struct Robot {
    /// Name or path of the robot, as given.
    #[pyo3(get)]
    source: String,
    /// Names of the joints that were chosen, as given.
    #[pyo3(get)]
    chosen: Vec<String>,
    /// Path of the drive file, as given.
    #[pyo3(get)]
    drive: Option<PathBuf>,
    /// Gravity in the base frame, m/s², as given.
    #[pyo3(get, name = "gravity")]
    gravity: Option<[f64; 3]>,
    /// Robot with the options for reading its recordings.
    pub setup: Setup,
}

impl Robot {
    /// Description, joints and gravity, as given.
    pub fn asked(&self) -> (String, Vec<String>, Option<[f64; 3]>) {
        (self.source.clone(), self.chosen.clone(), self.gravity)
    }

    /// Subject of a diagnosis of this robot.
    pub fn subject(&self) -> Subject {
        let (source, joints, gravity) = self.asked();
        Subject::Robot {
            source,
            joints,
            gravity,
        }
    }
}

/// Evaluates `of` at every row of the tables, without the interpreter's lock. Returns the number of rows, and `width`
/// values of each.
fn each<const K: usize>(
    py: Python,
    robot: &physics::robot::Robot,
    tables: [PyReadonlyArray2<f64>; K],
    width: usize,
    of: impl Fn(&mut Workspace, [&[f64]; K], &mut [f64]) + Sync,
) -> PyResult<(usize, Vec<f64>)> {
    let dof = robot.dof();
    let shape = tables[0].as_array().dim();
    if shape.1 != dof || tables.iter().any(|t| t.as_array().dim() != shape) {
        let name = robot.name();
        return Err(refused(format!(
            "q, qd and qdd have to have the shape (samples, {dof}) of {name}"
        )));
    }
    let tables = tables.map(|t| t.as_array().iter().copied().collect::<Vec<f64>>());
    let mut out = vec![0.0; shape.0 * width];
    py.detach(|| {
        let mut workspace = Workspace::new(robot);
        for (i, out) in out.chunks_exact_mut(width).enumerate() {
            let at = tables.each_ref().map(|t| &t[i * dof..][..dof]);
            of(&mut workspace, at, out);
        }
    });
    Ok((shape.0, out))
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
        if gravity.is_some_and(|g| g.iter().any(|v| !v.is_finite())) {
            return Err(refused("gravity has a value that is not finite".to_owned()));
        }
        Ok(Self {
            source: source.to_owned(),
            setup: Setup::with_joints(source, &joints, drive.as_deref(), gravity).map_err(raise)?,
            chosen: joints,
            drive,
            gravity,
        })
    }

    /// Name of the robot in its description.
    #[getter]
    fn name(&self) -> &str {
        self.setup.robot.name()
    }

    /// Names of the robot's joints, base first.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.setup.robot.joint_names()
    }

    /// Number of joints of the robot.
    #[getter]
    fn dof(&self) -> usize {
        self.setup.robot.dof()
    }

    /// Inertial parameters, ten per link: m, m·c (3), inertia about the joint frame's origin (6).
    #[getter]
    fn parameters(&self) -> Vec<f64> {
        self.setup.robot.parameters()
    }

    /// Names of the values in `parameters`, in order.
    #[getter]
    fn parameter_names(&self) -> Vec<String> {
        self.setup.robot.parameter_names()
    }

    /// Block `[controller]` of the drive file: its values by joint, and `kind`, `interpolation`, `gravity_compensation` (none: not
    /// known); none where there is no such block.
    #[getter]
    fn controller<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let drive = self.setup.drive.as_ref();
        let Some(controller) = drive.and_then(|d| d.controller.as_ref()) else {
            return Ok(None);
        };
        let out = PyDict::new(py);
        out.set_item("kind", controller.kind.name())?;
        for key in Key::ALL {
            if let Some(values) = controller.values(key, self.setup.robot.dof()) {
                out.set_item(key.name(), values)?;
            }
        }
        let linear = controller.interpolation == Interpolation::Linear;
        out.set_item("interpolation", if linear { "linear" } else { "hold" })?;
        out.set_item(
            "gravity_compensation",
            controller.gravity_compensation.known(),
        )?;
        Ok(Some(out))
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
        let dof = robot.dof();
        let (n, tau) = each(py, robot, [q, qd, qdd], dof, |w, [q, qd, qdd], tau| {
            inverse_dynamics(robot, w, q, qd, qdd, tau);
        })?;
        PyArray1::from_vec(py, tau).reshape([n, dof])
    }

    /// Mass matrix at each position, shape (samples, joints, joints).
    fn mass_matrix<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let robot = &self.setup.robot;
        let dof = robot.dof();
        let (n, m) = each(py, robot, [q], dof * dof, |w, [q], m| {
            mass_matrix(robot, w, q, m);
        })?;
        PyArray1::from_vec(py, m).reshape([n, dof, dof])
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
        let (dof, width) = (robot.dof(), PARAMETERS_PER_LINK * robot.dof());
        let (n, y) = each(
            py,
            robot,
            [q, qd, qdd],
            dof * width,
            |w, [q, qd, qdd], y| {
                regressor(robot, w, q, qd, qdd, y);
            },
        )?;
        PyArray1::from_vec(py, y).reshape([n, dof, width])
    }

    /// Arguments from which a pickled robot is made again. Its description must be readable where it is unpickled.
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((String,), Bound<'py, PyDict>)> {
        let named = PyDict::new(py);
        named.set_item("joints", &self.chosen)?;
        named.set_item("drive", &self.drive)?;
        named.set_item("gravity", self.gravity)?;
        Ok(((self.source.clone(),), named))
    }

    fn __repr__(&self) -> String {
        let (name, dof) = (self.setup.robot.name(), self.setup.robot.dof());
        format!("Robot({name:?}, {dof} joints)")
    }
}
