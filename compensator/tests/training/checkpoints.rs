//! Training that was interrupted.

use crate::hysteresis::{CARRIED, WINDOW, bytes, hysteresis, short};
use compensator::Error;
use compensator::training::{Control, Job, train};
use feedforward::network::Architecture;
use safetensors::{SafeTensors, serialize};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

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
            ..Control::default()
        };
        assert!(matches!(train(&jobs, &control), Err(Error::Interrupted)));
        let control = Control {
            cancel: None,
            progress: None,
            ..control
        };
        assert_eq!(uninterrupted, bytes(&train(&jobs, &control).unwrap()));
        // Finished networks are taken from their checkpoints as they are, and said to be done.
        let said = std::sync::Mutex::new(Vec::new());
        let progress = |p: &compensator::training::Progress| {
            said.lock()
                .unwrap()
                .push((p.epoch, p.finished, p.remaining));
        };
        let watched = Control {
            progress: Some(&progress),
            ..control
        };
        assert_eq!(uninterrupted, bytes(&train(&jobs, &watched).unwrap()));
        assert_eq!(*said.lock().unwrap(), [(5, true, Duration::ZERO)]);

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
