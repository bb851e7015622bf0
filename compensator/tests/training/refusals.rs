//! Data and settings that nothing can be learned with.

use crate::hysteresis::{WINDOW, hysteresis, short};
use compensator::Error;
use compensator::training::{Control, Job, Loss, Samples, train};
use ndarray::Array1;

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
