//! Raw recordings of real arms, where they are there: friction as their authors measured it, and nothing that is not there.

use datasets::{ReadOptions, read};
use diagnose::Effect;
use diagnose::NominalModel;
use diagnose::patch::patch;
use diagnose::{Options, Outcome, diagnose};
use physics::robot::{Description, Robot, Urdf};
use std::path::PathBuf;

fn outcome(arm: &str) -> Option<Outcome> {
    let folder = crate::shared(&format!("data/{arm}"))?;
    let robot = Robot::from_urdf_file(folder.join("robot.urdf")).unwrap();
    let options = ReadOptions::for_robot(robot.dof());
    let [data, heldout] =
        ["train.csv", "test.csv"].map(|f| read(&folder.join(f), &options).unwrap());
    let model = NominalModel::new(robot);
    Some(diagnose(&model, &data, &heldout, &Options::default()).unwrap())
}

#[track_caller]
fn nothing_invented(found: &Outcome) {
    let absent = [
        Effect::Payload,
        Effect::BaseTilt,
        Effect::ExternalContact,
        Effect::JointCoupling,
    ];
    let causes = &found.diagnosis.causes;
    assert!(
        causes.iter().all(|c| !absent.contains(&c.effect)),
        "{causes:?}"
    );
}

/// Friction of every joint at a speed within a part of the authors'.
#[track_caller]
fn rubs(found: &Outcome, speed: f64, authors: &[f64], within: f64) {
    let d = &found.diagnosis;
    for (joint, known) in d.friction.iter().zip(authors) {
        let at = joint.speed.iter().position(|v| (v - speed).abs() < 1e-9);
        let value = joint.found[at.unwrap()].unwrap();
        println!("{}: {value:.2} of {known:.2} N·m", joint.joint);
        assert!(
            (value / known - 1.0).abs() < within,
            "{}: {value} of {known}",
            joint.joint
        );
        let named = |c: &diagnose::schema::Cause| {
            c.effect.info().friction && c.joints.contains(&joint.joint)
        };
        assert!(
            joint.given[at.unwrap()] > 0.0 || d.causes.iter().any(named),
            "{}",
            joint.joint
        );
    }
}

#[test]
fn friction_of_a_ur10() {
    let Some(found) = outcome("ur10") else { return };
    nothing_invented(&found);
    let coulomb = [13.9, 17.2, 9.4, 2.6, 2.8, 3.5];
    let viscous = [14.5, 14.2, 7.7, 3.6, 2.6, 2.8];
    let authors: Vec<f64> = coulomb
        .iter()
        .zip(viscous)
        .map(|(c, v)| c + 0.5 * v)
        .collect();
    rubs(&found, 0.5, &authors, 0.2);
    assert!(
        found.diagnosis.resonances.is_empty(),
        "{:?}",
        found.diagnosis.resonances
    );
}

#[test]
fn friction_of_an_xmate() {
    let Some(found) = outcome("xmate") else {
        return;
    };
    nothing_invented(&found);
    rubs(&found, 0.3, &[9.0, 14.0, 7.0, 10.0, 3.0, 3.5, 1.7], 0.25);
}

/// No invented cause; no negative friction and no impossible body in words, JSON or URDF, and the same numbers in all of them.
#[test]
fn a_panda_has_nothing_extra_and_its_advice_is_possible_and_written() {
    let Some(found) = outcome("panda") else {
        return;
    };
    nothing_invented(&found);
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/panda/robot.urdf");
    let text = std::fs::read_to_string(file).unwrap();
    let model = NominalModel::new(Robot::from_urdf_str(&text).unwrap());
    let written = patch(
        &model,
        &found,
        &Description::Urdf(Urdf::new(text, &[]).unwrap()),
    )
    .unwrap();
    let robot = Robot::from_urdf_str(&written.urdf).unwrap();
    // Without bounds the fit takes dampings below zero and light links out of the cone of bodies.
    let bounds = found.diagnosis.bounds.as_ref().unwrap();
    assert!(!bounds.held.is_empty() && bounds.cost < 0.01, "{bounds:?}");
    let labels = robot.parameter_names();
    let links = robot.parameters();
    let mut compared = 0;
    for cause in &found.diagnosis.causes {
        for p in &cause.parameters {
            let joint = p.joint.as_deref();
            let j = robot
                .joints()
                .iter()
                .position(|own| Some(own.name.as_str()) == joint);
            let in_file = match (cause.effect, p.name.as_str()) {
                (Effect::FrictionParameters, "viscous") => robot.joints()[j.unwrap()].damping,
                (Effect::FrictionParameters, "coulomb") => robot.joints()[j.unwrap()].friction,
                (Effect::LinkParameters, name) => {
                    links[labels.iter().position(|label| label == name).unwrap()]
                }
                _ => continue,
            };
            let apart = (in_file - p.value).abs();
            assert!(
                apart < 1e-6 * (1.0 + in_file.abs()),
                "{p:?}: {in_file} in the URDF"
            );
            if cause.effect == Effect::FrictionParameters {
                assert!(p.value >= 0.0, "{p:?}");
            }
            compared += 1;
        }
    }
    assert!(compared > 3, "{compared} numbers compared");
    for joint in robot.joints() {
        assert!(
            joint.link.inertia.is_consistent(1e-6),
            "{}",
            joint.link.name
        );
    }
}
