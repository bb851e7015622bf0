//! Closed-loop forward simulation of the arm under recorded commands, with the sensitivities of its motion to
//! parameters.
//!
//! Steps are semi-implicit. Forces by position act from the start of a step, damping at its middle and dry friction at its end, so
//! that a joint can rest exactly. Positions are held at the steps and velocities between them. Commands are taken as
//! their mean over the step around it, so that no half step of delay arises.

mod bodies;
mod coupling;
mod reached;
mod step;
mod tangents;

pub use reached::reached;

use crate::arm::Arm;
use crate::command::Command;
use crate::friction::Friction;
use crate::parameter::{Kind, Parameter};
use crate::smooth::FUNCTIONS;
use nalgebra::{DMatrix, Vector3};
use ndarray::{Array2, ArrayView1};
use physics::dynamics::{Derivatives, Workspace, mass_matrix};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Number of steps between two evaluations of the rigid bodies' derivatives. They depend on posture and hardly change
/// within milliseconds.
const RENEWED: usize = 4;

/// Shortest integration step that a stiff drive may need, s; below it the drive is refused.
const SHORTEST: f64 = 5e-5;

/// Largest simulated position, rad or m. Beyond it the simulation has diverged.
const FARTHEST: f64 = 1e3;

/// Trajectory, or a block of one, to be replayed: recorded positions and the commands that led to them.
#[derive(Debug, Clone)]
pub struct Track {
    /// Index of the trajectory. Blocks of one trajectory share a variance in the likelihood.
    pub trajectory: usize,
    /// Times of the samples, s.
    pub time: Vec<f64>,
    /// Recorded positions, samples × joints, rad or m.
    pub q: Array2<f64>,
    /// Velocity of each joint at the first sample, rad/s (m/s), from which the simulation starts.
    pub start_velocity: Vec<f64>,
    /// Commanded positions of each joint. They cover the whole trajectory, also before a block.
    pub commands: Vec<Command>,
    /// Commanded velocities of each joint; none where they are not recorded.
    pub rates: Option<Vec<Command>>,
    /// Torque that the controller adds to its own law on each joint, N·m (N); none where it is not recorded.
    pub added: Option<Vec<Command>>,
}

/// Reason why a simulation ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unstable {
    /// Drive whose gain is too high for its inertia at any allowed step.
    #[error(
        "the drive of joint {joint} cannot be simulated: {gain} N·m/rad on {inertia:.2e} kg·m² oscillates faster than \
         a step of 50 µs follows; check kp and the link's inertia or armature"
    )]
    Stiff {
        /// Number of the joint, from 1.
        joint: usize,
        /// Proportional gain of its drive, N·m/rad.
        gain: f64,
        /// Inertia of the refused joint at the track's first positions while all others are free, rotor included, kg·m²
        /// (kg).
        inertia: f64,
    },
    /// Motion that leaves all bounds.
    #[error(
        "the simulated joint {joint} leaves all bounds after {time:.2} s: its drive is unstable as given"
    )]
    Diverged {
        /// Number of the joint, from 1.
        joint: usize,
        /// Time since the start of the track, s.
        time: f64,
    },
}

/// Simulates `track` from its recorded start. For every sample, `observe` gets its row, the positions (N values) and
/// their sensitivities. These are N rows of one derivative for each of `parameters`.
///
/// # Errors
/// Drive that is too stiff or unstable.
pub fn replay(
    arm: &Arm,
    track: &Track,
    parameters: &[Parameter],
    observe: &mut impl FnMut(usize, &[f64], &[f64]),
) -> Result<(), Unstable> {
    run(arm, track, parameters, &mut |row, state| {
        observe(row, &state.q, &state.dq);
    })
}

/// Simulates `track` from its recorded start, and shows `observe` the state at every sample, with its row.
fn run(
    arm: &Arm,
    track: &Track,
    parameters: &[Parameter],
    observe: &mut impl FnMut(usize, &State<'_>),
) -> Result<(), Unstable> {
    let longest = longest_step(arm, &track.q.row(0))?;
    let mut state = State::new(arm, track, parameters);
    observe(0, &state);
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
        observe(row, &state);
    }
    Ok(())
}

