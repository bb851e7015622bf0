//! Any bytes as an .mcap file: an error or a sound recording, never a panic.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run bag`.
#![no_main]

use datasets::ReadOptions;
use datasets::read::{Format, read_bytes};
use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let known = ReadOptions {
        joints: vec!["shoulder".into(), "elbow".into()],
        ..ReadOptions::for_robot(2)
    };
    for options in [known, ReadOptions::default()] {
        if let Ok(recording) = read_bytes(bytes, Format::Bag, Path::new("fuzz"), &options) {
            recording.validate().expect("what is read is sound");
        }
    }
});
