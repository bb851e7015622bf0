//! Closed-loop forward simulation of the arm under recorded commands, with the sensitivities of its motion.
//!
//! Steps are semi-implicit: forces of position at the start of a step, damping and dry friction at its end (a joint rests
//! exactly where friction holds it). Positions stand at the steps, velocities between them, so that commands are
//! taken as their mean over the step around it and no half step of delay arises.

mod bodies;
mod step;
mod tangents;

use crate::arm::Arm;
use crate::command::Command;
use crate::friction::Friction;
use crate::parameter::{Kind, Parameter};
use nalgebra::{DMatrix, Vector3};
use ndarray::{Array2, ArrayView1};
use physics::dynamics::{Derivatives, Workspace, mass_matrix};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Steps after which the rigid bodies' derivatives are taken anew: they change with the posture, hardly within milliseconds.
const RENEWED: usize = 4;

/// Shortest step to which a stiff drive shortens it, s.
const SHORTEST: f64 = 5e-5;

/// Largest position that counts as motion of an arm, rad or m. Beyond it the simulation has diverged.
const FARTHEST: f64 = 1e3;

/// One trajectory as it is replayed.
#[derive(Debug, Clone)]
pub struct Track {
    /// Index of the trajectory that it is, or is cut from: each has an error of its own size.
    pub trajectory: usize,
    /// Stamps, s.
    pub time: Vec<f64>,
    /// Recorded positions, (samples, joints), rad or m.
    pub q: Array2<f64>,
    /// Velocity at the start.
    pub start_velocity: Vec<f64>,
    /// Commanded positions by joint.
    pub commands: Vec<Command>,
    /// Commanded velocities by joint, where they are recorded.
    pub rates: Option<Vec<Command>>,
}

/// Why a replay ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unstable {
    /// The drive's gain is too high for its inertia.
    #[error(
        "the drive of joint {joint} cannot be simulated: {gain} N·m/rad on {inertia:.2e} kg·m² oscillates faster than \
         a step of 50 µs follows; check kp and the link's inertia or armature"
    )]
    Stiff {
        /// Number of the joint, from 1.
        joint: usize,
        /// Its gain.
        gain: f64,
        /// Its inertia.
        inertia: f64,
    },
    /// The motion left all bounds.
    #[error(
        "the simulated joint {joint} leaves all bounds after {time:.2} s: its drive is unstable as given"
    )]
    Diverged {
        /// Number of the joint, from 1.
        joint: usize,
        /// Time since the start, s.
        time: f64,
    },
}

/// Replays `track` from its recorded start; `observe` gets every sample's row, the positions (N values) and their sensitivities
/// (N rows of one value per parameter).
///
/// # Errors
/// A drive that is too stiff or unstable.
pub fn replay(
    arm: &Arm,
    track: &Track,
    parameters: &[Parameter],
    observe: &mut impl FnMut(usize, &[f64], &[f64]),
) -> Result<(), Unstable> {
    let longest = longest_step(arm, &track.q.row(0))?;
    let mut state = State::new(arm, track, parameters);
    observe(0, &state.q, &state.dq);
    for row in 1..track.time.len() {
        let from = track.time[row - 1];
        let span = track.time[row] - from;
        let steps = (span / longest - 1e-9).ceil().max(1.0);
        let h = span / steps;
        for k in 0..steps as usize {
            state.step(from + k as f64 * h, h);
        }
        if let Some(joint) = state
            .q
            .iter()
            .position(|q| q.is_nan() || q.abs() > FARTHEST)
        {
            return Err(Unstable::Diverged {
                joint: joint + 1,
                time: track.time[row] - track.time[0],
            });
        }
        observe(row, &state.q, &state.dq);
    }
    Ok(())
}

/// Step with which every drive's oscillation is resolved: h² kp ≤ inertia that the joint meets, all others free.
fn longest_step(arm: &Arm, q: &ArrayView1<'_, f64>) -> Result<f64, Unstable> {
    let n = arm.dof();
    let mut mass = vec![0.0; n * n];
    let q: Vec<f64> = q.iter().zip(&arm.zero).map(|(q, z)| q + z).collect();
    mass_matrix(&arm.robot, &mut Workspace::new(&arm.robot), &q, &mut mass);
    let mut m = DMatrix::from_row_slice(n, n, &mass);
    for i in 0..n {
        m[(i, i)] += arm.joints[i].armature;
    }
    let inverse = m.try_inverse();
    let mut h = arm.step;
    for i in 0..n {
        let inertia = inverse.as_ref().map_or(0.0, |m| 1.0 / m[(i, i)]);
        let gain = arm.servos[i].kp;
        let own = (inertia / gain.max(f64::MIN_POSITIVE)).sqrt();
        if own.is_nan() || own < SHORTEST {
            return Err(Unstable::Stiff {
                joint: i + 1,
                gain,
                inertia,
            });
        }
        h = h.min(own);
    }
    Ok(h)
}

