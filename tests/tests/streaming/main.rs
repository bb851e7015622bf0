//! The run-time against `eval`: the same torque over whole recordings, sample by sample, without allocation.

mod embedded;

use datasets::prepare::{Derivatives, PrepareOptions, Prepared, prepare};
use datasets::{ReadOptions, Recording};
use feedforward::clock::LONGEST_PAUSE;
use feedforward::{Feedforward, LoadError};
use physics::robot::Robot;
use signal::Motion;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use tests::program::{json, program, run};
use tests::synthetic::{Plan, record_to};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, counting the calls of each thread.
struct Counting;

// SAFETY: every call is handed on to `System` unchanged; the counter is a `Cell` without destructor in
// constant-initialised thread-local storage, so counting itself neither allocates nor unwinds.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller upholds the contract of `alloc`, which is that of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `alloc` above, thus from `System`, with the same layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Further apart than memory is carried.
const FAR: f64 = 1000.0;

fn train(robot: &str, data: &Path, out: &Path, extra: &[&str]) {
    let mut train = program("train");
    train.args(["--robot", robot, "--quiet", "--members", "2"]);
    train.arg("--data").arg(data).arg("--out").arg(out);
    run(train.args(extra)).succeeded();
}

/// Whether some joint's network is on: without one, little would be compared.
fn has_a_unit(model: &Path) -> bool {
    let file = json(&model.join("model.json"));
    let units = file["compensator"]["validation"].as_array();
    units.is_some_and(|units| units.iter().any(|u| u["enabled"] == true))
}

/// The recording, and what `eval --predict` makes of it, row by row.
fn predicted(model: &Path, data: &Path, to: &Path) -> (Recording, Vec<Vec<f64>>) {
    let mut eval = program("eval");
    eval.arg("--model").arg(model).arg("--data").arg(data);
    run(eval.arg("--predict").arg(to)).succeeded();
    let recording = datasets::read(data, &ReadOptions::default()).expect("a recording");
    let joints = recording.dof();
    let text = std::fs::read_to_string(to).expect("a prediction");
    let rows = text
        .lines()
        .skip(1)
        .map(|line| {
            let torque = line.split(',').skip(2).take(joints);
            torque.map(|t| t.parse().expect("a number")).collect()
        })
        .collect();
    (recording, rows)
}

/// Streams a motion through the run-time, a reset before each trajectory or, where the one before is near, a
/// pause, and hands every row's torque on.
/// Counts the allocations in between.
fn stream(
    model: &mut Feedforward,
    motion: &Motion,
    clock: bool,
    mut visit: impl FnMut(usize, &[f64]),
) {
    let rows: Vec<[Vec<f64>; 3]> = (0..motion.len())
        .map(|r| [&motion.q, &motion.qd, &motion.qdd].map(|table| table.row(r).to_vec()))
        .collect();
    let mut tau = vec![0.0; model.dof()];
    let mut allocations = 0;
    let mut last = None;
    for segment in &motion.segments {
        let start = motion.time[segment.start];
        match last.map(|end| start - end) {
            Some(pause) if pause <= LONGEST_PAUSE => model.pause(pause),
            _ => model.reset(clock.then_some(start)),
        }
        last = Some(motion.time[segment.end - 1]);
        for row in segment.clone() {
            let [q, qd, qdd] = &rows[row];
            let before = ALLOCATIONS.get();
            model.torque(q, qd, qdd, &mut tau);
            allocations += ALLOCATIONS.get() - before;
            visit(row, &tau);
        }
    }
    assert_eq!(allocations, 0, "the control loop allocates");
    // The counter does count.
    let before = ALLOCATIONS.get();
    drop(std::hint::black_box(vec![0_u8; 9]));
    assert!(ALLOCATIONS.get() > before);
}

/// The motion as `eval` prepares it for the model.
fn prepared(recording: &Recording, model: &Path) -> Prepared {
    let own = &json(&model.join("model.json"))["preprocessing"];
    let options = PrepareOptions {
        cutoff_hz: own["cutoff_hz"].as_f64(),
        derivatives: if own["position_alone"] == true {
            Derivatives::FromPosition
        } else {
            Derivatives::Auto
        },
        ..PrepareOptions::default()
    };
    prepare(recording, &options).expect("it was used by eval")
}

/// Largest difference of one row from the prediction, N·m.
fn difference(tau: &[f64], expected: &[f64]) -> f64 {
    std::iter::zip(tau, expected)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// At a rate at which nothing is resampled, the motion that eval took is fed to the run-time as it is: once on a
/// clock of its own, once on that of the training recording.
#[test]
fn same_torque_as_eval_at_the_recorded_rate() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| -> PathBuf { folder.path().join(name) };
    let robot = Robot::builtin("ur5").expect("built in");
    let plan = |seed: u64, start: f64, pause: f64| Plan {
        trajectories: 8,
        pause,
        seed,
        start,
        ..Plan::default()
    };
    // On the training recording's clock: between its trajectories, far from all; then soon after the last one.
    let (between, next) = (0.7 * FAR, 7.1 * FAR);
    let data = record_to(folder.path(), "train.csv", &robot, &plan(1, 0.0, FAR));
    // Everything there is to choose: warm-up, memory, load.
    train("ur5", &data, &place("model"), &["--epochs", "20"]);
    assert!(has_a_unit(&place("model")));
    let text = std::fs::read_to_string(place("model/model.json")).expect("a model");
    assert!(text.contains("warm_up"), "the clock is part of the test");
    let cases = [
        (0.0, FAR, false),
        (0.0, 2.0, false),
        (between, FAR, true),
        (next, FAR, true),
        (next, 2.0, true),
    ];
    for (start, pause, known) in cases {
        let test = record_to(folder.path(), "test.csv", &robot, &plan(2, start, pause));
        let (recording, expected) = predicted(&place("model"), &test, &place("torque.csv"));
        let mut model = Feedforward::load(&place("model"), None).expect("a model");
        assert!((model.period() - 0.01).abs() < 1e-9);
        let motion = prepared(&recording, &place("model"));
        let mut worst = 0.0_f64;
        stream(&mut model, &motion.at_samples, known, |row, tau| {
            worst = worst.max(difference(tau, &expected[row]));
        });
        assert!(
            worst < 1e-6,
            "{worst} N·m from eval, start {start} s, pause {pause} s"
        );
        a_sample_that_is_not_finite(&model, &motion.at_samples);
        a_motion_of_denormal_numbers(&model);
        if (start, pause, known) == (next, 2.0, true) {
            // The last one: its memory comes from the training's clock, and its trajectories follow each other.
            let rows = embedded::rows(&motion.at_samples, &expected);
            embedded::follow(&place("model"), model.period(), &rows, folder.path());
        }
    }
    periods_of_the_compensator(&place("model"));
}

