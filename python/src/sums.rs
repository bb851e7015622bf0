//! Sums of recordings that workers fill apart.

use crate::error::raise;
use crate::robot::Robot;
use datasets::Part;
use model::sums;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;

/// Triangular factors of the recordings of one robot, which add up.
#[pyclass(module = "residyn._residyn")]
pub struct Sums {
    robot: Py<Robot>,
    inner: sums::Sums,
}

#[pymethods]
impl Sums {
    #[new]
    #[pyo3(signature = (robot, cutoff_hz=None))]
    fn new(robot: Py<Robot>, cutoff_hz: Option<f64>) -> Self {
        let inner = sums::Sums::new(robot.get().setup.robot.clone(), cutoff_hz);
        Self { robot, inner }
    }

    /// Sums read back from the bytes of `to_bytes`. The robot must be the same.
    #[staticmethod]
    fn from_bytes(py: Python, robot: Py<Robot>, bytes: Vec<u8>) -> PyResult<Self> {
        let own = robot.get().setup.robot.clone();
        let inner = py.detach(|| sums::Sums::from_bytes(own, &bytes).map_err(raise))?;
        Ok(Self { robot, inner })
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.inner.to_bytes()))
    }

    #[getter]
    fn robot(&self, py: Python) -> Py<Robot> {
        self.robot.clone_ref(py)
    }

    #[getter]
    fn recordings(&self) -> usize {
        self.inner.recordings()
    }

    #[getter]
    fn samples(&self) -> usize {
        self.inner.samples()
    }

    /// Cut-off of the motion in Hz (none: no low-pass), and whether recorded velocity is left aside; none before the
    /// first recording decides it.
    #[getter]
    fn preparation(&self) -> Option<(Option<f64>, bool)> {
        let preparation = self.inner.preparation()?;
        Some((preparation.cutoff_hz, preparation.position_alone))
    }

    fn add(&mut self, py: Python, path: PathBuf) -> PyResult<()> {
        let setup = &self.robot.get().setup;
        let inner = &mut self.inner;
        py.detach(|| {
            let recording = setup.read_one(&path, Part::Train, true).map_err(raise)?;
            inner.add(&recording).map_err(raise)
        })
    }

    fn merge(&mut self, py: Python, other: &Self) -> PyResult<()> {
        let inner = &mut self.inner;
        py.detach(|| inner.merge(&other.inner).map_err(raise))
    }

    fn emptied(&self, py: Python) -> Self {
        Self {
            robot: self.robot.clone_ref(py),
            inner: self.inner.emptied(),
        }
    }

    /// Names, units, values, deviations and formulae of all parameters, residual and torque of each joint, rank.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = py.detach(|| self.inner.finish().map_err(raise))?;
        let joints = self.robot.get().setup.robot.joint_names();
        let mut all: Vec<(String, String, f64, f64, String)> = found
            .base
            .into_iter()
            .map(|b| (b.name, b.unit, b.value, b.std, b.formula))
            .collect();
        for (joint, list) in joints.iter().zip(&found.terms) {
            all.extend(list.iter().map(|w| {
                let (name, unit) = (w.term.label(), w.term.unit().to_owned());
                (format!("{name} {joint}"), unit, w.value, w.std, name)
            }));
        }
        let out = PyDict::new(py);
        out.set_item("parameters", all)?;
        out.set_item("joints", joints)?;
        out.set_item("residual_std", found.residual_std)?;
        out.set_item("torque_rms", found.torque_rms)?;
        out.set_item("rank", found.rank)?;
        Ok(out)
    }
}
