//! The check of a recording with the robot at hand: scale and shift of the torque, and which parameters the motion
//! tells apart.

use datasets::check::{
    CheckOptions, CheckReport, Finding, Kind, STILL, Severity, check, shift_finding,
};
use datasets::prepare::{PrepareError, PrepareOptions, Prepared, prepare};
use datasets::{Problem, Recording};
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics, regressor};
use physics::identify::base::{BaseParameters, Extra};
use physics::identify::least_squares::{
    Accumulator, LeastSquaresError, SolveOptions, SubRegressors, Triangle, solve,
};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Samples looked at, at most.
const SAMPLES: usize = 5000;
/// A column of which the others leave less than this part to itself is poorly told from them.
const OWN_SHARE: f64 = 0.01;
/// Part of a joint's torque variance that the rigid body has to explain before its scale is judged.
const RIGID_SHARE: f64 = 0.2;
/// Delays tried on either side, in samples (of 10 ms, where they are shorter).
const DELAYS: i32 = 5;
/// Part by which the squared error has to fall before a delay is believed.
const DELAY_GAIN: f64 = 0.1;
/// Kinds of columns beside the rigid ones.
const EXTRAS: [Extra; 4] = [
    Extra::RotorInertia,
    Extra::Viscous,
    Extra::Coulomb,
    Extra::Offset,
];

/// Why a recording could not be checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// It cannot be prepared.
    #[error("{file}: {source}")]
    Prepare {
        /// The recording.
        file: String,
        /// Why.
        source: PrepareError,
    },
    /// It holds nothing to check.
    #[error("{file}: {problem}")]
    Check {
        /// The recording.
        file: String,
        /// Why.
        problem: Problem,
    },
    /// Its regressor could not be taken apart.
    #[error("{file}: {source}")]
    LeastSquares {
        /// The recording.
        file: String,
        /// Why.
        source: LeastSquaresError,
    },
}

/// Checks a recording of `robot`: everything of [`datasets::check`], and what needs a model.
///
/// # Errors
/// See [`CheckError`].
pub fn check_recording(
    robot: &Robot,
    recording: &Recording,
    options: &PrepareOptions,
) -> Result<CheckReport, CheckError> {
    let file = || recording.source.clone();
    let prepared = prepare(recording, options).map_err(|source| CheckError::Prepare {
        file: file(),
        source,
    })?;
    let mut settings = CheckOptions {
        joints: robot.joint_names(),
        position_limits: robot
            .joints()
            .iter()
            .map(|j| [j.limits.lower, j.limits.upper])
            .collect(),
        torque_reference: Vec::new(),
    };
    let failed = |source| CheckError::LeastSquares {
        file: file(),
        source,
    };
    let mut found = Vec::new();
    if recording.dof() == robot.dof() {
        settings.torque_reference =
            torque_reference(robot, recording, &prepared).map_err(failed)?;
        found = fitted(robot, recording, &prepared).map_err(failed)?;
    }
    let mut report =
        check(recording, &prepared, &settings).map_err(|problem| CheckError::Check {
            file: file(),
            problem,
        })?;
    report.findings.extend(found);
    report
        .findings
        .sort_by_key(|f| std::cmp::Reverse(f.severity));
    Ok(report)
}

/// Samples looked at: evenly thinned.
fn thinned(recording: &Recording) -> impl Iterator<Item = usize> + use<> {
    (0..recording.len()).step_by(recording.len().div_ceil(SAMPLES).max(1))
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(s, n), v| (s + v * v, n + 1));
    (sum / count.max(1) as f64).sqrt()
}

