//! The residual, and the settings that it is learned with.

use compensator::training::{Job, Samples, Split, Trained, Training, UnitConfig};
use feedforward::network::{Architecture, Compensator, Memory, Recurrent};
use ndarray::{Array1, Array2};
use std::ops::Range;

const TRAJECTORIES: usize = 10;

const ROWS: usize = 400;

pub struct Data {
    pub inputs: Array2<f32>,
    pub target: Array1<f32>,
    pub trajectories: Vec<Range<usize>>,
}

/// q, q̇, q̈ of a joint on sums of two sines, and the torque of a stop operator (elastic up to 4 N·m, then
/// sliding) on q: hysteresis loops with memory around reversals.
pub fn hysteresis() -> Data {
    let mut inputs = Array2::zeros((TRAJECTORIES * ROWS, 3));
    let mut target = Array1::zeros(TRAJECTORIES * ROWS);
    let mut trajectories = Vec::new();
    for k in 0..TRAJECTORIES {
        let (a, b, w) = (
            0.4 + 0.05 * k as f64,
            0.2 + 0.02 * k as f64,
            1.0 + 0.07 * k as f64,
        );
        let mut torque = 0.0;
        let mut last: Option<f64> = None;
        for i in 0..ROWS {
            let t = i as f64 * 0.02;
            let q = a * (w * t).sin() + b * (2.3 * w * t + k as f64).sin();
            let qd = a * w * (w * t).cos() + b * 2.3 * w * (2.3 * w * t + k as f64).cos();
            let qdd =
                -a * w * w * (w * t).sin() - b * (2.3 * w).powi(2) * (2.3 * w * t + k as f64).sin();
            torque = (torque + 60.0 * (q - last.unwrap_or(q))).clamp(-4.0, 4.0);
            last = Some(q);
            let row = k * ROWS + i;
            for (j, v) in [q, qd, qdd].into_iter().enumerate() {
                inputs[[row, j]] = v as f32;
            }
            target[row] = torque as f32;
        }
        trajectories.push(k * ROWS..(k + 1) * ROWS);
    }
    Data {
        inputs,
        target,
        trajectories,
    }
}

impl Data {
    pub fn samples(&self) -> Samples<'_> {
        Samples::new(
            self.inputs.view(),
            self.target.view(),
            None,
            &self.trajectories,
        )
        .unwrap()
    }

    pub fn job(&self, config: UnitConfig) -> Job<'_> {
        let split = Split {
            train: vec![0, 2, 4, 5, 7, 9],
            validation: vec![3, 8],
        };
        Job {
            joint: 0,
            columns: vec![0, 1, 2],
            samples: self.samples(),
            split,
            config,
            seed: 11,
        }
    }

    pub fn rmse(&self, predicted: &[f32], trajectories: &[usize]) -> f64 {
        let rows: Vec<usize> = trajectories
            .iter()
            .flat_map(|&t| self.trajectories[t].clone())
            .collect();
        let sum: f64 = rows
            .iter()
            .map(|&i| f64::from(self.target[i] - predicted[i]).powi(2))
            .sum();
        (sum / rows.len() as f64).sqrt()
    }
}

pub const TEST: [usize; 2] = [1, 6];

pub fn recurrent(attention: bool, memory: Memory) -> UnitConfig {
    let attention = attention.then_some(16);
    UnitConfig {
        architecture: Architecture::Recurrent(Recurrent {
            encoder: 16,
            attention,
            reencoder: 16,
            memory,
        }),
        training: Training {
            epochs: 40,
            batch: 128,
            learning_rate: 0.01,
            dropout: 0.0,
            ..Training::default()
        },
        ..UnitConfig::default()
    }
}

pub fn short(memory: Memory) -> UnitConfig {
    let mut config = recurrent(true, memory);
    config.training.epochs = 3;
    config.training.batch = 64;
    config.training.dropout = 0.2;
    config
}

pub const WINDOW: Memory = Memory::Window { timestep: 5 };

pub const CARRIED: Memory = Memory::Carried { attended: 5 };

pub fn bytes(trained: &[Trained]) -> Vec<u8> {
    let units = trained.iter().map(|t| t.unit.clone()).collect();
    let inputs = ["q1", "qd1", "qdd1"].map(String::from).to_vec();
    Compensator {
        joints: vec!["joint".into()],
        inputs,
        units,
    }
    .to_bytes()
    .unwrap()
}
