//! Runs of one robot, simulated side by side.

use super::effects::JointEffects;
use crate::SimulateError;
use datasets::{Recording, Trajectory};
use ndarray::{Axis, concatenate};
use physics::robot::Robot;
use plant::Plant;
use plant::arm::Arm;
use plant::build::Build;
use plant::control::{Controller, Sensing};
use plant::measure::{Errors, record};
use plant::mechanism::{
    Bristle, Drag, DragKind, GearMesh, GearSpring, Mechanism, RestLaw, Ripple, Stribeck,
    StribeckKind, WarmingGrease,
};
use plant::reference::{Command, Session};
use plant::run::{Clock, run};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// One run: trajectories without a break of the clock.
pub struct Plan {
    /// Session that is run without a break.
    pub session: Session,
    /// Time at which the session starts on the clock of the part, s.
    pub offset: f64,
    /// Labels of its trajectories.
    pub labels: Vec<String>,
    /// Times of the session's control loop.
    pub clock: Clock,
    /// Index of the part of the recording that the run belongs to.
    pub part: usize,
}

/// Elastic gear of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gear {
    /// Stiffness of the gear, N·m/rad; it doubles at a deflection of 0.1 rad.
    pub stiffness: f64,
    /// Damping of the gear, N·m·s/rad.
    pub damping: f64,
}

/// Simulated robot of a protocol.
#[derive(Clone)]
pub struct Machine {
    /// Arm with friction, both of its controller's model and of the plant.
    pub arm: Arm,
    /// Effects of each joint, base first.
    pub effects: Vec<JointEffects>,
    /// Warming: time constant, s, and power at the steady state of each joint, W.
    pub warm_up: (f64, Vec<f64>),
    /// The elastic gear of each joint, none where it is stiff; empty: all are, as in every recording of the protocols.
    pub gears: Vec<Option<Gear>>,
    /// Further mechanisms, given the plant's joints that have motors.
    pub more: fn(&[usize]) -> Vec<Box<dyn Mechanism>>,
    /// Errors of the recorded channels.
    pub errors: Errors,
    /// Bandwidth of the controller, Hz.
    pub bandwidth: f64,
}

/// An arm from a built-in robot with its region of motion and friction.
pub fn arm(
    family: &'static str,
    robot: &Robot,
    centre: [f64; 6],
    reach: [f64; 6],
    friction: [(f64, f64); 6],
) -> Arm {
    let mut joints = robot.joints().to_vec();
    for (joint, (viscous, coulomb)) in joints.iter_mut().zip(friction) {
        joint.damping = viscous;
        joint.friction = coulomb;
    }
    Arm {
        family,
        centre: centre.to_vec(),
        reach: reach.to_vec(),
        v_eps: vec![0.002; joints.len()],
        rest: RestLaw::Root,
        disc: vec![0.0; joints.len()],
        joints,
    }
}

impl Machine {
    /// The robot with viscous and Coulomb friction and stiff gears. Its further mechanisms are kept (the
    /// KR300's counterbalance, the Foxbot's law of friction).
    pub fn plain(mut self) -> Self {
        self.effects.fill(JointEffects::default());
        self.gears.clear();
        self
    }

    /// The plant at rest where its motors are at `q`, `time` seconds into the session (the gears have been warming since), and
    /// its joints that have motors; an elastic gear's deflection is the joint after.
    ///
    /// # Errors
    /// The bodies make no possible robot.
    pub fn plant(&self, q: &[f64], time: f64) -> Result<(Plant, Vec<usize>), SimulateError> {
        let mut build = Build::plain(&self.arm);
        build.armature = self.arm.joints.iter().map(|j| j.rotor_inertia).collect();
        // Tip first: discs are counted by motor, and nothing may be added before a joint that is still to be split.
        for (j, gear) in self.gears.iter().enumerate().rev() {
            if gear.is_some() {
                build.split(j);
            }
        }
        for (j, gear) in self.gears.iter().enumerate() {
            if let Some(gear) = gear {
                build.add(GearSpring {
                    joint: build.axes[j] + 1,
                    stiffness: gear.stiffness,
                    hardening: 0.1,
                    damping: gear.damping,
                });
            }
        }
        let axes = build.axes.clone();
        build.mechanisms.extend((self.more)(&axes));
        for (j, e) in self.effects.iter().enumerate() {
            self.add_effects(&mut build, j, e, time);
        }
        Ok(build.plant(q)?)
    }

