//! Any text as a `model.json`: an error or a model that can be evaluated, never a panic.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run model`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use model::directory::ModelFile;

fuzz_target!(|text: &str| {
    if let Ok(file) = ModelFile::parse(text, "model.json".into()) {
        file.physics.model().expect("checked when read");
        let _ = file.covariance_table();
    }
});
