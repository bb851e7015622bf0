//! Properties of a motion: coverage of the limits, condition numbers, torque.

use identify::excitation::{BaseRows, MotionLimits, State, torque};
use identify::least_squares::{LeastSquaresError, SubRegressors};
use ndarray::Array2;
use physics::dynamics::Workspace;
use physics::robot::Robot;
use serde::Serialize;
use signal::Motion;

use crate::columns::triangle;

/// Range of a joint's motion beside its limits. Units rad or m, per sⁿ; N·m or N.
#[derive(Clone, Debug, Serialize)]
pub struct Coverage {
    /// Name of the joint whose motion it is.
    pub joint: String,
    /// Lowest and highest position of the motion, rad or m.
    pub position: [f64; 2],
    /// Lower and upper limit of the position, rad or m.
    pub position_limits: [f64; 2],
    /// Largest speed of the motion, and its limit, rad/s or m/s.
    pub velocity: [f64; 2],
    /// Largest acceleration of the motion, and its limit, rad/s² or m/s².
    pub acceleration: [f64; 2],
    /// Largest jerk of the motion, and its limit, rad/s³ or m/s³.
    pub jerk: [f64; 2],
    /// Largest torque of the described robot, N·m (N).
    pub torque: f64,
    /// Limit of the torque, where the description has one.
    pub torque_limit: Option<f64>,
}

impl Coverage {
    /// Part of the range that is covered.
    pub fn range(&self) -> f64 {
        let width = |r: [f64; 2]| r[1] - r[0];
        width(self.position) / width(self.position_limits)
    }

    /// Part of the torque's limit that the described robot would need.
    pub fn effort(&self) -> Option<f64> {
        self.torque_limit.map(|l| self.torque / l)
    }
}

/// Condition numbers of the regressor of the base parameters, Y, and of rows divided by their joint's noise, Y*.
#[derive(Clone, Debug, Serialize)]
pub struct Conditions {
    /// Number of base parameters.
    pub parameters: usize,
    /// Condition numbers of the regressor Y and its inertial, gravity and friction columns.
    pub plain: SubRegressors,
    /// Condition numbers of the weighted regressor Y*.
    pub weighted: SubRegressors,
}

/// Coverage of each joint's limits.
pub fn coverage(robot: &Robot, motion: &Motion, limits: &[MotionLimits]) -> Vec<Coverage> {
    let tau = torques(robot, motion);
    let most = |t: &Array2<f64>, j: usize| t.column(j).iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let jerk = jerk(motion);
    let joints = robot.joints().iter().zip(limits).enumerate();
    joints
        .map(|(j, (joint, l))| {
            let q = motion.q.column(j);
            let low = q.iter().copied().fold(f64::INFINITY, f64::min);
            let high = q.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let effort = joint.limits.effort;
            Coverage {
                joint: joint.name.clone(),
                position: [low, high],
                position_limits: [l.lower, l.upper],
                velocity: [most(&motion.qd, j), l.velocity],
                acceleration: [most(&motion.qdd, j), l.acceleration],
                jerk: [most(&jerk, j), l.jerk],
                torque: most(&tau, j),
                torque_limit: (effort.is_finite() && effort > 0.0).then_some(effort),
            }
        })
        .collect()
}

/// Torque of the described robot on a motion, shape (samples, joints).
pub fn torques(robot: &Robot, motion: &Motion) -> Array2<f64> {
    let mut tau = Array2::zeros(motion.q.dim());
    let mut workspace = Workspace::new(robot);
    let mut state = State::new(robot.dof());
    let mut row = vec![0.0; robot.dof()];
    for i in 0..motion.len() {
        state.q = motion.q.row(i).to_vec();
        state.qd = motion.qd.row(i).to_vec();
        state.qdd = motion.qdd.row(i).to_vec();
        torque(robot, &mut workspace, &state, &mut row);
        tau.row_mut(i).assign(&ndarray::ArrayView1::from(&row));
    }
    tau
}

/// Differences of the acceleration, shape (samples, joints); zero at the first sample of a segment.
fn jerk(motion: &Motion) -> Array2<f64> {
    let mut out = Array2::zeros(motion.qdd.dim());
    for s in &motion.segments {
        for i in s.start + 1..s.end {
            let dt = motion.time[i] - motion.time[i - 1];
            let slope = (&motion.qdd.row(i) - &motion.qdd.row(i - 1)) / dt;
            out.row_mut(i).assign(&slope);
        }
    }
    out
}

/// Condition numbers of a motion.
///
/// # Errors
/// Numbers that are not finite.
pub fn conditions(
    rows: &BaseRows,
    motion: &Motion,
    noise: &[f64],
) -> Result<Conditions, LeastSquaresError> {
    let [inertial, gravity, friction] = rows.parts();
    let of = |noise: &[f64]| {
        let (triangle, _) = triangle(rows, motion, noise)?;
        SubRegressors::of(&triangle, &inertial, &gravity, &friction)
    };
    Ok(Conditions {
        parameters: rows.columns(),
        plain: of(&vec![1.0; noise.len()])?,
        weighted: of(noise)?,
    })
}