/// Longest step, s, that resolves the oscillation of every drive: h² kp ≤ inertia. The inertia is the one that the
/// joint moves at position `q` while all others are free.
fn longest_step(arm: &Arm, q: &ArrayView1<'_, f64>) -> Result<f64, Unstable> {
    let n = arm.dof();
    let mut mass = vec![0.0; n * n];
    let motors: Vec<f64> = q.iter().zip(&arm.zero).map(|(q, z)| q + z).collect();
    let mut q = motors.clone();
    arm.links(&motors, &mut q);
    mass_matrix(&arm.robot, &mut Workspace::new(&arm.robot), &q, &mut mass);
    arm.of_motors(&mut mass);
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

/// State of a simulation with its sensitivities and buffers, for N joints and P parameters.
struct State<'a> {
    /// Arm that is simulated.
    arm: &'a Arm,
    /// Track whose commands it follows.
    track: &'a Track,
    /// Parameters whose sensitivities are computed.
    parameters: &'a [Parameter],
    /// Buffers of the rigid-body dynamics.
    workspace: Workspace,
    /// Derivatives of the links' inverse dynamics with respect to their positions and velocities, renewed every few steps.
    derivatives: Derivatives,
    /// The same derivatives by positions and by velocities on and by the motors, N × N each.
    by_motion: [Vec<f64>; 2],
    /// Derivatives of the compensated gravity torque with respect to positions; none where drives compensate no
    /// gravity.
    gravity: Option<Derivatives>,
    /// Whether the gravity torque that drives compensate has to be computed.
    compensates: bool,
    /// Number of steps taken.
    count: usize,
    /// Vector instructions of this processor.
    arch: pulp::Arch,
    /// Solver for velocities and dry friction of a step.
    friction: Friction,
    /// Whether links turn with other joints' motors.
    coupled: bool,
    /// Whether some parameter changes the rigid bodies or gravity.
    bodies: bool,
    /// Robot under the derivative of gravity with respect to a tilt about the base's x and y axes; empty where no tilt
    /// is among the parameters.
    tilted: Vec<Robot>,
    /// Inertial parameters of the given description, ten for each link.
    given: Vec<f64>,
    /// Joint torques by inertial parameters, N rows of ten values for each link.
    regressor: Vec<f64>,
    /// Simulated positions as an encoder shows them, N values, rad (m).
    q: Vec<f64>,
    /// Simulated velocities, N values, rad/s (m/s).
    v: Vec<f64>,
    /// Commands after the drives' low-pass filters, N values.
    smooth: Vec<f64>,
    /// Integral of the error in each drive, N values.
    integral: Vec<f64>,
    /// Sensitivities of `q`, N rows of P values.
    dq: Vec<f64>,
    /// Sensitivities of `v`, N rows of P values.
    dv: Vec<f64>,
    /// Sensitivities of `smooth`, N rows of P values.
    dsmooth: Vec<f64>,
    /// Sensitivities of `integral`, N rows of P values.
    dintegral: Vec<f64>,
    /// Right-hand side of the linear equation for the next `dv`, N rows of P values.
    rhs: Vec<f64>,
    /// Sensitivities of the drives' torques, N rows of P values.
    dtau: Vec<f64>,
    /// Index of the last used command of each joint, for position, velocity and added torque.
    hints: Vec<[usize; 3]>,
    /// True positions of the motors in this step, `q` plus encoder offsets, N values.
    body: Vec<f64>,
    /// Positions, velocities and accelerations of the links in this step, N values each. They are those of the motors but
    /// for couplings.
    link: [Vec<f64>; 3],
    /// Buffer for joint torques by a tilt, N values.
    zero: Vec<f64>,
    /// Zeros, N values: velocity and acceleration of a robot at rest.
    still: Vec<f64>,
    /// Accelerations of this step, N values.
    acceleration: Vec<f64>,
    /// Torques by gravity, Coriolis and centrifugal forces and passive springs in this step, N values.
    bias: Vec<f64>,
    /// Gravity torque at this step's true positions by the given description, N values, N·m (N). Every drive adds the
    /// same part of it, `arm.gravity_compensation`.
    held: Vec<f64>,
    /// Mass matrix without rotor inertias, N × N.
    mass: Vec<f64>,
    /// Matrix A of the implicit step, N × N: mass matrix, rotor inertia, and damping times the step.
    a: Vec<f64>,
    /// Right-hand side b of the implicit step, N values: momentum after the step without dry friction and implicit
    /// damping.
    b: Vec<f64>,
    /// Dry friction limit of each joint times the step, N values.
    limits: Vec<f64>,
    /// Torque of each joint's drive in this step, with its derivatives.
    drives: Vec<Drive>,
    /// Whether each joint's smooth unknown torque acts or is fitted.
    smooths: Vec<bool>,
    /// Values of the functions of each joint's smooth unknown torque in this step.
    functions: Vec<[f64; FUNCTIONS]>,
}

