//! Contacts of four times the residual's RMS with the simulated robot of a model directory, and hours without any.
//!
//! usage: contacts MODEL_DIR [HOURS [SEED [PER_HOUR]]] (three hours, seed 1, 0.1 false alarms per hour); six minutes of computing.

use control::collision::{Plan, Regime, contacts};
use control::demonstration::{Withheld, limits, machine};
use control::model::DirectoryModel;
use control::track::{Mode, Settings};
use model::directory::ModelFile;
use report::{Cell, Column, Table, say, say_text};
use signal::proportion::interval;
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let directory = PathBuf::from(
        arguments
            .next()
            .ok_or("usage: contacts MODEL_DIR [HOURS [SEED [PER_HOUR]]]")?,
    );
    let hours: f64 = arguments.next().map_or(Ok(3.0), |h| h.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |s| s.parse())?;
    let per_hour: f64 = arguments.next().map_or(Ok(0.1), |r| r.parse())?;
    let file = ModelFile::load(&directory)?;
    let robot = machine(&file, Withheld::Friction)?;
    let settings = Settings {
        step: 500e-6,
        cycle: 2,
        crossover_hz: 5.0,
        // Until the integrals carry the load and the teeth of the gears stand still.
        hold: 3.0,
        after: 0.0,
        ..Settings::default()
    };
    let load = || DirectoryModel::load(&directory, &file, settings.period());
    let plan = Plan {
        time: load()?.start().unwrap_or(0.0),
        mode: if file.compensator.is_some() {
            Mode::Compensated
        } else {
            Mode::Physics
        },
        // Three hours.
        calibration: 1080,
        contacts: 480,
        clean: (hours * 360.0).round() as usize,
        per_hour,
        factor: 4.0,
        seed,
        settings: settings.clone(),
    };
    let found = contacts(&robot, &limits(&robot), load, &plan)?;
    let mut columns = vec![
        Column::text("joint"),
        Column::number("residual RMS / N·m"),
        Column::number("contact / N·m"),
    ];
    for detector in &found.detectors {
        let name = detector.name.replace('_', " ");
        columns.push(Column::text(format!("thresholds, {name}")));
        columns.push(Column::text("found in 50 ms"));
    }
    let mut table = Table::new(columns);
    for (j, joint) in file.joints.iter().enumerate() {
        let mut row = vec![
            Cell::text(joint),
            Cell::significant(found.residual_rms[j], 3),
            Cell::significant(found.size[j], 3),
        ];
        for detector in &found.detectors {
            let [within, all] = detector.by_joint[j];
            let limits =
                Regime::ALL.map(|regime| format!("{:.2}", detector.thresholds[j].of(regime)));
            row.push(Cell::text(limits.join(" / ")));
            row.push(Cell::text(format!("{within} of {all}")));
        }
        table.push(row);
    }
    say_text!(table.to_text());
    // Half seconds with an alarm of all of them.
    let blocks = (7200.0 * found.clean_hours) as usize;
    for detector in &found.detectors {
        let [within, all] = detector.count();
        let [low, high] = interval(within, all, 0.05).map(|p| 100.0 * p);
        let rate = interval(detector.false_alarms.min(blocks), blocks, 0.05).map(|p| 7200.0 * p);
        say!(
            "{}: {within} of {all} = {:.1} % [{low:.1}, {high:.1}] found within 50 ms, median {:.0} ms; {} alarms in {:.1} h without \
             contact, [{:.2}, {:.2}] an hour",
            detector.name,
            100.0 * detector.share(),
            1e3 * detector.latency,
            detector.false_alarms,
            found.clean_hours,
            rate[0],
            rate[1],
        );
    }
    Ok(())
}
