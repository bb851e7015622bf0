//! The body on the last link, from a recording with it and a model without it.
//!
//! `cargo run --release -p residyn --example payload`

use residyn::model::payload::{PayloadOptions, estimate};
use residyn::trials::protocols::payload::{LoadedArm, loaded};
use residyn::{FitOptions, fit_physics};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let made = loaded(LoadedArm::Ur5, true, 14)?;
    let fit = fit_physics(&made.robot, &[made.without], None, &FitOptions::basic())?;
    let found = estimate(&fit.file, &made.with, &PayloadOptions::default())?;
    let mass = found.body.mass.ok_or("this motion tells the mass")?;
    println!(
        "mass {:.3} ± {:.3} kg, in truth {:.3} kg",
        mass.value, mass.std, made.body.mass
    );
    for (name, com, truth) in
        [("x", 0), ("y", 1), ("z", 2)].map(|(n, i)| (n, found.body.com[i], made.body.com()[i]))
    {
        if let Some(com) = com {
            println!(
                "centre of mass, {name}: {:.4} ± {:.4} m, in truth {truth:.4} m",
                com.value, com.std
            );
        }
    }
    assert!((mass.value - made.body.mass).abs() < 0.05 * made.body.mass);
    Ok(())
}
