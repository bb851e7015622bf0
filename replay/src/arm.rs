//! Simulated arm with its drives: every value that a replay depends on. Units hold for rotary joints.

use crate::parameter::{Kind, Parameter};
use crate::smooth::Smooth;
use physics::robot::{PARAMETERS_PER_LINK, Robot, RobotError};

/// Error that a drive integrates (its I part).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Integral {
    /// None: the drive has no integral action.
    #[default]
    None,
    /// Position error (PID controller).
    Position,
    /// Velocity error (cascade controller), whose set point is the output of the position loop.
    Velocity,
}

/// Drive of one joint: a controller that turns commands into torque, with its limits.
///
/// With e = command + offset − q, e_v = commanded velocity − q̇ and τ_ff the torque that the controller adds where one is
/// recorded, the control output is u = kp·e + kd·e_v + ki·z + τ_ff, limited to ±`drive_limit`. The torque is u + gravity compensation − back_emf·q̇, limited to ±`limit`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// Proportional gain: torque per position error, N·m/rad (N/m). In a cascade it is the product of both loops'
    /// gains.
    pub kp: f64,
    /// Derivative gain: torque per velocity error, N·m·s/rad (N·s/m). In a cascade it is the gain of the velocity loop.
    pub kd: f64,
    /// Integral gain: torque per integral z of the error that `integral` names.
    pub ki: f64,
    /// Error of which z is the integral. z stands still while a limit acts.
    pub integral: Integral,
    /// Torque lost per velocity by back EMF, N·m·s/rad. It acts after the limit of the voltage.
    pub back_emf: f64,
    /// Limit of the control output u, N·m: the largest torque at standstill that the voltage allows. Infinite where
    /// none is known.
    pub drive_limit: f64,
    /// Limit of the torque, N·m, equal in both directions; infinite where none is known.
    pub limit: f64,
    /// Delay of this drive's commands beyond the arm's common `delay`, s.
    pub delay: f64,
    /// Time constant of the first-order low-pass filter on the drive's command, s; 0 for no filter.
    pub lag: f64,
    /// Constant that the drive adds to its commanded position, rad.
    pub offset: f64,
}

/// Friction and rotor inertia of one joint, and its unknown torque.
///
/// Dry friction is `coulomb` + `stribeck`·exp(−(q̇/`stribeck_velocity`)²) + `load`·|torque of the drive|.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Viscous friction coefficient, N·m·s/rad.
    pub damping: f64,
    /// Coulomb friction, N·m.
    pub coulomb: f64,
    /// Dry friction at standstill beyond Coulomb friction, N·m.
    pub stribeck: f64,
    /// Velocity over which the Stribeck friction falls off, rad/s.
    pub stribeck_velocity: f64,
    /// Dry friction per torque of the drive, without unit.
    pub load: f64,
    /// Rotor inertia reflected to the joint, kg·m².
    pub armature: f64,
    /// Smooth torque that stands for something unknown on the joint; it does not act in the given arm.
    pub unknown: Smooth,
}

/// Longest integration step of a simulation that is scored, s.
pub const STEP: f64 = 1e-3;

/// Simulated arm: rigid bodies, joints and drives. [`Arm::get`] and [`Arm::set`] reach every parameter that can be
/// fitted.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Robot of the given description. Drives that compensate gravity compute with it.
    pub given: Robot,
    /// Robot that is simulated: the given one with payload, scaled links and tilted gravity.
    pub robot: Robot,
    /// Friction and rotor inertia of each joint.
    pub joints: Vec<Joint>,
    /// Drive of each joint.
    pub servos: Vec<Servo>,
    /// Common delay of the commands of all drives, s.
    pub delay: f64,
    /// Part of the gravity torque of `given` that each drive adds to its own torque, from 0 (none) to 1 (all).
    pub gravity_compensation: f64,
    /// Payload at the last link, in that link's joint frame: mass (kg), first moment along x, y and z (kg·m), and moment
    /// of inertia (kg·m²), the same about every axis through the joint's origin.
    pub payload: [f64; 5],
    /// Factor on all inertial parameters of each link; 1 for the given ones.
    pub link_scale: Vec<f64>,
    /// Rotation of the base about its own x and y axes, rad, as `diagnose` states it: gravity turns the other way.
    pub tilt: [f64; 2],
    /// Turn of each joint's link per turn of another joint's motor, N rows of N values: row of the link, column of the
    /// motor. The link turns by so much less than its own motor, at which its encoder, drive and friction are.
    pub coupling: Vec<f64>,
    /// Encoder offset of each joint, rad: recorded position plus offset is the true position.
    pub zero: Vec<f64>,
    /// Given damping gain of each joint's drive where only its sum with viscous friction can be fitted, else 0. Of that
    /// sum, so much counts as the drive's `kd`, and the rest is viscous friction.
    pub shared: Vec<f64>,
    /// Longest integration step, s.
    pub step: f64,
}

