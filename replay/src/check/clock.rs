//! Check that commands and positions are stamped by one clock.

use super::follows::{FINEST, FOLLOWED, Follows, SLOWEST};
use super::unusable::Unusable;
use datasets::Recording;
use ndarray::Array2;
use std::ops::Range;

/// Number of parts of a trajectory whose delays are compared.
const PARTS: usize = 6;
/// Least length of each part, s.
const PART: f64 = 5.0;

/// Refuses commands whose clock is shifted against that of the positions, or runs at another rate. The delay is the
/// median over the listed joints. `lags` says how late each joint follows by what is given of its drive, s.
///
/// # Errors
/// Delay that no drive has, or not one of these, or that grows evenly with time.
pub(super) fn clock(
    recording: &Recording,
    command: &Array2<f64>,
    joints: &[usize],
    lags: &[f64],
) -> Result<(), Unusable> {
    let source_name = || recording.source.clone();
    let step = recording.median_step().max(FINEST);
    // Delay of each joint that follows, as it is and beyond what is given.
    let delays = |rows: &Range<usize>| -> Vec<[f64; 2]> {
        let of = |&j: &usize| {
            let follows = Follows::over(recording, command, [j, j], rows, SLOWEST + lags[j]);
            let (late, correlation) = follows.best;
            (correlation > FOLLOWED).then_some([late, late - lags[j]])
        };
        joints.iter().filter_map(of).collect()
    };
    let middle = |all: &[[f64; 2]], k: usize| {
        signal::quantile::median(all.iter().map(|one| one[k]).collect())
    };
    let late = |rows: &Range<usize>| middle(&delays(rows), 0);
    let Some(longest) = recording.trajectories.iter().max_by_key(|t| t.range.len()) else {
        return Ok(());
    };
    let rows = longest.range.clone();
    let time = &recording.time;
    let span = time[rows.end - 1] - time[rows.start];
    if span > PARTS as f64 * PART {
        let cut = |k: usize| rows.start + rows.len() * k / PARTS;
        let parts: Option<Vec<f64>> = (0..PARTS).map(|k| late(&(cut(k)..cut(k + 1)))).collect();
        if let Some([first, last]) = parts.as_deref().and_then(|p| drift(p, step)) {
            // Time between the middles of the first and last part: five of six parts of the whole.
            let rate = (last - first) / (span * (PARTS - 1) as f64 / PARTS as f64);
            return Err(Unusable::Drift {
                source_name: source_name(),
                first,
                last,
                rate,
            });
        }
    }
    let all = delays(&rows);
    match (middle(&all, 0), middle(&all, 1)) {
        (Some(late), Some(beyond)) if beyond > SLOWEST || late < -2.0 * step => {
            Err(Unusable::Clock {
                source_name: source_name(),
                late,
            })
        }
        _ => Ok(()),
    }
}

/// First and last delay on the line through the delays of successive parts, s; none where they do not grow evenly.
/// Growth must exceed 0.05 s, two samples, and ten times the scatter about the line. A drive's own delay changes with
/// speed, not with time.
fn drift(parts: &[f64], step: f64) -> Option<[f64; 2]> {
    let n = parts.len() as f64;
    let (mean, middle) = (parts.iter().sum::<f64>() / n, 0.5 * (n - 1.0));
    let (mut xy, mut xx) = (0.0, 0.0);
    for (k, p) in parts.iter().enumerate() {
        let x = k as f64 - middle;
        (xy, xx) = (xy + x * (p - mean), xx + x * x);
    }
    let slope = xy / xx;
    let off = |(k, p): (usize, &f64)| (p - mean - slope * (k as f64 - middle)).powi(2);
    let scatter = (parts.iter().enumerate().map(off).sum::<f64>() / n).sqrt();
    let growth = slope * (n - 1.0);
    let grows = growth.abs() > (2.0 * step).max(0.05) && growth.abs() > 10.0 * scatter;
    grows.then_some([mean - 0.5 * growth, mean + 0.5 * growth])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forty seconds at 50 Hz of a joint that follows a wave by `late` s.
    fn followed(late: f64) -> (Recording, Array2<f64>) {
        let time: Vec<f64> = (0..2000).map(|k| 0.02 * f64::from(k)).collect();
        let wave = |t: f64| (0.9 * t).sin() + 0.4 * (2.1 * t).sin();
        let table = |late: f64| Array2::from_shape_fn((2000, 1), |(r, _)| wave(time[r] - late));
        let (q, command) = (table(late), table(0.0));
        (Recording::new("made", time, q, None), command)
    }

    #[test]
    fn a_drive_may_be_as_late_as_what_is_given_of_it() {
        let (recording, command) = followed(0.64);
        let checked = |lag: f64| clock(&recording, &command, &[0], &[lag]);
        assert!(checked(0.3).is_ok());
        let Err(Unusable::Clock { late, .. }) = checked(0.05) else {
            panic!("0.64 s is more than 0.5 s beyond 0.05 s");
        };
        assert!((late - 0.64).abs() < 0.01, "{late}");
        // Positions before their commands are no drive's, however slow it is.
        let (recording, command) = followed(-0.2);
        assert!(clock(&recording, &command, &[0], &[2.0]).is_err());
    }

    #[test]
    fn even_growth_is_drift_and_a_jump_is_not() {
        let even: Vec<f64> = (0..6).map(|k| 0.03 + 0.04 * f64::from(k)).collect();
        let [first, last] = drift(&even, 0.02).expect("it grows");
        assert!((first - 0.03).abs() < 1e-12 && (last - 0.23).abs() < 1e-12);
        assert_eq!(drift(&[0.03, 0.03, 0.03, 0.2, 0.2, 0.2], 0.02), None);
        assert_eq!(drift(&[0.03, 0.04, 0.03, 0.04, 0.05, 0.04], 0.02), None);
    }
}
