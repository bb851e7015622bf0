//! Logs that are written more often than their values change.

use crate::Recording;
use crate::recording::MIN_SAMPLES;
use ndarray::Array2;
use signal::quantile::median;

/// Least fraction of the changes that come a whole number of rows after the change before, within [`SLACK`].
const REGULAR: f64 = 0.9;
/// Slack in rows: the deviation from a whole number that two clocks running beside each other make.
const SLACK: f64 = 0.25;
/// Part of the changes in which a column that is held with others takes part, at least.
const TOGETHER: f64 = 0.5;

/// Leaves out the rows without a new value, where all values change together only every few rows: a log at 1
/// kHz of values that come at 100 Hz. Differentiated as it stands, such a log would give spikes and zeros.
pub(crate) fn released(recording: Recording) -> Recording {
    let Some((every, fresh)) = held(&recording) else {
        return recording;
    };
    let rate = 1.0 / recording.median_step();
    let (mut time, mut trajectories, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    for t in &recording.trajectories {
        let start = rows.len();
        rows.extend(t.range.clone().filter(|&r| fresh[r]));
        if rows.len() - start < MIN_SAMPLES {
            return recording;
        }
        trajectories.push(crate::Trajectory {
            label: t.label.clone(),
            range: start..rows.len(),
        });
    }
    time.extend(rows.iter().map(|&r| recording.time[r]));
    let mut released =
        recording.map_tables(time, trajectories, |t| t.select(ndarray::Axis(0), &rows));
    released.notes.push(format!(
        "held samples: the values change every {every} rows alone, {:.0} Hz in truth where the stamps say {rate:.0} Hz; the {} rows between \
         are left out",
        1.0 / released.median_step(),
        recording.len() - rows.len()
    ));
    released
}

/// Rows between changes, and for each row whether its values are new; none where values change in every row.
fn held(recording: &Recording) -> Option<(usize, Vec<bool>)> {
    let tables: Vec<&Array2<f64>> = [
        Some(&recording.q),
        recording.qd.as_ref(),
        recording.tau.as_ref(),
        recording.ql.as_ref(),
    ]
    .into_iter()
    .flatten()
    .collect();
    let mut fresh = vec![false; recording.len()];
    let mut gaps = Vec::new();
    for t in &recording.trajectories {
        fresh[t.range.start] = true;
        let mut last = None;
        for row in t.range.clone().skip(1) {
            fresh[row] = tables.iter().any(|v| v.row(row) != v.row(row - 1));
            if fresh[row] {
                gaps.extend(last.map(|l| (row - l) as f64));
                last = Some(row);
            }
        }
    }
    let count = gaps.len();
    let every = median(gaps.clone())?;
    let regular = gaps
        .iter()
        .filter(|g| (*g / every - 1.0).abs() <= SLACK)
        .count();
    if every < 2.0 || count < MIN_SAMPLES || (regular as f64) < REGULAR * count as f64 {
        return None;
    }
    // One coarse encoder at constant speed changes as regularly: what is held is held with others.
    let together = tables
        .iter()
        .flat_map(|t| t.columns())
        .filter(|column| {
            let own = (1..recording.len()).filter(|&r| fresh[r] && column[r] != column[r - 1]);
            own.count() as f64 > TOGETHER * count as f64
        })
        .count();
    (together > 1).then_some((every.round() as usize, fresh))
}
