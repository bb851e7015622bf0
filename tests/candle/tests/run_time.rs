//! The torque of the run-time against that on candle, on a file written here.

use candle_core::{DType, Device, Tensor};
use compensator_candle::Compensator as OnCandle;
use feedforward::network::{
    Architecture, Bounds, Compensator, Fade, Memory, Normaliser, Recurrent, Unit, Weights,
};

/// One unit of every kind, each on a joint of its own, with limits and fades that the samples reach.
fn compensator() -> Compensator {
    let recurrent = |attention, memory| {
        Architecture::Recurrent(Recurrent {
            encoder: 12,
            attention,
            reencoder: 9,
            memory,
        })
    };
    let perceptron = |hidden, timestep| Architecture::Perceptron { hidden, timestep };
    let architectures = [
        recurrent(Some(7), Memory::Window { timestep: 3 }),
        recurrent(None, Memory::Window { timestep: 2 }),
        recurrent(Some(5), Memory::Carried { attended: 4 }),
        recurrent(None, Memory::Carried { attended: 1 }),
        perceptron(vec![8, 5], 2),
        perceptron(vec![], 3),
        perceptron(vec![4], 1),
    ];
    let last = architectures.len() - 1;
    let units: Vec<Unit> = architectures
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
            let mut span = vec![1.5; d];
            if i == 4 {
                span[1] = 0.0;
            }
            Unit {
                joint: i,
                enabled: i != last,
                architecture,
                columns,
                input: Normaliser::new(vec![0.25; d], span).unwrap(),
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
        })
        .collect();
    Compensator {
        joints: (0..units.len()).map(|i| format!("joint_{i}")).collect(),
        inputs: ["q1", "qd1", "qdd1"].map(String::from).to_vec(),
        units,
    }
}

#[test]
fn torque_equals_that_of_the_run_time() {
    let compensator = compensator();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("compensator.safetensors");
    compensator.save(&path).unwrap();
    let samples: Vec<Vec<f32>> = (0..300)
        .map(|i| {
            (0..3)
                .map(|j| 2.0 * ((0.37 + 0.11 * j as f32) * i as f32).sin())
                .collect()
        })
        .collect();
    let table = Tensor::from_vec(samples.concat(), (samples.len(), 3), &Device::Cpu).unwrap();
    let predict = |dtype| {
        let on_candle = OnCandle::load(&path, dtype, &Device::Cpu).unwrap();
        assert_eq!(on_candle.inputs(), compensator.inputs);
        assert_eq!(on_candle.joints(), compensator.joints);
        let torque = on_candle.torque(&table.to_dtype(dtype).unwrap()).unwrap();
        let torque = torque.to_dtype(DType::F64).unwrap();
        torque.to_vec2::<f64>().unwrap()
    };
    let expected = predict(DType::F64);
    let single = predict(DType::F32);
    let differences = expected.iter().flatten().zip(single.iter().flatten());
    let apart = differences.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    println!("single and double precision differ by at most {apart:e} N·m");
    assert!(apart < 1e-5, "{apart:e}");

    let joints = compensator.joints.len();
    let mut stream = Compensator::load(&path).unwrap().stream().unwrap();
    let (mut worst, mut largest) = (vec![0.0_f64; joints], vec![0.0_f64; joints]);
    let mut silent = vec![0; joints];
    for (sample, expected) in samples.iter().zip(&expected) {
        let mut torque = vec![0.0; joints];
        stream.step(sample, &mut torque);
        for j in 0..joints {
            worst[j] = worst[j].max((torque[j] - expected[j]).abs());
            largest[j] = largest[j].max(torque[j].abs());
            silent[j] += usize::from(torque[j] == 0.0);
        }
    }
    println!("largest difference by unit, N·m: {worst:?}; largest torque {largest:.2?}");
    let (off, on) = (joints - 1, 0..joints - 1);
    for j in on {
        assert!(largest[j] > 0.1, "unit {j} says too little to compare");
        assert!(
            (1..samples.len()).contains(&silent[j]),
            "unit {j} fades somewhere, not everywhere"
        );
        assert!(worst[j] < 1e-5, "unit {j}: {:e} N·m", worst[j]);
    }
    assert_eq!((largest[off], worst[off]), (0.0, 0.0), "switched off");
}

/// The reason for which a file is refused.
fn refused(bytes: &[u8]) -> String {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("compensator.safetensors");
    std::fs::write(&path, bytes).unwrap();
    let loaded = OnCandle::load(&path, DType::F32, &Device::Cpu);
    loaded.err().unwrap().to_string()
}

#[test]
fn files_that_are_not_whole_are_refused() {
    let bytes = compensator().to_bytes().unwrap();
    // The same length: "version":1 sits inside an escaped string.
    let text = br#"\"version\":1"#;
    let at = bytes.windows(text.len()).position(|w| w == text).unwrap();
    let mut other = bytes.clone();
    other[at + text.len() - 1] = b'2';
    let error = refused(&other);
    assert!(error.contains("residyn/compensator 2"), "{error}");

    let mut flipped = bytes.clone();
    *flipped.last_mut().unwrap() ^= 1;
    let error = refused(&flipped);
    assert!(error.contains("checksum"), "{error}");
    assert!(!refused(&bytes[..bytes.len() / 2]).is_empty());
    assert!(!refused(b"short").is_empty());
}

#[test]
fn inputs_of_another_width_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("compensator.safetensors");
    compensator().save(&path).unwrap();
    let on_candle = OnCandle::load(&path, DType::F32, &Device::Cpu).unwrap();
    let inputs = Tensor::zeros((5, 2), DType::F32, &Device::Cpu).unwrap();
    let error = on_candle.torque(&inputs).err().unwrap().to_string();
    assert!(error.contains("2 input columns"), "{error}");
    let none = Tensor::zeros((0, 3), DType::F32, &Device::Cpu).unwrap();
    assert_eq!(on_candle.torque(&none).unwrap().dims(), [0, 7]);
}
