//! One number against many: a torque that is scaled on two joints is a gain, links whose inertials stand in a wrong frame
//! are links.

use crate::shared;
use datasets::{ReadOptions, Recording, read};
use diagnose::Effect;
use diagnose::NominalModel;
use diagnose::schema::Cause;
use diagnose::{Options, Outcome, diagnose};
use nalgebra::{Rotation3, Vector3};
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use trials::cases::{Case, CaseSpec, Kind, generate};

fn clean(index: u64, seed: u64) -> Case {
    let spec = CaseSpec {
        index,
        kind: Kind::None,
        hard: false,
        without: None,
        generator: 1,
    };
    generate(&spec, seed).unwrap()
}

fn outcome(robot: Robot, train: &Recording, test: &Recording) -> Outcome {
    let model = NominalModel::new(robot);
    diagnose(&model, train, test, &Options::default()).unwrap()
}

fn named(outcome: &Outcome) -> Vec<(Effect, Vec<String>)> {
    let causes = &outcome.diagnosis.causes;
    let one = |c: &Cause| (c.effect, c.joints.clone());
    causes.iter().map(one).collect()
}

/// The robot with the frame of some links' inertials turned by a right angle about an axis, centre of mass and inertia.
fn turned(robot: &Robot, links: &[usize], axis: Vector3<f64>) -> Robot {
    let by = *Rotation3::new(axis * std::f64::consts::FRAC_PI_2).matrix();
    let mut parameters = robot.parameters();
    for &l in links {
        let inertia = robot.joints()[l]
            .link
            .inertia
            .transformed(&by, &Vector3::zeros());
        let at = PARAMETERS_PER_LINK * l;
        parameters[at..at + PARAMETERS_PER_LINK].copy_from_slice(&inertia.parameters());
    }
    robot.with_parameters(&parameters).unwrap()
}

/// The links' inertials are named with the joints that they load, and no single number instead.
#[track_caller]
fn links_are_named(outcome: &Outcome, links: &[usize]) {
    let causes = &outcome.diagnosis.causes;
    println!("{:?}", named(outcome));
    let few = [
        Effect::EncoderOffset,
        Effect::Payload,
        Effect::BaseTilt,
        Effect::TorqueGain,
        Effect::Counterbalance,
        Effect::RotorInertia,
    ];
    assert!(
        causes.iter().all(|c| !few.contains(&c.effect)),
        "{causes:?}"
    );
    let entry = causes.iter().find(|c| c.effect == Effect::LinkParameters);
    let entry = entry.expect("the links are named");
    for &l in links {
        let name = &outcome.diagnosis.joints[l];
        assert!(entry.joints.contains(name), "{name}: {:?}", entry.joints);
    }
    assert!(!entry.parameters.is_empty(), "{entry:?}");
}

#[test]
#[ignore = "long: by hand, with --ignored"]
fn a_torque_scaled_on_two_joints_is_a_gain_of_each() {
    for (seed, joints, factors) in [(501, [1, 2], [0.8, 1.25]), (502, [0, 2], [1.3, 0.85])] {
        let case = clean(0, seed);
        let scaled = |r: &Recording| {
            let mut r = r.clone();
            let tau = r.tau.as_mut().unwrap();
            for (j, k) in joints.into_iter().zip(factors) {
                tau.column_mut(j).mapv_inplace(|t| k * t);
            }
            r
        };
        let robot = Robot::from_urdf_str(&case.urdf).unwrap();
        let found = outcome(robot, &scaled(&case.train), &scaled(&case.test));
        println!("{:?}", named(&found));
        let causes = &found.diagnosis.causes;
        for (j, k) in joints.into_iter().zip(factors) {
            let name = &found.diagnosis.joints[j];
            let gain = causes
                .iter()
                .find(|c| c.effect == Effect::TorqueGain && c.joints == [name.clone()]);
            let gain = gain.unwrap_or_else(|| panic!("{name}: {:?}", named(&found)));
            assert!((gain.parameters[0].value - k).abs() < 0.05, "{gain:?}");
        }
        let many = |c: &Cause| c.effect == Effect::LinkParameters;
        assert!(!causes.iter().any(many), "{:?}", named(&found));
    }
}

#[test]
#[ignore = "long: by hand, with --ignored"]
fn inertials_in_a_wrong_frame_are_links() {
    for (seed, links) in [(501, [1, 2]), (503, [2, 3])] {
        let case = clean(0, seed);
        let robot = Robot::from_urdf_str(&case.urdf).unwrap();
        let wrong = turned(&robot, &links, Vector3::y());
        links_are_named(&outcome(wrong, &case.train, &case.test), &links);
    }
}

/// A UR10 whose second and third links' inertials are turned about an axis, diagnosed on its shared recordings.
fn ur10_with_turned_inertials(axis: Vector3<f64>) {
    let Some(folder) = shared("data/ur10") else {
        return;
    };
    let robot = Robot::from_urdf_file(folder.join("robot.urdf")).unwrap();
    let options = ReadOptions::for_robot(robot.dof());
    let data = read(&folder.join("train.csv"), &options).unwrap();
    let heldout = read(&folder.join("test.csv"), &options).unwrap();
    let wrong = turned(&robot, &[1, 2], axis);
    links_are_named(&outcome(wrong, &data, &heldout), &[1, 2]);
}

#[test]
#[ignore = "long: .ci/release"]
fn inertials_of_a_ur10_turned_about_y_are_links() {
    ur10_with_turned_inertials(Vector3::y());
}

#[test]
#[ignore = "long: .ci/release"]
fn inertials_of_a_ur10_turned_about_x_are_links() {
    ur10_with_turned_inertials(Vector3::x());
}