struct State<'a> {
    arm: &'a Arm,
    track: &'a Track,
    parameters: &'a [Parameter],
    workspace: Workspace,
    derivatives: Derivatives,
    gravity: Option<Derivatives>,
    /// Whether the drives' own torque against gravity is needed.
    compensates: bool,
    /// Steps taken.
    count: usize,
    arch: pulp::Arch,
    friction: Friction,
    bodies: bool,
    /// The robot under gravity turned about the base's x and y, where a tilt is asked for.
    tilted: Vec<Robot>,
    /// Inertial parameters of the given description.
    given: Vec<f64>,
    regressor: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    /// Smoothed commands, and integrals of errors.
    smooth: Vec<f64>,
    integral: Vec<f64>,
    /// Sensitivities of all four: N rows of P values each.
    dq: Vec<f64>,
    dv: Vec<f64>,
    dsmooth: Vec<f64>,
    dintegral: Vec<f64>,
    /// Right-hand side of the sensitivities' step, and those of the drives' torque.
    rhs: Vec<f64>,
    dtau: Vec<f64>,
    hints: Vec<[usize; 2]>,
    // Of one step, N values each.
    body: Vec<f64>,
    zero: Vec<f64>,
    still: Vec<f64>,
    acceleration: Vec<f64>,
    bias: Vec<f64>,
    held: Vec<f64>,
    mass: Vec<f64>,
    a: Vec<f64>,
    b: Vec<f64>,
    limits: Vec<f64>,
    drives: Vec<Drive>,
}

/// What a drive does in one step.
#[derive(Debug, Clone, Copy, Default)]
struct Drive {
    /// Torque apart from what is implicit in the velocity, and the factor of that.
    torque: f64,
    damping: f64,
    /// Torque by the start's velocity: what the gear transmits.
    transmitted: f64,
    /// Derivatives of the torque: by command (equally by −position), by integral; 0 where cut.
    by_error: f64,
    by_integral: f64,
    /// Errors of position and velocity.
    error: f64,
    velocity_error: f64,
    /// Direction in which voltage or torque is cut, 0 where they are not.
    drive_cut: f64,
    cut: f64,
    /// Command, its change with later time, and the share that the filter takes over.
    command_rate: f64,
    take: f64,
    to_smooth: f64,
    commanded_velocity_rate: f64,
    integrates: bool,
    stribeck: f64,
}

impl Drive {
    /// 1, or 0 where the torque is cut: then nothing changes it.
    fn free(&self) -> f64 {
        f64::from(self.cut == 0.0)
    }
}

impl<'a> State<'a> {
    fn new(arm: &'a Arm, track: &'a Track, parameters: &'a [Parameter]) -> Self {
        let (n, p) = (arm.dof(), parameters.len());
        let start = |i: usize| track.q[(0, i)];
        let compensates = arm.gravity_compensation != 0.0
            || parameters
                .iter()
                .any(|p| p.kind == Kind::GravityCompensation);
        let tilt = parameters.iter().any(|p| matches!(p.kind, Kind::Tilt(_)));
        let about = |axis: Vector3<f64>| {
            let gravity = axis.cross(&arm.robot.gravity());
            arm.robot.clone().with_gravity(gravity)
        };
        let tilted = if tilt {
            vec![about(Vector3::x()), about(Vector3::y())]
        } else {
            Vec::new()
        };
        let zeros = || vec![0.0; n];
        let tangents = || vec![0.0; n * p];
        let first: Vec<f64> = (0..n)
            .map(|i| track.commands[i].value(track.time[0] - arm.delay - arm.servos[i].delay))
            .collect();
        Self {
            arm,
            track,
            parameters,
            workspace: Workspace::new(&arm.robot),
            derivatives: Derivatives::new(&arm.robot),
            gravity: (arm.gravity_compensation != 0.0).then(|| Derivatives::new(&arm.robot)),
            compensates,
            count: 0,
            arch: pulp::Arch::new(),
            friction: Friction::new(n),
            bodies: parameters.iter().any(|p| p.kind.is_body()),
            tilted,
            given: arm.given.parameters(),
            regressor: vec![0.0; n * n * PARAMETERS_PER_LINK],
            q: (0..n).map(start).collect(),
            v: track.start_velocity.clone(),
            smooth: first,
            integral: zeros(),
            dq: tangents(),
            dv: tangents(),
            dsmooth: tangents(),
            dintegral: tangents(),
            rhs: tangents(),
            dtau: tangents(),
            hints: vec![[0; 2]; n],
            body: zeros(),
            zero: zeros(),
            still: zeros(),
            acceleration: zeros(),
            bias: zeros(),
            held: zeros(),
            mass: vec![0.0; n * n],
            a: vec![0.0; n * n],
            b: zeros(),
            limits: zeros(),
            drives: vec![Drive::default(); n],
        }
    }
}
