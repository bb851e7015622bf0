//! Parameters of an arm from a recording, with their deviations.
//!
//! `cargo run --release -p residyn --example identify`

use residyn::trials::protocols::payload::{LoadedArm, loaded};
use residyn::{FitOptions, fit_physics};
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
    // On the trajectory that was left out, beside the linear model of the KR300 benchmark.
    let mut linear = f64::INFINITY;
    for row in fit.rows(1, &test)? {
        let nrmse = row.scores.mean_nrmse.unwrap_or(f64::NAN);
        println!("{:<16} {:?}: mean NRMSE {nrmse:.4}", row.name, row.scope);
        match row.name.as_str() {
            "linear_baseline" => linear = nrmse,
            "physics" => assert!(nrmse < 0.1 * linear),
            _ => {}
        }
    }
    Ok(())
}
