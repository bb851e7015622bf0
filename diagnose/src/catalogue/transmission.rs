//! A link on a transmission that gives way, driven by the recorded motor motion.
//!
//! With δ = q − q_link, T the torque that the link needs to follow the motor and M the inertia that the joint
//! turns, the link's own equation is M·δ̈ = T − F(δ, δ̇), and the recorded torque shows F instead of T. What turns with the
//! motor although the description has it in the link (rotor, wave generator) is moved by no transmission: T and M are
//! without it.

use crate::motion::motor::{Band, Motor};
use crate::motion::scene::Scene;
use crate::motion::sensed::Departure;
use ndarray::{Array1, Array2, Axis};

/// Transmission with a spring.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    /// Natural frequency of the link on the spring, Hz.
    pub frequency: f64,
    /// Damping ratio of the link on the spring.
    pub damping: f64,
    /// Part of the joint's inertia that turns with the motor.
    pub rotor: f64,
    /// Half of the play before the spring winds up, rad.
    pub half_play: f64,
}

/// Transmission with a gap between flanks, on which the link stays where it lands. Bounces on stiff flanks
/// cannot be predicted, and last no longer than the torque's low-pass. The time at which the link leaves a
/// flank is computed in the whole band of the rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// Half of the play between the flanks, rad.
    pub half_play: f64,
    /// Part of the joint's inertia that turns with the motor.
    pub rotor: f64,
}

/// Largest phase of the natural oscillation in one step of the integration, rad.
const STEP_PHASE: f64 = 0.15;
/// Uncertainty of a landing's time, s: small errors of friction, mass or play shift it.
const LANDING: f64 = 0.015;
/// Least part of the joint's inertia that belongs to the link in any position.
const LEAST_LINK: f64 = 0.05;

/// Change of the rigid torque of all joints by the recorded departure of the link, N·m (N), shape (samples,
/// joints); none where it was not recorded. `zero`: departure that the encoders show where the transmission
/// carries no torque.
pub(super) fn recorded(
    scene: &Scene,
    joint: usize,
    band: Band,
    rotor: f64,
    zero: f64,
) -> Option<Array2<f64>> {
    let [x, v, a] = scene.departed(joint, band)?;
    let departure = [&x - zero, v.to_owned(), a.to_owned()];
    Some(changed(&scene.motor(joint, band), rotor, &departure))
}

impl Spring {
    /// Change of the rigid torque of all joints by the spring, N·m (N), shape (samples, joints).
    pub fn change(&self, scene: &Scene, joint: usize) -> Array2<f64> {
        let motor = scene.motor(joint, Band::Motion);
        changed(&motor, self.rotor, &self.follow(scene, &motor))
    }

