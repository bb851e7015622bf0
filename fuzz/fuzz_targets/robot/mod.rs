//! A robot with a small compensator, as the two files of its model directory.

use feedforward::inputs::{Input, Signal};
use feedforward::model_file::{SCHEMA, sha256};
use feedforward::network::{
    Architecture, Bounds, Compensator, Fade, Memory, Normaliser, Recurrent, Unit, Weights,
};
use physics::effects::{Sliding, Term};
use physics::robot::Robot;
use physics::torque_model::{TorqueModelRecord, WeightedTerm};

pub const JOINTS: usize = 6;

fn inputs() -> Vec<Input> {
    let of = |joint, signal| Input { joint, signal };
    vec![
        of(0, Signal::Position),
        of(0, Signal::Velocity),
        of(1, Signal::Load),
    ]
}

/// Contents of a `compensator.safetensors`: units of every kind, form and memory.
pub fn network() -> Vec<u8> {
    let recurrent = |attention, memory| {
        Architecture::Recurrent(Recurrent {
            encoder: 5,
            attention,
            reencoder: 4,
            memory,
        })
    };
    let kinds = [
        (
            recurrent(Some(6), Memory::Window { timestep: 3 }),
            Weights::F32,
        ),
        (
            recurrent(Some(3), Memory::Carried { attended: 4 }),
            Weights::Int8,
        ),
        (
            recurrent(None, Memory::Window { timestep: 2 }),
            Weights::Bf16,
        ),
        (
            Architecture::Perceptron {
                hidden: vec![3],
                timestep: 2,
            },
            Weights::F32,
        ),
    ];
    let unit = |(joint, (architecture, weights)): (usize, (Architecture, Weights))| {
        let count = architecture.parameter_count(3)?;
        Some(Unit {
            joint,
            enabled: true,
            architecture,
            columns: vec![0, 1, 2],
            input: Normaliser::new(vec![0.0; 3], vec![1.0; 3])?,
            target: Normaliser::new(vec![0.0], vec![2.0])?,
            bounds: Bounds::new(
                vec![-1.0; 3],
                vec![1.0; 3],
                vec![0.0; 3],
                vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
                2.0,
                3.0,
                Fade::default(),
            )?,
            members: vec![(0..count).map(|k| (k as f32 * 0.7).sin()).collect()],
            weights,
        })
    };
    let units: Option<Vec<Unit>> = kinds.into_iter().enumerate().map(unit).collect();
    let robot = Robot::builtin("ur5").expect("built in");
    let compensator = Compensator {
        joints: robot.joints().iter().map(|j| j.name.clone()).collect(),
        inputs: inputs().iter().map(Input::name).collect(),
        units: units.expect("consistent parts"),
    };
    compensator.to_bytes().expect("consistent parts")
}

/// Contents of a `model.json` that belongs to these bytes of a network, if any.
pub fn model(network: Option<&[u8]>) -> Vec<u8> {
    let robot = Robot::builtin("ur5").expect("built in");
    let term = |term, value| WeightedTerm {
        term,
        value,
        std: 0.0,
    };
    let each = |j: usize| {
        vec![
            term(Term::RotorInertia, 0.1 * (j + 1) as f64),
            term(Term::Sliding(Sliding::Viscous), 2.0),
            term(Term::Sliding(Sliding::Coulomb), 5.0),
        ]
    };
    let own = robot.parameters();
    let record = TorqueModelRecord::new(&robot, own.clone(), own, (0..JOINTS).map(each).collect());
    let compensator = network.map(|bytes| {
        serde_json::json!({"inputs": inputs(), "period": 0.01, "sha256": sha256(bytes), "validation": []})
    });
    let file = serde_json::json!({
        "schema": SCHEMA, "physics": record, "preprocessing": {"fine_hz": 500.0}, "clock": [], "memory": [],
        "compensator": compensator,
    });
    file.to_string().into_bytes()
}
