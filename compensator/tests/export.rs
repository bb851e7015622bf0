//! Exported units evaluated by ONNX Runtime and by NumPy: `fixtures/independent_check.py`, run by the
//! interpreter that `RESIDYN_PYTHON` names.

use std::process::Command;

use compensator::onnx::export;
use compensator::training::{Samples, predict};
use feedforward::network::{
    Architecture, Bounds, Compensator, Fade, Memory, Normaliser, Recurrent, Unit, Weights,
};
use ndarray::{Array1, Array2};

/// Units of every kind on windows, with limits and fades that the samples reach.
fn compensator() -> Compensator {
    let recurrent = |attention, timestep| {
        let memory = Memory::Window { timestep };
        Architecture::Recurrent(Recurrent {
            encoder: 12,
            attention,
            reencoder: 9,
            memory,
        })
    };
    let architectures = [
        recurrent(Some(7), 3),
        recurrent(None, 2),
        Architecture::Perceptron {
            hidden: vec![8, 5],
            timestep: 2,
        },
        Architecture::Perceptron {
            hidden: vec![],
            timestep: 1,
        },
    ];
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
    let compensator = compensator();
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
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/independent_check.py");
    let output = Command::new(python)
        .arg(script)
        .arg(directory.path())
        .output()
        .unwrap();
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn carried_state_is_refused() {
    let mut unit = compensator().units.swap_remove(0);
    if let Architecture::Recurrent(shape) = &mut unit.architecture {
        shape.memory = Memory::Carried { attended: 3 };
    }
    assert!(matches!(export(&unit), Err(compensator::Error::Unit(_))));
}
