//! Contacts of four times the residual's RMS with the simulated robot of a model directory, and hours without any.
//!
//! usage: contacts MODEL_DIR [HOURS] (three by default); minutes on two cores.

use control::collision::{Plan, contacts};
use control::demonstration::{Withheld, limits, machine};
use control::model::DirectoryModel;
use control::track::{Mode, Settings};
use model::directory::ModelFile;
use report::{Cell, Column, Table, say, say_text};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let directory = PathBuf::from(
        arguments
            .next()
            .ok_or("usage: contacts MODEL_DIR [HOURS]")?,
    );
    let hours: f64 = arguments.next().map_or(Ok(3.0), |h| h.parse())?;
    let file = ModelFile::load(&directory)?;
    let robot = machine(&file, Withheld::Friction)?;
    let settings = Settings {
        step: 500e-6,
        cycle: 2,
        crossover_hz: 5.0,
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
        calibration: 60,
        contacts: 240,
        clean: (hours * 360.0).round() as usize,
        per_hour: 0.1,
        factor: 4.0,
        seed: 1,
        settings: settings.clone(),
    };
    let found = contacts(&robot, &limits(&robot), load, &plan)?;
    let mut table = Table::new([
        Column::text("joint"),
        Column::number("residual RMS / N·m"),
        Column::number("contact / N·m"),
        Column::number("threshold, torque error"),
        Column::text("found in 50 ms"),
        Column::number("threshold, momentum observer"),
        Column::text("found in 50 ms"),
    ]);
    let [error, observer] = &found.detectors;
    for (j, joint) in file.joints.iter().enumerate() {
        let told = |[found, all]: [usize; 2]| Cell::text(format!("{found} of {all}"));
        table.push([
            Cell::text(joint),
            Cell::significant(found.residual_rms[j], 3),
            Cell::significant(found.size[j], 3),
            Cell::significant(error.thresholds[j], 3),
            told(error.by_joint[j]),
            Cell::significant(observer.thresholds[j], 3),
            told(observer.by_joint[j]),
        ]);
    }
    say_text!(table.to_text());
    for detector in &found.detectors {
        say!(
            "{}: {:.1} % found within 50 ms, median {:.0} ms; {} alarms in {:.1} h without contact",
            detector.name,
            100.0 * detector.share(),
            1e3 * detector.latency,
            detector.false_alarms,
            found.clean_hours
        );
    }
    Ok(())
}
