//! `eval --onnx`: the compensator of all joints as one graph.

use datasets::{Part, read};
use feedforward::network::{Architecture, Memory, Recurrent};
use model::directory::{ModelFile, sha256};
use model::evaluation::{EvaluateOptions, Evaluation, evaluate, read_options};
use model::residual::{self, Pace, input_table};
use ndarray::Array2;
use physics::robot::Robot;
use std::ops::Range;
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

/// What the graphs of a model are compared on: a recording as the compensator sees it, and what `eval` says.
struct Seen {
    scored: Evaluation,
    /// Inputs of the compensator, shape (samples, columns).
    table: Array2<f32>,
    /// Rows in the order in which motions run, and the motions within it.
    order: Vec<usize>,
    motions: Vec<Range<usize>>,
}

impl Seen {
    fn new(model: &Path, file: &ModelFile, test: &Path) -> Self {
        let record = file.compensator.as_ref().expect("a compensator");
        let options = read_options(file, None, Part::Test, true).expect("options");
        let recording = read(test, &options).expect("a recording");
        let options = EvaluateOptions::default();
        let scored = evaluate(model, file, recording, &options).expect("scores");
        let physics = file.physics.model().expect("a model");
        let load = scored.session.load(physics.load_robot());
        let inputs = &record.inputs;
        let table = input_table(&scored.session, inputs, &load, &file.memory).swap_remove(0);
        let motion = &scored.session.parts[0];
        let pace = Pace::new(motion.report.rate_hz, record.period).expect("fast enough");
        let (order, motions) = pace.rows(&motion.at_samples.segments);
        Self {
            scored,
            table,
            order,
            motions,
        }
    }

    /// Checks that `given`, the compensator's torque of all rows in order, makes up the torque of `eval`: to 1e-5 of its RMS, and
    /// of the largest torque that the compensator says.
    fn compare(&self, given: &[u8], said_by: &str) {
        let joints = self.scored.torque.ncols();
        let (given, _) = given.as_chunks::<4>();
        assert_eq!(given.len(), self.order.len() * joints);
        let (mut worst, mut square, mut said) = (0.0_f64, 0.0, 0.0_f64);
        for (row, own) in self.order.iter().zip(given.chunks_exact(joints)) {
            for (joint, value) in own.iter().enumerate() {
                let at = [*row, joint];
                let (whole, physics) = (self.scored.torque[at], self.scored.physics[at]);
                let value = f64::from(f32::from_le_bytes(*value));
                worst = worst.max((physics + value - whole).abs());
                square += whole * whole;
                said = said.max(value.abs());
            }
        }
        let rms = (square / given.len() as f64).sqrt();
        println!(
            "{}: worst {worst:.1e} N·m of {rms:.2} RMS, largest said {said:.2}",
            said_by.trim()
        );
        assert!(said > 0.05, "the compensator says something: {said}");
        assert!(worst < 1e-5 * rms.min(said), "{worst:e} of {rms}");
    }
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
    let seen = Seen::new(&model, &file, &test);
    let samples = description["samples"].as_u64().expect("a number") as usize;
    let mut windows = Vec::new();
    for sequence in &seen.motions {
        for newest in sequence.clone() {
            for t in 0..samples {
                let at = (newest + t + 1).saturating_sub(samples).max(sequence.start);
                windows.extend(seen.table.row(seen.order[at]));
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
    seen.compare(&given, &ended.out);
}

/// Gives the units of a model networks that carry their state, which `train` makes none of.
fn carry_state(directory: &Path) {
    let mut file = ModelFile::load(directory).expect("a model");
    let stored = residual::load(directory, &file).expect("a network");
    let mut compensator = stored.expect("a compensator");
    for (i, unit) in compensator.units.iter_mut().enumerate() {
        unit.architecture = Architecture::Recurrent(Recurrent {
            encoder: 8,
            attention: Some(6),
            reencoder: 5,
            memory: Memory::Carried { attended: 4 },
        });
        let count = unit.architecture.parameter_count(unit.columns.len());
        let draw = |k: usize| ((k * 7919 + i * 104_729) % 2003) as f32 / 2002.0 - 0.5;
        unit.members = vec![(0..count.expect("sizes")).map(draw).collect()];
        unit.enabled = true;
    }
    let path = directory.join("compensator.safetensors");
    compensator.save(&path).expect("writable");
    let record = file.compensator.as_mut().expect("a compensator");
    record.sha256 = sha256(&std::fs::read(&path).expect("readable"));
    file.save(directory).expect("writable");
}

/// Sample by sample over the recording's motions, once with windows as trained and once with carried state.
#[test]
fn a_graph_for_one_sample_gives_the_torque_of_eval() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name);
    let (model, test) = trained(folder.path(), false);
    for carried in [false, true] {
        if carried {
            carry_state(&model);
            run(&mut export(&model, &place("window.onnx"))).refused(&["carries its state"]);
        }
        run(export(&model, &place("steps.onnx")).arg("--stepwise")).succeeded();
        let description = json(&place("steps.onnx.json"));
        assert_eq!(description["schema"], "onnx-step/1");
        assert_eq!(description["num_layers"], 1);
        let unit = &description["units"][1];
        let history = (!carried).then_some(3);
        assert_eq!(unit["history"].as_u64(), history);
        assert_eq!(unit["joint"], description["joints"][1]["name"]);
        assert!(unit["low"][0].as_f64() < unit["high"][0].as_f64());

        let Some(python) = std::env::var_os("RESIDYN_PYTHON") else {
            println!("skipped: RESIDYN_PYTHON names no interpreter with numpy and onnxruntime");
            return;
        };
        let file = ModelFile::load(&model).expect("a model");
        let seen = Seen::new(&model, &file, &test);
        let rows = seen
            .order
            .iter()
            .flat_map(|&row| seen.table.row(row).to_vec());
        let samples: Vec<f32> = rows.collect();
        std::fs::write(place("samples"), bytes(&samples)).expect("writable");
        let lengths: Vec<usize> = seen.motions.iter().map(Range::len).collect();
        let lengths = serde_json::to_string(&lengths).expect("numbers");
        std::fs::write(place("lengths"), lengths).expect("writable");
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/onnx_steps.py");
        let mut command = Command::new(python);
        command.arg(script).arg(place("steps.onnx"));
        command.arg(place("samples")).arg(place("lengths"));
        let ended = run(command.arg(place("torque")));
        ended.succeeded();
        let given = std::fs::read(place("torque")).expect("readable");
        seen.compare(&given, &ended.out);
    }
}

#[test]
fn a_model_without_a_compensator_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (model, _) = trained(folder.path(), true);
    let graph = folder.path().join("torque.onnx");
    run(&mut export(&model, &graph)).refused(&["no compensator"]);
    assert!(!graph.exists());
}
