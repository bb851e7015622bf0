//! Reduction of recordings that are too long for the memory to evenly spread stretches.

use datasets::{Recording, Trajectory};

/// Largest number of samples times joints that is used of one recording; with seven joints at most about 2 GB at the peak, where they are one trajectory.
const MOST: usize = 1_000_000;
/// Length of a stretch that is taken or left, s. Trajectories shorter than this stay whole.
const STRETCH: f64 = 60.0;
/// Golden ratio 1/φ: its multiples never fall into step with motions that alternate.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The recording, or evenly spread stretches of it where it is too long, and a sentence on the part left out.
pub fn within(recording: Recording) -> (Recording, Option<String>) {
    shortened(recording, MOST)
}

fn shortened(mut recording: Recording, most: usize) -> (Recording, Option<String>) {
    let size = recording.len() * recording.dof();
    if size <= most {
        return (recording, None);
    }
    let length = ((STRETCH / recording.median_step()) as usize).max(1);
    recording.trajectories = stretches(&recording.trajectories, length);
    let share = most as f64 / size as f64;
    let chosen: Vec<usize> = (0..recording.trajectories.len())
        .filter(|&i| (i as f64 * GOLDEN).fract() < share)
        .collect();
    let short = recording.select(&chosen);
    let note = format!(
        "{}: {} of {} stretches are used, {:.0} % of the samples, evenly spread: all of them would not fit into memory",
        recording.source,
        chosen.len(),
        recording.trajectories.len(),
        100.0 * short.len() as f64 / recording.len() as f64
    );
    (short, Some(note))
}

/// Trajectories cut into equal stretches of at most `length` samples.
fn stretches(trajectories: &[Trajectory], length: usize) -> Vec<Trajectory> {
    let cut = |t: &Trajectory| {
        let pieces = t.range.len().div_ceil(length).max(1);
        let (start, n, label) = (t.range.start, t.range.len(), t.label.clone());
        (0..pieces).map(move |p| Trajectory {
            label: label.clone(),
            range: start + p * n / pieces..start + (p + 1) * n / pieces,
        })
    };
    trajectories.iter().flat_map(cut).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn recording(samples: usize) -> Recording {
        let time = (0..samples).map(|i| 0.1 * i as f64).collect();
        let q = Array2::from_shape_fn((samples, 2), |(i, _)| i as f64);
        Recording::new("long.csv", time, q.clone(), Some(q))
    }

    #[test]
    fn a_long_recording_keeps_its_beginning_middle_and_end() {
        let (short, note) = shortened(recording(60_000), 24_000);
        let share = short.len() as f64 / 60_000.0;
        assert!((share - 0.2).abs() < 0.03, "{share}");
        assert!(note.unwrap().contains("long.csv"));
        assert_eq!(short.validate(), Ok(()));
        let mean = short.time.iter().sum::<f64>() / short.len() as f64;
        assert!((mean - 3000.0).abs() < 300.0, "{mean}");
        assert!(short.trajectories.iter().all(|t| t.range.len() <= 600));
    }

    #[test]
    fn a_short_one_is_left_alone() {
        let whole = recording(1000);
        assert_eq!(shortened(whole.clone(), 2000), (whole, None));
    }
}
