//! A model directory: torque in a loop, and over whole recordings.

use crate::error::{raise, refused};
use datasets::{Part, read};
use feedforward::Feedforward;
use feedforward::inputs::CompensatorRecord;
use model::directory::{self, ModelFile};
use model::evaluation::{EvaluateOptions, evaluate, read_options};
use model::failure::Failure;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use physics::robot::{JointKind, Robot};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use std::path::PathBuf;

/// Identified model, as `identify` and `train` write it.
#[pyclass(module = "residyn")]
pub struct Model {
    /// Path of the model's directory.
    #[pyo3(get)]
    directory: PathBuf,
    file: ModelFile,
    runtime: Feedforward,
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (directory, *, period=None))]
    fn new(directory: PathBuf, period: Option<f64>) -> PyResult<Self> {
        let file = ModelFile::load(&directory).map_err(raise)?;
        let runtime = Feedforward::load(&directory, period).map_err(refused)?;
        Ok(Self {
            directory,
            file,
            runtime,
        })
    }

    /// Names of the model's joints, base first.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.file.joints.clone()
    }

    /// Control period of `torque`, s.
    #[getter]
    fn period(&self) -> f64 {
        self.runtime.period()
    }

    /// Torque of the whole model at the next sample of a control loop; the model's memory of the motion moves on.
    fn torque<'py>(
        &mut self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
        qd: PyReadonlyArray1<'py, f64>,
        qdd: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let dof = self.runtime.dof();
        let [q, qd, qdd] = [&q, &qd, &qdd].map(|x| x.as_array().to_vec());
        if [&q, &qd, &qdd].iter().any(|x| x.len() != dof) {
            return Err(refused(format!("q, qd and qdd need {dof} values each")));
        }
        let mut tau = vec![0.0; dof];
        self.runtime.torque(&q, &qd, &qdd, &mut tau);
        Ok(tau.into_pyarray(py))
    }

    /// Compensator's part of the last torque, N·m or N, by joint; none without one.
    #[getter]
    fn compensation<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let part = self.runtime.compensation()?;
        Some(PyArray1::from_slice(py, part))
    }

    /// What evaluates the compensator elsewhere, as JSON: its inputs (none without one), the control period and how many of them lie in
    /// one of training, and the chain behind the load.
    fn parts(&self) -> PyResult<String> {
        let model = self.file.physics.model().map_err(refused)?;
        let record = self.file.compensator.as_ref();
        let period = self.runtime.period();
        let turns = record.and_then(|record| feedforward::clock::stride(record.period / period));
        Ok(parts(model.load_robot(), record, period, turns.unwrap_or(1)).to_string())
    }

    /// Forgets the motion; `clock` is the time on the recordings' clock where it is known, s.
    #[pyo3(signature = (clock=None))]
    fn reset(&mut self, clock: Option<f64>) {
        self.runtime.reset(clock);
    }

    /// Predictions and scores over a recording, as `eval` has them.
    #[pyo3(signature = (path, drive=None, cutoff_hz=None))]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        drive: Option<PathBuf>,
        cutoff_hz: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (file, directory) = (&self.file, &self.directory);
        let done = py.detach(|| -> Result<_, Failure> {
            let options = read_options(file, drive.as_deref(), Part::Test, false)?;
            let recording = read(&path, &options).map_err(|e| Failure::input(e.to_string(), ""))?;
            let options = EvaluateOptions { cutoff_hz };
            Ok(evaluate(directory, file, recording, &options)?)
        });
        let done = done.map_err(raise)?;
        let out = PyDict::new(py);
        out.set_item("report", directory::json(&done.report))?;
        out.set_item("time", done.recording.time.into_pyarray(py))?;
        let motion = &done.session.parts[0].at_samples;
        for (name, table) in [("q", &motion.q), ("qd", &motion.qd), ("qdd", &motion.qdd)] {
            out.set_item(name, table.clone().into_pyarray(py))?;
        }
        out.set_item("torque", done.torque.into_pyarray(py))?;
        out.set_item("physics", done.physics.into_pyarray(py))?;
        out.set_item("std", done.deviation.into_pyarray(py))?;
        Ok(out)
    }

    fn __repr__(&self) -> String {
        let (robot, dof) = (&self.file.physics.robot, self.file.joints.len());
        format!("Model({robot:?}, {dof} joints, {:?})", self.directory)
    }
}

/// Description for [`Model::parts`].
fn parts(
    robot: &Robot,
    record: Option<&CompensatorRecord>,
    period: f64,
    turns: usize,
) -> serde_json::Value {
    let held = robot.gravity_compensation();
    let chain = robot.joints().iter().enumerate().map(|(i, joint)| {
        // Row by row.
        let rotation: Vec<f64> = joint.rotation.transpose().iter().copied().collect();
        json!({
            "name": joint.name,
            "slides": joint.kind == JointKind::Prismatic,
            "axis": joint.axis.as_slice(),
            "rotation": rotation,
            "translation": joint.translation.as_slice(),
            "parameters": joint.link.inertia.parameters(),
            "held": held.get(i).copied().unwrap_or(0.0),
        })
    });
    json!({
        "inputs": record.map(|record| &record.inputs),
        "period": period,
        "turns": turns,
        "chain": chain.collect::<Vec<_>>(),
        "gravity": robot.gravity().as_slice(),
    })
}
