//! Scores of the same model on other motion of the same recording: planned motion, and motion derived causally
//! as in a control loop.

use super::error::EvaluateError;
use crate::loaded::Loaded;
use crate::session::Session;
use datasets::Recording;
use datasets::metrics::Row;
use datasets::prepare::Prepared;
use signal::state_variable::StateVariable;

/// Scores with planned motion, where the recording has it, and with causally derived motion, with a note on
/// each. Measured torque, scope and samples are those of the other rows.
pub(super) fn rows(
    loaded: &Loaded,
    recording: &Recording,
    prepared: &Prepared,
    cutoff_hz: Option<f64>,
) -> Result<(Vec<Row>, Vec<String>), EvaluateError> {
    let (mut rows, mut notes) = (Vec::new(), Vec::new());
    let Some(tau) = &recording.tau else {
        return Ok((rows, notes));
    };
    let mut variants = Vec::new();
    if let Some(planned) = planned(recording) {
        let moved = loaded
            .file
            .preprocessing
            .prepare(&planned, cutoff_hz)
            .map_err(|source| EvaluateError::Prepare {
                file: format!("{} (q_ref)", recording.source),
                source,
            })?;
        variants.push(("reference", moved));
        notes.push("[reference]: the model was fed the planned motion (q_ref and its derivatives) instead of the measured one, and scored on the same torque.".to_owned());
    }
    let cutoff = prepared.report.cutoff_hz;
    let mut derived = causal(recording, prepared);
    if let Some(channel) = &loaded.file.preprocessing.channel {
        channel.turn(&mut derived.fine);
    }
    variants.push(("causal", derived));
    notes.push(format!(
        "[causal]: motion as a control loop has it, from the recorded position alone, nothing from the future: {}.",
        cutoff.map_or_else(
            || "backward differences".to_owned(),
            |hz| format!("position, velocity and acceleration of a second-order low-pass at {hz:.3} Hz")
        )
    ));
    for (name, moved) in variants {
        let session = Session::new(vec![moved], &loaded.file.clock);
        let [physics, torque] = loaded.torque(&session)?;
        let qd = &prepared.at_samples.qd;
        rows.extend(Row::both_scopes(
            &format!("physics [{name}]"),
            tau,
            &physics,
            qd,
        )?);
        if loaded.compensator.is_some() {
            rows.extend(Row::both_scopes(
                &format!("physics+compensator [{name}]"),
                tau,
                &torque,
                qd,
            )?);
        }
    }
    Ok((rows, notes))
}

/// Recording with planned instead of measured motion; none where it has no planned motion.
fn planned(recording: &Recording) -> Option<Recording> {
    Some(Recording {
        q: recording.q_ref.clone()?,
        qd: recording.qd_ref.clone(),
        qdd: None,
        ..recording.clone()
    })
}

/// `prepared` with its motion replaced by one in which no sample depends on a later one.
///
/// Between recorded samples (the fine grid of a slow recording) motion is extrapolated with the acceleration of the newest one.
fn causal(recording: &Recording, prepared: &Prepared) -> Prepared {
    let mut made = prepared.clone();
    let report = &prepared.report;
    let slack = 1e-6 / report.rate_hz;
    for joint in 0..recording.dof() {
        for (rows, fine) in std::iter::zip(recording.segments(), &prepared.fine.segments) {
            let time = &recording.time[rows.clone()];
            let q: Vec<f64> = rows.clone().map(|r| recording.q[[r, joint]]).collect();
            let states = derive(time, &q, report.cutoff_hz);
            for (row, [q, qd, qdd]) in rows.zip(&states) {
                made.at_samples.q[[row, joint]] = *q;
                made.at_samples.qd[[row, joint]] = *qd;
                made.at_samples.qdd[[row, joint]] = *qdd;
            }
            for row in fine.clone() {
                let t = prepared.fine.time[row];
                let newest = time.partition_point(|&s| s <= t + slack).saturating_sub(1);
                let [q, qd, qdd] = states[newest];
                let ahead = (t - time[newest]).max(0.0);
                made.fine.q[[row, joint]] = q + ahead * (qd + 0.5 * ahead * qdd);
                made.fine.qd[[row, joint]] = qd + ahead * qdd;
                made.fine.qdd[[row, joint]] = qdd;
            }
        }
    }
    made
}

