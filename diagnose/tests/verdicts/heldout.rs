//! Held-out recordings that are special.

use crate::arm::{Noise, effects, moving, nothing, report};
use datasets::Recording;

/// Nothing is chosen with the torque of the held-out recording.
#[test]
fn scrambled_heldout_torque_changes_no_cause_and_no_verdict() {
    let drag = |_: usize, _: f64, qd: &[f64], j: usize| {
        [2.5, 0.0, 0.0][j] * qd[j] * qd[j].abs() + [0.0, 0.0, 4.0][j]
    };
    let data = moving(1, &drag);
    let heldout = moving(7, &drag);
    let mut scrambled = heldout.clone();
    let mut order: Vec<usize> = (0..heldout.len()).collect();
    let mut noise = Noise(5);
    for i in (1..order.len()).rev() {
        order.swap(i, ((noise.next() + 0.5) * (i + 1) as f64) as usize);
    }
    scrambled.tau = heldout
        .tau
        .as_ref()
        .map(|t| t.select(ndarray::Axis(0), &order));
    let said = |r: &Recording| {
        let found = report(&data, r);
        let causes = found["causes"].as_array().unwrap();
        let mut causes: Vec<String> = causes
            .iter()
            .filter(|c| c["effect"] != "external_contact")
            .map(|c| format!("{} {} {}", c["effect"], c["joints"], c["parameters"]))
            .collect();
        causes.sort();
        (
            causes,
            found["verdict"].clone(),
            found["unexplained"].clone(),
        )
    };
    let (plain, scrambled) = (said(&heldout), said(&scrambled));
    assert!(
        plain
            .0
            .iter()
            .any(|c| c.contains("nonlinear_viscous_friction")),
        "{:?}",
        plain.0
    );
    assert_eq!(plain, scrambled);
}

/// A torque that is cut in the held-out recording alone is not fitted there.
#[test]
fn a_limit_that_only_the_heldout_recording_reaches_is_no_cause() {
    let mut cut = moving(7, &nothing);
    let tau = cut.tau.as_mut().unwrap();
    tau.column_mut(1).mapv_inplace(|t| t.clamp(-22.0, 22.0));
    let found = report(&moving(1, &nothing), &cut);
    assert!(
        !effects(&found).contains(&"saturation"),
        "{:#}",
        found["causes"]
    );
    assert_eq!(found["verdict"], "no_gap", "of the fitted recording");
}

/// Friction of one joint a tenth larger in the held-out recording is said, on that joint alone, and changes no cause.
#[test]
fn friction_of_another_day_is_said() {
    let warmer = |_: usize, _: f64, qd: &[f64], j: usize| {
        [0.0, 0.1, 0.0][j] * (2.0 * qd[j] + 3.0 * qd[j].signum())
    };
    let of = |found: &serde_json::Value| -> Vec<String> {
        let notes = found["notes"].as_array().unwrap();
        let notes = notes.iter().map(|n| n.as_str().unwrap().to_owned());
        notes
            .filter(|n| n.contains("friction is another"))
            .collect()
    };
    let same = report(&moving(1, &nothing), &moving(7, &nothing));
    assert_eq!(of(&same), Vec::<String>::new());
    let other = report(&moving(1, &nothing), &moving(7, &warmer));
    let said = of(&other);
    assert_eq!(said.len(), 1, "{:#}", other["notes"]);
    assert!(
        said[0].contains("j2 +1") && !said[0].contains("j1 ") && !said[0].contains("j3 "),
        "{}",
        said[0]
    );
    assert_eq!(other["causes"], same["causes"]);
    assert_eq!(other["verdict"], same["verdict"]);
}
