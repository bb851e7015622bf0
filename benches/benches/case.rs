//! Cost of a diagnosis: one case (12 trajectories of 15 s at 250 Hz, full catalogue), and how it grows with the data.

use criterion::{BenchmarkId, Criterion, Throughput};
use datasets::{Recording, Trajectory};
use diagnose::NominalModel;
use diagnose::{Options, diagnose};
use ndarray::{Axis, concatenate};
use physics::robot::Robot;
use std::hint::black_box;
use trials::cases::{Case, draw, generate};

/// The recording `times` times in a row, on one clock.
fn repeated(recording: &Recording, times: usize) -> Recording {
    let table = |t: &ndarray::Array2<f64>| {
        let views = vec![t.view(); times];
        concatenate(Axis(0), &views).expect("equal widths")
    };
    let last = recording.time.last().copied().unwrap_or(0.0);
    let span = last - recording.time[0] + 2.0;
    let mut out = Recording::new(
        &recording.source,
        (0..times)
            .flat_map(|k| recording.time.iter().map(move |t| t + k as f64 * span))
            .collect(),
        table(&recording.q),
        recording.tau.as_ref().map(table),
    );
    out.qd = recording.qd.as_ref().map(table);
    out.trajectories = (0..times)
        .flat_map(|k| {
            let start = k * recording.len();
            recording.trajectories.iter().map(move |t| Trajectory {
                label: format!("{}-{k}", t.label),
                range: start + t.range.start..start + t.range.end,
            })
        })
        .collect();
    out
}

fn case() -> Case {
    // The first case of the run with a robot of seven joints.
    (0..)
        .map(|index| generate(&draw(index, 5), 5).expect("a case"))
        .find(|c| c.truth.joints == 7)
        .expect("an endless run holds one")
}

/// Largest resident size of this process, as the kernel says it.
fn most_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut lines = status.lines();
    let said = lines.find_map(|l| l.strip_prefix("VmHWM:"));
    said.map_or_else(|| "not known".into(), |s| s.trim().into())
}

fn benchmark(criterion: &mut Criterion) {
    let case = case();
    let model = NominalModel::new(Robot::from_urdf_str(&case.urdf).expect("a robot"));
    let run = |data: &Recording, heldout: &Recording| {
        diagnose(&model, data, heldout, &Options::default()).expect("a diagnosis")
    };
    let mut group = criterion.benchmark_group("diagnosis");
    group.sample_size(10);
    group.throughput(Throughput::Elements(
        (case.train.len() + case.test.len()) as u64,
    ));
    group.bench_function("one case", |b| {
        b.iter(|| black_box(run(&case.train, &case.test)));
    });
    println!("most memory so far: {}", most_memory());
    // Elements per second must not fall from the first to the second.
    let (few, one) = (case.train.select(&[0, 1]), case.test.select(&[0]));
    for times in [1, 10] {
        let (data, heldout) = (repeated(&few, times), repeated(&one, times));
        group.throughput(Throughput::Elements((data.len() + heldout.len()) as u64));
        group.bench_function(BenchmarkId::new("data", times), |b| {
            b.iter(|| black_box(run(&data, &heldout)));
        });
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    benchmark(&mut criterion);
    criterion.final_summary();
}
