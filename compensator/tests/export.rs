//! Exported units evaluated by ONNX Runtime and by NumPy: `fixtures/independent_check.py` and `fixtures/stepwise_check.py`, run by
//! the interpreter that `RESIDYN_PYTHON` names.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

use compensator::onnx::{export, export_steps, hidden_size};
use compensator::training::{Samples, predict};
use feedforward::network::{
    Architecture, Bounds, Compensator, Fade, Memory, Normaliser, Recurrent, Unit, Weights,
};
use ndarray::{Array1, Array2};

fn recurrent(attention: Option<usize>, memory: Memory) -> Architecture {
    Architecture::Recurrent(Recurrent {
        encoder: 12,
        attention,
        reencoder: 9,
        memory,
    })
}

/// Units of every kind on windows.
fn windowed() -> Compensator {
    compensator(vec![
        recurrent(Some(7), Memory::Window { timestep: 3 }),
        recurrent(None, Memory::Window { timestep: 2 }),
        Architecture::Perceptron {
            hidden: vec![8, 5],
            timestep: 2,
        },
        Architecture::Perceptron {
            hidden: vec![],
            timestep: 1,
        },
    ])
}

/// Units of these architectures, with limits and fades that the samples reach.
fn compensator(architectures: Vec<Architecture>) -> Compensator {
    let units = architectures
        .into_iter()
        .enumerate()
        .map(|(i, architecture)| {
            let columns = if i % 2 == 0 {
                vec![0, 1, 2]
            } else {
                vec![2, 0]
            };
            let d = columns.len();
            let count = architecture.parameter_count(d).unwrap();
            let member = |seed: usize| {
                let draw = |k| ((k * 7919 + seed * 104_729) % 2003) as f32 / 1001.0 - 1.0;
                (0..count).map(draw).collect()
            };
            let factor = if d == 3 {
                vec![0.5, 0.0, 0.0, 0.1, 0.4, 0.0, -0.1, 0.2, 0.6]
            } else {
                vec![0.5, 0.0, 0.2, 0.4]
            };
            Unit {
                joint: 0,
                enabled: true,
                architecture,
                columns,
                input: Normaliser::new(vec![0.25; d], vec![1.5; d]).unwrap(),
                target: Normaliser::new(vec![0.1], vec![1.2]).unwrap(),
                bounds: Bounds::new(
                    vec![-0.7; d],
                    vec![0.5; d],
                    vec![-0.1; d],
                    factor,
                    1.5,
                    1.1,
                    Fade::default(),
                )
                .unwrap(),
                members: vec![member(i), member(i + 40)],
                weights: Weights::default(),
            }
        });
    Compensator {
        joints: vec!["joint".into()],
        inputs: ["q1", "qd1", "qdd1"].map(String::from).to_vec(),
        units: units.collect(),
    }
}

#[test]
fn onnx_runtime_and_numpy_reproduce_the_torque() {
    let Some(python) = std::env::var_os("RESIDYN_PYTHON") else {
        println!(
            "skipped: RESIDYN_PYTHON names no interpreter with numpy, safetensors and onnxruntime"
        );
        return;
    };
    let compensator = windowed();
    let rows = 300;
    let inputs = Array2::from_shape_fn((rows, 3), |(i, j)| {
        ((0.37 + 0.11 * j as f32) * i as f32).sin()
    });
    let target = Array1::zeros(rows);
    let trajectory = 0..rows;
    let samples = Samples::new(
        inputs.view(),
        target.view(),
        None,
        std::slice::from_ref(&trajectory),
    )
    .unwrap();
    let directory = tempfile::tempdir().unwrap();
    let (mut windows, mut torque) = (Vec::new(), Vec::new());
    for (i, unit) in compensator.units.iter().enumerate() {
        std::fs::write(
            directory.path().join(format!("unit{i}.onnx")),
            export(unit).unwrap(),
        )
        .unwrap();
        let steps = unit.architecture.timestep();
        let window = |row: usize| -> Vec<Vec<f32>> {
            (0..steps)
                .map(|t| inputs.row((row + t + 1).saturating_sub(steps)).to_vec())
                .collect()
        };
        windows.push((0..rows).map(window).collect::<Vec<_>>());
        torque.push(predict(unit, &samples, &[0]).unwrap());
    }
    compensator
        .save(&directory.path().join("compensator.safetensors"))
        .unwrap();
    let given = serde_json::json!({ "windows": windows, "torque": torque });
    std::fs::write(directory.path().join("windows.json"), given.to_string()).unwrap();
    succeeds(&python, "independent_check.py", directory.path());
}

