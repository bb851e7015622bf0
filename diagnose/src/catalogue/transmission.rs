//! A link on a transmission that gives way, driven by the recorded motor motion.
//!
//! With δ = q − q_link, T the torque that the link needs to follow the motor and M the inertia that the joint
//! turns, the link's own equation is M·δ̈ = T − F(δ, δ̇), and the recorded torque shows F instead of T. What turns with the
//! motor although the description has it in the link (rotor, wave generator) is moved by no transmission: T and M are
//! without it.

use crate::motion::scene::{Motor, Scene};
use ndarray::{Array1, Array2, Axis};

/// A spring.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    /// Natural frequency of link and spring, Hz.
    pub frequency: f64,
    /// Its damping ratio.
    pub damping: f64,
}

/// A gap between flanks on which the link stays where it lands: how it would bounce on stiff flanks cannot be foretold, and
/// lasts no longer than the torque's low-pass. When it leaves a flank is seen in the whole band of the rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// Half of the play, rad.
    pub half_play: f64,
    /// Part of the joint's inertia that turns with the motor.
    pub rotor: f64,
}

/// Largest phase of the natural oscillation in one step of the integration, rad.
const STEP_PHASE: f64 = 0.15;
/// Time to which landings are known, s: a friction, a mass or a play that is a little different shifts them.
const LANDING: f64 = 0.015;
/// Least part of its inertia that is the link's in any position.
const LEAST_LINK: f64 = 0.05;

/// Departure of the link from the motor with its derivatives, per sample.
type Departure = [Array1<f64>; 3];

impl Spring {
    /// Change of the rigid torque of all joints, shape (samples, joints).
    pub fn change(&self, scene: &Scene, joint: usize) -> Array2<f64> {
        let motor = scene.motor(joint);
        changed(&motor, 0.0, &self.follow(scene, &motor))
    }

    /// By semi-implicit Euler steps, from rest in every trajectory.
    fn follow(&self, scene: &Scene, motor: &Motor) -> Departure {
        let omega = std::f64::consts::TAU * self.frequency;
        let step = scene.scale.step;
        let substeps = (step * omega / STEP_PHASE).ceil().max(1.0) as usize;
        let h = step / substeps as f64;
        let damping = 2.0 * self.damping * omega;
        let needed = needed(motor, 0.0);
        let mut out = [0, 1, 2].map(|_| Array1::zeros(scene.len()));
        for segment in &scene.motion.segments {
            let mut x = needed[segment.start] / (omega * omega);
            let mut v = 0.0;
            for i in segment.clone() {
                let mut sum = 0.0;
                for _ in 0..substeps {
                    let a = (needed[i] - omega * omega * x - damping * v) / (1.0 + h * damping);
                    v += h * a;
                    x += h * v;
                    sum += a;
                }
                out[0][i] = x;
                out[1][i] = v;
                out[2][i] = sum / substeps as f64;
            }
        }
        out
    }
}

impl Gap {
    /// Change of the rigid torque of all joints, shape (samples, joints), rounded as landings are known.
    pub fn change(&self, scene: &Scene, joint: usize) -> Array2<f64> {
        let motor = scene.wide_motor(joint);
        let mut out = changed(&motor, self.rotor, &self.cross(scene, &motor));
        for mut column in out.columns_mut() {
            let rounded = scene.rounded(&column.to_owned(), LANDING);
            column.assign(&rounded);
        }
        out
    }

    /// From the flank that the torque presses at the start of every trajectory.
    fn cross(&self, scene: &Scene, motor: &Motor) -> Departure {
        let h = scene.scale.step;
        let needed = needed(motor, self.rotor);
        let mut out = [0, 1, 2].map(|_| Array1::zeros(scene.len()));
        for segment in &scene.motion.segments {
            let mut x = self.half_play * needed[segment.start].signum();
            let mut v = 0.0;
            for i in segment.clone() {
                let before = (x, v);
                v += h * needed[i];
                x += h * v;
                // The flank takes what the link brings.
                if x.abs() >= self.half_play {
                    x = self.half_play * x.signum();
                    v = 0.0;
                }
                out[0][i] = x;
                out[1][i] = (x - before.0) / h;
                out[2][i] = (v - before.1) / h;
            }
        }
        out
    }
}

/// Acceleration with which a free link departs from its motor, T/M.
fn needed(motor: &Motor, rotor: f64) -> Array1<f64> {
    let inertia = motor.tangent.qdd.column(motor.joint);
    let own = rotor * inertia.mean().unwrap_or(0.0);
    let link = |whole: f64| (whole - own).max(LEAST_LINK * whole).max(1e-9);
    let each = motor.rigid.iter().zip(motor.qdd).zip(inertia);
    each.map(|((torque, qdd), &whole)| (torque - own * qdd) / link(whole))
        .collect()
}

/// Torque that a link needs less where it departs from its motor.
fn changed(motor: &Motor, rotor: f64, departure: &Departure) -> Array2<f64> {
    let by = motor.tangent;
    let [q, qd, qdd] = [0, 1, 2].map(|k| -departure[k].clone().insert_axis(Axis(1)));
    let mut out = &by.q * &q + &by.qd * &qd + &by.qdd * &qdd;
    // The rotor stays with the motor.
    let own = rotor * by.qdd.column(motor.joint).mean().unwrap_or(0.0);
    out.column_mut(motor.joint).scaled_add(own, &departure[2]);
    out
}
