//! Recordings of periodic motion as the papers take them: averaged, as a series, with smoothed torque.

use crate::arguments::Arguments;
use datasets::Recording;
use datasets::periods::{as_series, average, smooth_torque};
use model::failure::Failure;
use report::say;

/// `--average`, `--harmonics` and `--rloess` on the training recordings.
pub fn applied(data: Vec<Recording>, arguments: &Arguments) -> Result<Vec<Recording>, Failure> {
    let wrong = |e: datasets::periods::PeriodError| {
        Failure::input(
            e.to_string(),
            "Check --average, --harmonics and --rloess against the recording.",
        )
    };
    let one = |mut recording: Recording| {
        if let Some(period) = arguments.average {
            let averaged = average(&recording, period).map_err(wrong)?;
            if !arguments.running.quiet {
                told(
                    &recording.source,
                    &averaged.runs,
                    [&averaged.position, &averaged.torque],
                );
            }
            recording = averaged.recording;
            if let Some(harmonics) = arguments.harmonics {
                recording = as_series(&recording, period, harmonics).map_err(wrong)?;
            }
        }
        match arguments.rloess {
            Some(span) => smooth_torque(&recording, span).map_err(wrong),
            None => Ok(recording),
        }
    };
    data.into_iter().map(one).collect()
}

/// Prints the number of runs, and the deviation of one run from the average.
fn told(source: &str, runs: &[usize], deviations: [&Option<Vec<f64>>; 2]) {
    let most = runs.iter().max().copied().unwrap_or(0);
    let least = runs.iter().min().copied().unwrap_or(0);
    say!(
        "{source}: {} motions, averages over {least} to {most} runs",
        runs.len()
    );
    for (what, deviation) in ["position / rad (m)", "torque / N·m (N)"]
        .iter()
        .zip(deviations)
    {
        if let Some(values) = deviation {
            let list: Vec<String> = values.iter().map(|v| format!("{v:.3e}")).collect();
            say!("  deviation of one run, {what}: {}", list.join(", "));
        }
    }
}
