//! Any text as an MJCF: an error or a robot whose dynamics can be evaluated and whose numbers can be written back, never a
//! panic. Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run mjcf`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Changed, Mjcf, Robot, to_urdf};
use std::path::Path;

fuzz_target!(|text: &str| {
    let Ok(mjcf) = Mjcf::from_text(text, &[]) else {
        return;
    };
    let Ok(robot) = mjcf.robot() else {
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
    // A model directory stores the robot as a URDF.
    Robot::from_urdf_str(&to_urdf(&robot)).expect("what is written can be read");
    let more: Vec<f64> = robot.joints().iter().map(|j| j.damping + 1.0).collect();
    let friction: Vec<f64> = robot.joints().iter().map(|j| j.friction).collect();
    let doubled: Vec<f64> = robot.parameters().iter().map(|p| 2.0 * p).collect();
    let Ok(new) = robot.with_friction(&more, &friction) else {
        return;
    };
    let Ok(new) = new.with_parameters(&doubled) else {
        return;
    };
    if let Ok(edited) = mjcf.with(&Changed { zeros: &vec![0.1; n], ..Changed::of(&new) }) {
        let files = edited.files(Path::new("out.xml")).expect("one file");
        // The numbers of a robot at the edge of what is one may go over it; what is written is still XML.
        let written = Mjcf::from_text(&files[0].1, &[]);
        written.expect("what is written can be parsed");
    }
});
