//! Any bytes as a .parquet file: an error or a sound recording, never a panic.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run parquet`.
#![no_main]

use datasets::read::{Format, read_bytes};
use datasets::{ColumnMap, Part, ReadOptions};
use libfuzzer_sys::fuzz_target;
use std::path::Path;

/// Elements of lists, as LeRobot data sets have them.
fn lists() -> ReadOptions {
    let names = [
        ("time", "timestamp"),
        ("trajectory", "episode_index"),
        ("q1", "observation.state[0]"),
        ("q2", "observation.state[1]"),
        ("tau1", "observation.current[0]"),
        ("tau2", "observation.current[1]"),
    ];
    let names = names.map(|(key, name)| (key.to_owned(), name.to_owned()));
    ReadOptions {
        columns: ColumnMap {
            names: names.into_iter().collect(),
            ..ColumnMap::default()
        },
        ..ReadOptions::for_robot(2)
    }
}

fuzz_target!(|bytes: &[u8]| {
    let kr300 = [Part::Train, Part::Test].map(ReadOptions::kr300);
    for options in kr300.into_iter().chain([lists()]) {
        if let Ok(recording) = read_bytes(bytes, Format::Parquet, Path::new("fuzz"), &options) {
            recording.validate().expect("what is read is sound");
        }
    }
});
