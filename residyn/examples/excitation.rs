//! A periodic motion within an arm's limits from which its parameters can be told well.
//!
//! `cargo run --release -p residyn --example excitation`

use residyn::Robot;
use residyn::identify::base::{BaseParameters, Extra};
use residyn::identify::excitation::{
    BaseRows, Bounds, Criterion, Excitation, Goal, MotionLimits, Room, SearchOptions, optimise,
};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (robot, _) = Robot::load("ur5", &[])?;
    let extras = [Extra::Viscous, Extra::Coulomb];
    let base = BaseParameters::of_robot(&robot, &extras);
    let limits: Vec<MotionLimits> = MotionLimits::of_robot(&robot)
        .into_iter()
        .map(|limit| MotionLimits {
            // Descriptions know no acceleration: full speed within half a second.
            acceleration: 2.0 * limit.velocity,
            ..limit.share(0.8)
        })
        .collect();
    // Noise of each joint's torque: a hundredth of what it can give.
    let noise = robot.joints().iter().map(|j| 0.01 * j.limits.effort);
    let rows = BaseRows::new(&robot, &base, &extras);
    let goal = Excitation::new(rows, Criterion::Condition, noise.collect(), 100)?;
    let room = Room::new(Bounds::of(limits.clone()), 12.5, &[1, 2, 3, 4, 5], 1)?;
    let options = SearchOptions {
        starts: 10,
        evaluations: 200,
        seed: 1,
    };
    let found = optimise(&room, &options, |motion| goal.cost(motion))?;
    println!(
        "condition number {:.0} at first, {:.0} after {} motions",
        found.start_cost, found.cost, found.evaluations
    );

    let motion = found.trajectory.sampled(100.0, 1, 0.0);
    for (j, limit) in limits.iter().enumerate() {
        let fastest = motion
            .qd
            .column(j)
            .iter()
            .fold(0.0_f64, |m, v| m.max(v.abs()));
        println!(
            "{}: up to {fastest:.2} of {:.2} rad/s",
            robot.joints()[j].name,
            limit.velocity
        );
        assert!(fastest <= limit.velocity);
    }
    assert!(found.cost < found.start_cost);
    Ok(())
}
