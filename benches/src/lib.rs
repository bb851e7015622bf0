//! What the benchmarks share: peers in other languages, and ratios from one run.
#![forbid(unsafe_code)]

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

/// Where build products lie.
pub fn target_dir() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"),
        PathBuf::from,
    )
}

/// A program of another language that times itself: to the line `NAME ITERATIONS` it answers with nanoseconds.
pub struct Peer {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts the program and sends it its set-up. `None`, with the reason on standard error, when it was not
    /// built.
    pub fn start(program: &Path, setup: &str) -> Option<Self> {
        let spawned = Command::new(program)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn();
        let mut child = match spawned {
            Ok(child) => child,
            Err(reason) => {
                eprintln!("no peer: {}: {reason}", program.display());
                return None;
            }
        };
        let mut input = child.stdin.take()?;
        let output = BufReader::new(child.stdout.take()?);
        writeln!(input, "{setup}").ok()?;
        Some(Self {
            child,
            input,
            output,
        })
    }

    /// Time that the peer takes for `iterations` of `name`.
    ///
    /// # Panics
    /// When the peer dies or answers something else.
    pub fn time(&mut self, name: &str, iterations: u64) -> Duration {
        writeln!(self.input, "{name} {iterations}").expect("the peer listens");
        let mut answer = String::new();
        self.output
            .read_line(&mut answer)
            .expect("the peer answers");
        Duration::from_nanos(answer.trim().parse().expect("the peer answers nanoseconds"))
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // A peer that is already gone is as good as a stopped one.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Time per iteration in nanoseconds, from the samples that criterion took in this run: their first decile.
/// Whatever else runs on the machine only ever adds time, so a low quantile compares the programs, and the median
/// the moments at which they ran.
pub fn quiet(group: &str, function: &str) -> Option<f64> {
    let path = target_dir()
        .join("criterion")
        .join(group)
        .join(function)
        .join("new/sample.json");
    let sample: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
    let numbers = |key: &str| -> Option<Vec<f64>> {
        sample[key].as_array()?.iter().map(|v| v.as_f64()).collect()
    };
    let mut each: Vec<f64> = numbers("times")?
        .iter()
        .zip(numbers("iters")?)
        .map(|(time, iterations)| time / iterations)
        .collect();
    each.sort_by(f64::total_cmp);
    each.get(each.len() / 10).copied()
}
