//! Small compensator for the tests of this folder.

use super::{
    Architecture, Bounds, Compensator, Fade, Memory, Normaliser, Recurrent, Unit, Weights,
};

/// Two joints, three inputs, one unit of every kind, weights from a fixed sequence.
pub(super) fn compensator() -> Compensator {
    let recurrent = |attention, memory| {
        Architecture::Recurrent(Recurrent {
            encoder: 5,
            attention,
            reencoder: 4,
            memory,
        })
    };
    let architectures = [
        recurrent(Some(6), Memory::Window { timestep: 3 }),
        recurrent(None, Memory::Window { timestep: 2 }),
        recurrent(Some(3), Memory::Carried { attended: 4 }),
        Architecture::Perceptron {
            hidden: vec![7, 3],
            timestep: 2,
        },
        Architecture::Perceptron {
            hidden: vec![],
            timestep: 3,
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
                (0..count)
                    .map(|k| (((k * 7919 + seed * 104_729) % 2003) as f32 / 1001.0 - 1.0) * 0.8)
                    .collect()
            };
            let identity = (0..d * d)
                .map(|k| if k % (d + 1) == 0 { 1.0 } else { 0.0 })
                .collect();
            Unit {
                joint: i % 2,
                enabled: true,
                architecture,
                columns,
                input: Normaliser::new(vec![0.25; d], vec![2.0; d]).unwrap(),
                target: Normaliser::new(vec![0.5], vec![3.0]).unwrap(),
                bounds: Bounds::new(
                    vec![-1.0; d],
                    vec![1.0; d],
                    vec![0.0; d],
                    identity,
                    2.0,
                    8.0,
                    Fade::default(),
                )
                .unwrap(),
                members: vec![member(i), member(i + 50)],
                weights: Weights::default(),
            }
        });
    Compensator {
        joints: vec!["shoulder".into(), "elbow".into()],
        inputs: vec!["q1".into(), "qd1".into(), "qdd1".into()],
        units: units.collect(),
    }
}

/// Samples well inside the bounds of [`compensator`].
pub(super) fn samples(count: usize) -> Vec<[f32; 3]> {
    (0..count)
        .map(|i| i as f32 * 0.3)
        .map(|t| [t.sin(), (1.7 * t).cos(), (0.6 * t).sin() * 0.5])
        .collect()
}
