//! `diagnose`.

use crate::error::undiagnosed;
use crate::interrupt::{self, OnInterrupt};
use crate::robot::Robot;
use ::diagnose::{Done, Job, Subject, words};
use numpy::{IntoPyArray, ToPyArray};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Finished diagnosis with its outputs.
#[pyclass(frozen, module = "residyn")]
pub struct Diagnosis(Mutex<Done>);

/// Diagnoses `data` and `heldout` against a robot's description, its recordings `before`, or a model directory.
#[pyfunction]
#[pyo3(signature = (robot, model, before, data, heldout, *, drive, cutoff_hz, fast, learn, next_motion))]
#[allow(clippy::too_many_arguments)] // one each of the command line's
pub fn diagnose(
    py: Python,
    robot: Option<&Robot>,
    model: Option<PathBuf>,
    before: Vec<PathBuf>,
    data: Vec<PathBuf>,
    heldout: Option<PathBuf>,
    drive: Option<PathBuf>,
    cutoff_hz: Option<f64>,
    fast: bool,
    learn: bool,
    next_motion: bool,
) -> PyResult<Diagnosis> {
    let subject = match (robot, model) {
        (Some(robot), _) => robot.subject(),
        (None, Some(directory)) => Subject::Model(directory),
        (None, None) => return Err(crate::error::refused("a robot or a model is needed")),
    };
    let job = Job {
        subject: subject.as_in(before),
        drive,
        // Tables without time get one in pandas.
        rate_hz: None,
        data,
        heldout,
        cutoff_hz,
        fast,
        learn,
        next: next_motion,
    };
    let done = interrupt::run(py, OnInterrupt::Abandon, move |_| job.run(|_| ()))?;
    done.map(|d| Diagnosis(Mutex::new(d)))
        .map_err(|e| undiagnosed(&e))
}

impl Diagnosis {
    fn with<T>(&self, of: impl FnOnce(&Done) -> T) -> T {
        // A panic inside leaves what is only read as it was.
        let done = self
            .0
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        of(&done)
    }
}

fn write(path: &Path, text: &str) -> PyResult<()> {
    report::write_atomic(path, text).map_err(|e| PyOSError::new_err(e.to_string()))
}

#[pymethods]
impl Diagnosis {
    /// Report of the schema `diagnosis/1` as JSON text.
    fn json(&self) -> String {
        self.with(Done::json)
    }

    /// Lines of text that the program `diagnose` prints.
    fn lines(&self) -> Vec<String> {
        self.with(|d| words::lines(&d.outcome.diagnosis))
    }

    /// The report as a self-contained page, which names the files of the corrected description, `patched`.
    fn html(&self, patched: Vec<PathBuf>) -> PyResult<String> {
        self.with(|d| Ok(d.page(&d.patch().map_err(|e| undiagnosed(&e))?, &patched)))
    }

    /// Writes the corrected description and the files beside it; returns the paths.
    fn patch(&self, path: PathBuf) -> PyResult<Vec<PathBuf>> {
        let patch = self.with(Done::patch).map_err(|e| undiagnosed(&e))?;
        let files = patch.files(&path).map_err(|e| undiagnosed(&e))?;
        for (path, text) in &files {
            write(path, text)?;
        }
        patch.remove_stale(&path);
        Ok(files.into_iter().map(|f| f.0).collect())
    }

    /// Writes the causes as a model directory; returns the causes that a torque model cannot hold.
    fn write_model(&self, path: PathBuf) -> PyResult<Vec<String>> {
        self.with(|d| {
            let directory = d.directory()?;
            let patch = d.patch()?;
            let weights = directory.compensator.as_deref();
            let (file, metrics) = (&directory.file, &directory.metrics);
            file.write(&path, metrics, weights, Some(&patch.urdf))?;
            Ok(directory.left_out)
        })
        .map_err(|e: ::diagnose::DiagnoseError| undiagnosed(&e))
    }

    /// The held-out recording as it was scored: time, q, qd, qdd after the low-pass, the recorded torque, and the report's own
    /// torque as given and with the causes.
    fn motion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.with(|d| {
            let held = &d.outcome.frames.heldout;
            let motion = held.samples();
            let out = PyDict::new(py);
            out.set_item("time", motion.time.to_pyarray(py))?;
            out.set_item("q", motion.q.to_pyarray(py))?;
            out.set_item("qd", motion.qd.to_pyarray(py))?;
            out.set_item("qdd", motion.qdd.to_pyarray(py))?;
            out.set_item("tau", held.tau.to_pyarray(py))?;
            let explanation = &d.outcome.explanation;
            let (given, explained) = (
                &held.tau - &explanation.gap,
                &held.tau - &explanation.residual,
            );
            out.set_item("given", given.into_pyarray(py))?;
            out.set_item("explained", explained.into_pyarray(py))?;
            out.set_item(
                "clock_known",
                d.outcome.frames.heldout_passage().clock_known(),
            )?;
            Ok(out)
        })
    }

    /// Motion that memory has run through by the end of the held-out recording, in order: time, q, qd, qdd, and the
    /// index of each sample in `motion`, -1 for samples of the fitted recording.
    fn session<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (motion, rows) = self.with(|d| d.outcome.frames.heldout_walked());
        let row = |r: Option<usize>| r.map_or(-1, |r| r as i64);
        let out = PyDict::new(py);
        out.set_item("time", motion.time.to_pyarray(py))?;
        out.set_item("q", motion.q.into_pyarray(py))?;
        out.set_item("qd", motion.qd.into_pyarray(py))?;
        out.set_item("qdd", motion.qdd.into_pyarray(py))?;
        let rows: Vec<i64> = rows.into_iter().map(row).collect();
        out.set_item("row", rows.into_pyarray(py))?;
        Ok(out)
    }

    /// Writes the next motion as CSV or Parquet. False where none was asked for or the diagnosis needs none.
    fn next_motion(&self, path: PathBuf) -> PyResult<bool> {
        self.with(|d| d.next.as_ref().map(|n| n.write(&path)).transpose())
            .map(|written| written.is_some())
            .map_err(|e| undiagnosed(&e))
    }
}
