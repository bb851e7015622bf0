//! What counts as no gap: a small part of the departure from the commands, and how far executions of one motion differ. No
//! simulator of the motion comes closer.

use datasets::{Recording, repeats};
use ndarray::Array2;

/// Largest ratio of simulation error to tracking error of a joint without a gap.
pub const SMALL: f64 = 0.05;

/// RMS difference of one execution of a motion from another over √2, by joint, rad (m): between trajectories, or periods of
/// one, whichever is larger. `tracking` is the RMS of command less position of each joint. None where no motion is repeated.
///
/// Executions count as one motion where their commands differ by so little that it counts as no gap.
pub(crate) fn repeatability(
    recording: &Recording,
    command: &Array2<f64>,
    tracking: &[f64],
) -> Option<Vec<f64>> {
    // Repeated motion is looked for among the commands; `table` stands in the place of the torque that is compared.
    let compared = |table: &Array2<f64>| Recording {
        trajectories: recording.trajectories.clone(),
        ..Recording::new(
            &recording.source,
            recording.time.clone(),
            command.clone(),
            Some(table.clone()),
        )
    };
    let (asked, moved) = (compared(command), compared(&recording.q));
    let still = Array2::zeros(command.dim());
    let between = |of: &Recording, pairs: &[(usize, usize)]| {
        repeats::repeatability(of, &still, pairs).map(|r| r.all)
    };
    let alike = |apart: &Vec<f64>| {
        let mut each = apart.iter().zip(tracking);
        each.all(|(apart, tracking)| *apart <= SMALL * tracking)
    };
    let mut pairs = repeats::find(&asked);
    pairs.retain(|pair| between(&asked, &[*pair]).is_some_and(|apart| alike(&apart)));
    let within = repeats::within(&asked).filter(alike);
    let within = within.and_then(|_| repeats::within(&moved));
    let larger = |a: Vec<f64>, b: Vec<f64>| a.into_iter().zip(b).map(|(a, b)| a.max(b)).collect();
    between(&moved, &pairs)
        .into_iter()
        .chain(within)
        .reduce(larger)
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::Trajectory;

    /// Two trajectories of 20 s at 50 Hz that one joint follows 0.1 rad late, with an error of its own in each: the amplitude
    /// `error` at another frequency. The second commands go `factor` as far as the first.
    fn twice(factor: f64, error: f64) -> (Recording, Array2<f64>) {
        let rows = 1000;
        let wave = |row: usize| {
            let k = row / rows;
            let t = 0.02 * (row % rows) as f64;
            (k, t, if k == 0 { 1.0 } else { factor })
        };
        // Of two frequencies without a common period.
        let goal = |t: f64| t.sin() + 0.5 * (2.2 * t).sin();
        let command = Array2::from_shape_fn((2 * rows, 1), |(row, _)| {
            let (_, t, factor) = wave(row);
            factor * goal(t)
        });
        let q = Array2::from_shape_fn((2 * rows, 1), |(row, _)| {
            let (k, t, factor) = wave(row);
            factor * goal(t - 0.1) + error * (7.0 * t + k as f64 * std::f64::consts::PI).sin()
        });
        let time = (0..2 * rows).map(|r| 0.02 * r as f64 + 5.0 * (r / rows) as f64);
        let mut recording = Recording::new("made", time.collect(), q, None);
        let part = |k: usize| Trajectory {
            label: k.to_string(),
            range: k * rows..(k + 1) * rows,
        };
        recording.trajectories = vec![part(0), part(1)];
        (recording, command)
    }

    fn of((recording, command): (Recording, Array2<f64>)) -> Option<Vec<f64>> {
        let off = &command - &recording.q;
        let tracking = (off.mapv(|v| v * v).sum() / off.len() as f64).sqrt();
        repeatability(&recording, &command, &[tracking])
    }

    #[test]
    fn executions_differ_by_their_own_errors() {
        // The two errors are opposite: each differs from their mean by its own RMS, and √2 times that is their distance over √2.
        let floor = of(twice(1.0, 0.01)).expect("the motion is repeated")[0];
        assert!((floor - 0.01).abs() < 2e-4, "{floor}");
    }

    #[test]
    fn other_commands_are_another_motion() {
        // One per cent of the way is a tenth of the departure from the commands.
        assert_eq!(of(twice(1.01, 0.0)), None);
        assert_eq!(of(twice(1.5, 0.0)), None);
    }
}
