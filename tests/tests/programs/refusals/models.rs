//! Model directories that are refused.

use super::refused::{eval_refuses, folder, model, recording};
use std::path::{Path, PathBuf};

/// A copy of the model directory, to be spoilt.
fn copy_of_model(folder: &Path) -> PathBuf {
    let to = folder.join("model");
    std::fs::create_dir(&to).expect("a folder");
    for (name, bytes) in tests::program::files(&model().join("model")) {
        std::fs::write(to.join(name), bytes).expect("writable");
    }
    to
}

#[test]
fn altered_models() {
    let place = folder();
    let data = place.path().join("r.csv");
    recording().write(&data);
    let weights = "compensator.safetensors";

    let nothing = place.path().join("nothing");
    eval_refuses(&nothing, &data, &["model.json"]);
    let machine = place.path().join("machine");
    std::fs::create_dir(&machine).expect("a folder");
    std::fs::write(machine.join("machine.json"), "{}").expect("writable");
    eval_refuses(&machine, &data, &["machine.json", "machine eval"]);

    let altered = |change: &dyn Fn(&Path), fragments: &[&str]| {
        let place = folder();
        let model = copy_of_model(place.path());
        change(&model);
        eval_refuses(&model, &data, fragments);
    };
    let model_json = |edit: &dyn Fn(String) -> String, fragments: &[&str]| {
        altered(
            &|model| {
                let path = model.join("model.json");
                let text = std::fs::read_to_string(&path).expect("readable");
                let new = edit(text.clone());
                assert_ne!(new, text, "the edit changes nothing");
                std::fs::write(&path, new).expect("writable");
            },
            fragments,
        );
    };
    let size = std::fs::metadata(model().join("model").join(weights))
        .expect("it is there")
        .len() as usize;
    for at in [0, 9, size / 2, size - 1] {
        let flip = |model: &Path| {
            let mut bytes = std::fs::read(model.join(weights)).expect("readable");
            bytes[at] ^= 1;
            std::fs::write(model.join(weights), bytes).expect("writable");
        };
        altered(&flip, &[weights, "checksum"]);
    }
    let cut = |model: &Path| {
        let bytes = std::fs::read(model.join(weights)).expect("readable");
        std::fs::write(model.join(weights), &bytes[..size / 2]).expect("writable");
    };
    altered(&cut, &[weights, "checksum"]);
    let lost = |model: &Path| std::fs::remove_file(model.join(weights)).expect("removable");
    altered(&lost, &[weights]);
    let covariance = "covariance.json";
    let lost = |model: &Path| std::fs::remove_file(model.join(covariance)).expect("removable");
    altered(&lost, &[covariance]);
    let other = |model: &Path| {
        let text = std::fs::read_to_string(model.join(covariance)).expect("readable");
        let new = text.replacen("[[", "[[1", 1);
        std::fs::write(model.join(covariance), new).expect("writable");
    };
    altered(&other, &[covariance, "checksum"]);

    model_json(
        &|t| t[..t.len() / 2].to_owned(),
        &["model.json", "not a model"],
    );
    model_json(&|_| "[]".into(), &["model.json", "schema"]);
    model_json(
        &|t| t.replacen("model/1", "model/9", 1),
        &["model.json", "model/9", "model/1"],
    );
    model_json(
        &|t| t.replace("\"residual_std\"", "\"residual_sd\""),
        &["model.json", "residual_std"],
    );
    model_json(
        &|t| t.replace("shoulder_pan_joint", "another_joint"),
        &["joint"],
    );
}
