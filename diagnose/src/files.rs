//! Recordings as the command line names them.

use crate::error::DiagnoseError;
use datasets::{Part, ReadOptions, Recording, Trajectory, read};
use ndarray::{Array2, Axis, concatenate};
use physics::robot::Robot;
use std::path::{Path, PathBuf};

/// Reads one recording of a robot.
///
/// # Errors
/// The file cannot be used.
pub fn recording(robot: &Robot, path: &Path, part: Part) -> Result<Recording, DiagnoseError> {
    // The benchmark's torque was low-passed; its files come with a robot of this name.
    let options = if robot.name() == "kr300" {
        ReadOptions::kr300(part)
    } else {
        ReadOptions::for_robot(robot.dof())
    };
    Ok(read(path, &options)?)
}

/// Reads and joins the recordings that are fitted.
///
/// # Errors
/// A file cannot be used.
pub fn data(robot: &Robot, paths: &[PathBuf]) -> Result<Recording, DiagnoseError> {
    let all: Result<Vec<Recording>, _> = paths
        .iter()
        .map(|p| recording(robot, p, Part::Train))
        .collect();
    Ok(joined(&all?))
}

/// One recording of all trajectories. Optional tables that one of them lacks are left out.
fn joined(all: &[Recording]) -> Recording {
    let mut out = all[0].clone();
    for next in &all[1..] {
        let start = out.len();
        out.trajectories
            .extend(next.trajectories.iter().map(|t| Trajectory {
                label: t.label.clone(),
                range: start + t.range.start..start + t.range.end,
            }));
        out.time.extend_from_slice(&next.time);
        let both = |a: &Array2<f64>, b: &Array2<f64>| {
            concatenate(Axis(0), &[a.view(), b.view()])
                .expect("recordings of one robot have the same joints")
        };
        let some =
            |a: &Option<Array2<f64>>, b: &Option<Array2<f64>>| Some(both(a.as_ref()?, b.as_ref()?));
        out.q = both(&out.q, &next.q);
        out.tau = some(&out.tau, &next.tau);
        out.qd = some(&out.qd, &next.qd);
        out.qdd = some(&out.qdd, &next.qdd);
        out.ql = some(&out.ql, &next.ql);
        out.q_ref = some(&out.q_ref, &next.q_ref);
        out.qd_ref = some(&out.qd_ref, &next.qd_ref);
        out.temp = some(&out.temp, &next.temp);
        out.source = format!("{}, {}", out.source, next.source);
    }
    out
}