/// Torque of one drive in one step, with its derivatives. The torque is `torque` − `damping`·velocity at the end of the
/// step.
#[derive(Debug, Clone, Copy, Default)]
struct Drive {
    /// Torque without its part by the velocity at the step's end, N·m. It includes the joint's unknown torque.
    torque: f64,
    /// Torque lost per velocity at the step's end, N·m·s/rad: `kd` plus back EMF. Only back EMF counts where
    /// `drive_limit` acts, and it is 0 where `limit` acts.
    damping: f64,
    /// Share of all damping of the joint that acts on the velocity at the step's end.
    implicit: f64,
    /// Control output before `drive_limit` cuts it, N·m, at the velocity of the step's start.
    wanted: f64,
    /// Torque at the velocity of the step's start, N·m, which the gear transmits: load-dependent friction grows with it.
    transmitted: f64,
    /// Derivative of the torque with respect to the command, or to −position; 0 where a limit acts.
    by_error: f64,
    /// Derivative of the torque with respect to the integral of the error; 0 where a limit acts.
    by_integral: f64,
    /// Position error: filtered command plus offset less position, rad.
    error: f64,
    /// Velocity error: commanded less simulated velocity, rad/s.
    velocity_error: f64,
    /// Direction, ±1, in which the control output is at `drive_limit`; 0 where it is below.
    drive_cut: f64,
    /// Direction, ±1, in which the torque is at `limit`; 0 where it is below.
    cut: f64,
    /// Rate of change of the step's mean command with time, rad/s.
    command_rate: f64,
    /// Share of the distance to its input that the command filter covers in the step; 1 without a filter.
    take: f64,
    /// Derivative of the time by which the filter's input is taken earlier by the filter's time constant.
    late_by_lag: f64,
    /// Change of the filtered command in the step, rad.
    to_smooth: f64,
    /// Rate of change with time of the torque by the step's mean commanded velocity and added torque, N·m/s.
    torque_rate: f64,
    /// Whether the integral of the error changes in the step: the drive has one, and neither `drive_limit` nor `limit` acts.
    integrates: bool,
    /// Part of the Stribeck friction that is left at this velocity, 0 to 1.
    stribeck: f64,
    /// Derivatives of the smooth unknown torque by position (N·m/rad) and velocity (N·m·s/rad).
    smooth_by: [f64; 2],
}

impl Drive {
    /// 1 where the torque changes with the drive's inputs, 0 where `limit` holds it.
    fn free(&self) -> f64 {
        f64::from(self.cut == 0.0)
    }
}

impl<'a> State<'a> {
    /// State at the start of the track: recorded positions, start velocities, filters at rest and sensitivities zero.
    fn new(arm: &'a Arm, track: &'a Track, parameters: &'a [Parameter]) -> Self {
        let (n, p) = (arm.dof(), parameters.len());
        let start = |i: usize| track.q[(0, i)];
        let compensates = arm.gravity_compensation != 0.0
            || parameters
                .iter()
                .any(|p| p.kind == Kind::GravityCompensation);
        let tilt = parameters.iter().any(|p| matches!(p.kind, Kind::Tilt(_)));
        let about = |axis: Vector3<f64>| {
            let gravity = arm.robot.gravity().cross(&axis);
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
            by_motion: [vec![0.0; n * n], vec![0.0; n * n]],
            gravity: (arm.gravity_compensation != 0.0).then(|| Derivatives::new(&arm.robot)),
            compensates,
            count: 0,
            arch: pulp::Arch::new(),
            friction: Friction::new(n),
            coupled: arm.is_coupled(),
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
            hints: vec![[0; 3]; n],
            body: zeros(),
            link: [zeros(), zeros(), zeros()],
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
            smooths: (0..n)
                .map(|i| {
                    let own = |p: &Parameter| matches!(p.kind, Kind::Unknown(_)) && p.joint == i;
                    arm.joints[i].unknown.acts() || parameters.iter().any(own)
                })
                .collect(),
            functions: vec![[0.0; FUNCTIONS]; n],
        }
    }
}