/// RMS torque that each joint should show if its scale were that of the robot's model: recorded RMS over the
/// coefficient of the model's torque in a fit beside friction and offset. Zero where nothing can be said, because the
/// rigid body explains too little.
fn torque_reference(
    robot: &Robot,
    recording: &Recording,
    prepared: &Prepared,
) -> Result<Vec<f64>, LeastSquaresError> {
    let n = robot.dof();
    let Some(tau) = &recording.tau else {
        return Ok(Vec::new());
    };
    let motion = &prepared.at_samples;
    let mut workspace = Workspace::new(robot);
    let mut joints: Vec<Accumulator> = (0..n).map(|_| Accumulator::new(4)).collect();
    let mut rigid = vec![0.0; n];
    for k in thinned(recording) {
        let row = |table: &Array2<f64>| table.row(k).to_vec();
        let (q, qd, qdd) = (row(&motion.q), row(&motion.qd), row(&motion.qdd));
        inverse_dynamics(robot, &mut workspace, &q, &qd, &qdd, &mut rigid);
        if let Some(c) = robot.counterbalance() {
            rigid[c.joint] += c.torque(q[c.joint]);
        }
        for (j, rows) in joints.iter_mut().enumerate() {
            let [viscous, coulomb] = [Extra::Viscous, Extra::Coulomb].map(|e| e.value(qd[j], 0.0));
            rows.push(&[1.0, viscous, coulomb, rigid[j]], tau[(k, j)], 1.0)?;
        }
    }
    let mut reference = vec![0.0; n];
    for (j, rows) in joints.into_iter().enumerate() {
        let triangle = rows.finish()?;
        let fit = solve(&triangle, &SolveOptions::default())?;
        // The last diagonal entry is the part of the model's torque that friction cannot imitate; the first column
        // takes the mean.
        let own = (fit.parameters[3] * triangle.r()[(3, 3)]).powi(2);
        let varying = triangle.target_sum_of_squares() - triangle.z()[0].powi(2);
        let explained = own / varying.max(f64::MIN_POSITIVE);
        if explained > RIGID_SHARE {
            let measured = rms(tau.column(j).iter().copied());
            // A reversed sign is as wrong as a scale can be.
            reference[j] = measured / fit.parameters[3].max(1e-3);
        }
    }
    Ok(reference)
}

/// Findings from the regressor of rigid body and basic friction: conditioning and delay.
fn fitted(
    robot: &Robot,
    recording: &Recording,
    prepared: &Prepared,
) -> Result<Vec<Finding>, LeastSquaresError> {
    let n = robot.dof();
    let base = BaseParameters::of_robot(robot, &EXTRAS);
    let p = base.len();
    let motion = &prepared.at_samples;
    let step = recording.median_step();
    let unit = step.max(0.01);
    let delays: Vec<f64> = (-2 * DELAYS..=2 * DELAYS)
        .map(|k| 0.5 * unit * f64::from(k))
        .collect();
    let tau = recording.tau.as_ref();
    let targets = tau.map_or(0, |_| delays.len());
    let weight: Vec<f64> = (0..n)
        .map(|j| {
            let size = tau.map_or(1.0, |t| rms(t.column(j).iter().copied()));
            if size > 0.0 { 1.0 / size } else { 0.0 }
        })
        .collect();
    // What derivation makes of a joint at rest is noise, whose sign would look like motion.
    let moves: Vec<bool> = (0..n)
        .map(|j| {
            let q = recording.q.column(j);
            let low = q.iter().copied().fold(f64::INFINITY, f64::min);
            q.iter().any(|v| v - low >= STILL)
        })
        .collect();
    let mut rows = Accumulator::new(p + targets);
    let mut workspace = Workspace::new(robot);
    let rigid = PARAMETERS_PER_LINK * n;
    let mut y = vec![0.0; n * rigid];
    let mut line = vec![0.0; p + targets];
    let segments = recording.segments();
    for k in thinned(recording) {
        let Some(trajectory) = segments.iter().find(|s| s.contains(&k)) else {
            continue;
        };
        let time = &recording.time[trajectory.clone()];
        let reach = delays[delays.len() - 1];
        let at = recording.time[k];
        if targets > 0 && !(at - reach >= time[0] && at + reach <= time[time.len() - 1]) {
            continue;
        }
        let row = |table: &Array2<f64>| table.row(k).to_vec();
        let (q, mut qd, mut qdd) = (row(&motion.q), row(&motion.qd), row(&motion.qdd));
        for j in (0..n).filter(|&j| !moves[j]) {
            (qd[j], qdd[j]) = (0.0, 0.0);
        }
        regressor(robot, &mut workspace, &q, &qd, &qdd, &mut y);
        for joint in 0..n {
            for (value, &column) in line.iter_mut().zip(base.independent()) {
                *value = if column < rigid {
                    y[joint * rigid + column]
                } else if (column - rigid) % n == joint {
                    EXTRAS[(column - rigid) / n].value(qd[joint], qdd[joint])
                } else {
                    0.0
                };
            }
            if let Some(tau) = tau {
                for (value, delay) in line[p..].iter_mut().zip(&delays) {
                    *value = interpolated(time, at + delay, |i| tau[(trajectory.start + i, joint)]);
                }
            }
            rows.push(&line, 0.0, weight[joint])?;
        }
    }
    let whole = rows.finish()?;
    if whole.rows() == 0 {
        return Ok(Vec::new());
    }
    let own: Vec<usize> = (0..p).collect();
    let mut findings: Vec<Finding> = conditioning(&base, &whole.select(&own)?)?
        .into_iter()
        .collect();
    if targets > 0 {
        let left: Vec<f64> = (p..p + targets)
            .map(|c| whole.r().col(c).subrows(p, c + 1 - p).squared_norm_l2())
            .collect();
        findings.extend(delay(&delays, &left).and_then(|d| shift_finding(d, unit)));
    }
    Ok(findings)
}

