//! MJCF: equality with MuJoCo on the values of `fixtures/mjcf.py`, what is said and refused, and new numbers in the files.

use physics::dynamics::{
    Workspace, forward_dynamics, inverse_dynamics, mass_matrix, potential_energy, regressor,
};
use physics::robot::{Description, Inertia, JointKind, Mjcf, Passive, Robot, RobotError};
use serde::Deserialize;
use std::path::{Path, PathBuf};

#[derive(Deserialize)]
struct Fixture {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    file: String,
    chosen: Vec<String>,
    joints: Vec<String>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    tau: Vec<f64>,
    mass: Vec<f64>,
}

fn fixture() -> Fixture {
    serde_json::from_str(include_str!("fixtures/mjcf.json")).expect("the fixture is valid")
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/mjcf")
}

fn model(file: &str, joints: &[String]) -> (Mjcf, Robot) {
    match Description::load(&folder().join(file), joints) {
        Ok((Description::Mjcf(mjcf), robot)) => (mjcf, robot),
        Ok(_) => panic!("{file} is an MJCF"),
        Err(e) => panic!("{e}"),
    }
}

/// Largest departure, relative to the largest value.
fn departure(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let scale = theirs.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    let pairs = ours.iter().zip(theirs);
    pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs() / scale))
}

/// What the robot as given predicts, from a rigid torque.
fn with_drives(robot: &Robot, state: &State, rigid: &[f64]) -> Vec<f64> {
    let mut tau = rigid.to_vec();
    for (j, joint) in robot.joints().iter().enumerate() {
        tau[j] += joint.rotor_inertia * state.qdd[j]
            + joint.damping * state.qd[j]
            + joint.friction * state.qd[j].signum();
    }
    for p in robot.passive() {
        tau[p.joint()] += p.torque(state.q[p.joint()]);
    }
    tau
}

#[test]
fn values_equal_mujoco() {
    let cases = fixture().cases;
    assert!(cases.len() >= 16);
    for case in &cases {
        let (_, robot) = model(&case.file, &case.chosen);
        assert_eq!(robot.joint_names(), case.joints, "{}", case.file);
        let n = robot.dof();
        let mut workspace = Workspace::new(&robot);
        let parameters = robot.parameters();
        for state in &case.states {
            let State { q, qd, qdd, .. } = state;
            let close = |what: &str, ours: &[f64], theirs: &[f64]| {
                let d = departure(ours, theirs);
                assert!(d < 1e-9, "{}: {what} departs by {d:.1e}", case.file);
            };
            let mut rigid = vec![0.0; n];
            inverse_dynamics(&robot, &mut workspace, q, qd, qdd, &mut rigid);
            close("torque", &with_drives(&robot, state, &rigid), &state.tau);

            let mut y = vec![0.0; n * 10 * n];
            regressor(&robot, &mut workspace, q, qd, qdd, &mut y);
            let product: Vec<f64> = y
                .chunks(10 * n)
                .map(|row| row.iter().zip(&parameters).map(|(y, p)| y * p).sum())
                .collect();
            close(
                "regressor",
                &with_drives(&robot, state, &product),
                &state.tau,
            );

            let mut mass = vec![0.0; n * n];
            mass_matrix(&robot, &mut workspace, q, &mut mass);
            for (j, inertia) in robot.rotor_inertia().iter().enumerate() {
                mass[j * n + j] += inertia;
            }
            close("mass matrix", &mass, &state.mass);

            let mut back = vec![0.0; n];
            forward_dynamics(&robot, &mut workspace, q, qd, &rigid, &[], &mut back);
            close("acceleration", &back, qdd);
        }
    }
}

/// The energy of the weight that nothing holds has the torque at rest as its slope.
#[test]
fn compensated_weight_is_no_energy() {
    let (_, robot) = model("springs.xml", &[]);
    let n = robot.dof();
    let (q, still) = ([0.4, -0.7, 0.9, 0.2], vec![0.0; n]);
    let mut tau = vec![0.0; n];
    let mut workspace = Workspace::new(&robot);
    inverse_dynamics(&robot, &mut workspace, &q, &still, &still, &mut tau);
    let step = 1e-5;
    for j in 0..n {
        let energy = |d: f64| {
            let mut at = q;
            at[j] += d;
            potential_energy(&robot, &at)
        };
        let slope = (energy(step) - energy(-step)) / (2.0 * step);
        assert!((slope - tau[j]).abs() < 1e-6, "{j}: {slope} {}", tau[j]);
    }
}

/// A hinge with everything that a test wants to add.
fn pendulum(compiler: &str, body: &str, after: &str) -> String {
    format!(
        "<mujoco><compiler angle=\"radian\"/>{compiler}<worldbody><body name=\"link\">\
         <inertial pos=\"0.1 0 0\" mass=\"1\" diaginertia=\"0.01 0.01 0.01\"/>\
         <joint name=\"hinge\" axis=\"0 1 0\"/>{body}</body></worldbody>{after}</mujoco>"
    )
}