/// Position, velocity and acceleration of one joint after each sample of a trajectory, from samples up to it; at rest before
/// the first. Those of a low-pass at `cutoff_hz` or, without one, backward differences.
fn derive(time: &[f64], q: &[f64], cutoff_hz: Option<f64>) -> Vec<[f64; 3]> {
    let samples = std::iter::zip(time.iter().copied(), q.iter().copied());
    match cutoff_hz {
        Some(hz) => low_passed(samples, hz),
        None => differences(samples),
    }
}

/// States of a causal low-pass, which starts at rest on the first sample.
fn low_passed(samples: impl Iterator<Item = (f64, f64)>, hz: f64) -> Vec<[f64; 3]> {
    let mut filter: Option<StateVariable> = None;
    let state = |(time, q)| match &mut filter {
        None => filter.insert(StateVariable::at_rest(hz, time, q)).state(),
        Some(filter) => {
            filter.step(time, q);
            filter.state()
        }
    };
    samples.map(state).collect()
}

/// Positions with their backward differences.
fn differences(samples: impl Iterator<Item = (f64, f64)>) -> Vec<[f64; 3]> {
    let mut states: Vec<[f64; 3]> = Vec::new();
    let mut last = None;
    for (time, q) in samples {
        let state = match (last, states.last()) {
            (Some(before), Some([q0, qd0, _])) => {
                let dt = time - before;
                let qd = (q - q0) / dt;
                // The first difference has no velocity to be compared with.
                let qdd = if states.len() == 1 {
                    0.0
                } else {
                    (qd - qd0) / dt
                };
                [q, qd, qdd]
            }
            _ => [q, 0.0, 0.0],
        };
        states.push(state);
        last = Some(time);
    }
    states
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::Trajectory;
    use datasets::prepare::{PrepareOptions, prepare};
    use ndarray::Array2;

    fn recording(position: impl Fn(f64) -> f64) -> Recording {
        let time: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
        let q = Array2::from_shape_fn((400, 1), |(i, _)| position(time[i]));
        Recording::new("test", time, q, None)
    }

    #[test]
    fn nothing_comes_from_the_future() {
        let options = PrepareOptions {
            cutoff_hz: Some(8.0),
            ..PrepareOptions::default()
        };
        let whole = recording(|t| (3.0 * t).sin());
        let mut bent = recording(|t| (3.0 * t).sin() + if t > 2.0 { t - 2.0 } else { 0.0 });
        let motion = |r: &Recording| causal(r, &prepare(r, &options).unwrap());
        let (a, b) = (motion(&whole), motion(&bent));
        for (x, y) in [(&a.fine, &b.fine), (&a.at_samples, &b.at_samples)] {
            for row in 0..=200 {
                assert_eq!(
                    (x.q[[row, 0]], x.qd[[row, 0]], x.qdd[[row, 0]]),
                    (y.q[[row, 0]], y.qd[[row, 0]], y.qdd[[row, 0]]),
                    "row {row}"
                );
            }
            assert_ne!(x.qd[[202, 0]], y.qd[[202, 0]]);
        }
        // A break is a new start.
        bent.trajectories = vec![
            Trajectory {
                label: "a".into(),
                range: 0..150,
            },
            Trajectory {
                label: "b".into(),
                range: 150..400,
            },
        ];
        let split = motion(&bent);
        assert_eq!(split.at_samples.qd[[150, 0]], 0.0);
        assert_eq!(split.at_samples.qd[[149, 0]], b.at_samples.qd[[149, 0]]);
    }

    #[test]
    fn between_slow_samples_the_newest_one_decides() {
        let slow = |bend: f64| {
            let mut r = recording(|t| (0.3 * t).sin() + bend * (t - 2.0).max(0.0));
            for t in &mut r.time {
                *t *= 10.0;
            }
            causal(&r, &prepare(&r, &PrepareOptions::default()).unwrap()).fine
        };
        // The sample at 20.1 s is the first that differs.
        let (a, b) = (slow(0.0), slow(0.5));
        for (row, t) in a.time.iter().enumerate() {
            let same = a.q[[row, 0]] == b.q[[row, 0]] && a.qdd[[row, 0]] == b.qdd[[row, 0]];
            assert_eq!(same, *t < 20.1 - 1e-6, "{t} s");
        }
    }

    #[test]
    fn differences_of_a_parabola() {
        let time = [0.0, 0.1, 0.2, 0.3, 0.4];
        let q: Vec<f64> = time.iter().map(|t| 2.0 * t * t).collect();
        let states = derive(&time, &q, None);
        for (i, s) in states.iter().enumerate().skip(2) {
            // Backward differences of 2t²: velocity of the interval's middle, acceleration exact.
            let middle = time[i] - 0.05;
            assert!((s[1] - 4.0 * middle).abs() < 1e-12, "{s:?}");
            assert!((s[2] - 4.0).abs() < 1e-10, "{s:?}");
        }
        assert_eq!(states[0], [0.0, 0.0, 0.0]);
    }

    /// Largest error of the acceleration against the filter's own answer to the motion on a fine clock, after the start.
    fn worst_acceleration(time: &[f64]) -> f64 {
        let position = |t: f64| (2.0 * t).sin() + 0.3 * (7.0 * t).sin() + 0.1 * (13.0 * t).sin();
        let hz = 8.0;
        let at = |time: &[f64]| {
            let q: Vec<f64> = time.iter().map(|t| position(*t)).collect();
            derive(time, &q, Some(hz))
        };
        let fine: Vec<f64> = (0..40_000).map(|k| f64::from(k) * 1e-4).collect();
        let truth = at(&fine);
        let states = at(time);
        let late = std::iter::zip(time, &states).filter(|(t, _)| **t > 0.5 && **t < 3.9);
        late.map(|(t, state)| (state[2] - truth[(t * 1e4).round() as usize][2]).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn uneven_and_lost_stamps_cost_no_acceleration() {
        let even: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.01).collect();
        // Every stamp off by up to 3 ms of 10, on the fine clock's grid; one sample in twenty lost.
        let jitter = |k: usize| ((k * 7919 + 13) % 61) as f64 * 1e-4 - 0.003;
        let kept = (0..400).filter(|k| *k < 2 || k % 20 != 7);
        let uneven: Vec<f64> = kept
            .map(|k| even[k] + if k == 0 { 0.0 } else { jitter(k) })
            .collect();
        assert!(uneven.is_sorted());
        // Between samples the input is a straight line, off by at most a gap² / 8 of the largest acceleration, 36 rad/s²; the
        // filter takes that times ω². Neither jitter nor a lost sample costs more than the longest gap does.
        let bound = |gap: f64| (16.0 * std::f64::consts::PI).powi(2) * 36.0 * gap * gap / 8.0;
        let gaps = uneven.windows(2).map(|w| w[1] - w[0]);
        let longest = gaps.fold(0.0, f64::max);
        assert!(longest > 0.02, "{longest}");
        for (time, gap) in [(&even, 0.01), (&uneven, longest)] {
            let worst = worst_acceleration(time);
            assert!(worst < bound(gap), "gaps of up to {gap} s: {worst}");
        }
    }

    #[test]
    fn planned_motion_needs_planned_positions() {
        let mut r = recording(|t| t);
        assert!(planned(&r).is_none());
        r.q_ref = Some(&r.q + 1.0);
        assert_eq!(planned(&r).unwrap().q, &r.q + 1.0);
    }
}
