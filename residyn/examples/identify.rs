//! Parameters of an arm from a recording, with their deviations.
//!
//! `cargo run --release -p residyn --example identify`

use residyn::trials::protocols::payload::{LoadedArm, loaded};
use residyn::{Fit, FitOptions, fit_physics};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // A simulated UR5 with friction, ripple, soft gears and noise: four excitations of 25 s.
    let made = loaded(LoadedArm::Ur5, false, 11)?;
    let (train, test) = made.without.split(&[3]);
    let fit = fit_physics(&made.robot, &[train], Some(&test), &FitOptions::default())?;

    println!("parameter                      identified  deviation  as described");
    for p in fit.file.base_parameters.iter().take(8) {
        println!(
            "{:<30} {:10.4} {:10.4} {:13.4}  {}",
            p.name, p.value, p.std, p.nominal, p.unit
        );
    }
    // On the trajectory that was left out: a rigid body with viscous and Coulomb friction has to beat the linear model of the KR300
    // benchmark, and terms chosen from the dictionary have to beat that.
    let (train, test) = made.without.split(&[3]);
    let basic = fit_physics(&made.robot, &[train], Some(&test), &FitOptions::basic())?;
    let scores = |fit: &Fit, name: &str| -> Result<f64, Box<dyn Error>> {
        let rows = fit.rows(1, &test)?;
        // Over all samples, which come first.
        let row = rows.iter().find(|r| r.name == name);
        let nrmse = row.and_then(|r| r.scores.mean_nrmse);
        nrmse.ok_or_else(|| format!("{name} is not scored").into())
    };
    let (linear, plain, chosen) = (
        scores(&fit, "linear_baseline")?,
        scores(&basic, "physics")?,
        scores(&fit, "physics")?,
    );
    println!("mean NRMSE: linear {linear:.4}, basic terms {plain:.4}, chosen terms {chosen:.4}");
    assert!(chosen < plain && plain < linear);
    Ok(())
}
