//! Recordings from files to arrays and back.

use crate::error::{raise, refused};
use crate::robot::Robot;
use datasets::{Part, ReadOptions, Recording, Trajectory, read};
use ndarray::Array2;
use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Reads a recording as a dict of arrays; `robot` says names and units of its columns.
#[pyfunction]
#[pyo3(signature = (path, robot=None))]
pub fn read_recording<'py>(
    py: Python<'py>,
    path: PathBuf,
    robot: Option<&Robot>,
) -> PyResult<Bound<'py, PyDict>> {
    let recording = py.detach(|| match robot {
        Some(robot) => {
            let one = robot.setup.read_one(&path, Part::Train, false);
            one.map_err(raise)
        }
        None => read(&path, &ReadOptions::default()).map_err(refused),
    })?;
    let out = PyDict::new(py);
    let labels: Vec<&str> = recording.trajectories.iter().map(|t| &*t.label).collect();
    let starts = recording.starts();
    out.set_item("labels", labels)?;
    out.set_item("starts", starts)?;
    out.set_item("time", recording.time.into_pyarray(py))?;
    out.set_item("q", recording.q.into_pyarray(py))?;
    for (name, table) in [
        ("tau", recording.tau),
        ("qd", recording.qd),
        ("qdd", recording.qdd),
        ("ql", recording.ql),
        ("q_ref", recording.q_ref),
        ("qd_ref", recording.qd_ref),
        ("tau_ff", recording.tau_ff),
        ("temp", recording.temp),
    ] {
        out.set_item(name, table.map(|t| t.into_pyarray(py)))?;
    }
    Ok(out)
}

/// Writes arrays as a recording, by the file's ending.
#[pyfunction]
#[pyo3(signature = (path, time, labels, starts, **tables))]
pub fn write_recording(
    path: PathBuf,
    time: PyReadonlyArray1<f64>,
    labels: Vec<String>,
    starts: Vec<usize>,
    tables: Option<&Bound<PyDict>>,
) -> PyResult<()> {
    let table = |name: &str| -> PyResult<Option<Array2<f64>>> {
        let Some(value) = tables.map(|t| t.get_item(name)).transpose()?.flatten() else {
            return Ok(None);
        };
        let array: PyReadonlyArray2<f64> = value.extract().map_err(|_| {
            refused(format!(
                "{name}: a float64 array of shape (samples, joints) is needed"
            ))
        })?;
        Ok(Some(array.as_array().as_standard_layout().to_owned()))
    };
    let q = table("q")?.ok_or_else(|| refused("q is missing"))?;
    let time = time.as_array().to_vec();
    let ends = starts.iter().skip(1).copied().chain([time.len()]);
    let trajectories = labels.into_iter().zip(starts.iter().zip(ends));
    let recording = Recording {
        trajectories: trajectories
            .map(|(label, (&start, end))| Trajectory {
                label,
                range: start..end,
            })
            .collect(),
        qd: table("qd")?,
        qdd: table("qdd")?,
        ql: table("ql")?,
        q_ref: table("q_ref")?,
        qd_ref: table("qd_ref")?,
        tau_ff: table("tau_ff")?,
        temp: table("temp")?,
        ..Recording::new("arrays", time, q, table("tau")?)
    };
    recording.validate().map_err(refused)?;
    datasets::write(&recording, &path).map_err(refused)
}
