//! Training throughput of one unit of the paper's size (18 inputs, T = 3, 128 + 128) against PyTorch on
//! one thread each, in one interleaved run:
//!
//! `RESIDYN_PYTHON=python cargo bench -p residyn-compensator --bench training`
//!
//! Both sides count CPU time, so a busy machine distorts little. Ours is the whole training loop (gather,
//! scaling, dropout, cost, clipping, Adam); the peer's is forward, backward and Adam on a ready batch.

use std::io::{BufRead, BufReader, Write};
use std::process::{ChildStdin, ChildStdout, Command, Stdio};

use compensator::training::{Control, Job, Samples, Schedule, Split, Training, UnitConfig, train};
use feedforward::network::{Architecture, Memory, Recurrent};
use ndarray::{Array1, Array2};

const ROWS: usize = 8192;
const ROUNDS: usize = 5;
type Failure = Box<dyn std::error::Error>;

/// CPU time of this thread, s (Linux).
fn cpu_time() -> Result<f64, Failure> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat")?;
    let nanoseconds: f64 = text
        .split_whitespace()
        .next()
        .ok_or("empty schedstat")?
        .parse()?;
    Ok(nanoseconds * 1e-9)
}

/// Samples per CPU second: two epochs more, so preparation cancels.
fn ours(batch: usize, attention: Option<usize>) -> Result<f64, Failure> {
    let inputs = Array2::from_shape_fn((ROWS, 18), |(i, j)| ((i * (j + 3)) as f32 * 0.01).sin());
    let target = Array1::from_shape_fn(ROWS, |i| (i as f32 * 0.05).cos());
    let rows = 0..ROWS;
    let samples = Samples::new(
        inputs.view(),
        target.view(),
        None,
        std::slice::from_ref(&rows),
    )?;
    let memory = Memory::Window { timestep: 3 };
    let mut times = [0.0; 2];
    for (epochs, time) in [1, 3].into_iter().zip(&mut times) {
        let training = Training {
            epochs,
            batch,
            dropout: 0.5,
            schedule: Schedule::Constant,
            ..Training::default()
        };
        let architecture = Architecture::Recurrent(Recurrent {
            encoder: 128,
            attention,
            reencoder: 128,
            memory,
        });
        let config = UnitConfig {
            architecture,
            training,
            ..UnitConfig::default()
        };
        let split = Split {
            train: vec![0],
            validation: Vec::new(),
        };
        let job = Job {
            joint: 0,
            columns: (0..18).collect(),
            samples,
            split,
            config,
            seed: 1,
        };
        let start = cpu_time()?;
        train(&[job], &Control::default())?;
        *time = cpu_time()? - start;
    }
    Ok(2.0 * ROWS as f64 / (times[1] - times[0]))
}

struct Peer(ChildStdin, BufReader<ChildStdout>);

impl Peer {
    fn start(python: std::ffi::OsString) -> Result<Self, Failure> {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/pytorch.py");
        let mut child = Command::new(python)
            .arg(script)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (input, output) = (
            child.stdin.take().ok_or("stdin")?,
            child.stdout.take().ok_or("stdout")?,
        );
        Ok(Self(input, BufReader::new(output)))
    }

    fn rate(&mut self, batch: usize, attention: bool) -> Result<f64, Failure> {
        writeln!(self.0, "{batch} {}", u8::from(attention))?;
        self.0.flush()?;
        let mut line = String::new();
        self.1.read_line(&mut line)?;
        Ok(line.trim().parse()?)
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() -> Result<(), Failure> {
    let mut peer = match std::env::var_os("RESIDYN_PYTHON") {
        Some(python) => Some(Peer::start(python)?),
        None => {
            println!("RESIDYN_PYTHON names no interpreter with torch: no peer, no ratio");
            None
        }
    };
    println!("samples per CPU second, one thread, median of {ROUNDS} interleaved rounds");
    for (batch, attention) in [(256, true), (256, false), (512, true), (512, false)] {
        let (mut rust, mut torch) = (Vec::new(), Vec::new());
        for _ in 0..ROUNDS {
            rust.push(ours(batch, attention.then_some(128))?);
            if let Some(peer) = &mut peer {
                torch.push(peer.rate(batch, attention)?);
            }
        }
        let name = if attention {
            "with attention"
        } else {
            "without attention"
        };
        let rust = median(rust);
        print!("batch {batch}, {name}: {rust:.0}");
        match torch.is_empty() {
            true => println!(),
            false => {
                let torch = median(torch);
                println!(", PyTorch {torch:.0}, ratio {:.2}", rust / torch);
            }
        }
    }
    Ok(())
}
