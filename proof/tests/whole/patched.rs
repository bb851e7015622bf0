//! A simulator's model with the causes written in: diagnosed again, they are no longer there.

use diagnose::NominalModel;
use diagnose::patch::{ForMujoco, patch};
use diagnose::{Options, Outcome, diagnose};
use physics::robot::drive::Drive;
use physics::robot::{Description, Robot, Urdf};
use trials::cases::{CaseSpec, EFFECTS, Kind, generate};

fn causes(outcome: &Outcome) -> Vec<&'static str> {
    let list = &outcome.diagnosis.causes;
    list.iter().map(|c| c.effect.name()).collect()
}

/// Diagnoses a simulated case with one withheld effect, patches the model, and diagnoses that.
fn round_trip(effect: &str, index: u64) {
    let number = EFFECTS.iter().position(|e| *e == effect).unwrap();
    let kind = Kind::Single(number);
    let case = generate(
        &CaseSpec {
            index,
            kind,
            hard: false,
            without: None,
            generator: 1,
        },
        77,
    )
    .unwrap();
    let diagnosed = |robot: Robot| {
        let model = NominalModel::new(robot);
        let outcome = diagnose(&model, &case.train, &case.test, &Options::default()).unwrap();
        (model, outcome)
    };
    let (model, before) = diagnosed(Robot::from_urdf_str(&case.urdf).unwrap());
    assert!(
        causes(&before).contains(&effect),
        "{effect}: {:?}",
        causes(&before)
    );
    let description = Description::Urdf(Urdf::new(case.urdf.clone(), &[]).unwrap());
    let patch = patch(&model, &before, &description).unwrap();
    let ForMujoco::Snippet(mjcf) = &patch.mjcf else {
        panic!("a snippet beside a URDF");
    };
    assert!(roxmltree::Document::parse(mjcf).is_ok(), "{mjcf}");
    let mut robot = Robot::from_urdf_str(&patch.urdf).unwrap();
    if let Some(text) = &patch.drive {
        robot = Drive::from_toml(text, &robot)
            .unwrap()
            .apply(robot)
            .unwrap();
    }
    let (_, after) = diagnosed(robot);
    assert!(
        !causes(&after).contains(&effect),
        "{effect} again: {:?}",
        causes(&after)
    );
    // What the causes closed, the patched model no longer leaves open.
    let steps = &before.diagnosis.ladder;
    let error = |step: &diagnose::schema::Step| step.all.mean_nrmse.unwrap();
    let (given, explained) = (error(&steps[0]), error(&steps[steps.len() - 1]));
    let patched = error(&after.diagnosis.ladder[0]);
    println!("{effect}: {given:.4} as given, {explained:.4} explained, {patched:.4} patched");
    assert!(given - patched > 0.8 * (given - explained), "{effect}");
}

#[test]
#[ignore = "long: .ci/release"]
fn a_payload() {
    round_trip("payload", 0);
}

#[test]
#[ignore = "long: .ci/release"]
fn friction() {
    round_trip("friction_parameters", 1);
}

#[test]
#[ignore = "long: .ci/release"]
fn a_tilted_base() {
    round_trip("base_tilt", 2);
}

#[test]
#[ignore = "long: .ci/release"]
fn rotor_inertia() {
    round_trip("rotor_inertia", 4);
}
