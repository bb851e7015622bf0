//! New numbers in the files.

use super::models::{State, departure, fixture, folder, model, read};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Changed, Description, Inertia, Mjcf, Robot};
use std::path::Path;

/// Lines that differ.
fn changed<'a>(old: &'a str, new: &'a str) -> Vec<(&'a str, &'a str)> {
    assert_eq!(old.lines().count(), new.lines().count());
    old.lines()
        .zip(new.lines())
        .filter(|(a, b)| a != b)
        .collect()
}

fn moved<'a>(robot: &'a Robot, zeros: &'a [f64]) -> Changed<'a> {
    Changed {
        zeros,
        ..Changed::of(robot)
    }
}

fn main_text(mjcf: &Mjcf, robot: &Robot, zeros: &[f64]) -> String {
    let edited = mjcf.with(&moved(robot, zeros)).unwrap();
    assert!(edited.left_out().is_empty());
    edited.files(Path::new("out.xml")).unwrap().swap_remove(0).1
}

#[test]
fn only_changed_attributes_differ() {
    let (mjcf, robot) = model("friction.xml", &[]);
    let text = std::fs::read_to_string(folder().join("friction.xml")).unwrap();
    assert_eq!(main_text(&mjcf, &robot, &[]), text);
    let damping: Vec<f64> = robot.joints().iter().map(|j| j.damping).collect();
    let friction = [6.0, 4.5, 0.7, 0.2];
    let new = robot.clone().with_friction(&damping, &friction).unwrap();
    let mut armature = robot.rotor_inertia();
    armature[2] = 0.25;
    let new = new.with_rotor_inertia(&armature).unwrap();
    let written = main_text(&mjcf, &new, &[]);
    let lines = changed(&text, &written);
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert_eq!(
        lines[0].1,
        lines[0]
            .0
            .replace("frictionloss=\"5\"", "frictionloss=\"4.5\"")
    );
    assert_eq!(lines[1].1.trim(), "<joint name=\"j3\" armature=\"0.25\"/>");
    let back = read(&written).unwrap();
    assert_eq!(back.joints()[2].rotor_inertia, 0.25);
    assert_eq!(back.joints()[1].friction, 4.5);
}

const SPRUNG: &str = r#"<mujoco><option><flag frictionloss="disable" gravity="disable"/></option><worldbody><body name="b">
<joint name="j" type="slide" axis="1 0 0" stiffness="10" springref="0.3"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
</body></worldbody></mujoco>"#;

/// A spring rests where it did when its joint's zero moves; what a flag switches off is said.
#[test]
fn springs_move_with_the_zero_and_flags_are_told() {
    let mjcf = Mjcf::from_text(SPRUNG, &[]).unwrap();
    let robot = mjcf.robot().unwrap();
    let back = read(&main_text(&mjcf, &robot, &[0.1])).unwrap();
    for q in [-0.4, 0.0, 0.7] {
        let apart = back.passive()[0].torque(q) - robot.passive()[0].torque(q + 0.1);
        assert!(apart.abs() < 1e-12, "{q}: {apart}");
    }
    let new = robot.clone().with_friction(&[0.0], &[1.2]).unwrap();
    let new = new.with_gravity([0.0, 0.0, -9.7].into());
    let edited = mjcf.with(&Changed::of(&new)).unwrap();
    let said = edited.left_out().join("; ");
    assert!(
        said.contains("frictionloss of joint j") && said.contains("gravity"),
        "{said}"
    );
}

/// Every model with other numbers is, read again, the robot with those numbers.
#[test]
fn what_is_written_is_read_again() {
    for case in fixture().cases {
        let (mjcf, robot) = model(&case.file, &case.chosen);
        let n = robot.dof();
        // A body on every link, so that what is written is possible; more friction; other gravity.
        let body = Inertia::from_com(
            0.3,
            nalgebra::Vector3::new(0.02, -0.01, 0.03),
            nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(0.01, 0.012, 0.009)),
        );
        let extra = body.parameters();
        let parameters: Vec<f64> = robot
            .parameters()
            .iter()
            .enumerate()
            .map(|(i, p)| p + extra[i % 10])
            .collect();
        let more = |x: fn(&physics::robot::Joint) -> f64| -> Vec<f64> {
            robot.joints().iter().map(|j| x(j) + 0.125).collect()
        };
        let new = robot
            .with_parameters(&parameters)
            .and_then(|r| r.with_friction(&more(|j| j.damping), &more(|j| j.friction)))
            .and_then(|r| r.with_rotor_inertia(&more(|j| j.rotor_inertia)))
            .unwrap()
            .with_gravity([0.1, 0.2, -9.7].into());
        let zeros: Vec<f64> = (0..n).map(|i| 0.05 * (i as f64 - 1.5)).collect();
        let edited = mjcf.with(&moved(&new, &zeros)).unwrap();
        assert!(edited.left_out().is_empty(), "{:?}", edited.left_out());
        // Beside the original, as a user would have it.
        let place = tempfile::tempdir().unwrap();
        copy(&folder(), place.path());
        for (path, text) in edited.files(&place.path().join("new.xml")).unwrap() {
            std::fs::write(path, text).unwrap();
        }
        let read = Description::load(&place.path().join("new.xml"), &case.chosen);
        let back = read
            .map(|(_, robot)| robot)
            .unwrap_or_else(|e| panic!("{e}"));
        for state in &case.states {
            let State { q, qd, qdd, .. } = state;
            let torque = |robot: &Robot, q: &[f64]| {
                let mut tau = vec![0.0; n];
                inverse_dynamics(robot, &mut Workspace::new(robot), q, qd, qdd, &mut tau);
                tau
            };
            let moved: Vec<f64> = q.iter().zip(&zeros).map(|(q, z)| q + z).collect();
            let d = departure(&torque(&back, q), &torque(&new, &moved));
            assert!(d < 1e-9, "{}: {d:.1e}", case.file);
        }
        let numbers = |r: &Robot| -> Vec<f64> {
            let joints = r.joints().iter();
            joints
                .flat_map(|j| [j.damping, j.friction, j.rotor_inertia])
                .collect()
        };
        let d = departure(&numbers(&back), &numbers(&new));
        assert!(d < 1e-12, "{}: {d:.1e}", case.file);
        assert_eq!(back.gravity(), new.gravity(), "{}", case.file);
    }
}

fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            std::fs::create_dir(&target).unwrap();
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// What included files hold is written beside the main one; what does not change is included from where it is.
#[test]
fn included_files_are_written_beside() {
    let (mjcf, robot) = model("scene.xml", &[]);
    let mut friction: Vec<f64> = robot.joints().iter().map(|j| j.friction).collect();
    friction[3] = 0.5;
    let damping: Vec<f64> = robot.joints().iter().map(|j| j.damping).collect();
    let new = robot.with_friction(&damping, &friction).unwrap();
    let edited = mjcf.with(&Changed::of(&new)).unwrap();
    let files = edited.files(Path::new("there/fixed.xml")).unwrap();
    let names: Vec<String> = files.iter().map(|(p, _)| p.display().to_string()).collect();
    assert_eq!(
        names,
        [
            "there/fixed.xml",
            "there/fixed.arm.xml",
            "there/fixed.wrist.xml"
        ]
    );
    let old = std::fs::read_to_string(folder().join("scene.xml")).unwrap();
    assert_eq!(
        changed(&old, &files[0].1),
        [(
            "  <include file=\"parts/arm.xml\"/>",
            "  <include file=\"fixed.arm.xml\"/>"
        )]
    );
    assert!(files[2].1.contains("frictionloss=\"0.5\""));
}
