//! What a simulator gets wrong about a robot, from two recordings of it.
//!
//! `cargo run --release -p residyn --example diagnose`

use residyn::diagnose::words;
use residyn::trials::cases::{CaseSpec, Kind, effect_index, generate};
use residyn::{Job, Subject, write};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // A robot whose joint has torque ripple that its URDF does not have; 1 is the seed.
    let spec = CaseSpec {
        index: 0,
        kind: Kind::Single(effect_index("torque_ripple").ok_or("ripple is in the catalogue")?),
        hard: false,
        without: None,
        generator: 1,
    };
    let case = generate(&spec, 1)?;
    let folder = tempfile::tempdir()?;
    let [urdf, monday, friday] =
        ["robot.urdf", "monday.parquet", "friday.parquet"].map(|name| folder.path().join(name));
    std::fs::write(&urdf, &case.urdf)?;
    write(&case.train.select(&[0, 1, 2, 3]), &monday)?;
    write(&case.test.select(&[0, 1]), &friday)?;

    let job = Job {
        fast: true, // no surrogates: no p-values, seconds instead of a minute
        ..Job::new(
            Subject::robot(urdf.display().to_string()),
            vec![monday],
            friday,
        )
    };
    let done = job.run(|_| ())?;
    for line in words::lines(&done.outcome.diagnosis) {
        println!("{line}");
    }
    let first = &done.outcome.diagnosis.causes[0];
    assert_eq!(first.effect.name(), "torque_ripple");
    Ok(())
}