impl Arm {
    /// Arm of the described robot with these drives: no payload, no tilt, no offsets and no common delay.
    pub fn new(robot: Robot, servos: Vec<Servo>) -> Self {
        let joints = robot
            .joints()
            .iter()
            .map(|j| Joint {
                damping: j.damping,
                coulomb: j.friction,
                stribeck: 0.0,
                // Velocity at which sliding has begun: a small gear motor's, about one revolution per minute of its
                // output.
                stribeck_velocity: 0.1,
                load: 0.0,
                armature: j.rotor_inertia,
                unknown: Smooth::default(),
            })
            .collect();
        let n = robot.dof();
        Self {
            given: robot.clone(),
            robot,
            joints,
            servos,
            delay: 0.0,
            gravity_compensation: 0.0,
            payload: [0.0; 5],
            link_scale: vec![1.0; n],
            tilt: [0.0; 2],
            coupling: vec![0.0; n * n],
            zero: vec![0.0; n],
            shared: vec![0.0; n],
            step: STEP,
        }
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Total delay of the command of joint `j`, s: common delay, its own delay and the time constant of its filter.
    pub fn late(&self, j: usize) -> f64 {
        self.delay + self.servos[j].delay + self.servos[j].lag
    }

    /// Whether all of joint `j`'s shared damping counts as its drive's. A change of viscous friction then changes the
    /// drive's gain.
    pub(crate) fn damped_by_drive(&self, j: usize) -> bool {
        self.shared[j] > 0.0 && self.joints[j].damping == 0.0
    }

    /// Value of a parameter. For viscous friction that is shared with the drive it is the sum of both.
    pub fn get(&self, p: Parameter) -> f64 {
        let (s, j) = (&self.servos[p.joint], &self.joints[p.joint]);
        match p.kind {
            Kind::Gain => s.kp,
            Kind::ServoDamping => s.kd,
            Kind::Integral => s.ki,
            Kind::DriveLimit => s.drive_limit,
            Kind::Limit => s.limit,
            Kind::Delay => s.delay,
            Kind::CommonDelay => self.delay,
            Kind::Lag => s.lag,
            Kind::Offset => s.offset,
            Kind::Damping if self.shared[p.joint] > 0.0 => j.damping + s.kd,
            Kind::Damping => j.damping,
            Kind::Coulomb => j.coulomb,
            Kind::Stribeck => j.stribeck,
            Kind::StribeckVelocity => j.stribeck_velocity,
            Kind::Load => j.load,
            Kind::Armature => j.armature,
            Kind::GravityCompensation => self.gravity_compensation,
            Kind::Payload(k) => self.payload[k],
            Kind::LinkScale => self.link_scale[p.joint],
            Kind::Tilt(k) => self.tilt[k],
            Kind::Coupling(motor) => self.coupling[p.joint * self.dof() + motor],
            Kind::Zero => self.zero[p.joint],
            Kind::Unknown(k) => j.unknown.coefficients[k],
        }
    }

    /// Sets parameters to values, and assembles the robot again where rigid bodies or gravity change.
    ///
    /// # Errors
    /// Inertial parameters that make no valid robot.
    pub fn set(&mut self, values: &[(Parameter, f64)]) -> Result<(), RobotError> {
        let mut bodies = false;
        let n = self.dof();
        for &(p, value) in values {
            bodies |= p.kind.is_body();
            let (s, j) = (&mut self.servos[p.joint], &mut self.joints[p.joint]);
            match p.kind {
                Kind::Gain => s.kp = value,
                Kind::ServoDamping => s.kd = value,
                Kind::Integral => s.ki = value,
                Kind::DriveLimit => s.drive_limit = value,
                Kind::Limit => s.limit = value,
                Kind::Delay => s.delay = value,
                Kind::CommonDelay => self.delay = value,
                Kind::Lag => s.lag = value,
                Kind::Offset => s.offset = value,
                Kind::Damping if self.shared[p.joint] > 0.0 => {
                    s.kd = value.min(self.shared[p.joint]);
                    j.damping = value - s.kd;
                }
                Kind::Damping => j.damping = value,
                Kind::Coulomb => j.coulomb = value,
                Kind::Stribeck => j.stribeck = value,
                Kind::StribeckVelocity => j.stribeck_velocity = value,
                Kind::Load => j.load = value,
                Kind::Armature => j.armature = value,
                Kind::GravityCompensation => self.gravity_compensation = value,
                Kind::Payload(k) => self.payload[k] = value,
                Kind::LinkScale => self.link_scale[p.joint] = value,
                Kind::Tilt(k) => self.tilt[k] = value,
                Kind::Coupling(motor) => self.coupling[p.joint * n + motor] = value,
                Kind::Zero => self.zero[p.joint] = value,
                Kind::Unknown(k) => j.unknown.coefficients[k] = value,
            }
        }
        if bodies {
            self.assemble()?;
        }
        Ok(())
    }

    /// Assembles `robot` from `given`, the factors on its links, the payload and the tilt.
    fn assemble(&mut self) -> Result<(), RobotError> {
        let mut parameters = self.given.parameters();
        for (link, scale) in parameters
            .chunks_mut(PARAMETERS_PER_LINK)
            .zip(&self.link_scale)
        {
            link.iter_mut().for_each(|p| *p *= scale);
        }
        let last = parameters.len() - PARAMETERS_PER_LINK;
        for (p, added) in parameters[last..].iter_mut().zip(payload(&self.payload)) {
            *p += added;
        }
        let gravity = self.given.gravity();
        let [x, y] = self.tilt;
        let turn = nalgebra::Rotation3::new(nalgebra::Vector3::new(-x, -y, 0.0));
        self.robot = self
            .given
            .with_parameters(&parameters)?
            .with_gravity(turn * gravity);
        Ok(())
    }
}

/// Inertial parameters of a payload (mass, first moment, inertia about the joint's origin), from the five values of
/// [`Arm::payload`].
pub(crate) fn payload(fitted: &[f64; 5]) -> [f64; PARAMETERS_PER_LINK] {
    let [m, x, y, z, i] = *fitted;
    [m, x, y, z, i, 0.0, i, 0.0, 0.0, i]
}
