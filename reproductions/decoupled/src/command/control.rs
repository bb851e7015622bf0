//! `decoupled control`.

use super::axis;
use crate::DecoupledError;
use crate::comau::{axes, columns};
use crate::estimators::{Estimator, MaximumLikelihood};
use crate::reference::Reference;
use crate::simulation::{Setup, simulate};
use crate::study::{SECONDS, excitation};
use crate::validation::{track, validate};
use report::{Cell, Column, Table, say, say_text};

/// Which axes.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Axis of the simulated COMAU Smart-3 S2, from 1 [default: all].
    #[arg(long)]
    axis: Option<usize>,
    /// Seed of excitation and noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Identifies by maximum likelihood, validates, tracks, prints.
pub fn run(arguments: &Arguments) -> Result<(), DecoupledError> {
    let wanted: Vec<usize> = match arguments.axis {
        Some(number) => vec![number],
        None => (1..=axes().len()).collect(),
    };
    let setup = Setup::default();
    let mut judged = Table::new([
        Column::text("axis"),
        Column::number("largest position error / °"),
        Column::number("RMS torque error / N·m"),
        Column::number("of a perfect model / N·m"),
        Column::number("skewness, kurtosis of position error"),
        Column::number("of torque error"),
    ]);
    let mut tracked = Table::new([
        Column::text("axis"),
        Column::text("controller"),
        Column::number("RMS / mrad"),
        Column::number("peak / mrad"),
        Column::number("peak at reversals / mrad"),
    ]);
    for number in wanted {
        let joint = axis(number)?;
        let columns = columns(&joint);
        let (series, _) = excitation(columns, arguments.seed ^ number as u64)?;
        let reference = Reference::Periodic(series);
        let run = simulate(&joint, &reference, SECONDS, &setup, None, arguments.seed).run;
        let found = MaximumLikelihood.estimate(&run, columns, &|_| 0.0)?;
        let model = columns.joint(&found.parameters);
        let v = validate(&joint, &model, &setup, arguments.seed ^ 0x5eed);
        let shape =
            |[skewness, kurtosis]: [f64; 2]| Cell::text(format!("{skewness:.2}, {kurtosis:.2}"));
        judged.push([
            Cell::text(number.to_string()),
            Cell::number(v.position.to_degrees(), 4),
            Cell::significant(v.torque, 3),
            Cell::significant(v.noise, 3),
            shape(v.shape[0]),
            shape(v.shape[1]),
        ]);
        let both = track(&joint, &model, &setup, arguments.seed ^ 0x5eed);
        for (name, t) in ["PID", "PID + model"].into_iter().zip(both) {
            tracked.push([
                Cell::text(number.to_string()),
                Cell::text(name),
                Cell::significant(1e3 * t.rms, 3),
                Cell::significant(1e3 * t.peak, 3),
                Cell::significant(1e3 * t.reversal, 3),
            ]);
        }
    }
    say!("The identified joint beside the recorded one on trapezoids, under the same controller\n");
    say_text!(judged.to_text());
    say!("\nTracking errors on the same trapezoids, true position\n");
    say_text!(tracked.to_text());
    Ok(())
}
