//! One sample through six units on one thread, against the time that reading their weights takes and against ONNX Runtime,
//! in one interleaved run:
//!
//! `RESIDYN_PYTHON=python taskset -c 1 cargo bench -p residyn-compensator --bench inference`
//!
//! Whatever else runs on the machine only adds time, so ratios are those of the shortest rounds; medians stand beside them.

use compensator::onnx::export_all;
use feedforward::network::{
    Architecture, Bounds, Compensator, Fade, Memory, Normaliser, Recurrent, Stream, Unit, Weights,
};
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

const ROUNDS: usize = 100;
/// Samples of a round: few, so that some rounds end before the machine turns to something else.
const SAMPLES: usize = 20;
type Failure = Box<dyn std::error::Error>;

/// Six units, one for each joint, of `members` networks as wide as `width`. Unit j sees motion of joints j to 6.
fn compensator(
    width: usize,
    members: usize,
    memory: Memory,
    weights: Weights,
) -> Option<Compensator> {
    let architecture = Architecture::Recurrent(Recurrent {
        encoder: width,
        attention: Some(width),
        reencoder: width,
        memory,
    });
    let unit = |joint| {
        let blocks = (0..3).flat_map(|block| (joint..6).map(move |j| 6 * block + j));
        let columns: Vec<usize> = blocks.collect();
        let d = columns.len();
        let identity = (0..d * d).map(|k| if k % (d + 1) == 0 { 1.0 } else { 0.0 });
        let count = architecture.parameter_count(d)?;
        let draw = |k: usize| ((k * 7919 % 2003) as f32 / 1001.5 - 1.0) * 0.09;
        Some(Unit {
            joint,
            enabled: true,
            architecture: architecture.clone(),
            columns,
            input: Normaliser::new(vec![0.0; d], vec![1.0; d])?,
            target: Normaliser::new(vec![0.0], vec![1.0])?,
            bounds: Bounds::new(
                vec![-1.0; d],
                vec![1.0; d],
                vec![0.0; d],
                identity.collect(),
                9.0,
                50.0,
                Fade::default(),
            )?,
            members: (0..members)
                .map(|m| (0..count).map(|k| draw(k + m)).collect())
                .collect(),
            weights,
        })
    };
    Some(Compensator {
        joints: (1..=6).map(|j| format!("joint_{j}")).collect(),
        inputs: (0..18).map(|c| format!("column_{c}")).collect(),
        units: (0..6).map(unit).collect::<Option<_>>()?,
    })
}

/// What is timed.
enum Subject {
    /// Our run-time.
    Ours(Box<Stream>),
    /// Reading as many words of 32 bits as the weights have.
    Floor(Vec<u32>),
    /// ONNX Runtime on a graph, in single precision or in its own whole numbers.
    Peer(PathBuf, &'static str),
}

struct Row {
    name: String,
    subject: Subject,
    /// Microseconds for a sample, by round.
    times: Vec<f64>,
}

impl Row {
    fn shortest(&self) -> f64 {
        self.times.iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn median(&self) -> f64 {
        let mut times = self.times.clone();
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }
}

/// Python with ONNX Runtime, asked by lines.
struct Peer(Child, BufReader<std::process::ChildStdout>);

impl Peer {
    fn start() -> Result<Option<Self>, Failure> {
        let Some(python) = std::env::var_os("RESIDYN_PYTHON") else {
            return Ok(None);
        };
        let script = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/benches/peers/onnxruntime_units.py"
        );
        let mut child = Command::new(python)
            .arg(script)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let output = BufReader::new(child.stdout.take().ok_or("stdout")?);
        Ok(Some(Self(child, output)))
    }

    /// Microseconds for a sample.
    fn time(&mut self, graph: &Path, form: &str) -> Result<f64, Failure> {
        let input = self.0.stdin.as_mut().ok_or("stdin")?;
        writeln!(input, "{} {form} {SAMPLES}", graph.display())?;
        let mut line = String::new();
        self.1.read_line(&mut line)?;
        Ok(line.trim().parse::<f64>()? * 1e-3)
    }
}

/// Sums of all words, so that every one is read.
fn read(words: &[u32]) -> [u32; 128] {
    struct Read<'a>(&'a [u32]);
    impl pulp::WithSimd for Read<'_> {
        type Output = [u32; 128];

        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _: S) -> [u32; 128] {
            let mut sums = [0_u32; 128];
            for words in self.0.as_chunks::<128>().0 {
                for j in 0..128 {
                    sums[j] = sums[j].wrapping_add(words[j]);
                }
            }
            sums
        }
    }
    pulp::Arch::new().dispatch(Read(words))
}

