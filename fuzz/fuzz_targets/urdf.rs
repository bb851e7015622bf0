//! Any text as a URDF: an error or a robot whose dynamics can be evaluated, never a panic.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run urdf`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Robot, to_urdf, urdf_with};

fuzz_target!(|text: &str| {
    let Ok(robot) = Robot::from_urdf_str(text) else {
        return;
    };
    let n = robot.dof();
    let (rest, mut tau) = (vec![0.0; n], vec![0.0; n]);
    inverse_dynamics(
        &robot,
        &mut Workspace::new(&robot),
        &rest,
        &rest,
        &rest,
        &mut tau,
    );
    Robot::from_urdf_str(&to_urdf(&robot)).expect("what is written can be read");
    let _ = urdf_with(text, &robot);
});
