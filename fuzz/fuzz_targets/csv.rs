//! Any bytes as a .csv file: an error or a sound recording, never a panic.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run csv`.
#![no_main]

use datasets::read::{Format, read_bytes};
use datasets::{Part, ReadOptions};
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    for part in [Part::Train, Part::Test] {
        let options = ReadOptions::kr300(part);
        if let Ok(recording) = read_bytes(bytes, Format::Csv, Path::new("fuzz"), &options) {
            recording.validate().expect("what is read is sound");
        }
    }
});
