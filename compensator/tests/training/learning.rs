//! What a trained unit predicts.

use crate::hysteresis::{CARRIED, Data, TEST, WINDOW, bytes, hysteresis, recurrent, short};
use compensator::training::{Control, Job, Samples, Split, UnitConfig};
use compensator::training::{predict, train, train_ridge};
use feedforward::network::{Architecture, UnitStream};
use ndarray::Array1;

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
