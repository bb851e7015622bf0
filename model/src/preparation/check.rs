//! Check of a recording against the robot's model: torque channel, and parameters that the motion does not separate.

use crate::preparation::{channel, doctor};
use ::identify::base::{BaseParameters, Extra};
use ::identify::least_squares::{
    Accumulator, LeastSquaresError, SolveOptions, SubRegressors, Triangle, solve,
};
use datasets::check::{
    Ailment, CheckOptions, CheckReport, Complaint, Finding, Kind, Severity, check, moves,
};
use datasets::prepare::{PrepareError, PrepareOptions, Prepared, prepare};
use datasets::{Problem, Recording};
use ndarray::Array2;
use physics::dynamics::{Workspace, regressor};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Largest number of samples that are checked.
const SAMPLES: usize = 5000;
/// Independent part of a column below which it is poorly separated from the others.
const OWN_SHARE: f64 = 0.01;
/// Columns beside the rigid ones.
const EXTRAS: [Extra; 4] = [
    Extra::RotorInertia,
    Extra::Viscous,
    Extra::Coulomb,
    Extra::Offset,
];

/// Reason why a recording could not be checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// Recording that cannot be prepared.
    #[error("{file}: {source}")]
    Prepare {
        /// Name of the recording that cannot be prepared.
        file: String,
        /// Reason why it cannot be prepared.
        source: PrepareError,
    },
    /// Recording that holds nothing to check.
    #[error("{file}: {problem}")]
    Check {
        /// Name of the recording without anything to check.
        file: String,
        /// Problem that prevents the check.
        problem: Problem,
    },
    /// Recording whose regressor could not be decomposed.
    #[error("{file}: {source}")]
    LeastSquares {
        /// Name of the recording whose regressor failed.
        file: String,
        /// Error of the decomposition.
        source: LeastSquaresError,
    },
}

/// Options of a check from a robot: joint names and limits of position, velocity and torque.
pub fn options(robot: &Robot) -> CheckOptions {
    let joints = robot.joints().iter();
    CheckOptions {
        joints: robot.joint_names(),
        position_limits: joints
            .clone()
            .map(|j| [j.limits.lower, j.limits.upper])
            .collect(),
        slides: joints.map(|j| !j.kind.is_rotation()).collect(),
    }
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
    let settings = self::options(robot);
    let mut report =
        check(recording, &prepared, &settings).map_err(|problem| CheckError::Check {
            file: file(),
            problem,
        })?;
    if recording.dof() == robot.dof() {
        let poor =
            told_apart(robot, recording, &prepared).map_err(|source| CheckError::LeastSquares {
                file: file(),
                source,
            })?;
        let channel = channel::estimate(robot, recording, &prepared);
        let complaints = doctor::examine(robot, recording, &prepared, &channel);
        report.add(poor);
        judge(&mut report, channel.findings(&settings.joints), &complaints);
        report.channel = Some(channel);
        report.doctor = complaints;
    }
    Ok(report)
}

/// Adds the torque channel of a recording to its report, with findings on it. Findings that the examination of the
/// torque ([`doctor`]) makes more exactly are left to its complaints. Of these the report holds those on exchanged
/// columns and turned positions, which no physics explains.
pub fn add_channel(
    report: &mut CheckReport,
    robot: &Robot,
    recording: &Recording,
    prepared: &Prepared,
) {
    let channel = channel::estimate(robot, recording, prepared);
    let found = channel.findings(&robot.joint_names());
    let open = |f: &Finding| matches!(f.kind, Kind::TorqueScale | Kind::TorquePlateau);
    let complaints = if found.iter().chain(&report.findings).any(open) {
        doctor::examine(robot, recording, prepared, &channel)
    } else {
        Vec::new()
    };
    judge(report, found, &complaints);
    report.channel = Some(channel);
    let columns = |c: &Complaint| matches!(c.ailment, Ailment::Columns | Ailment::Turned);
    report.doctor = complaints.into_iter().filter(columns).collect();
}

/// Adds findings, and removes those on scale and limit that the examination of the torque does not confirm.
fn judge(report: &mut CheckReport, found: Vec<Finding>, complaints: &[Complaint]) {
    report.add(found);
    report.findings.retain(|f| match f.kind {
        Kind::TorqueScale => is_confirmed(complaints, f.joint),
        Kind::TorquePlateau => is_cut(complaints, f.joint),
        _ => true,
    });
}

/// Whether the examination of the torque leaves open or confirms that a flat top is a limit, not made by the motion.
fn is_cut(complaints: &[Complaint], joint: Option<usize>) -> bool {
    let mut all = complaints.iter();
    all.any(|c| match c.ailment {
        Ailment::Saturated => joint.is_none_or(|j| c.joints.contains(&j)),
        Ailment::Absolute | Ailment::Columns | Ailment::Turned => true,
        _ => false,
    })
}

/// Whether the examination of the torque, whose model includes friction, finds a wrong scale or sign. A torque without
/// gravity or sign has no scale.
fn is_confirmed(complaints: &[Complaint], joint: Option<usize>) -> bool {
    let scaled = |c: &&Complaint| {
        use Ailment::{Current, Motor, PerMille, Percent, Scale, Sign};
        matches!(
            c.ailment,
            Current | Motor | PerMille | Percent | Scale | Sign
        )
    };
    let mut all = complaints.iter().filter(scaled);
    all.any(|c| joint.is_none_or(|j| c.joints.contains(&j)))
}

/// Indices of the samples that are checked, evenly thinned.
fn thinned(recording: &Recording) -> impl Iterator<Item = usize> + use<> {
    (0..recording.len()).step_by(recording.len().div_ceil(SAMPLES).max(1))
}

/// Root mean square of some values.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(s, n), v| (s + v * v, n + 1));
    (sum / count.max(1) as f64).sqrt()
}

/// Finding on parameters of rigid body and basic friction that this motion does not separate; none where it separates
/// all.
fn told_apart(
    robot: &Robot,
    recording: &Recording,
    prepared: &Prepared,
) -> Result<Option<Finding>, LeastSquaresError> {
    let n = robot.dof();
    let base = BaseParameters::of_robot(robot, &EXTRAS);
    let motion = &prepared.at_samples;
    let tau = recording.tau.as_ref();
    let weight: Vec<f64> = (0..n)
        .map(|j| {
            let size = tau.map_or(1.0, |t| rms(t.column(j).iter().copied()));
            if size > 0.0 { 1.0 / size } else { 0.0 }
        })
        .collect();
    // What derivation makes of a joint at rest is noise, whose sign would look like motion.
    let moves: Vec<bool> = (0..n).map(|j| moves(recording, j)).collect();
    let mut rows = Accumulator::new(base.len());
    let mut workspace = Workspace::new(robot);
    let rigid = PARAMETERS_PER_LINK * n;
    let mut y = vec![0.0; n * rigid];
    let mut line = vec![0.0; base.len()];
    for k in thinned(recording) {
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
            rows.push(&line, 0.0, weight[joint])?;
        }
    }
    let whole = rows.finish()?;
    if whole.rows() == 0 {
        return Ok(None);
    }
    conditioning(&base, &whole)
}

/// Finding on columns that are nearly combinations of others; none where there are none.
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
