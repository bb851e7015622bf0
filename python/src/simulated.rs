//! The catalogue of effects, and simulated robots that have them.

use crate::error::refused;
use crate::interrupt::{self, OnInterrupt};
use ::diagnose::{Effect, patch};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::path::PathBuf;
use trials::cases;

/// Every effect with where a patched MJCF holds it, or why neither that nor generated code does.
#[pyfunction]
pub fn effects() -> Vec<(&'static str, &'static str)> {
    let held = |e: Effect| patch::place(e, true).unwrap_or_else(|| patch::beyond(e));
    Effect::ALL.map(|e| (e.name(), held(e))).into()
}

/// Writes the first case of an effect that a seed deals below `folder`, as `simulate cases --only EFFECT` does; returns
/// the case's own folder.
#[pyfunction]
pub fn simulate_case(py: Python, effect: String, seed: u64, folder: PathBuf) -> PyResult<PathBuf> {
    if cases::effect_index(&effect).is_none() {
        return Err(refused(format!("no case withholds {effect}")));
    }
    let made = interrupt::run(py, OnInterrupt::Abandon, move |_| {
        let spec = cases::draw_only(&effect, seed).next();
        let spec = spec.expect("a round deals every effect");
        let case = cases::generate(&spec, seed)?;
        cases::write(&case, &folder)?;
        Ok::<_, trials::SimulateError>(folder.join("cases").join(case.id))
    })?;
    made.map_err(|e| PyRuntimeError::new_err(e.to_string()))
}