fn read(text: &str) -> Result<Robot, RobotError> {
    Mjcf::from_text(text, &[])?.robot()
}

#[test]
fn joints_limits_and_drives_are_read() {
    let (_, robot) = model("scara.xml", &[]);
    let kinds: Vec<JointKind> = robot.joints().iter().map(|j| j.kind).collect();
    use JointKind::{Continuous, Prismatic, Revolute};
    assert_eq!(kinds, [Revolute, Revolute, Prismatic, Continuous]);
    let joints = robot.joints();
    assert!((joints[0].limits.upper - 150_f64.to_radians()).abs() < 1e-15);
    assert_eq!(joints[2].limits.upper, 0.2);
    assert_eq!((joints[0].damping, joints[2].rotor_inertia), (0.5, 3.0));
    let (_, robot) = model("seven_axis.xml", &[]);
    let effort: Vec<f64> = robot.joints().iter().map(|j| j.limits.effort).collect();
    assert_eq!(effort, [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0]);
    let (_, robot) = model("springs.xml", &[]);
    let springs: Vec<usize> = robot.passive().iter().map(Passive::joint).collect();
    assert_eq!(springs, [1, 2, 3]);
    assert_eq!(robot.gravity_compensation()[0], 1.0);
}

/// Nothing is left out without a word.
#[test]
fn what_is_not_chosen_is_said() {
    let notes = |file: &str, chosen: &[&str]| {
        let chosen: Vec<String> = chosen.iter().map(|s| (*s).to_owned()).collect();
        model(file, &chosen).1.notes().join("\n")
    };
    assert_eq!(notes("six_axis.xml", &[]), "");
    let hand = notes("seven_axis.xml", &[]);
    assert!(
        hand.contains("fixed at their reference position: finger_joint1, finger_joint2"),
        "{hand}"
    );
    let free = notes("free_base.xml", &[]);
    assert!(free.contains("reference position: float"), "{free}");
    assert!(
        free.contains("no part of the chosen chain: wheel"),
        "{free}"
    );
    let two = notes("two_arms.xml", &["left_1", "left_2"]);
    assert!(two.contains("reference position: left_3"), "{two}");
    assert!(two.contains("right_1"), "{two}");
    let medium = read(&pendulum("<option density=\"1.2\"/>", "", "")).unwrap();
    assert!(medium.notes()[0].contains("medium"), "{:?}", medium.notes());
    let held = pendulum(
        "",
        "<body name=\"lid\" gravcomp=\"1\"><geom size=\"0.1\"/></body>",
        "",
    );
    let held = read(&held).unwrap();
    assert!(
        held.notes()[0].contains("gravcomp (body"),
        "{:?}",
        held.notes()
    );
}

#[test]
fn flags_switch_forces_off() {
    let flags = |flag: &str| {
        let joint = "<default><joint stiffness=\"3\" damping=\"2\" frictionloss=\"1\"/></default>";
        let option = format!("<option><flag {flag}=\"disable\"/></option>");
        read(&pendulum(&format!("{joint}{option}"), "", "")).unwrap()
    };
    let joint = |r: &Robot| {
        (
            r.joints()[0].damping,
            r.joints()[0].friction,
            r.passive().len(),
        )
    };
    assert_eq!(joint(&flags("contact")), (2.0, 1.0, 1));
    assert_eq!(joint(&flags("damper")), (0.0, 1.0, 1));
    assert_eq!(joint(&flags("spring")), (2.0, 1.0, 0));
    assert_eq!(joint(&flags("frictionloss")), (2.0, 0.0, 1));
    assert_eq!(flags("gravity").gravity().norm(), 0.0);
}

