//! Training on a synthetic residual: hysteresis of a joint, which only history explains.

use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use compensator::Error;
use compensator::training::{Control, Job, Loss, Samples, Split, Training, UnitConfig};
use compensator::training::{predict, train, train_ridge};
use feedforward::network::{Architecture, Compensator, Memory, Recurrent, UnitStream};
use ndarray::{Array1, Array2};
use safetensors::{SafeTensors, serialize};

const TRAJECTORIES: usize = 10;
const ROWS: usize = 400;

struct Data {
    inputs: Array2<f32>,
    target: Array1<f32>,
    trajectories: Vec<Range<usize>>,
}

/// q, q̇, q̈ of a joint on sums of two sines, and the torque of a stop operator (elastic up to 4 N·m, then
/// sliding) on q: hysteresis loops with memory around reversals.
fn hysteresis() -> Data {
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
    fn samples(&self) -> Samples<'_> {
        Samples::new(
            self.inputs.view(),
            self.target.view(),
            None,
            &self.trajectories,
        )
        .unwrap()
    }

    fn job(&self, config: UnitConfig) -> Job<'_> {
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

    fn rmse(&self, predicted: &[f32], trajectories: &[usize]) -> f64 {
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

const TEST: [usize; 2] = [1, 6];

fn recurrent(attention: bool, memory: Memory) -> UnitConfig {
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

fn short(memory: Memory) -> UnitConfig {
    let mut config = recurrent(true, memory);
    config.training.epochs = 3;
    config.training.batch = 64;
    config.training.dropout = 0.2;
    config
}

const WINDOW: Memory = Memory::Window { timestep: 5 };
const CARRIED: Memory = Memory::Carried { attended: 5 };

#[test]
fn lstm_with_attention_learns_hysteresis() {
    let data = hysteresis();
    let samples = data.samples();
    let nothing = data.rmse(&vec![0.0; samples.rows()], &TEST);
    let control = Control {
        threads: 2,
        ..Control::default()
    };
    let mut carried = recurrent(true, CARRIED);
    carried.training.batch = 8;
    let jobs = [data.job(recurrent(true, WINDOW)), data.job(carried)];
    let trained = train(&jobs, &control).unwrap();
    for (name, t) in ["window", "carried"].iter().zip(&trained) {
        let left = data.rmse(&predict(&t.unit, &samples, &TEST).unwrap(), &TEST);
        println!(
            "{name}: {left:.3} of {nothing:.3} N·m, {} epochs",
            t.report.history[0].len()
        );
        assert!(
            t.unit.enabled && left < 0.5 * nothing,
            "{name}: {left} of {nothing}"
        );
    }
    let linear = train_ridge(&jobs[0]).unwrap();
    let left = data.rmse(&predict(&linear.unit, &samples, &TEST).unwrap(), &TEST);
    println!("ridge: {left:.3} of {nothing:.3} N·m");
    assert!(left < nothing, "ridge: {left} of {nothing}");
}

#[test]
fn batch_and_streaming_predict_the_same() {
    let data = hysteresis();
    let samples = data.samples();
    let mlp = UnitConfig {
        architecture: Architecture::Perceptron {
            hidden: vec![12, 7],
            timestep: 4,
        },
        members: 2,
        ..short(WINDOW)
    };
    let mut averaged = short(WINDOW);
    averaged.members = 2;
    for config in [averaged, short(CARRIED), mlp] {
        let trained = train(&[data.job(config)], &Control::default()).unwrap();
        let unit = &trained[0].unit;
        assert!(unit.enabled);
        let batch = predict(unit, &samples, &TEST).unwrap();
        let mut stream = UnitStream::new(unit, 1, 3).unwrap();
        let mut worst = 0.0_f32;
        for &t in &TEST {
            stream.reset();
            for i in data.trajectories[t].clone() {
                let row = data.inputs.row(i).to_vec();
                worst = worst.max((stream.step(&row) - batch[i]).abs());
            }
        }
        println!("streaming and batch differ by at most {worst:e} N·m");
        // Torques reach 4 N·m; the sums run in another order.
        assert!(worst < 4e-6, "{worst:e}");
    }
}

fn bytes(trained: &[compensator::training::Trained]) -> Vec<u8> {
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

#[test]
fn same_seed_same_bytes_whatever_the_threads() {
    let data = hysteresis();
    let mut two = short(WINDOW);
    two.members = 2;
    let jobs = [data.job(two), data.job(short(CARRIED))];
    let run = |threads| {
        bytes(
            &train(
                &jobs,
                &Control {
                    threads,
                    ..Control::default()
                },
            )
            .unwrap(),
        )
    };
    let once = run(1);
    assert_eq!(once, run(2));
    assert_eq!(once, run(1));
    let mut other = jobs.clone();
    other[0].seed += 1;
    assert_ne!(once, bytes(&train(&other, &Control::default()).unwrap()));
}

#[test]
fn resumed_training_ends_in_the_same_bytes() {
    let data = hysteresis();
    for memory in [WINDOW, CARRIED] {
        let mut config = short(memory);
        config.training.schedule = compensator::training::Schedule::OneCycle {
            warm_up: 0.3,
            start: 0.1,
            end: 1e-3,
        };
        config.training.epochs = 5;
        config.training.batch = 16;
        let jobs = [data.job(config)];
        let uninterrupted = bytes(&train(&jobs, &Control::default()).unwrap());
        let directory = tempfile::tempdir().unwrap();
        let cancel = AtomicBool::new(false);
        let epochs = AtomicUsize::new(0);
        let progress = |_: &compensator::training::Progress| {
            if epochs.fetch_add(1, Ordering::Relaxed) == 1 {
                cancel.store(true, Ordering::Relaxed);
            }
        };
        let control = Control {
            checkpoints: Some(directory.path()),
            cancel: Some(&cancel),
            progress: Some(&progress),
            threads: 1,
        };
        assert!(matches!(train(&jobs, &control), Err(Error::Interrupted)));
        let control = Control {
            cancel: None,
            progress: None,
            ..control
        };
        assert_eq!(uninterrupted, bytes(&train(&jobs, &control).unwrap()));
        // Finished networks are taken from their checkpoints as they are.
        assert_eq!(uninterrupted, bytes(&train(&jobs, &control).unwrap()));

        let file = directory.path().join("unit0-member0.safetensors");
        let whole = std::fs::read(&file).unwrap();
        let mut other = jobs.clone();
        other[0].config.training.learning_rate *= 0.5;
        let refused = |jobs: &[Job]| train(jobs, &control).unwrap_err();
        assert!(matches!(
            refused(&other),
            Error::OtherCheckpoint {
                what: "settings",
                ..
            }
        ));
        let mut other = jobs.clone();
        other[0].seed += 1;
        assert!(matches!(
            refused(&other),
            Error::OtherCheckpoint {
                what: "data or another seed",
                ..
            }
        ));
        assert_eq!(whole, std::fs::read(&file).unwrap(), "nothing is lost");
    }
}

/// Writes a checkpoint again with another header.
fn rewrite(file: &Path, change: impl Fn(&mut serde_json::Value)) {
    let content = std::fs::read(file).unwrap();
    let (_, metadata) = SafeTensors::read_metadata(&content).unwrap();
    let mut metadata = metadata.metadata().clone().unwrap();
    let header = metadata.get_mut("residyn-checkpoint").unwrap();
    let mut parsed = serde_json::from_str(header).unwrap();
    change(&mut parsed);
    *header = parsed.to_string();
    let tensors = SafeTensors::deserialize(&content).unwrap();
    std::fs::write(file, serialize(tensors.tensors(), Some(metadata)).unwrap()).unwrap();
}

#[test]
fn damaged_and_foreign_checkpoints_are_refused_and_kept() {
    let data = hysteresis();
    let mut config = short(WINDOW);
    config.training.epochs = 1;
    let jobs = [data.job(config.clone())];
    let mut wider = config;
    let Architecture::Recurrent(shape) = &mut wider.architecture else {
        unreachable!("a recurrent unit")
    };
    shape.encoder += 1;
    let wider = [data.job(wider)];
    let (ours, theirs) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let within = |folder: &'_ Path, jobs: &[Job]| {
        let control = Control {
            checkpoints: Some(folder),
            ..Control::default()
        };
        train(jobs, &control)
    };
    within(ours.path(), &jobs).unwrap();
    within(theirs.path(), &wider).unwrap();
    let file = |folder: &tempfile::TempDir| folder.path().join("unit0-member0.safetensors");
    let whole = std::fs::read(file(&ours)).unwrap();
    let refused = || {
        let before = std::fs::read(file(&ours)).unwrap();
        let error = within(ours.path(), &jobs).unwrap_err();
        assert_eq!(
            before,
            std::fs::read(file(&ours)).unwrap(),
            "nothing is lost"
        );
        let message = error.to_string();
        assert!(!message.contains('\n'), "{message}");
        (error, message)
    };

    // A bit in the middle of the records: burn's own reader would take it.
    for place in [whole.len() / 2, whole.len() - 1] {
        let mut flipped = whole.clone();
        flipped[place] ^= 1;
        std::fs::write(file(&ours), flipped).unwrap();
        let (error, message) = refused();
        assert!(matches!(error, Error::BadCheckpoint { .. }), "{message}");
    }
    std::fs::write(file(&ours), &whole[..whole.len() / 2]).unwrap();
    assert!(matches!(refused().0, Error::BadCheckpoint { .. }));

    std::fs::write(file(&ours), &whole).unwrap();
    rewrite(&file(&ours), |header| {
        header.as_object_mut().unwrap().remove("version");
    });
    let (error, message) = refused();
    let first = matches!(error, Error::CheckpointVersion { found: 1, .. });
    assert!(first, "{message}");
    std::fs::write(file(&ours), &whole).unwrap();
    rewrite(&file(&ours), |header| header["version"] = 3.into());
    assert!(matches!(
        refused().0,
        Error::CheckpointVersion { found: 3, .. }
    ));

    // Records of a wider unit under this unit's name: the hash is right, the shape is not.
    let (_, metadata) = SafeTensors::read_metadata(&whole).unwrap();
    let header = &metadata.metadata().as_ref().unwrap()["residyn-checkpoint"];
    let origin: serde_json::Value = serde_json::from_str(header).unwrap();
    std::fs::copy(file(&theirs), file(&ours)).unwrap();
    rewrite(&file(&ours), |header| {
        for key in ["fingerprint", "config"] {
            header[key] = origin[key].clone();
        }
    });
    let (error, message) = refused();
    assert!(matches!(error, Error::BadCheckpoint { .. }), "{message}");
    assert!(message.contains("shape"), "{message}");
}

/// Weights near the largest number of single precision make slopes that are not: no step is taken on them,
/// and what was written before stays.
#[test]
fn a_gradient_that_is_not_finite_ends_the_training() {
    let data = hysteresis();
    let weight = Array1::from_elem(data.target.len(), f32::MAX);
    let samples = Samples::new(
        data.inputs.view(),
        data.target.view(),
        Some(weight.view()),
        &data.trajectories,
    )
    .unwrap();
    let mut config = short(WINDOW);
    config.training.loss = Loss::Mse;
    let mut job = data.job(config);
    job.samples = samples;
    let directory = tempfile::tempdir().unwrap();
    let control = Control {
        checkpoints: Some(directory.path()),
        ..Control::default()
    };
    let error = train(&[job], &control).unwrap_err();
    assert_eq!(
        error.to_string(),
        "training diverged in epoch 1: the gradient is not finite; lower the learning rate"
    );
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}

/// A residual that the inputs say nothing about: the unit must go off and predict exactly zero.
#[test]
fn a_unit_that_does_not_help_is_off() {
    let mut data = hysteresis();
    let mut state = 1_u64;
    for y in &mut data.target {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        *y = (state >> 40) as f32 / (1 << 23) as f32 - 1.0;
    }
    let trained = train(&[data.job(short(WINDOW))], &Control::default()).unwrap();
    assert!(!trained[0].unit.enabled);
    let predicted = predict(&trained[0].unit, &data.samples(), &[0, 1, 2]).unwrap();
    assert!(predicted.iter().all(|&y| y == 0.0));
}

#[test]
fn masked_samples_do_not_count() {
    let mut data = hysteresis();
    let weight = Array1::from_shape_fn(data.target.len(), |i| if i % 3 == 0 { 0.0 } else { 1.0 });
    let config = short(WINDOW);
    let split = Split {
        train: vec![0, 1],
        validation: vec![2],
    };
    let trained = |data: &Data| {
        let view = weight.view();
        let samples = Samples::new(
            data.inputs.view(),
            data.target.view(),
            Some(view),
            &data.trajectories,
        )
        .unwrap();
        let job = Job {
            joint: 0,
            columns: vec![1],
            samples,
            split: split.clone(),
            config: config.clone(),
            seed: 1,
        };
        bytes(&train(&[job], &Control::default()).unwrap())
    };
    let before = trained(&data);
    data.target.iter_mut().step_by(3).for_each(|y| *y += 100.0);
    assert_eq!(before, trained(&data));
}

#[test]
fn bad_data_and_settings_are_refused() {
    let data = hysteresis();
    let mut inputs = data.inputs.clone();
    inputs[[7, 2]] = f32::NAN;
    let refused = Samples::new(inputs.view(), data.target.view(), None, &data.trajectories);
    assert!(matches!(
        refused,
        Err(Error::NotFinite {
            table: "input",
            row: 7,
            column: 2
        })
    ));
    assert!(
        Samples::new(
            data.inputs.view(),
            data.target.view(),
            None,
            std::slice::from_ref(&(5..5))
        )
        .is_err()
    );

    let train_one = |job: Job| train(&[job], &Control::default()).map(|_| ());
    let mut job = data.job(short(WINDOW));
    job.split.validation = vec![2];
    assert!(
        matches!(train_one(job), Err(Error::Samples(_))),
        "a trajectory on both sides"
    );
    let mut job = data.job(short(WINDOW));
    job.split.train.clear();
    assert!(matches!(train_one(job), Err(Error::TooLittleData(_))));
    let mut job = data.job(short(WINDOW));
    job.columns = vec![3];
    assert!(
        matches!(train_one(job), Err(Error::Samples(_))),
        "a column that does not exist"
    );
    let mut job = data.job(short(WINDOW));
    job.config.training.dropout = 1.0;
    assert!(matches!(
        train_one(job),
        Err(Error::Config {
            setting: "dropout",
            ..
        })
    ));
    let mut job = data.job(short(WINDOW));
    job.config.training.learning_rate = f32::NAN;
    assert!(matches!(
        train_one(job),
        Err(Error::Config {
            setting: "learning_rate",
            ..
        })
    ));
}

/// Far outside the training inputs the torque is exactly zero, on the way there it falls without a jump,
/// and nowhere does it exceed the largest torque of training.
#[test]
fn bounded_far_outside_the_training_inputs() {
    let data = hysteresis();
    for memory in [WINDOW, CARRIED] {
        let trained = train(&[data.job(short(memory))], &Control::default()).unwrap();
        let unit = &trained[0].unit;
        let limit = data.target.iter().fold(0.0_f32, |m, y| m.max(y.abs()));
        let mut stream = UnitStream::new(unit, 1, 3).unwrap();
        for direction in [
            [1.0_f32, 0.0, 0.0],
            [0.0, -1.0, 0.0],
            [1.0, 1.0, -1.0],
            [0.0, 0.0, 1.0],
        ] {
            stream.reset();
            let mut last: Option<f32> = None;
            for i in 0..20_000 {
                let r = i as f32 * 1e-3;
                let y = stream.step(&direction.map(|d| d * r));
                assert!(y.abs() <= limit, "{y} at {r} exceeds {limit}");
                assert!(
                    last.is_none_or(|l| (y - l).abs() < 0.05 * limit),
                    "a jump at {r}: {last:?} to {y}"
                );
                last = Some(y);
            }
            for r in [100.0, 1e6, 1e30] {
                assert_eq!(stream.step(&direction.map(|d| d * r)), 0.0);
            }
        }
        assert_eq!(stream.step(&[f32::NAN, 0.0, 0.0]), 0.0);
        assert!(
            stream.step(&[0.1, 0.2, -0.1]).is_finite(),
            "an absurd past must not poison the state"
        );
    }
}
