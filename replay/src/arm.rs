//! The simulated arm under its drives: every value that a replay depends on.

use crate::parameter::{Kind, Parameter};
use physics::robot::{PARAMETERS_PER_LINK, Robot, RobotError};
use std::f64::consts::FRAC_1_SQRT_2;

/// Integral action of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Integral {
    /// No integral action.
    #[default]
    None,
    /// Integral of the position error (PID).
    Position,
    /// Integral of the velocity error (cascade). Its set point is the output of the position loop.
    Velocity,
}

/// Drive of one joint. With e = command + offset − q and e_v = commanded velocity − q̇:
/// u = kp·e + kd·e_v + ki·z, cut at `drive_limit`; torque = u − back_emf·q̇, cut at `limit`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// Torque per error of position, N·m/rad (N/m).
    pub kp: f64,
    /// Torque per error of velocity, N·m·s/rad (N·s/m).
    pub kd: f64,
    /// Torque per integral z of the error.
    pub ki: f64,
    /// Error of which z is the integral.
    pub integral: Integral,
    /// Torque lost per velocity behind the cut of the voltage, N·m·s/rad.
    pub back_emf: f64,
    /// Largest torque at standstill that the voltage allows, N·m; infinite where none is known.
    pub drive_limit: f64,
    /// Largest torque, N·m.
    pub limit: f64,
    /// Time by which commands reach this drive later than the others, s.
    pub delay: f64,
    /// Time constant by which the drive smooths its command, s.
    pub lag: f64,
    /// What the drive adds to its command, rad.
    pub offset: f64,
}

/// Friction and rotor of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Viscous friction, N·m·s/rad.
    pub damping: f64,
    /// Coulomb friction, N·m.
    pub coulomb: f64,
    /// Friction beyond Coulomb's at standstill, N·m.
    pub stribeck: f64,
    /// Velocity over which it falls, rad/s.
    pub stribeck_velocity: f64,
    /// Friction per torque of the drive.
    pub load: f64,
    /// Rotor inertia seen from the link, kg·m².
    pub armature: f64,
    /// Coefficients of a smooth torque that no mechanism explains, N·m.
    pub unknown: [f64; UNKNOWN],
}

/// Longest step of integration of a motion that is scored, s.
pub const STEP: f64 = 1e-3;

/// Number of functions that stand for an unknown effect on a joint.
pub const UNKNOWN: usize = 8;

/// A simulated arm: rigid bodies, joints, drives.
#[derive(Debug, Clone)]
pub struct Arm {
    /// The description that the simulator has.
    pub given: Robot,
    /// The same with payload, scaled links and tilt: what is simulated.
    pub robot: Robot,
    /// Friction and rotor of each joint.
    pub joints: Vec<Joint>,
    /// Drive of each joint.
    pub servos: Vec<Servo>,
    /// Time by which commands reach every drive late, s.
    pub delay: f64,
    /// Part of the given description's gravity that the drive compensates by itself.
    pub gravity_compensation: f64,
    /// Body at the last link, in its joint frame: mass (kg) and first moment (kg·m).
    pub payload: [f64; 4],
    /// Factors on the links' inertial parameters.
    pub link_scale: Vec<f64>,
    /// Rotation of gravity about the base's x and y, rad.
    pub tilt: [f64; 2],
    /// Offset of each joint, rad: recorded position plus offset is the true position.
    pub zero: Vec<f64>,
    /// Damping of each joint's drive where only its sum with viscous friction is known. This much of the sum counts
    /// as the drive's, and the drive's limit cuts it. Zero where both are known apart.
    pub shared: Vec<f64>,
    /// Longest step of integration, s.
    pub step: f64,
}

impl Arm {
    /// An arm as described, with these drives.
    pub fn new(robot: Robot, servos: Vec<Servo>) -> Self {
        let joints = robot
            .joints()
            .iter()
            .map(|j| Joint {
                damping: j.damping,
                coulomb: j.friction,
                stribeck: 0.0,
                // Sliding has begun at a tenth of a revolution per minute of a small gear motor's output.
                stribeck_velocity: 0.1,
                load: 0.0,
                armature: j.rotor_inertia,
                unknown: [0.0; UNKNOWN],
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
            payload: [0.0; 4],
            link_scale: vec![1.0; n],
            tilt: [0.0; 2],
            zero: vec![0.0; n],
            shared: vec![0.0; n],
            step: STEP,
        }
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Time by which commands reach joint `j` late in all, s.
    pub fn late(&self, j: usize) -> f64 {
        self.delay + self.servos[j].delay + self.servos[j].lag
    }

    /// Whether a change of joint `j`'s viscous friction is one of its drive's damping.
    pub(crate) fn damped_by_drive(&self, j: usize) -> bool {
        self.shared[j] > 0.0 && self.joints[j].damping == 0.0
    }

    /// Value of a parameter.
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
            Kind::Load => j.load,
            Kind::Armature => j.armature,
            Kind::GravityCompensation => self.gravity_compensation,
            Kind::Payload(k) => self.payload[k],
            Kind::LinkScale => self.link_scale[p.joint],
            Kind::Tilt(k) => self.tilt[k],
            Kind::Zero => self.zero[p.joint],
            Kind::Unknown(k) => j.unknown[k],
        }
    }

    /// Sets parameters and puts the robot together again where it changes.
    ///
    /// # Errors
    /// Inertial parameters that do not fit the robot.
    pub fn set(&mut self, values: &[(Parameter, f64)]) -> Result<(), RobotError> {
        let mut bodies = false;
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
                Kind::Load => j.load = value,
                Kind::Armature => j.armature = value,
                Kind::GravityCompensation => self.gravity_compensation = value,
                Kind::Payload(k) => self.payload[k] = value,
                Kind::LinkScale => self.link_scale[p.joint] = value,
                Kind::Tilt(k) => self.tilt[k] = value,
                Kind::Zero => self.zero[p.joint] = value,
                Kind::Unknown(k) => j.unknown[k] = value,
            }
        }
        if bodies {
            self.assemble()?;
        }
        Ok(())
    }

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
        let turn = nalgebra::Rotation3::new(nalgebra::Vector3::new(x, y, 0.0));
        self.robot = self
            .given
            .with_parameters(&parameters)?
            .with_gravity(turn * gravity);
        Ok(())
    }
}

/// Radius of gyration about the joint's origin that a payload's mass is given, m: its inertia hardly shows beside its weight,
/// and with a fixed one the body is linear in what is fitted.
const GYRATION: f64 = 0.1;

/// Inertial parameters of a payload from mass and first moment.
pub(crate) fn payload(fitted: &[f64; 4]) -> [f64; PARAMETERS_PER_LINK] {
    let [m, x, y, z] = *fitted;
    let i = m * GYRATION * GYRATION;
    [m, x, y, z, i, 0.0, i, 0.0, 0.0, i]
}

/// Value of the smooth functions of an unknown torque at position, velocity and command (rad, rad/s), each of size one:
/// two harmonics of position, and saturating functions of velocity and of the command's rate of change.
pub(crate) fn unknown(q: f64, qd: f64, command_rate: f64) -> [f64; UNKNOWN] {
    // Walking speed of a joint: velocities beyond it count as fast.
    let slow = 0.2;
    let v = qd / (qd.abs() + slow);
    let r = command_rate / (command_rate.abs() + slow);
    [
        FRAC_1_SQRT_2,
        q.sin(),
        q.cos(),
        (2.0 * q).sin(),
        (2.0 * q).cos(),
        v,
        v * v.abs(),
        r,
    ]
}
