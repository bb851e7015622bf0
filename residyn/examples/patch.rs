//! The corrected model of a simulator: URDF, values for MuJoCo and generated code for what no parameter holds.
//!
//! `cargo run --release -p residyn --example patch`

use residyn::trials::cases::{CaseSpec, Kind, effect_index, generate};
use residyn::{Job, Robot, Subject, write};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // A robot that carries a body which its URDF does not have; 2 is the seed.
    let spec = CaseSpec {
        index: 0,
        kind: Kind::Single(effect_index("payload").ok_or("payload is in the catalogue")?),
        hard: false,
        without: None,
        generator: 1,
    };
    let case = generate(&spec, 2)?;
    let folder = tempfile::tempdir()?;
    let [urdf, monday, friday] =
        ["robot.urdf", "monday.parquet", "friday.parquet"].map(|name| folder.path().join(name));
    std::fs::write(&urdf, &case.urdf)?;
    write(&case.train.select(&[0, 1, 2, 3]), &monday)?;
    write(&case.test.select(&[0, 1]), &friday)?;

    let job = Job {
        fast: true,
        ..Job::new(
            Subject::robot(urdf.display().to_string()),
            vec![monday],
            friday,
        )
    };
    let done = job.run(|_| ())?;
    let corrected = folder.path().join("corrected.urdf");
    for (path, text) in done.patch()?.files(&corrected)? {
        println!(
            "{}: {} lines",
            path.file_name().unwrap_or_default().display(),
            text.lines().count()
        );
        std::fs::write(path, text)?;
    }
    let mass = |robot: &Robot| robot.parameters()[10 * (robot.dof() - 1)];
    let (before, after) = (
        Robot::from_urdf_str(&case.urdf)?,
        Robot::from_urdf_file(&corrected)?,
    );
    let truth = &case.truth.effects[0].parameters;
    let carried = truth["mass"].as_f64().unwrap_or(f64::NAN);
    println!(
        "last link: {:.3} kg as given, {:.3} kg corrected; the robot carries {carried:.3} kg",
        mass(&before),
        mass(&after)
    );
    // How well the report says that it knows the mass: two deviations, 95 %.
    let causes = &done.outcome.diagnosis.causes;
    let parameters = causes.iter().flat_map(|c| &c.parameters);
    let mut deviations = parameters.filter(|p| p.name == "mass").map(|p| p.std);
    let deviation = deviations.next().flatten().ok_or("a payload is a cause")?;
    println!("its mass is known to {deviation:.3} kg");
    assert!((mass(&after) - mass(&before) - carried).abs() < 2.0 * deviation);
    Ok(())
}
