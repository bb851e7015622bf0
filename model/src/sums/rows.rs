//! Triangular factors of a recording's rows.
//!
//! Standard deviations need stretches of consecutive rows (blocks of a jackknife). Every recording is cut into
//! [`STRETCHES`] of them, and a digest of its contents assigns it to one of [`GROUPS`]. So a stretch's place is
//! the same on every worker and in every order, and the number of places is limited. Stretches of two
//! recordings in one place are left out together.

use super::columns::Columns;
use super::error::SumsError;
use super::preparation::Preparation;
use crate::identify::design::rigid_columns;
use crate::identify::error::IdentifyError;
use crate::identify::target;
use crate::physics_fit::FitError;
use crate::preparation::cutoff;
use crate::session::Session;
use ::identify::least_squares::{Accumulator, LeastSquaresError, Triangle};
use datasets::Recording;
use datasets::prepare::prepare;
use ndarray::Array2;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Number of stretches of a recording: neighbours are joined in pairs as long as 24 blocks are left.
pub(super) const STRETCHES: usize = 32;
/// Number of groups into which recordings are divided. Stretches with the same number in one group share a place, and
/// are left out together.
pub(super) const GROUPS: usize = 4;

/// Triangular factors of one recording, by place and joint.
pub(super) fn factors(
    columns: &Columns,
    recording: &Recording,
    preparation: Preparation,
) -> Result<BTreeMap<usize, Vec<Triangle>>, SumsError> {
    let robot = &columns.robot;
    if recording.dof() != robot.dof() {
        return Err(IdentifyError::Joints {
            found: recording.dof(),
            expected: robot.dof(),
        }
        .into());
    }
    let own = cutoff::for_recording(&preparation.options(), recording);
    let part = prepare(recording, &own).map_err(|source| FitError::Prepare {
        file: recording.source.clone(),
        source,
    })?;
    let tau = target::identified(robot, recording, &part)?;
    let session = Session::new(vec![part], &[]);
    let rigid = rigid_columns(robot, &columns.base, &session, 0..1, 1);
    let no_load = [Array2::zeros(session.parts[0].fine.q.dim())];
    let samples = recording.len();
    let by_joint: Vec<Vec<Triangle>> = (0..robot.dof())
        .into_par_iter()
        .map(|joint| {
            let acting = columns.acting(joint);
            let terms = session.columns(joint, &columns.terms[joint], &no_load, &[]);
            let mut row = vec![0.0; columns.width(joint)];
            (0..STRETCHES)
                .map(|k| {
                    let mut rows = Accumulator::new(row.len());
                    for r in k * samples / STRETCHES..(k + 1) * samples / STRETCHES {
                        let rigid = acting.iter().map(|&c| rigid[joint][0][[r, c]]);
                        let friction = terms[0].row(r);
                        let values = rigid.chain(friction.iter().copied());
                        row.iter_mut()
                            .zip(values)
                            .for_each(|(to, value)| *to = value);
                        rows.push(&row, tau[[r, joint]], 1.0)?;
                    }
                    rows.finish()
                })
                .collect()
        })
        .collect::<Result<_, LeastSquaresError>>()?;
    let first = STRETCHES * group(recording);
    Ok((0..STRETCHES)
        .map(|k| (first + k, by_joint.iter().map(|j| j[k].clone()).collect()))
        .collect())
}

/// Group of a recording, from a digest of its contents.
fn group(recording: &Recording) -> usize {
    let mut digest = Sha256::new();
    let tables = [Some(&recording.q), recording.tau.as_ref()];
    let values = tables.into_iter().flatten().flat_map(|t| t.iter());
    for value in recording.time.iter().chain(values) {
        digest.update(value.to_le_bytes());
    }
    usize::from(digest.finalize()[0]) % GROUPS
}
