//! A stored model in a control loop: torque for the next sample, without allocation, with its memory of the motion.
//!
//! `cargo run --release -p residyn --example feedforward`

use residyn::trials::protocols::payload::{LoadedArm, loaded};
use residyn::{Feedforward, FitOptions, fit_physics};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let made = loaded(LoadedArm::Ur5, true, 12)?;
    let fit = fit_physics(&made.robot, &[made.without], None, &FitOptions::basic())?;
    let folder = tempfile::tempdir()?;
    fit.file.save(folder.path())?;

    let period = 0.001;
    let mut model = Feedforward::load(folder.path(), Some(period))?;
    let mut tau = vec![0.0; model.dof()];
    // No motion before this one: its memory is neutral.
    model.reset(None);
    for cycle in 0..3000 {
        // A swing that begins at rest: q = a (1 − cos ωt).
        let (t, a, w) = (f64::from(cycle) * period, 0.4, 2.0);
        let (sin, cos) = f64::sin_cos(w * t);
        let (q, qd, qdd) = ([a * (1.0 - cos); 6], [a * w * sin; 6], [a * w * w * cos; 6]);
        model.torque(&q, &qd, &qdd, &mut tau);
        if cycle % 500 == 0 {
            println!("{t:5.2} s  {tau:8.2?} N·m");
        }
        assert!(tau.iter().all(|t| t.is_finite()));
    }
    Ok(())
}
