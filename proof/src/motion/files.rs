//! Files that a sealed case hands out: recordings and drive file.

use super::MotionError;
use super::effects::Truth;
use super::real::{LENGTH, Moved, Real};
use datasets::{Recording, Trajectory};
use ndarray::{Array2, Axis, concatenate};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Recording of some trajectories as a logger would make it: positions with noise and quantisation, and times with
/// jitter. `rates`: whether commanded velocities are recorded. Beside it the standard deviation of noise and quantisation, rad.
pub(super) fn record(
    moved: &[Moved],
    period: f64,
    rates: bool,
    rng: &mut ChaCha8Rng,
) -> Result<(Recording, f64), MotionError> {
    let count = TAU / f64::from(1u32 << rng.random_range(12..18));
    let noise = count * rng.random_range(0.1..0.5);
    let jitter = period * rng.random_range(0.0..0.05);
    let mut time = Vec::new();
    for (k, m) in moved.iter().enumerate() {
        let start = k as f64 * (LENGTH + 2.0);
        time.extend(
            (0..m.q.nrows())
                .map(|row| start + row as f64 * period + jitter * rng.random_range(0.0..1.0)),
        );
    }
    let join = |of: &dyn Fn(&Moved) -> Array2<f64>| -> Array2<f64> {
        let tables: Vec<Array2<f64>> = moved.iter().map(of).collect();
        let views: Vec<_> = tables.iter().map(|t| t.view()).collect();
        concatenate(Axis(0), &views).expect("tables of one robot")
    };
    let mut q = join(&|m| m.q.clone());
    q.mapv_inplace(|v| {
        let z: f64 = StandardNormal.sample(rng);
        ((v + noise * z) / count).round() * count
    });
    let mut recording = Recording::new("simulation", time, q, None);
    recording.q_ref = Some(join(&|m| m.q_ref.clone()));
    recording.qd_ref = rates.then(|| join(&|m| m.qd_ref.clone()));
    let mut start = 0;
    recording.trajectories = moved
        .iter()
        .enumerate()
        .map(|(k, m)| {
            let range = start..start + m.q.nrows();
            start = range.end;
            Trajectory {
                label: (k + 1).to_string(),
                range,
            }
        })
        .collect();
    Ok((recording, noise.hypot(count / 12f64.sqrt())))
}

/// Drive file as TOML text, with the gains of the robot `nominal` and their tolerance.
pub(super) fn drive_file(nominal: &Real, tolerance: f64, period: f64) -> String {
    let list = |values: &[f64]| {
        let each: Vec<String> = values.iter().map(|v| format!("{v:.6e}")).collect();
        format!("[{}]", each.join(", "))
    };
    let mut text = String::from("[controller]\nkind = \"pd\"\n");
    let _ = writeln!(text, "kp = {}", list(&nominal.kp));
    let _ = writeln!(text, "kd = {}", list(&nominal.kd));
    let _ = writeln!(text, "limit = {}", list(&nominal.limit));
    let _ = writeln!(
        text,
        "tolerance = {{ kp = {tolerance:?}, kd = {tolerance:?} }}"
    );
    let _ = writeln!(text, "period = {period}\ninterpolation = \"hold\"");
    let _ = writeln!(
        text,
        "gravity_compensation = {}",
        nominal.gravity_compensation != 0.0
    );
    text
}

/// True gains and delays of all drives.
pub(super) fn drives(real: &Real) -> Vec<Truth> {
    let mut out = Vec::new();
    for (j, joint) in real.arm.joints.iter().enumerate() {
        let mut add = |name: &str, value: f64| {
            out.push(Truth {
                name: name.to_owned(),
                joint: Some(joint.name.clone()),
                value,
            });
        };
        add("kp", real.kp[j]);
        add("kd", real.kd[j]);
        add("delay", real.late[j]);
    }
    out
}
