//! Play whose torque nobody can foretell, heard by its blows.

use diagnose::NominalModel;
use diagnose::{Options, diagnose};
use physics::robot::Robot;
use trials::cases::{draw, generate};

/// A wrist whose motor bounces between the flanks: no column lowers its error, and play is named on it all the same.
#[test]
fn play_is_named_where_its_torque_cannot_be_foretold() {
    let seed = 15_101;
    let case = generate(&draw(102, seed), seed).unwrap();
    let model = NominalModel::new(Robot::from_urdf_str(&case.urdf).unwrap());
    let outcome = diagnose(&model, &case.train, &case.test, &Options::default()).unwrap();
    let list = &outcome.diagnosis.causes;
    let structure: Vec<_> = list.iter().filter(|c| c.kind == "structure").collect();
    let [play] = structure[..] else {
        panic!("{list:?}");
    };
    assert_eq!(play.effect.name(), "backlash");
    assert_eq!(play.joints, ["joint5"]);
    assert!(play.remark.is_some_and(|r| r.contains("blows")), "{play:?}");
    assert_eq!(play.confidence, None);
    assert!(play.gap_closed.abs() < 0.1, "{play:?}");
}
