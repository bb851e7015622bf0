//! What torque can tell of an arm at all: its base parameters, and what they are made of.
//!
//! `cargo run --release -p residyn --example base_parameters`

use residyn::identify::base::{BaseParameters, Extra};
use residyn::{Robot, RobotError};

fn main() -> Result<(), RobotError> {
    let (robot, _) = Robot::load("ur5", &[])?;
    let extras = [Extra::Viscous, Extra::Coulomb];
    let base = BaseParameters::of_robot(&robot, &extras);
    println!(
        "{}: {} of {} parameters can be told; {} act on no torque",
        robot.name(),
        base.len(),
        base.names().len(),
        base.unidentifiable().len()
    );
    for formula in base.formulae().iter().take(6) {
        println!("  {formula}");
    }
    // 36 of the rigid body, two of friction for each joint, as the UR5's paper has it.
    assert_eq!(base.len(), 48);
    Ok(())
}
