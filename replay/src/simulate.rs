//! Closed-loop forward simulation of the arm under recorded commands, with the sensitivities of its motion.
//!
//! Steps are semi-implicit: forces of position at the start of a step, damping and dry friction at its end (a joint rests
//! exactly where friction holds it). Positions stand at the steps, velocities between them, so that commands are
//! taken as their mean over the step around it and no half step of delay arises.

use crate::arm::{Arm, Integral, UNKNOWN, unknown};
use crate::command::Command;
use crate::friction::{Friction, Slip};
use crate::parameter::{Kind, Parameter};
use crate::profile::{Planned, plan};
use nalgebra::{DMatrix, Vector3};
use ndarray::{Array2, ArrayView1};
use physics::dynamics::{
    Derivatives, Workspace, inverse_dynamics, inverse_dynamics_derivatives, mass_matrix,
    regressor_with_gravity,
};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Longest step of integration, s.
pub const STEP: f64 = 1e-3;

/// Shortest step to which a stiff drive shortens it, s.
const SHORTEST: f64 = 5e-5;

/// Motion farther than this (rad or m) is none of an arm's.
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
    let mut h = STEP;
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
    friction: Friction,
    bodies: bool,
    /// The robot under gravity turned about the base's x and y, where a tilt is asked for.
    tilted: Vec<Robot>,
    /// Inertial parameters of the given description.
    given: Vec<f64>,
    regressor: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    /// Planned motion towards the commands with its velocity, smoothed commands, and integrals of errors.
    planned: Vec<f64>,
    planned_velocity: Vec<f64>,
    smooth: Vec<f64>,
    integral: Vec<f64>,
    /// Sensitivities of all four: N rows of P values each.
    dq: Vec<f64>,
    dv: Vec<f64>,
    dplanned: Vec<f64>,
    dplanned_velocity: Vec<f64>,
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
    /// Error less the dead band, its side, the error of velocity.
    error: f64,
    side: f64,
    velocity_error: f64,
    /// Direction in which voltage or torque is cut, 0 where they are not.
    drive_cut: f64,
    cut: f64,
    /// Command, its change with later time, and the share that the filter takes over.
    command_rate: f64,
    take: f64,
    to_smooth: f64,
    planned: Option<Planned>,
    commanded_velocity_rate: f64,
    integrates: bool,
    stribeck: f64,
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
            .map(|i| track.commands[i].value(track.time[0] - arm.servos[i].delay))
            .collect();
        Self {
            arm,
            track,
            parameters,
            workspace: Workspace::new(&arm.robot),
            derivatives: Derivatives::new(&arm.robot),
            gravity: compensates.then(|| Derivatives::new(&arm.robot)),
            friction: Friction::new(n),
            bodies: parameters.iter().any(|p| p.kind.is_body()),
            tilted,
            given: arm.given.parameters(),
            regressor: vec![0.0; n * n * PARAMETERS_PER_LINK],
            q: (0..n).map(start).collect(),
            v: track.start_velocity.clone(),
            planned: first.clone(),
            planned_velocity: zeros(),
            smooth: first,
            integral: zeros(),
            dq: tangents(),
            dv: tangents(),
            dplanned: tangents(),
            dplanned_velocity: tangents(),
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

    fn step(&mut self, t: f64, h: f64) {
        let n = self.arm.dof();
        for i in 0..n {
            self.body[i] = self.q[i] + self.arm.zero[i];
        }
        let robot = &self.arm.robot;
        mass_matrix(robot, &mut self.workspace, &self.body, &mut self.mass);
        inverse_dynamics(
            robot,
            &mut self.workspace,
            &self.body,
            &self.v,
            &self.still,
            &mut self.bias,
        );
        for passive in robot.passive() {
            let joint = passive.joint();
            self.bias[joint] += passive.torque(self.body[joint]);
        }
        if self.gravity.is_some() {
            // The drive knows the given description, not the payload that it carries.
            inverse_dynamics(
                &self.arm.given,
                &mut self.workspace,
                &self.body,
                &self.still,
                &self.still,
                &mut self.held,
            );
        }
        for i in 0..n {
            let mut drive = self.drive(i, t, h);
            drive.torque += self.arm.gravity_compensation * self.held[i];
            drive.transmitted += self.arm.gravity_compensation * self.held[i];
            self.drives[i] = drive;
            let joint = &self.arm.joints[i];
            let shape = (self.v[i] / joint.stribeck_velocity).powi(2);
            self.drives[i].stribeck = (-shape).exp();
            let limit = joint.coulomb
                + joint.stribeck * self.drives[i].stribeck
                + joint.load * drive.transmitted.abs();
            self.limits[i] = h * limit.max(0.0);
            self.b[i] = h * (drive.torque - self.bias[i]);
            for j in 0..n {
                self.a[i * n + j] = self.mass[i * n + j];
            }
            self.a[i * n + i] += joint.armature;
            for j in 0..n {
                self.b[i] += self.a[i * n + j] * self.v[j];
            }
            self.a[i * n + i] += h * (joint.damping + drive.damping);
        }
        // A set that contradicts itself by rounding is as good as its neighbour.
        self.friction.solve(&self.a, &self.b, &self.limits);
        if !self.parameters.is_empty() {
            self.tangents(h);
        }
        for i in 0..n {
            let drive = &self.drives[i];
            if drive.integrates {
                let servo = &self.arm.servos[i];
                self.integral[i] += h * match servo.integral {
                    Integral::None => 0.0,
                    Integral::Position => drive.error,
                    Integral::Velocity => servo.kp / servo.kd * drive.error + drive.velocity_error,
                };
            }
            self.smooth[i] += drive.to_smooth;
            if let Some(planned) = drive.planned {
                (self.planned[i], self.planned_velocity[i]) = (planned.position, planned.velocity);
            }
            self.v[i] = self.friction.velocity[i];
            self.q[i] += h * self.v[i];
        }
    }

    /// The drive of joint `i` over a step.
    fn drive(&mut self, i: usize, t: f64, h: f64) -> Drive {
        let servo = &self.arm.servos[i];
        let mut out = Drive::default();
        let at = t - servo.delay - 0.5 * h;
        let [hint, rate_hint] = &mut self.hints[i];
        let (mean, rate) = self.track.commands[i].mean(at, h, hint);
        out.command_rate = rate;
        out.take = if servo.lag > 0.0 {
            -(-h / servo.lag).exp_m1()
        } else {
            1.0
        };
        let mean = if servo.acceleration.is_finite() {
            let planned = plan(
                self.planned[i],
                self.planned_velocity[i],
                mean,
                servo.acceleration,
                h,
            );
            out.planned = Some(planned);
            planned.position
        } else {
            mean
        };
        out.to_smooth = out.take * (mean - self.smooth[i]);
        let command = self.smooth[i] + out.to_smooth;
        let (commanded_velocity, later) = match &self.track.rates {
            Some(rates) => rates[i].mean(at, h, rate_hint),
            None => (0.0, 0.0),
        };
        out.commanded_velocity_rate = later;
        let error = command + servo.offset - self.q[i];
        out.error = error - error.clamp(-servo.dead_band, servo.dead_band);
        out.side = out.error.signum() * f64::from(out.error != 0.0);
        let open = f64::from(servo.dead_band == 0.0 || out.error != 0.0);
        out.velocity_error = commanded_velocity - self.v[i];
        let fixed = servo.kp * out.error + servo.ki * self.integral[i];
        let wanted = fixed + servo.kd * out.velocity_error;
        if wanted.abs() > servo.drive_limit {
            out.drive_cut = wanted.signum();
        }
        let (torque, damping) = if out.drive_cut == 0.0 {
            (
                fixed + servo.kd * commanded_velocity,
                servo.kd + servo.back_emf,
            )
        } else {
            (out.drive_cut * servo.drive_limit, servo.back_emf)
        };
        let now = torque - damping * self.v[i];
        if now.abs() > servo.limit {
            out.cut = now.signum();
            out.torque = out.cut * servo.limit;
            out.transmitted = out.torque;
        } else {
            (out.torque, out.damping, out.transmitted) = (torque, damping, now);
            if out.drive_cut == 0.0 {
                out.by_error = servo.kp * open;
                out.by_integral = servo.ki;
            }
        }
        out.integrates = servo.integral != Integral::None && out.drive_cut == 0.0 && out.cut == 0.0;
        let coefficients = &self.arm.joints[i].unknown;
        if coefficients.iter().any(|&c| c != 0.0) {
            let shapes = unknown(self.q[i], self.v[i], rate);
            out.torque += coefficients
                .iter()
                .zip(shapes)
                .map(|(c, s)| c * s)
                .sum::<f64>();
        }
        out
    }

    /// Sensitivities after the step from those before it, by the derivative of the step's own equation.
    fn tangents(&mut self, h: f64) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        for i in 0..n {
            self.acceleration[i] = (self.friction.velocity[i] - self.v[i]) / h;
        }
        let robot = &self.arm.robot;
        inverse_dynamics_derivatives(
            robot,
            &self.body,
            &self.v,
            &self.acceleration,
            &mut self.derivatives,
        );
        if let Some(gravity) = &mut self.gravity {
            inverse_dynamics_derivatives(
                &self.arm.given,
                &self.body,
                &self.still,
                &self.still,
                gravity,
            );
        }
        self.rhs.fill(0.0);
        self.dtau.fill(0.0);
        self.commands_by_parameters(h);
        self.drives_by_parameters();
        for i in 0..n {
            let drive = self.drives[i];
            let joint = &self.arm.joints[i];
            let servo = &self.arm.servos[i];
            // Torque of the drive: by command, integral and position.
            let dtau = &mut self.dtau[i * p..][..p];
            if drive.by_error != 0.0 {
                axpy(dtau, drive.by_error, &self.dsmooth[i * p..][..p]);
                axpy(dtau, -drive.by_error, &self.dq[i * p..][..p]);
            }
            if drive.by_integral != 0.0 {
                axpy(dtau, drive.by_integral, &self.dintegral[i * p..][..p]);
            }
            if servo.integral != Integral::None && drive.integrates {
                let cascade = servo.integral == Integral::Velocity;
                let of_error = if cascade { servo.kp / servo.kd } else { 1.0 };
                let own = &mut self.dintegral[i * p..][..p];
                axpy(own, h * of_error, &self.dsmooth[i * p..][..p]);
                axpy(own, -h * of_error, &self.dq[i * p..][..p]);
                if cascade {
                    axpy(own, -h, &self.dv[i * p..][..p]);
                }
                for (by, parameter) in own.iter_mut().zip(self.parameters) {
                    *by += h * match parameter.kind {
                        _ if parameter.joint != i => 0.0,
                        Kind::Offset => of_error,
                        Kind::Gain if cascade => drive.error / servo.kd,
                        Kind::ServoDamping if cascade => -of_error * drive.error / servo.kd,
                        _ => 0.0,
                    };
                }
            }
            let sign = self.friction.slip[i].sign();
            let pressed = self.pressed(i);
            let rhs = &mut self.rhs[i * p..][..p];
            axpy(rhs, h * (1.0 - pressed), &self.dtau[i * p..][..p]);
            for j in 0..n {
                let at = i * n + j;
                let mut mass = self.mass[at] - h * self.derivatives.dqd[at];
                let mut stiffness = self.derivatives.dq[at];
                if let Some(gravity) = &self.gravity {
                    stiffness -= self.arm.gravity_compensation * (1.0 - pressed) * gravity.dq[at];
                }
                if i == j {
                    mass += joint.armature + h * pressed * drive.damping;
                    // Stribeck's fall with velocity.
                    mass += h * sign * joint.stribeck * drive.stribeck * 2.0 * self.v[i]
                        / joint.stribeck_velocity.powi(2);
                }
                axpy(rhs, mass, &self.dv[j * p..][..p]);
                axpy(rhs, -h * stiffness, &self.dq[j * p..][..p]);
            }
        }
        self.bodies_by_parameters(h);
        self.joints_by_parameters(h);
        self.friction.back_substitute(&mut self.rhs, p);
        std::mem::swap(&mut self.rhs, &mut self.dv);
        for (q, v) in self.dq.iter_mut().zip(&self.dv) {
            *q += h * v;
        }
    }

    /// Part of a change of the drive's torque that friction by load takes: it presses on the gear as it drives.
    fn pressed(&self, i: usize) -> f64 {
        let sign = self.friction.slip[i].sign();
        sign * self.arm.joints[i].load * self.drives[i].transmitted.signum()
    }

    /// The commands that the drives see, by delay, planning and smoothing.
    fn commands_by_parameters(&mut self, h: f64) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        for i in 0..n {
            let (drive, servo) = (self.drives[i], &self.arm.servos[i]);
            let own = i * p..(i + 1) * p;
            for s in &mut self.dsmooth[own.clone()] {
                *s *= 1.0 - drive.take;
            }
            let planned = drive.planned.map(|plan| plan.by);
            if let Some([by_distance, by_velocity, _]) = planned {
                let velocities = &mut self.dplanned_velocity[own.clone()];
                for (v, c) in velocities.iter_mut().zip(&self.dplanned[own.clone()]) {
                    *v = by_velocity * *v - by_distance * c;
                }
            }
            for (k, parameter) in self.parameters.iter().enumerate() {
                let at = i * p + k;
                let common = parameter.kind == Kind::CommonDelay;
                let later = common || (parameter.kind == Kind::Delay && parameter.joint == i);
                match planned {
                    Some([by_distance, _, _]) if later => {
                        self.dplanned_velocity[at] -= by_distance * drive.command_rate;
                    }
                    Some([_, _, by_acceleration])
                        if parameter.kind == Kind::Acceleration && parameter.joint == i =>
                    {
                        self.dplanned_velocity[at] += by_acceleration;
                    }
                    None if later => self.dsmooth[at] -= drive.take * drive.command_rate,
                    _ => {}
                }
                if later && drive.drive_cut == 0.0 && drive.cut == 0.0 {
                    self.dtau[at] -= servo.kd * drive.commanded_velocity_rate;
                }
                if parameter.kind == Kind::Lag && parameter.joint == i && servo.lag > 0.0 {
                    // take = 1 − exp(−h/T), so that its derivative by T is −h/T² exp(−h/T).
                    let change = (1.0 - drive.take).ln() / servo.lag * (1.0 - drive.take);
                    self.dsmooth[at] += change * drive.to_smooth / drive.take;
                }
            }
            if planned.is_some() {
                axpy(
                    &mut self.dplanned[own.clone()],
                    h,
                    &self.dplanned_velocity[own.clone()],
                );
                axpy(
                    &mut self.dsmooth[own.clone()],
                    drive.take,
                    &self.dplanned[own],
                );
            }
        }
    }

    /// The drives' torque by their own parameters.
    fn drives_by_parameters(&mut self) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        for (k, parameter) in self.parameters.iter().enumerate() {
            if parameter.kind == Kind::GravityCompensation {
                for i in 0..n {
                    self.dtau[i * p + k] += self.held[i];
                }
                continue;
            }
            let i = parameter.joint;
            let (drive, servo) = (self.drives[i], &self.arm.servos[i]);
            let linear = f64::from(drive.drive_cut == 0.0 && drive.cut == 0.0);
            let by = &mut self.dtau[i * p + k];
            match parameter.kind {
                Kind::Gain => *by += linear * drive.error,
                Kind::ServoDamping => {
                    *by += linear * (drive.velocity_error - (self.friction.velocity[i] - self.v[i]))
                }
                Kind::Integral => *by += linear * self.integral[i],
                Kind::DriveLimit => *by += drive.drive_cut * f64::from(drive.cut == 0.0),
                Kind::Limit => *by += drive.cut,
                Kind::DeadBand => *by -= linear * servo.kp * drive.side,
                Kind::Offset => *by += drive.by_error,
                Kind::Unknown(f) if f < UNKNOWN => {
                    *by += unknown(self.q[i], self.v[i], drive.command_rate)[f];
                }
                _ => {}
            }
        }
    }

    /// Rigid bodies by payload, links and tilt.
    fn bodies_by_parameters(&mut self, h: f64) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        let width = n * PARAMETERS_PER_LINK;
        if self.bodies {
            regressor_with_gravity(
                &self.arm.robot,
                &mut self.workspace,
                &self.arm.robot.gravity(),
                &self.body,
                &self.v,
                &self.acceleration,
                &mut self.regressor,
            );
        }
        for (k, parameter) in self.parameters.iter().enumerate() {
            match parameter.kind {
                Kind::Zero => {
                    for i in 0..n {
                        let at = i * n + parameter.joint;
                        let mut stiffness = self.derivatives.dq[at];
                        if let Some(gravity) = &self.gravity {
                            let part = self.arm.gravity_compensation * (1.0 - self.pressed(i));
                            stiffness -= part * gravity.dq[at];
                        }
                        self.rhs[i * p + k] -= h * stiffness;
                    }
                }
                Kind::Payload(part) => {
                    let mut unit = [0.0; 4];
                    unit[part] = 1.0;
                    let change = crate::arm::payload(&unit);
                    let last = width - PARAMETERS_PER_LINK;
                    for i in 0..n {
                        let row = &self.regressor[i * width + last..][..PARAMETERS_PER_LINK];
                        let torque: f64 = row.iter().zip(&change).map(|(y, c)| y * c).sum();
                        self.rhs[i * p + k] -= h * torque;
                    }
                }
                Kind::LinkScale => {
                    let link = parameter.joint;
                    let own = &self.given[link * PARAMETERS_PER_LINK..][..PARAMETERS_PER_LINK];
                    for i in 0..=link {
                        let row = &self.regressor[i * width + link * PARAMETERS_PER_LINK..]
                            [..PARAMETERS_PER_LINK];
                        let torque: f64 = row.iter().zip(own).map(|(y, c)| y * c).sum();
                        self.rhs[i * p + k] -= h * torque;
                    }
                }
                Kind::Tilt(axis) => {
                    inverse_dynamics(
                        &self.tilted[axis],
                        &mut self.workspace,
                        &self.body,
                        &self.still,
                        &self.still,
                        &mut self.zero,
                    );
                    for i in 0..n {
                        self.rhs[i * p + k] -= h * self.zero[i];
                    }
                }
                _ => {}
            }
        }
    }

    /// Friction and rotor of a joint.
    fn joints_by_parameters(&mut self, h: f64) {
        let p = self.parameters.len();
        for (k, parameter) in self.parameters.iter().enumerate() {
            let i = parameter.joint;
            let (drive, joint) = (self.drives[i], &self.arm.joints[i]);
            let slip = self.friction.slip[i];
            let (sign, v) = (slip.sign(), self.friction.velocity[i]);
            let by = match parameter.kind {
                Kind::Damping => v,
                Kind::Coulomb => sign,
                Kind::Stribeck => sign * drive.stribeck,
                Kind::StribeckVelocity => {
                    sign * joint.stribeck * drive.stribeck * 2.0 * self.v[i].powi(2)
                        / joint.stribeck_velocity.powi(3)
                }
                Kind::Load => sign * drive.transmitted.abs(),
                Kind::Armature => self.acceleration[i],
                _ => continue,
            };
            if slip != Slip::Stick {
                self.rhs[i * p + k] -= h * by;
            }
        }
    }
}

fn axpy(y: &mut [f64], a: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}
