//! Any text as a drive file: an error or conversions of every joint, never a panic.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run drive`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use physics::robot::{Builtin, drive::Drive};

fuzz_target!(|text: &str| {
    let robot = Builtin::Ur5.robot();
    if let Ok(drive) = Drive::from_toml(text, &robot) {
        let torque = drive.torque_conversion(&robot).expect("checked when read");
        assert_eq!(torque.len(), robot.dof());
        assert_eq!(drive.position_conversion(&robot).len(), robot.dof());
        drive.apply(robot).expect("checked when read");
    }
});
