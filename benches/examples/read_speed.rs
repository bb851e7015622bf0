//! How fast a recording is read, and in how much memory.
//!
//! `cargo run --release --workspace --example read_speed -- FILE [--repeats 5]` reads the recording on one thread, joints in the order in
//! which it has them, and prints size, rows, the median time, MB/s, and (on Linux) the largest memory that the process held. A bag of
//! 104 MB: `datasets/tests/fixtures/bags/make.py --large FILE`.

use clap::Parser;
use datasets::{ReadOptions, read};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How fast a recording is read.
#[derive(Parser)]
struct Arguments {
    /// The recording.
    file: PathBuf,
    /// Joints; what the recording has, where it is not given, at the price of a second pass over a bag.
    #[arg(long)]
    joints: Option<usize>,
    /// How often it is read.
    #[arg(long, default_value_t = 5)]
    repeats: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let options = ReadOptions {
        dof: arguments.joints,
        ..ReadOptions::default()
    };
    let mut seconds = Vec::new();
    let mut rows = 0;
    for _ in 0..arguments.repeats.max(1) {
        let begun = Instant::now();
        rows = read(&arguments.file, &options)?.len();
        seconds.push(begun.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let median = seconds[seconds.len() / 2];
    let size = size(&arguments.file)? as f64 / 1e6;
    println!(
        "{size:.1} MB, {rows} rows: {median:.3} s, {:.0} MB/s",
        size / median
    );
    if let Some(peak) = peak() {
        println!("largest memory held: {peak}");
    }
    Ok(())
}

/// Bytes of a file, or of the files of a folder.
fn size(path: &Path) -> std::io::Result<u64> {
    if !path.is_dir() {
        return Ok(std::fs::metadata(path)?.len());
    }
    let entries = std::fs::read_dir(path)?;
    entries.map(|e| Ok(e?.metadata()?.len())).sum()
}

fn peak() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    Some(line.trim().to_owned())
}
