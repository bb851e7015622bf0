//! Motions as tables: of designed trajectories, and from files.

use datasets::{Part, Problem, ReadOptions, Recording, prepare, read};
use identify::excitation::Series;
use model::failure::Failure;
use model::preparation::setup::{Setup, SetupError};
use ndarray::{Array2, ArrayView2, Axis, concatenate};
use signal::Motion;
use std::path::Path;

/// A motion with a label for each of its segments.
pub struct Labelled {
    /// Samples; the clock of each segment begins at zero.
    pub motion: Motion,
    /// Label of each segment, in order.
    pub labels: Vec<String>,
}

/// Samples of trajectories, labelled `1`, `2`, ….
pub fn sampled(trajectories: &[Series], rate: f64, repeats: usize) -> Labelled {
    let each: Vec<Motion> = trajectories
        .iter()
        .map(|t| t.sampled(rate, repeats, 0.0))
        .collect();
    let joined = |of: fn(&Motion) -> &Array2<f64>| {
        let views: Vec<ArrayView2<f64>> = each.iter().map(|m| of(m).view()).collect();
        concatenate(Axis(0), &views).expect("motions of one robot")
    };
    let mut segments = Vec::with_capacity(each.len());
    let mut start = 0;
    for m in &each {
        segments.push(start..start + m.len());
        start += m.len();
    }
    Labelled {
        motion: Motion {
            time: each.iter().flat_map(|m| m.time.clone()).collect(),
            q: joined(|m| &m.q),
            qd: joined(|m| &m.qd),
            qdd: joined(|m| &m.qdd),
            segments,
        },
        labels: (1..=each.len()).map(|k| k.to_string()).collect(),
    }
}

/// Motion from a file: a recording, or a table with columns `q_ref` alone that is still to be run.
pub fn from_file(setup: &Setup, path: &Path) -> Result<Labelled, Failure> {
    let recording = match setup.read_one(path, Part::Test, false) {
        Ok(recording) => recording,
        Err(SetupError::Read(error)) if matches!(error.problem, Problem::MissingColumn { .. }) => {
            let reference = read(path, &ReadOptions::for_reference(setup.robot.dof()));
            // Where it is no reference either, the recording's own refusal says more.
            reference.map_err(|_| Failure::from(SetupError::Read(error)))?
        }
        Err(error) => return Err(error.into()),
    };
    let labels = recording
        .trajectories
        .iter()
        .map(|t| t.label.clone())
        .collect();
    Ok(Labelled {
        motion: motion(recording, path)?,
        labels,
    })
}

fn motion(recording: Recording, path: &Path) -> Result<Motion, Failure> {
    if let (Some(qd), Some(qdd)) = (&recording.qd, &recording.qdd) {
        return Ok(Motion {
            segments: recording.segments(),
            time: recording.time.clone(),
            q: recording.q.clone(),
            qd: qd.clone(),
            qdd: qdd.clone(),
        });
    }
    let prepared = prepare(&recording, &datasets::PrepareOptions::default())
        .map_err(|e| Failure::input(format!("{}: {e}", path.display()), ""))?;
    Ok(prepared.at_samples)
}