/// Linear interpolation at `t` within the stamps.
fn interpolated(time: &[f64], t: f64, value: impl Fn(usize) -> f64) -> f64 {
    let after = time.partition_point(|&s| s <= t).clamp(1, time.len() - 1);
    let share = (t - time[after - 1]) / (time[after] - time[after - 1]);
    (1.0 - share) * value(after - 1) + share * value(after)
}

/// Delay of least error, where it removes enough of the error without delay.
fn delay(delays: &[f64], left: &[f64]) -> Option<f64> {
    let best = (0..left.len()).min_by(|&a, &b| left[a].total_cmp(&left[b]))?;
    let none = left[delays.len() / 2];
    if left[best] > (1.0 - DELAY_GAIN) * none {
        return None;
    }
    let (Some(before), Some(after)) = (best.checked_sub(1), left.get(best + 1)) else {
        return Some(delays[best]);
    };
    let (a, b, c) = (left[before], left[best], *after);
    let bend = a - 2.0 * b + c;
    let part = if bend > 0.0 {
        0.5 * (a - c) / bend
    } else {
        0.0
    };
    Some(delays[best] + part * (delays[1] - delays[0]))
}

/// The finding of columns that the motion does not tell from others.
fn conditioning(
    base: &BaseParameters,
    triangle: &Triangle,
) -> Result<Option<Finding>, LeastSquaresError> {
    let options = SolveOptions {
        sigma2: Some(1.0),
        ..SolveOptions::default()
    };
    let fit = solve(triangle, &options)?;
    let (mut poor, mut worst) = (Vec::new(), 1.0_f64);
    for (j, name) in base.base_names().into_iter().enumerate() {
        let norm = triangle.r().col(j).norm_l2();
        // The covariance of columns of unit norm has the variance inflation on its diagonal.
        let share = if norm > 0.0 {
            1.0 / (fit.std[j] * norm)
        } else {
            0.0
        };
        if share < OWN_SHARE {
            poor.push(name);
            worst = worst.min(share);
        }
    }
    if poor.is_empty() {
        return Ok(None);
    }
    let condition = SubRegressors::scaled(triangle)?;
    let list = poor.join(", ");
    Ok(Some(Finding {
        kind: Kind::PoorConditioning,
        severity: Severity::Warning,
        joint: None,
        row: None,
        value: condition,
        message: format!(
            "poor conditioning ({condition:.0} with columns of unit norm): the motion hardly tells {list} from other \
             parameters (in the worst case {:.2} % of the column is its own); move more joints at once, further and \
             faster, or use --prior",
            100.0 * worst
        ),
        parameters: poor,
    }))
}
