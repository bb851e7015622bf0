//! `replay`.

use crate::error::unreplayed;
use crate::interrupt::{self, OnInterrupt};
use crate::robot::Robot;
use ::replay::{Done, Job, Options};
use numpy::{PyArray1, PyArray2, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Finished diagnosis of motion with its outputs.
#[pyclass(frozen, module = "residyn")]
pub struct Replay(Done);

/// Replays the commands of `data` and `heldout` on a robot's simulator and diagnoses the gap in motion.
#[pyfunction]
#[pyo3(signature = (robot, data, heldout, *, before, drive, fast, ceiling))]
#[allow(clippy::too_many_arguments)] // one each of the command line's
pub fn replay(
    py: Python,
    robot: &Robot,
    data: Vec<PathBuf>,
    heldout: PathBuf,
    before: Vec<PathBuf>,
    drive: Option<PathBuf>,
    fast: bool,
    ceiling: bool,
) -> PyResult<Replay> {
    let (robot, joints, gravity) = robot.asked();
    let job = Job {
        robot,
        joints,
        data,
        heldout,
        before,
        drive,
        gravity,
        options: Options::default().fast(fast).ceiling(ceiling),
    };
    let done = interrupt::run(py, OnInterrupt::Abandon, move |_| job.run(|_| ()))?;
    done.map(Replay).map_err(|e| unreplayed(&e))
}

#[pymethods]
impl Replay {
    /// Report of the schema `replay/1` as JSON text.
    fn json(&self) -> String {
        self.0.json()
    }

    /// Lines of text that the program `replay` prints.
    fn lines(&self) -> Vec<String> {
        self.0.lines()
    }

    /// The report as a self-contained page, which names the files of the corrected model, `patched`.
    fn html(&self, patched: Vec<PathBuf>) -> String {
        self.0.page(&patched)
    }

    /// Writes the corrected model and the files beside it; returns the paths, and the changes that the files cannot
    /// hold.
    fn patch(&self, path: PathBuf) -> PyResult<(Vec<PathBuf>, Vec<String>)> {
        let patch = self.0.patch(&path).map_err(|e| unreplayed(&e.into()))?;
        for (path, text) in &patch.files {
            report::write_atomic(path, text).map_err(|e| unreplayed(&e.into()))?;
        }
        let paths = patch.files.into_iter().map(|f| f.0).collect();
        Ok((paths, patch.left_out))
    }

    /// The held-out trajectories as they were scored, one dictionary each: time (samples), and of shape (samples, joints) the
    /// recorded q, the command q_ref that holds at each sample, and the simulated motion as given and corrected.
    fn motion<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let errors = &self.0.outcome.errors;
        let each = self.0.heldout.whole.iter().enumerate();
        each.map(|(k, track)| {
            let (rows, n) = track.q.dim();
            let table = |values: Vec<f64>| -> PyResult<Bound<'py, PyArray2<f64>>> {
                PyArray1::from_vec(py, values).reshape([rows, n])
            };
            let q = || track.q.iter();
            let simulated = |e: &[f64]| q().zip(e).map(|(q, e)| q + e).collect();
            let commands = (0..rows * n).map(|i| track.commands[i % n].value(track.time[i / n]));
            let out = PyDict::new(py);
            out.set_item("time", track.time.to_pyarray(py))?;
            out.set_item("q", track.q.to_pyarray(py))?;
            out.set_item("q_ref", table(commands.collect())?)?;
            out.set_item("given", table(simulated(&errors[0][k]))?)?;
            out.set_item("corrected", table(simulated(&errors[1][k]))?)?;
            Ok(out)
        })
        .collect()
    }
}