/// Every torque of a sample with a hole is NaN; those after it are as they would have been, from a second later on to a
/// thousandth of the largest.
fn a_sample_that_is_not_finite(model: &Feedforward, motion: &Motion) {
    let [mut whole, mut holed] = [model.clone(), model.clone()];
    let [mut a, mut b] = [(); 2].map(|()| vec![0.0; model.dof()]);
    whole.reset(None);
    holed.reset(None);
    let (mut largest, mut worst) = (0.0_f64, 0.0_f64);
    let rows = motion.segments[0].len().min(400);
    let hole = rows / 2;
    for row in 0..rows {
        let [q, qd, mut qdd] =
            [&motion.q, &motion.qd, &motion.qdd].map(|table| table.row(row).to_vec());
        whole.torque(&q, &qd, &qdd, &mut a);
        if row == hole {
            qdd[1] = f64::NAN;
        }
        holed.torque(&q, &qd, &qdd, &mut b);
        assert_eq!(b.iter().all(|t| t.is_nan()), row == hole);
        assert!(row == hole || b.iter().all(|t| t.is_finite()));
        largest = a.iter().fold(largest, |l, t| l.max(t.abs()));
        if row > hole + 100 {
            worst = worst.max(difference(&a, &b));
        }
    }
    assert!(worst < 1e-3 * largest, "{worst} of {largest} N·m");
}

/// Denormal numbers, with which arithmetic is slow, count as zero.
fn a_motion_of_denormal_numbers(model: &Feedforward) {
    let [mut still, mut fading] = [model.clone(), model.clone()];
    let n = model.dof();
    let (zero, faint, q) = (vec![0.0; n], vec![1e-310; n], vec![0.4; n]);
    let [mut a, mut b] = [(); 2].map(|()| vec![0.0; n]);
    for _ in 0..20 {
        still.torque(&q, &zero, &zero, &mut a);
        fading.torque(&q, &faint, &faint, &mut b);
        assert_eq!(a, b);
    }
}

/// A network of 100 Hz goes with no loop in which its windows were twice as long, or its copies without number.
fn periods_of_the_compensator(model: &Path) {
    for period in [0.02, 1e-9, 1e-300] {
        let refused = Feedforward::load(model, Some(period));
        assert!(
            matches!(refused, Err(LoadError::Windows { .. })),
            "{period}"
        );
        assert!(Feedforward::load_physics(model, Some(period)).is_ok());
    }
    for period in [0.0, f64::NAN] {
        let refused = Feedforward::load(model, Some(period));
        assert!(matches!(refused, Err(LoadError::Period(_))), "{period}");
    }
    assert!(Feedforward::load(model, Some(0.001)).is_ok());
}

/// Recorded at 60 Hz, memory runs on a grid of 120 Hz and the network sees every second point of it: a loop at
/// 120 Hz, fed the motion on that grid, gives eval's torque at every recorded stamp.
#[test]
fn same_torque_as_eval_between_the_recorded_samples() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| -> PathBuf { folder.path().join(name) };
    let robot = Robot::builtin("foxbot_a05").expect("built in");
    let plan = |seed: u64| Plan {
        trajectories: 8,
        rate: 60.0,
        seconds: 8.0,
        pause: FAR,
        seed,
        ..Plan::default()
    };
    let data = record_to(folder.path(), "train.csv", &robot, &plan(3));
    let test = record_to(folder.path(), "test.csv", &robot, &plan(4));
    train(
        "foxbot_a05",
        &data,
        &place("model"),
        &["--basic", "--epochs", "40"],
    );
    assert!(has_a_unit(&place("model")));
    let (recording, expected) = predicted(&place("model"), &test, &place("torque.csv"));
    let mut model = Feedforward::load(&place("model"), Some(1.0 / 120.0)).expect("a model");
    let motion = prepared(&recording, &place("model"));
    let starts: Vec<[usize; 2]> = std::iter::zip(&motion.fine.segments, recording.segments())
        .map(|(fine, rows)| {
            assert_eq!(fine.len(), 2 * rows.len() - 1, "two fine steps per sample");
            [fine.start, rows.start]
        })
        .collect();
    let mut worst = 0.0_f64;
    let mut compared = 0;
    stream(&mut model, &motion.fine, false, |row, tau| {
        let [fine, recorded] = starts[starts.partition_point(|s| s[0] <= row) - 1];
        if (row - fine) % 2 == 0 {
            let sample = recorded + (row - fine) / 2;
            worst = worst.max(difference(tau, &expected[sample]));
            compared += 1;
        }
    });
    assert_eq!(compared, recording.len());
    assert!(worst < 1e-6, "{worst} N·m from eval");
}
