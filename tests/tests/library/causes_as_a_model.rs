//! What a diagnosis found, as a model directory: the ladder's last structural step, `eval` and the control loop say the
//! same torque, and a diagnosis that starts from the directory sees what `eval` sees.

use datasets::prepare::prepare;
use diagnose::{Effect, NominalModel, Options, Outcome, diagnose, directory};
use feedforward::Feedforward;
use model::directory::ModelFile;
use model::evaluation::{EvaluateOptions, evaluate};
use model::preparation::cutoff::for_recording;
use ndarray::Array2;
use physics::robot::Robot;
use std::path::Path;
use trials::cases::{Case, CaseSpec, EFFECTS, Kind, generate};

/// Seed of the cases.
const SEED: u64 = 4;

fn case(effect: &str, index: u64) -> Case {
    let kind = EFFECTS.iter().position(|e| *e == effect).expect("listed");
    let spec = CaseSpec {
        index,
        kind: Kind::Single(kind),
        hard: false,
        without: None,
        generator: 1,
    };
    generate(&spec, SEED).expect("a case")
}

/// The diagnosis of a case, and its directory written.
fn written(
    case: &Case,
    folder: &Path,
    learn: bool,
) -> (NominalModel, Outcome, directory::Directory) {
    let given = NominalModel::new(Robot::from_urdf_str(&case.urdf).expect("a robot"));
    let options = Options {
        learn,
        ..Options::default()
    };
    let outcome = diagnose(&given, &case.train, &case.test, &options).expect("a diagnosis");
    let made = directory::directory(&given, &case.train, &case.test, &outcome, false);
    let made = made.expect("a model");
    let weights = made.compensator.as_deref();
    let done = made.file.write(folder, &made.metrics, weights, None);
    done.expect("written");
    (given, outcome, made)
}

/// Largest difference of two tables relative to the largest value of the second.
fn apart(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    let largest = b.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let difference = (a - b).iter().fold(0.0f64, |m, x| m.max(x.abs()));
    difference / largest
}

/// The control loop over the fine motion of the held-out recording, at its recorded samples.
fn streamed(folder: &Path, case: &Case) -> Array2<f64> {
    let file = ModelFile::load(folder).expect("a model");
    let own = for_recording(&file.preprocessing.options(None), &case.test);
    let prepared = prepare(&case.test, &own).expect("prepared");
    let mut model =
        Feedforward::load(folder, Some(1.0 / prepared.report.fine_hz)).expect("a model");
    let fine = &prepared.fine;
    let mut table = Array2::zeros(fine.q.dim());
    for segment in &fine.segments {
        // Every trajectory stands between those of training on one clock.
        model.reset(Some(fine.time[segment.start]));
        for row in segment.clone() {
            let [q, qd, qdd] = [&fine.q, &fine.qd, &fine.qdd].map(|t| t.row(row).to_vec());
            let mut tau = vec![0.0; q.len()];
            model.torque(&q, &qd, &qdd, &mut tau);
            for (out, tau) in table.row_mut(row).iter_mut().zip(tau) {
                *out = tau;
            }
        }
    }
    let mut at_samples = Array2::zeros(case.test.q.dim());
    for (mut out, column) in at_samples.columns_mut().into_iter().zip(table.columns()) {
        out.assign(&ndarray::Array1::from(
            prepared.to_samples(&column.to_vec()),
        ));
    }
    at_samples
}

/// The way round for one effect: ladder, directory, `eval`, control loop, and a diagnosis that starts from the directory.
fn round_trip(effect: &str, index: u64) {
    let case = case(effect, index);
    let folder = tempfile::tempdir().expect("a folder");
    let (_, outcome, made) = written(&case, folder.path(), false);
    let causes = &outcome.diagnosis.causes;
    let wanted = causes.iter().any(|c| c.effect.name() == effect);
    assert!(
        wanted,
        "the cause is found: {:?}",
        causes.iter().map(|c| c.effect).collect::<Vec<_>>()
    );
    assert!(made.left_out.is_empty(), "{:?}", made.left_out);
    let file = ModelFile::load(folder.path()).expect("a model");
    let scored = evaluate(
        folder.path(),
        &file,
        case.test.clone(),
        &EvaluateOptions::default(),
    );
    let scored = scored.expect("scores");
    let step = &outcome.frames.heldout.tau - &outcome.explanation.residual;
    let from_step = apart(&scored.physics, &step);
    assert!(
        from_step < 1e-9,
        "{effect}: eval from the ladder's step {from_step:.2e}"
    );
    assert!(made.departure < 1e-9, "{:.2e}", made.departure);
    let loop_ = apart(&streamed(folder.path(), &case), &scored.physics);
    assert!(loop_ < 1e-9, "{effect}: control loop from eval {loop_:.2e}");
    // The directory as the simulator's model: what is given is what eval scores.
    let again = NominalModel::identified(&file).expect("a model");
    let second =
        diagnose(&again, &case.train, &case.test, &Options::default()).expect("a diagnosis");
    let given = &case.test.tau.clone().expect("torque") - &second.explanation.gap;
    let from_eval = apart(&given, &scored.physics);
    assert!(
        from_eval < 1e-12,
        "{effect}: as given from eval {from_eval:.2e}"
    );
}

#[test]
fn memory_is_carried() {
    round_trip("presliding_hysteresis", 6);
}

#[test]
#[ignore = "long: .ci/release"]
fn drift_is_carried() {
    round_trip("friction_drift", 2);
}

#[test]
#[ignore = "long: .ci/release"]
fn position_and_load_are_carried() {
    round_trip("position_dependent_friction", 3);
    round_trip("load_dependent_friction", 4);
}

/// Properties of the recording are applied by `eval` and left out of the control loop.
#[test]
fn a_scaled_channel_is_the_recordings_own() {
    let case = case("torque_gain", 5);
    let folder = tempfile::tempdir().expect("a folder");
    let (_, outcome, made) = written(&case, folder.path(), false);
    let file = ModelFile::load(folder.path()).expect("a model");
    let channel = file.preprocessing.channel.clone().expect("a channel");
    let causes = &outcome.diagnosis.causes;
    let gain = causes.iter().find(|c| c.effect == Effect::TorqueGain);
    let gain = gain.expect("the cause is found").parameters[0].clone();
    let joint = outcome
        .diagnosis
        .joints
        .iter()
        .position(|j| Some(j) == gain.joint.as_ref());
    let joint = joint.expect("a joint");
    assert!(
        (channel.gain[joint] - gain.value).abs() < 4.0 * gain.std.unwrap_or(0.01),
        "{channel:?} {gain:?}"
    );
    // Scale and parameters multiply, where the search added them.
    assert!(made.departure < 0.02, "{:.2e}", made.departure);
    let scored = evaluate(
        folder.path(),
        &file,
        case.test.clone(),
        &EvaluateOptions::default(),
    );
    let scored = scored.expect("scores").physics;
    let mut loop_ = streamed(folder.path(), &case);
    assert!((channel.gain[joint] - 1.0).abs() > 0.01, "{channel:?}");
    channel.note(&mut loop_);
    assert!(apart(&loop_, &scored) < 1e-9);
}
