//! A plant in the making.

use crate::arm::Arm;
use crate::integrate::{Friction, Plant};
use crate::mechanism::{Mechanism, RestLaw};
use crate::run::Trace;
use physics::robot::RobotError;

/// Bodies, friction, mechanisms and measurement chain of the robot that is recorded.
pub struct Build {
    /// Bodies; effects may add joints.
    pub arm: Arm,
    /// Indices of the joints of `arm` that have motors and encoders.
    pub axes: Vec<usize>,
    /// Rotor inertia of each joint of `arm`, kg·m².
    pub armature: Vec<f64>,
    /// Friction, per joint of `arm`.
    pub friction: Vec<Friction>,
    /// Mechanisms beyond rigid bodies and friction.
    pub mechanisms: Vec<Box<dyn Mechanism>>,
    /// Measurement chain from motor torque to recorded torque.
    pub measurement: Measurement,
}

/// Measurement chain of the torque, per motor.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Factor of the recorded torque on the real torque, without unit.
    pub gain: Vec<f64>,
    /// Offset of the recorded torque, N·m.
    pub offset: Vec<f64>,
    /// Largest torque that can be recorded, N·m.
    pub limit: Vec<f64>,
    /// Delay of the recorded torque after the motion, s.
    pub delay: f64,
}

impl Measurement {
    /// Measurement chain without error.
    pub fn faithful(dof: usize) -> Self {
        Self {
            gain: vec![1.0; dof],
            offset: vec![0.0; dof],
            limit: vec![f64::INFINITY; dof],
            delay: 0.0,
        }
    }

    /// Recorded value of a torque of motor `j`, N·m, without the delay.
    pub fn note(&self, j: usize, torque: f64) -> f64 {
        let limit = self.limit[j];
        (self.gain[j] * torque + self.offset[j]).clamp(-limit, limit)
    }
}

/// Torque as the channel notes it, without noise: samples × joints, row after row.
pub fn noted(trace: &Trace, measurement: &Measurement) -> Vec<f64> {
    let n = trace.dof;
    trace
        .tau
        .iter()
        .enumerate()
        .map(|(i, t)| measurement.note(i % n, *t))
        .collect()
}

impl Build {
    /// A plant without any effect.
    pub fn plain(arm: &Arm) -> Self {
        let n = arm.dof();
        let friction = arm.joints.iter().zip(&arm.v_eps);
        Self {
            axes: (0..n).collect(),
            armature: vec![0.0; n],
            friction: friction
                .map(|(j, &v_eps)| Friction {
                    viscous: j.damping,
                    coulomb: j.friction,
                    v_eps,
                    rest: arm.rest,
                })
                .collect(),
            mechanisms: Vec::new(),
            measurement: Measurement::faithful(n),
            arm: arm.clone(),
        }
    }

    /// Adds a mechanism to the plant.
    pub fn add(&mut self, mechanism: impl Mechanism + 'static) {
        self.mechanisms.push(Box::new(mechanism));
    }

    /// Speed below which the friction of motor `j` is softened, rad/s.
    pub fn v_eps(&self, j: usize) -> f64 {
        self.friction[self.axes[j]].v_eps
    }

    /// Puts an elastic joint behind motor `j`; returns the new joint's index.
    pub fn split(&mut self, j: usize) -> usize {
        let joint = self.axes[j];
        self.arm.split_joint(joint);
        self.insert(joint + 1);
        joint + 1
    }

    /// Accounts for a joint without motor or friction that was put at `index` of the arm.
    pub fn insert(&mut self, index: usize) {
        let none = Friction {
            viscous: 0.0,
            coulomb: 0.0,
            v_eps: 1e-3,
            rest: RestLaw::Root,
        };
        self.friction.insert(index, none);
        self.armature.insert(index, 0.0);
        for axis in &mut self.axes {
            if *axis >= index {
                *axis += 1;
            }
        }
    }

    /// The plant at rest where its motors are at `q`.
    ///
    /// # Errors
    /// The bodies make no possible robot.
    pub fn plant(self, q: &[f64]) -> Result<(Plant, Vec<usize>), RobotError> {
        let mut at = vec![0.0; self.arm.dof()];
        for (&axis, q) in self.axes.iter().zip(q) {
            at[axis] = *q;
        }
        let plant = Plant::new(
            self.arm.robot()?,
            self.armature,
            self.friction,
            self.mechanisms,
            at,
        );
        Ok((plant, self.axes))
    }
}
