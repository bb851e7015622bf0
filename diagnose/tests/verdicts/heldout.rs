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
