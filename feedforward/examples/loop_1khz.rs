//! Time and allocations of a 1 kHz control loop that asks a trained model for its torque.
//!
//! `cargo run --release -p residyn-feedforward --example loop_1khz -- MODEL_DIRECTORY`

use feedforward::Feedforward;
use std::alloc::{GlobalAlloc, Layout, System};
use std::f64::consts::TAU;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const PERIOD: Duration = Duration::from_millis(1);
const CYCLES: usize = 20_000;

/// The system's allocator, counting.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed on unchanged to the system's allocator, which keeps the contract.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise on `layout` is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `System.alloc` with this layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Position, velocity and acceleration of a joint that swings ±0.5 rad, slower towards the base.
fn motion(joint: usize, t: f64) -> [f64; 3] {
    let w = TAU * (0.1 + 0.03 * joint as f64);
    let (sin, cos) = (w * t).sin_cos();
    [0.5 * sin, 0.5 * w * cos, -0.5 * w * w * sin]
}

fn run(directory: &Path) -> Result<(), feedforward::LoadError> {
    let period = PERIOD.as_secs_f64();
    let mut model = Feedforward::load(directory, Some(period))?;
    let n = model.dof();
    let [mut q, mut qd, mut qdd, mut tau, mut largest] = [(); 5].map(|()| vec![0.0; n]);
    let mut times = Vec::with_capacity(CYCLES);
    let mut late = 0;
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    let start = Instant::now();
    for cycle in 0..CYCLES {
        let due = start + PERIOD * cycle as u32;
        match due.checked_duration_since(Instant::now()) {
            Some(wait) => std::thread::sleep(wait),
            None => late += usize::from(cycle > 0),
        }
        for j in 0..n {
            [q[j], qd[j], qdd[j]] = motion(j, cycle as f64 * period);
        }
        let asked = Instant::now();
        model.torque(&q, &qd, &qdd, &mut tau);
        times.push(asked.elapsed());
        for (largest, tau) in largest.iter_mut().zip(&tau) {
            *largest = tau.abs().max(*largest);
        }
    }
    let allocations = ALLOCATIONS.load(Ordering::Relaxed) - before;
    times.sort_unstable();
    let at = |share: f64| times[(share * (CYCLES - 1) as f64).round() as usize].as_secs_f64() * 1e6;
    println!(
        "{n} joints, {CYCLES} cycles of {period} s in {:.2} s",
        start.elapsed().as_secs_f64()
    );
    println!(
        "torque(): p50 {:.1} µs, p99 {:.1} µs, p99.9 {:.1} µs, max {:.1} µs",
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
    println!("cycles that began late: {late}; allocations in the loop: {allocations}");
    println!("largest |torque| by joint: {largest:.1?}");
    Ok(())
}

fn main() -> ExitCode {
    let Some(directory) = std::env::args_os().nth(1) else {
        eprintln!("usage: loop_1khz MODEL_DIRECTORY");
        return ExitCode::from(2);
    };
    match run(Path::new(&directory)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(2)
        }
    }
}
