//! A recording made of tables, written, read again, and checked before anything is fitted to it.
//!
//! `cargo run --release -p residyn --example recordings`; writes into the folder for temporary files.

use ndarray::Array2;
use residyn::datasets::PrepareOptions;
use residyn::model::preparation::check::check_recording;
use residyn::{ReadOptions, Recording, Robot, Trajectory, read, write};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (robot, _) = Robot::load("ur5", &[])?;
    // Two trajectories of ten seconds at 100 Hz; the torque of the fourth joint was not wired up.
    let (rows, rate) = (1000, 100.0);
    let time: Vec<f64> = (0..2 * rows)
        .map(|i| i as f64 / rate + if i < rows { 0.0 } else { 5.0 })
        .collect();
    let q = Array2::from_shape_fn((2 * rows, 6), |(i, j)| {
        0.6 * ((0.7 + 0.2 * j as f64) * time[i]).sin() + 0.2 * (3.1 * time[i] + j as f64).cos()
    });
    let mut tau = q.mapv(|q| 20.0 * (1.3 * q).sin());
    tau.column_mut(3).fill(0.0);
    let part = |label: &str, range| Trajectory {
        label: label.to_owned(),
        range,
    };
    let recording = Recording {
        trajectories: vec![part("morning", 0..rows), part("noon", rows..2 * rows)],
        ..Recording::new("tables", time, q, Some(tau))
    };

    let folder = tempfile::tempdir()?;
    for name in ["run.csv", "run.parquet"] {
        let path = folder.path().join(name);
        write(&recording, &path)?;
        let back = read(&path, &ReadOptions::for_robot(6))?;
        println!(
            "{name}: {} samples in {} trajectories",
            back.len(),
            back.trajectories.len()
        );
        assert_eq!((&back.q, back.trajectories.len()), (&recording.q, 2));
    }

    let report = check_recording(&robot, &recording, &PrepareOptions::default())?;
    for finding in &report.findings {
        println!("{}", finding.message);
    }
    assert!(
        report
            .findings
            .iter()
            .any(|f| f.message.contains("wrist_1_joint"))
    );
    Ok(())
}