/// Runs a script of `fixtures/` on a directory.
fn succeeds(python: &OsStr, script: &str, directory: &Path) {
    let fixtures = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures");
    let output = Command::new(python)
        .arg(Path::new(fixtures).join(script))
        .arg(directory)
        .output()
        .unwrap();
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Three motions at once, two of which start anew on the way, against the streaming run-time.
#[test]
fn a_graph_for_one_sample_gives_the_torque_of_the_run_time() {
    let Some(python) = std::env::var_os("RESIDYN_PYTHON") else {
        println!("skipped: RESIDYN_PYTHON names no interpreter with numpy and onnxruntime");
        return;
    };
    let carried = |attention, attended| recurrent(attention, Memory::Carried { attended });
    let mut all = windowed();
    let more = vec![
        carried(Some(7), 4),
        carried(None, 4),
        carried(Some(5), 2),
        carried(Some(5), 1),
    ];
    all.units.extend(compensator(more).units);
    all.joints.push("still".into());
    all.joints.push("second".into());
    for unit in all.units.iter_mut().skip(5) {
        unit.joint = 2;
    }
    // A unit that is off remembers nothing.
    let mut off = all.units[0].clone();
    off.enabled = false;
    all.units.push(off);
    // Windows of 3 and 2 samples of 3 and 2 columns and a perceptron on 2 of 3, each with its flag; then carried states of two members.
    let windows = (6 + 1) + (2 + 1) + (3 + 1);
    let states = |older: usize, flags: usize| 2 * (12 + 9 + 12 * older + flags);
    let expected = windows + states(2, 3) + states(0, 0) + states(0, 1) + states(0, 0);
    assert_eq!(hidden_size(&all), expected);

    let (rows, motions) = (120, 3);
    let anew = [[40, 1], [77, 2]];
    let (mut samples, mut torque) = (Vec::new(), Vec::new());
    let mut streams = vec![all.stream().unwrap(); motions];
    for row in 0..rows {
        for (motion, stream) in streams.iter_mut().enumerate() {
            if anew.contains(&[row, motion]) {
                stream.reset();
            }
            let angle = |j: usize| (0.37 + 0.11 * j as f32) * row as f32 + 1.3 * motion as f32;
            let sample = [0, 1, 2].map(|j| angle(j).sin());
            let mut sum = [0.0; 3];
            stream.step(&sample, &mut sum);
            samples.extend(sample);
            torque.extend(sum.map(|t| t as f32));
        }
    }
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, values: &[f32]| {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        std::fs::write(directory.path().join(name), bytes).unwrap();
    };
    write("samples", &samples);
    write("torque", &torque);
    let graph = export_steps(&all, r#"{"said": "as given"}"#).unwrap();
    std::fs::write(directory.path().join("steps.onnx"), graph).unwrap();
    let given = serde_json::json!({ "motions": motions, "anew": anew });
    std::fs::write(directory.path().join("anew.json"), given.to_string()).unwrap();
    succeeds(&python, "stepwise_check.py", directory.path());
}

#[test]
fn carried_state_is_refused_over_a_window() {
    let mut unit = windowed().units.swap_remove(0);
    if let Architecture::Recurrent(shape) = &mut unit.architecture {
        shape.memory = Memory::Carried { attended: 3 };
    }
    assert!(matches!(export(&unit), Err(compensator::Error::Unit(_))));
}
