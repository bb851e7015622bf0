//! The robot under control: a plant, seen and driven at its motors.

use crate::ControlError;
use machines::description::{Description, Moves};
use machines::plant::Carried;
use plant::bodies::Bodies;
use plant::{Friction, Plant};
use trials::protocols::Machine as Arm;

/// A joint's name and kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// Name.
    pub name: String,
    /// Whether it turns (rad, N·m) or slides (m, N).
    pub turns: bool,
}

impl Axis {
    /// Unit of torque or force.
    pub fn effort_unit(&self) -> &'static str {
        if self.turns { "N·m" } else { "N" }
    }
}

/// A simulated robot with N motors.
pub struct Subject {
    /// Its joints.
    pub axes: Vec<Axis>,
    plant: Plant,
    /// Plant joint of each motor.
    motors: Vec<usize>,
    /// Whether the plant joint after each motor's is its gear's deflection.
    elastic: Vec<bool>,
    /// Largest torque of each motor, N·m or N; infinite where there is no limit.
    effort: Vec<f64>,
    torque: Vec<f64>,
}

impl Subject {
    /// An arm of a protocol at rest at `q`, `time` seconds into its session: its gears have been warming since.
    ///
    /// # Errors
    /// Bodies that make no possible robot.
    pub fn arm(arm: &Arm, q: &[f64], time: f64) -> Result<Self, ControlError> {
        let (plant, motors) = arm.plant(q, time)?;
        let joints = &arm.arm.joints;
        let axes = joints.iter().map(|j| Axis {
            name: j.name.clone(),
            turns: j.kind.is_rotation(),
        });
        Ok(Self {
            axes: axes.collect(),
            torque: vec![0.0; plant.dof()],
            plant,
            elastic: (0..motors.len())
                .map(|j| arm.gears.get(j).is_some_and(Option::is_some))
                .collect(),
            motors,
            effort: joints.iter().map(|j| j.limits.effort).collect(),
        })
    }

    /// A machine at rest at `q`.
    ///
    /// # Errors
    /// A description that no plant has.
    pub fn machine(description: &Description, q: &[f64]) -> Result<Self, ControlError> {
        let machine = machines::plant::plant(description, false, &Carried::default())?;
        let friction = machine.friction().into_iter().map(|f| Friction {
            viscous: f.viscous,
            coulomb: f.coulomb,
            v_eps: f.soft,
            rest: plant::mechanism::RestLaw::Root,
        });
        let friction: Vec<Friction> = friction.collect();
        let n = description.axis.len();
        let bodies = Box::new(OfMachine { machine, n });
        let axes = description.axis.iter().map(|axis| Axis {
            name: axis.name.clone(),
            turns: axis.kind == Moves::Rotary,
        });
        Ok(Self {
            axes: axes.collect(),
            plant: Plant::of(bodies, vec![0.0; n], friction, Vec::new(), q.to_vec()),
            motors: (0..n).collect(),
            elastic: vec![false; n],
            effort: description.axis.iter().map(|a| a.effort).collect(),
            torque: vec![0.0; n],
        })
    }

    /// Number of motors, N.
    pub fn dof(&self) -> usize {
        self.motors.len()
    }

    /// Positions and velocities at the motors, N values each.
    pub fn measure(&self, q: &mut [f64], v: &mut [f64]) {
        for (j, &joint) in self.motors.iter().enumerate() {
            q[j] = self.plant.q[joint];
            v[j] = self.plant.v[joint];
        }
    }

    /// Positions of the links: of the motors and what their gears wind up, N values.
    pub fn links(&self, q: &mut [f64]) {
        for (j, (q, &joint)) in q.iter_mut().zip(&self.motors).enumerate() {
            let wound = if self.elastic[j] {
                self.plant.q[joint + 1]
            } else {
                0.0
            };
            *q = self.plant.q[joint] + wound;
        }
    }

    /// Torque that the motors give when asked for `u`: within their limits.
    pub fn limit(&self, u: &mut [f64]) {
        for (u, limit) in u.iter_mut().zip(&self.effort) {
            *u = u.clamp(-limit, *limit);
        }
    }

    /// One step of `dt` seconds from time `t` under motor torques `u`, with `push` from outside on the links (N values each).
    pub fn step(&mut self, t: f64, dt: f64, u: &[f64], push: &[f64]) {
        self.torque.fill(0.0);
        for (j, &joint) in self.motors.iter().enumerate() {
            self.torque[joint] = u[j] + push[j];
            // A torque on the link does work on the motor's turn and on the gear's deflection alike.
            if self.elastic[j] {
                self.torque[joint + 1] = push[j];
            }
        }
        self.plant.step(t, dt, &self.torque);
    }
}

/// A machine whose torque is linear in the acceleration.
struct OfMachine {
    machine: Box<dyn machines::plant::Plant>,
    n: usize,
}

impl Bodies for OfMachine {
    fn dof(&self) -> usize {
        self.n
    }

    fn mass(&mut self, q: &[f64], mass: &mut [f64]) {
        let n = self.n;
        let still = vec![0.0; n];
        let held = self.machine.torque(q, &still, &still);
        let mut unit = still.clone();
        for j in 0..n {
            unit[j] = 1.0;
            let column = self.machine.torque(q, &still, &unit);
            for i in 0..n {
                mass[i * n + j] = column[i] - held[i];
            }
            unit[j] = 0.0;
        }
    }

    fn bias(&mut self, q: &[f64], v: &[f64], bias: &mut [f64]) {
        bias.copy_from_slice(&self.machine.torque(q, v, &vec![0.0; self.n]));
    }
}