    /// Departure by semi-implicit Euler steps, from rest in every trajectory.
    fn follow(&self, scene: &Scene, motor: &Motor) -> Departure {
        let omega = std::f64::consts::TAU * self.frequency;
        let step = scene.scale.step;
        let substeps = (step * omega / STEP_PHASE).ceil().max(1.0) as usize;
        let h = step / substeps as f64;
        let damping = 2.0 * self.damping * omega;
        let needed = needed(motor, self.rotor);
        let mut out = [0, 1, 2].map(|_| Array1::zeros(scene.len()));
        for segment in &scene.motion.segments {
            let first = needed[segment.start];
            let mut x = first / (omega * omega) + self.half_play * first.signum();
            let mut v = 0.0;
            for i in segment.clone() {
                let mut sum = 0.0;
                for _ in 0..substeps {
                    let depth = x - x.clamp(-self.half_play, self.half_play);
                    let rubs = if self.half_play > 0.0 && depth == 0.0 {
                        0.0
                    } else {
                        damping
                    };
                    let a = (needed[i] - omega * omega * depth - rubs * v) / (1.0 + h * rubs);
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
    /// Change of the rigid torque of all joints by the gap, N·m (N), shape (samples, joints), smoothed by the
    /// uncertainty of landings.
    pub fn change(&self, scene: &Scene, joint: usize) -> Array2<f64> {
        let motor = scene.motor(joint, Band::Rows);
        let mut out = changed(&motor, self.rotor, &self.cross(scene, &motor));
        for mut column in out.columns_mut() {
            let rounded = scene.rounded(&column.to_owned(), LANDING);
            column.assign(&rounded);
        }
        out
    }

    /// Departure by steps, starting in every trajectory from the flank that the torque presses.
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

/// Acceleration of a free link's departure from its motor, T/M.
fn needed(motor: &Motor, rotor: f64) -> Array1<f64> {
    let inertia = motor.tangent.qdd.column(motor.joint);
    let own = rotor * motor.inertia;
    let link = |whole: f64| (whole - own).max(LEAST_LINK * whole).max(1e-9);
    let each = motor.rigid.iter().zip(motor.qdd).zip(inertia);
    each.map(|((torque, qdd), &whole)| (torque - own * qdd) / link(whole))
        .collect()
}

/// Change of all joints' torque by the departure of a link, N·m (N), shape (samples, joints).
fn changed(motor: &Motor, rotor: f64, departure: &Departure) -> Array2<f64> {
    let by = motor.tangent;
    let [q, qd, qdd] = [0, 1, 2].map(|k| -departure[k].clone().insert_axis(Axis(1)));
    let mut out = &by.q * &q + &by.qd * &qd + &by.qdd * &qdd;
    // The rotor stays with the motor.
    let own = rotor * motor.inertia;
    out.column_mut(motor.joint).scaled_add(own, &departure[2]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::scene::Scale;
    use ndarray::ArrayView1;
    use physics::robot::Robot;
    use signal::Motion;

    const RATE: f64 = 250.0;

    /// The first joint of a UR5, whose axis is vertical, swings by itself.
    fn swinging() -> (Robot, Motion, Scale) {
        let robot = Robot::builtin("ur5").unwrap();
        let (n, dof, omega) = (1000, robot.dof(), 5.0);
        let first = |f: &dyn Fn(f64) -> f64| {
            Array2::from_shape_fn((n, dof), |(i, j)| match j {
                0 => f(omega * i as f64 / RATE),
                _ => 0.3,
            })
        };
        let only = |f: &dyn Fn(f64) -> f64| {
            let mut table = first(f);
            for mut column in table.columns_mut().into_iter().skip(1) {
                column.fill(0.0);
            }
            table
        };
        let motion = Motion {
            time: (0..n).map(|i| i as f64 / RATE).collect(),
            q: first(&|x| x.sin()),
            qd: only(&|x| omega * x.cos()),
            qdd: only(&|x| -omega * omega * x.sin()),
            segments: std::iter::once(0..n).collect(),
        };
        let scale = Scale {
            softness: vec![0.01; dof],
            lead: vec![0.0; dof],
            speed: vec![1.0; dof],
            range: vec![(-1.0, 1.0); dof],
            torque: vec![3.0; dof],
            session: (0.0, 4.0),
            step: 1.0 / RATE,
            channel: None,
            correlation_rows: None,
        };
        (robot, motion, scale)
    }

    fn largest(x: ArrayView1<f64>) -> f64 {
        x.iter().fold(0.0, |most, x| most.max(x.abs()))
    }

    #[test]
    fn a_link_crosses_the_gap_at_each_change_of_its_load_and_gives_back_what_it_brings() {
        let (robot, motion, scale) = swinging();
        let scene = Scene::new(&robot, &motion, &scale);
        for rotor in [0.0, 0.4] {
            let half_play = 0.004;
            let gap = Gap { half_play, rotor };
            let [x, _, _] = gap.cross(&scene, &scene.motor(0, Band::Rows));
            assert!(x.iter().all(|x| x.abs() <= half_play));
            let sides = x.iter().zip(x.iter().skip(1));
            let crossings = sides.filter(|(a, b)| *a * *b < 0.0).count();
            // A zero of the load every π/ω seconds, the first at the start.
            assert_eq!(crossings, 6, "rotor {rotor}");
            // F − T = −M·δ̈ of the link: over whole crossings its integral is nought, and it is not small in between.
            let change = gap.change(&scene, 0).column(0).to_owned();
            let impulse = change.sum() / RATE;
            let size = change.mapv(f64::abs).sum() / RATE;
            assert!(
                size > 0.5 && impulse.abs() < 0.02 * size,
                "{impulse} of {size}"
            );
        }
        let none = Gap {
            half_play: 1e-9,
            rotor: 0.0,
        };
        assert!(largest(none.change(&scene, 0).column(0)) < 0.05 * largest(scene.rigid.column(0)));
    }

    #[test]
    fn a_spring_adds_what_its_equation_says() {
        // Far below its resonance a spring gives way by T/K: M·(q̈ − δ̈) with δ̈ = −(ω/Ω)²·q̈ to first order.
        let (robot, motion, scale) = swinging();
        let scene = Scene::new(&robot, &motion, &scale);
        let spring = Spring {
            frequency: 12.0,
            damping: 0.5,
            rotor: 0.0,
            half_play: 0.0,
        };
        let part = (5.0 / (std::f64::consts::TAU * spring.frequency)).powi(2);
        let change = spring.change(&scene, 0).column(0).to_owned();
        let expected = scene.rigid.column(0).mapv(|t| part * t);
        let settled = |x: &Array1<f64>| largest(x.slice_axis(Axis(0), (250..).into()));
        let worst = settled(&(&change - &expected));
        let most = settled(&expected);
        assert!(worst < 0.15 * most, "{worst} of {most}");
    }
}
