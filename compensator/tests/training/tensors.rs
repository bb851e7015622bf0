//! Training through burn's own operations, here on the CPU; `gpu/tests/` asks the same of a GPU.

use crate::hysteresis::{CARRIED, TEST, WINDOW, hysteresis, short};
use compensator::Error;
use compensator::training::{Control, Tensors, UnitConfig, predict, train};
use feedforward::network::Architecture;
use std::sync::atomic::{AtomicBool, Ordering};

fn on(tensors: &Tensors) -> Control<'_> {
    Control {
        tensors: Some(tensors),
        ..Control::default()
    }
}

#[test]
fn ends_where_the_kernels_end() {
    ends_where_the_kernels_end_on(&Tensors::cpu());
}

pub fn ends_where_the_kernels_end_on(tensors: &Tensors) {
    let data = hysteresis();
    let samples = data.samples();
    let mlp = UnitConfig {
        architecture: Architecture::Perceptron {
            hidden: vec![12, 7],
            timestep: 4,
        },
        ..short(WINDOW)
    };
    for config in [short(WINDOW), short(CARRIED), mlp] {
        let jobs = [data.job(config)];
        let torque = |control: &Control| {
            let unit = &train(&jobs, control).unwrap()[0].unit;
            assert!(unit.enabled);
            predict(unit, &samples, &TEST).unwrap()
        };
        let [kernels, composed] = [torque(&Control::default()), torque(&on(tensors))];
        let pairs = kernels.iter().zip(&composed);
        let worst = pairs.fold(0.0_f32, |m, (a, b)| m.max((a - b).abs()));
        println!("torques differ by at most {worst:e} N·m");
        // Torques reach 4 N·m; a few hundred steps carry rounding on.
        assert!(worst > 0.0 && worst < 0.02, "{worst:e}");
    }
}

#[test]
fn interrupted_and_resumed_as_if_it_never_was() {
    interrupted_and_resumed_as_if_it_never_was_on(&Tensors::cpu());
}

pub fn interrupted_and_resumed_as_if_it_never_was_on(tensors: &Tensors) {
    let data = hysteresis();
    let jobs = [data.job(short(WINDOW))];
    let straight = train(&jobs, &on(tensors)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    let raise = |_: &_| stop.store(true, Ordering::Relaxed);
    let broken = Control {
        checkpoints: Some(folder.path()),
        cancel: Some(&stop),
        progress: Some(&raise),
        ..on(tensors)
    };
    assert!(matches!(train(&jobs, &broken), Err(Error::Interrupted)));
    let kept = Control {
        checkpoints: Some(folder.path()),
        ..Control::default()
    };
    // The kernels do not go on from it: that would be a third result.
    assert!(matches!(
        train(&jobs, &kept),
        Err(Error::OtherCheckpoint { .. })
    ));
    let resumed = Control {
        tensors: Some(tensors),
        ..kept
    };
    assert_eq!(train(&jobs, &resumed).unwrap(), straight);
}
