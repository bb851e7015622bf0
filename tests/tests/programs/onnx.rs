//! `eval --onnx`: the compensator of all joints as one graph.

use datasets::{Part, read};
use model::directory::ModelFile;
use model::evaluation::{EvaluateOptions, evaluate, read_options};
use model::residual::{Pace, input_table};
use physics::robot::Robot;
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::program::{json, program, run};
use tests::synthetic::{Plan, record_to};

/// A model with a short compensator, and a recording that it has not seen.
fn trained(folder: &Path, physics_only: bool) -> (PathBuf, PathBuf) {
    let ur5 = Robot::builtin("ur5").expect("built in");
    let data = record_to(folder, "train.csv", &ur5, &Plan::default());
    let other = Plan {
        seed: 2,
        ..Plan::default()
    };
    let test = record_to(folder, "test.csv", &ur5, &other);
    let out = folder.join("model");
    let mut train = program("train");
    train.args(["--robot", "ur5", "--basic", "--quiet"]);
    if physics_only {
        train.arg("--physics-only");
    } else {
        train.args(["--epochs", "4", "--members", "2"]);
    }
    run(train.arg("--data").arg(&data).arg("--out").arg(&out)).succeeded();
    (out, test)
}

fn export(model: &Path, graph: &Path) -> Command {
    let mut eval = program("eval");
    eval.arg("--model").arg(model).arg("--onnx").arg(graph);
    eval
}

fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

#[test]
fn onnx_runtime_gives_the_torque_of_eval() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name);
    let (model, test) = trained(folder.path(), false);
    run(&mut export(&model, &place("torque.onnx"))).succeeded();
    let description = json(&place("torque.onnx.json"));
    assert_eq!(description["schema"], "onnx/1");
    assert_eq!(description["opset"], 17);
    assert_eq!(description["joints"].as_array().map(Vec::len), Some(6));
    assert_eq!(description["joints"][5]["unit"], "N·m");

    let file = ModelFile::load(&model).expect("a model");
    let record = file.compensator.as_ref().expect("a compensator");
    let columns = description["columns"].as_array().expect("columns");
    assert_eq!(columns.len(), record.inputs.len());
    let unit_of = |name: &str| {
        let of = columns.iter().find(|c| c["name"] == name);
        of.map(|c| c["unit"].clone())
    };
    assert_eq!(unit_of("qd of joint 1"), Some("rad/s".into()));

    let Some(python) = std::env::var_os("RESIDYN_PYTHON") else {
        println!("skipped: RESIDYN_PYTHON names no interpreter with numpy and onnxruntime");
        return;
    };
    let options = read_options(&file, None, Part::Test, true).expect("options");
    let recording = read(&test, &options).expect("a recording");
    let options = EvaluateOptions::default();
    let scored = evaluate(&model, &file, recording, &options).expect("scores");
    let physics = file.physics.model().expect("a model");
    let load = scored.session.load(physics.load_robot());
    let table = input_table(&scored.session, &record.inputs, &load, &file.memory).swap_remove(0);
    let motion = &scored.session.parts[0];
    let pace = Pace::new(motion.report.rate_hz, record.period).expect("fast enough");
    let (order, sequences) = pace.rows(&motion.at_samples.segments);
    let samples = description["samples"].as_u64().expect("a number") as usize;
    let mut windows = Vec::new();
    for sequence in sequences {
        for newest in sequence.clone() {
            for t in 0..samples {
                let at = (newest + t + 1).saturating_sub(samples).max(sequence.start);
                windows.extend(table.row(order[at]));
            }
        }
    }
    std::fs::write(place("windows"), bytes(&windows)).expect("writable");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/onnx_torque.py");
    let mut command = Command::new(python);
    command.arg(script).arg(place("torque.onnx"));
    let ended = run(command.arg(place("windows")).arg(place("torque")));
    ended.succeeded();
    let given = std::fs::read(place("torque")).expect("readable");
    let (given, _) = given.as_chunks::<4>();
    let joints = file.joints.len();
    assert_eq!(given.len(), order.len() * joints);
    let (mut worst, mut square, mut said) = (0.0_f64, 0.0, 0.0_f64);
    for (row, own) in order.iter().zip(given.chunks_exact(joints)) {
        for (joint, value) in own.iter().enumerate() {
            let (whole, physics) = (scored.torque[[*row, joint]], scored.physics[[*row, joint]]);
            let value = f64::from(f32::from_le_bytes(*value));
            worst = worst.max((physics + value - whole).abs());
            square += whole * whole;
            said = said.max(value.abs());
        }
    }
    let rms = (square / given.len() as f64).sqrt();
    println!(
        "{}: worst {worst:.1e} N·m of {rms:.2} RMS, largest said {said:.2}",
        ended.out.trim()
    );
    assert!(said > 0.05, "the compensator says something: {said}");
    assert!(worst < 1e-5 * rms.min(said), "{worst:e} of {rms}");
}

#[test]
fn a_model_without_a_compensator_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (model, _) = trained(folder.path(), true);
    let graph = folder.path().join("torque.onnx");
    run(&mut export(&model, &graph)).refused(&["no compensator"]);
    assert!(!graph.exists());
}