#[test]
fn refusals_name_the_element_and_what_to_do() {
    let second = "<body name=\"next\"><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/><joint name=\"other\"/></body>";
    let with = |after: &str| pendulum("", second, after);
    for (text, expected) in [
        (
            with("<equality><joint name=\"tie\" joint1=\"hinge\"/></equality>"),
            "equality constraint \"tie\" acts on joint \"hinge\"",
        ),
        (
            with("<equality><weld body1=\"next\"/></equality>"),
            "ties body \"next\" to body \"world\"",
        ),
        (
            with(
                "<tendon><fixed name=\"cord\"><joint joint=\"hinge\" coef=\"1\"/></fixed></tendon>",
            ),
            "tendon \"cord\" acts on joint \"hinge\"",
        ),
        (
            pendulum("", "<composite type=\"cable\"/>", ""),
            "body \"link\" holds <composite>",
        ),
        (
            pendulum(
                "",
                "<body name=\"tool\"><geom name=\"drill\" type=\"mesh\" mesh=\"drill\"/></body>",
                "",
            ),
            "geom \"drill\" of body \"tool\" is a mesh",
        ),
        (
            pendulum("", "<joint name=\"second\" axis=\"1 0 0\"/>", ""),
            "move the same body \"link\"",
        ),
        (
            pendulum("<compiler settotalmass=\"3\"/>", "", ""),
            "settotalmass",
        ),
        (
            pendulum("<compiler coordinate=\"global\"/>", "", ""),
            "only local coordinates",
        ),
        (
            pendulum("", "<geom class=\"nowhere\" size=\"1\"/>", ""),
            "class \"nowhere\"",
        ),
        (
            pendulum("", "<body euler=\"1 2\"/>", ""),
            "it needs 3 numbers",
        ),
        (
            pendulum("", "<body quat=\"nan 0 0 0\"/>", ""),
            "finite numbers are needed",
        ),
        (
            pendulum("", "<body name=\"link\"/>", ""),
            "two bodies are called \"link\"",
        ),
        (
            "<mujoco><include file=\"arm.xml\"/></mujoco>".to_owned(),
            "includes \"arm.xml\"",
        ),
        (
            "<mujocoinclude/>".to_owned(),
            "outermost element is <mujocoinclude>",
        ),
        (
            "<mujoco><worldbody/></mujoco>".to_owned(),
            "no moving joint",
        ),
        ("<mujoco>".to_owned(), "cannot be parsed"),
        (
            "<mujoco><worldbody><body><joint name=\"j\"/></body></worldbody></mujoco>".to_owned(),
            "has no mass",
        ),
    ] {
        let error = read(&text).map(|_| ()).expect_err(&text).to_string();
        assert!(error.contains(expected), "{error}");
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn choices_that_make_no_chain_are_refused() {
    let choose = |file: &str, joints: &str| -> String {
        let joints: Vec<String> = joints
            .split(',')
            .filter(|j| !j.is_empty())
            .map(str::to_owned)
            .collect();
        let read = Description::load(&folder().join(file), &joints);
        read.map(|_| ()).expect_err(file).to_string()
    };
    let all = choose("two_arms.xml", "");
    assert!(
        all.contains("begin at left_1, right_1") && all.contains("--joints"),
        "{all}"
    );
    let both = choose("two_arms.xml", "left_1,right_1");
    assert!(both.contains("do not lie on one chain"), "{both}");
    let order = choose("two_arms.xml", "left_2,left_1");
    assert!(order.contains("give --joints left_1,left_2"), "{order}");
    let none = choose("two_arms.xml", "left_9");
    assert!(
        none.contains("no joint \"left_9\"") && none.contains("left_3"),
        "{none}"
    );
    let float = choose("free_base.xml", "float");
    assert!(float.contains("ball or free"), "{float}");
    let tied = choose("gripper.xml", "left,left_tip");
    assert!(tied.contains("tendon \"belt\" ties body"), "{tied}");
    let urdf = tempfile::tempdir().unwrap();
    let urdf = urdf.path().join("arm.urdf");
    std::fs::write(
        &urdf,
        physics::robot::to_urdf(&Robot::builtin("ur5").unwrap()),
    )
    .unwrap();
    let error = Description::load(&urdf, &["elbow_joint".to_owned()]);
    let error = error.map(|_| ()).expect_err("a URDF").to_string();
    assert!(error.contains("leave --joints out"), "{error}");
}

/// Included files are looked for beside the main one; missing and repeated ones are named.
#[test]
fn includes_are_followed() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name);
    let load = || Description::load(&path("scene.xml"), &[]).map(|(_, robot)| robot);
    std::fs::write(
        path("scene.xml"),
        "<mujoco><include file=\"arm.xml\"/></mujoco>",
    )
    .unwrap();
    let missing = load().expect_err("a file is missing").to_string();
    assert!(
        missing.contains("arm.xml") && missing.contains("scene.xml"),
        "{missing}"
    );
    std::fs::write(path("arm.xml"), pendulum("", "", "")).unwrap();
    assert_eq!(load().expect("a robot").joint_names(), ["hinge"]);
    std::fs::write(
        path("arm.xml"),
        "<mujoco><include file=\"arm.xml\"/></mujoco>",
    )
    .unwrap();
    let twice = load().expect_err("it includes itself").to_string();
    assert!(twice.contains("included twice"), "{twice}");
}

/// Lines that differ.
fn changed<'a>(old: &'a str, new: &'a str) -> Vec<(&'a str, &'a str)> {
    assert_eq!(old.lines().count(), new.lines().count());
    old.lines()
        .zip(new.lines())
        .filter(|(a, b)| a != b)
        .collect()
}

fn main_text(mjcf: &Mjcf, robot: &Robot, zeros: &[f64]) -> String {
    let edited = mjcf.with(robot, zeros).unwrap();
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
        let edited = mjcf.with(&new, &zeros).unwrap();
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
    let edited = mjcf.with(&new, &[]).unwrap();
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