    /// Adds the effects of joint `j` beyond viscous and Coulomb friction.
    fn add_effects(&self, build: &mut Build, j: usize, e: &JointEffects, time: f64) {
        let joint = build.axes[j];
        let own = build.friction[joint];
        let v_eps = own.v_eps;
        if e.cold > 0.0 {
            let (time_constant, power) = &self.warm_up;
            build.add(WarmingGrease {
                joint,
                cold: e.cold,
                fading: 2.0,
                time: *time_constant,
                power: power[j],
                viscous: own.viscous,
                coulomb: 0.3 * own.coulomb,
                v_eps,
                warmth: 1.0 - (-time.max(0.0) / time_constant).exp(),
            });
        }
        if e.deflection > 0.0 {
            build.friction[joint].coulomb = 0.0;
            build.add(Bristle {
                joint,
                coulomb: own.coulomb,
                deflection: e.deflection,
                elastic: 0.1,
                damping: 0.02 * own.coulomb / e.deflection,
                z: 0.0,
            });
        }
        if e.loss > 0.0 {
            build.add(GearMesh {
                joint,
                loss: e.loss,
                v_eps,
            });
        }
        if e.stribeck > 0.0 {
            build.add(Stribeck {
                joint,
                size: e.stribeck,
                v_s: e.stribeck_speed,
                v_eps,
                kind: StribeckKind::Lorentz,
                film: 0.0,
            });
        }
        if e.flow > 0.0 {
            build.add(Drag {
                joint,
                size: e.flow,
                v_0: 0.12,
                v_top: 3.0,
                kind: DragKind::Eyring,
            });
        }
        if e.ripple > 0.0 {
            let second = [2.7 * e.order, 0.4 * e.ripple, 2.0];
            build.add(Ripple {
                joint,
                waves: vec![[e.order, e.ripple, 0.7], second],
            });
        }
    }

    /// Simulates the plans; the recording of each part, in order of the plans.
    pub fn record(
        &self,
        plans: &[Plan],
        parts: usize,
        seed: u64,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Vec<Recording>, SimulateError> {
        let done = AtomicUsize::new(0);
        let runs = plans
            .par_iter()
            .enumerate()
            .map(|(i, plan)| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(i as u64 + 1);
                let recording = self.run(plan, &mut rng)?;
                let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress(finished as f64 / plans.len() as f64);
                Ok(recording)
            })
            .collect::<Result<Vec<Recording>, SimulateError>>()?;
        let of_part = |part: usize| {
            let mine: Vec<&Recording> = plans
                .iter()
                .zip(&runs)
                .filter(|(p, _)| p.part == part)
                .map(|(_, r)| r)
                .collect();
            joined(&mine)
        };
        Ok((0..parts).filter_map(of_part).collect())
    }

    fn run(&self, plan: &Plan, rng: &mut ChaCha8Rng) -> Result<Recording, SimulateError> {
        let mut start = Command::new(self.arm.dof());
        plan.session.sample(plan.session.span().0, &mut start);
        let sensing = Sensing {
            count: self.errors.count.clone(),
            velocity_noise: self.errors.velocity.iter().map(|v| 0.4 * v).collect(),
            corner: 60.0,
        };
        let period = plan.clock.step * plan.clock.control as f64;
        let control_rng = ChaCha8Rng::from_rng(rng);
        let mut controller =
            Controller::new(&self.arm, self.bandwidth, period, sensing, control_rng)?;
        let (mut plant, axes) = self.plant(&start.q, plan.offset)?;
        let mut trace = run(
            &plan.session,
            &mut controller,
            &mut plant,
            &axes,
            plan.clock,
            0.0,
        );
        trace.time.iter_mut().for_each(|t| *t += plan.offset);
        let (mut recording, _) = record(&trace, &trace.tau, &self.errors, rng);
        for (trajectory, label) in recording.trajectories.iter_mut().zip(&plan.labels) {
            trajectory.label.clone_from(label);
        }
        Ok(recording)
    }

    /// The robot's true parameters.
    pub fn truth(&self) -> serde_json::Value {
        serde_json::json!({
            "robot": self.arm.family,
            "joints": self.arm.joints.iter().map(|j| &j.name).collect::<Vec<_>>(),
            "parameters": self.arm.joints.iter().map(|j| j.link.inertia.parameters()).collect::<Vec<_>>(),
            "rotor_inertia": self.arm.joints.iter().map(|j| j.rotor_inertia).collect::<Vec<_>>(),
            "viscous": self.arm.damping(),
            "coulomb": self.arm.friction(),
            "v_eps": self.arm.v_eps,
            "effects": self.effects,
            "warm_up_time": self.warm_up.0,
            "torque_noise": self.errors.torque,
        })
    }
}

/// Recording of all runs one behind the other; none without runs.
fn joined(runs: &[&Recording]) -> Option<Recording> {
    let first = *runs.first()?;
    let mut whole = first.clone();
    let tables = |get: fn(&Recording) -> Option<&ndarray::Array2<f64>>| {
        let views: Option<Vec<_>> = runs.iter().map(|r| get(r).map(|t| t.view())).collect();
        concatenate(Axis(0), &views?).ok()
    };
    whole.q = tables(|r| Some(&r.q))?;
    whole.qd = tables(|r| r.qd.as_ref());
    whole.tau = tables(|r| r.tau.as_ref());
    for run in &runs[1..] {
        let start = whole.time.len();
        whole.time.extend_from_slice(&run.time);
        whole
            .trajectories
            .extend(run.trajectories.iter().map(|t| Trajectory {
                label: t.label.clone(),
                range: t.range.start + start..t.range.end + start,
            }));
    }
    Some(whole)
}
