//! Recognition of a low-pass on the stored torque, from its spectrum and confirmed by the basic model.

use crate::identify::design::rigid_columns;
use crate::identify::dictionary;
use crate::session::Session;
use ::identify::base::BaseParameters;
use ::identify::least_squares::{Accumulator, SolveOptions, solve};
use datasets::prepare::{PrepareOptions, prepare};
use datasets::{Recording, TorqueFilter, metrics, stop_band};
use ndarray::Array2;
use physics::robot::Robot;
use rayon::prelude::*;

/// Filter of the torque of these training recordings. Its spectrum must have an empty stop band
/// ([`stop_band`]), and rigid body and basic friction must explain the torque better through the filter than
/// without it. Only `data` is used.
pub fn recognise(robot: &Robot, data: &[Recording]) -> Option<TorqueFilter> {
    if data.iter().any(|r| r.torque_filter.is_some()) {
        return None;
    }
    let candidates = stop_band::candidates(data);
    if candidates.is_empty() {
        return None;
    }
    let without = error(robot, data, None)?;
    candidates
        .into_iter()
        .filter_map(|filter| Some((error(robot, data, Some(filter))?, filter)))
        .filter(|(with, _)| *with < without)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, filter)| filter)
}

/// Mean over joints of the squared NRMSE of rigid body and basic friction, fitted joint by joint. None where a
/// recording cannot be prepared or nothing moves.
fn error(robot: &Robot, data: &[Recording], filter: Option<TorqueFilter>) -> Option<f64> {
    let parts = data
        .iter()
        .map(|recording| {
            let mut recording = recording.clone();
            recording.torque_filter = filter;
            prepare(&recording, &PrepareOptions::default()).ok()
        })
        .collect::<Option<Vec<_>>>()?;
    let session = Session::new(parts, &[]);
    let base = BaseParameters::of_robot(robot, &[]);
    let rigid = rigid_columns(robot, &base, &session, 0..data.len(), 1);
    let load: Vec<Array2<f64>> = session
        .parts
        .iter()
        .map(|p| Array2::zeros(p.fine.q.dim()))
        .collect();
    let terms = dictionary::basic();
    let joints: Vec<Option<f64>> = (0..robot.dof())
        .into_par_iter()
        .map(|joint| {
            let friction = session.columns(joint, &terms, &load, &[]);
            let mut rows = Accumulator::new(base.len() + terms.len());
            let mut deviation = 0.0;
            let mut samples = 0;
            for (part, recording) in data.iter().enumerate() {
                let tau = recording.tau.as_ref()?;
                let qd = session.parts[part].at_samples.qd.view();
                let spread = metrics::deviations(tau.view(), qd)[joint].unwrap_or(0.0);
                deviation += tau.nrows() as f64 * spread.powi(2);
                samples += tau.nrows();
                for row in 0..tau.nrows() {
                    let mut line = rigid[joint][part].row(row).to_vec();
                    line.extend(friction[part].row(row));
                    rows.push(&line, tau[(row, joint)], 1.0).ok()?;
                }
            }
            let triangle = rows.finish().ok()?;
            let fit = solve(&triangle, &SolveOptions::default()).ok()?;
            let left = triangle.residual_sum_of_squares(&fit.parameters).ok()?;
            (deviation > 0.0 && samples > 0).then(|| left / deviation)
        })
        .collect();
    metrics::mean(&joints)
}