fn time(subject: &mut Subject, peer: &mut Option<Peer>, round: usize) -> Result<f64, Failure> {
    let start = Instant::now();
    match subject {
        Subject::Peer(graph, form) => {
            let peer = peer.as_mut().ok_or("no peer")?;
            return peer.time(graph, form);
        }
        Subject::Floor(words) => {
            for _ in 0..SAMPLES {
                black_box(read(black_box(words)));
            }
        }
        Subject::Ours(stream) => {
            let (mut inputs, mut torque) = ([0.0_f32; 18], [0.0; 6]);
            for i in 0..SAMPLES {
                let t = (round * SAMPLES + i) as f32 * 1e-3;
                for (c, x) in inputs.iter_mut().enumerate() {
                    *x = (t + c as f32).sin();
                }
                stream.step(&inputs, &mut torque);
            }
            black_box(torque);
        }
    }
    Ok(start.elapsed().as_secs_f64() * 1e6 / SAMPLES as f64)
}

fn main() -> Result<(), Failure> {
    let mut peer = Peer::start()?;
    if peer.is_none() {
        println!("without ONNX Runtime: RESIDYN_PYTHON names no interpreter");
    }
    let folder = tempfile::tempdir()?;
    let window = Memory::Window { timestep: 3 };
    let shapes = [
        ("128 + 128, windows of 3", 128, 1, window),
        (
            "128 + 128, carried state",
            128,
            1,
            Memory::Carried { attended: 3 },
        ),
        ("default: 3 × (32 + 32), windows of 3", 32, 3, window),
    ];
    for (n, (name, width, members, memory)) in shapes.into_iter().enumerate() {
        let mut rows = Vec::new();
        let mut add = |name: String, subject| {
            rows.push(Row {
                name,
                subject,
                times: Vec::new(),
            });
        };
        for (form, bytes) in [(Weights::F32, 4), (Weights::Bf16, 2), (Weights::Int8, 1)] {
            let built = compensator(width, members, memory, form).ok_or("sizes")?;
            let weights: usize = built
                .units
                .iter()
                .flat_map(|u| &u.members)
                .map(Vec::len)
                .sum();
            add(
                format!("reading {bytes} B a weight"),
                Subject::Floor((0..weights * bytes / 4).map(|i| i as u32).collect()),
            );
            add(
                format!("residyn {form:?}").to_lowercase(),
                Subject::Ours(Box::new(built.stream()?)),
            );
        }
        if peer.is_some() {
            let built = compensator(width, members, memory, Weights::F32).ok_or("sizes")?;
            let path = folder.path().join(format!("{n}.onnx"));
            match export_all(&built) {
                Ok(graph) => {
                    std::fs::write(&path, graph)?;
                    add(
                        "ONNX Runtime f32".into(),
                        Subject::Peer(path.clone(), "f32"),
                    );
                    add("ONNX Runtime int8".into(), Subject::Peer(path, "int8"));
                }
                Err(reason) => println!("{name}: no graph for ONNX Runtime: {reason}"),
            }
        }
        for round in 0..ROUNDS {
            for row in &mut rows {
                row.times.push(time(&mut row.subject, &mut peer, round)?);
            }
        }
        println!("\nSix units of {name}; µs a sample, shortest round and median:");
        for row in &rows {
            println!(
                "{:24} {:8.1} {:8.1}",
                row.name,
                row.shortest(),
                row.median()
            );
        }
        let of = |name: &str| rows.iter().find(|r| r.name == name).map(Row::shortest);
        let ratio = |above: &str, below: &str| {
            if let (Some(a), Some(b)) = (of(above), of(below)) {
                println!("{above} over {below}: {:.2}", a / b);
            }
        };
        ratio("residyn f32", "reading 4 B a weight");
        ratio("residyn bf16", "reading 2 B a weight");
        ratio("residyn int8", "reading 1 B a weight");
        ratio("ONNX Runtime f32", "residyn f32");
        ratio("ONNX Runtime int8", "residyn int8");
    }
    Ok(())
}
