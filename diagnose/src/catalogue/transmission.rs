//! A link on a transmission that gives way, driven by the recorded motor motion.
//!
//! With δ = q − q_link, T the torque that the rigid model needs to follow the motor and M the inertia that the joint
//! turns, the link's own equation is M·δ̈ = T − F(δ, δ̇): a spring with damping, behind a gap where there is play.
//! The recorded torque then shows F instead of T.

use crate::motion::scene::Scene;
use ndarray::{Array1, Array2, Axis};

/// A spring behind a gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transmission {
    /// Natural frequency of link and spring, Hz.
    pub frequency: f64,
    /// Damping ratio in contact.
    pub damping: f64,
    /// Half of the play, rad.
    pub half_play: f64,
}

/// Largest phase of the natural oscillation in one step of the integration, rad.
const STEP_PHASE: f64 = 0.15;

impl Transmission {
    /// Change of the rigid torque of all joints, shape (samples, joints).
    pub fn change(&self, scene: &Scene, joint: usize) -> Array2<f64> {
        let (wind_up, rate, acceleration) = self.follow(scene, joint);
        let by = &scene.tangents[joint];
        let column = |x: &Array1<f64>| -x.clone().insert_axis(Axis(1));
        &by.q * &column(&wind_up) + &by.qd * &column(&rate) + &by.qdd * &column(&acceleration)
    }

    /// δ, δ̇ and δ̈ by semi-implicit Euler steps, from contact at rest in every trajectory.
    fn follow(&self, scene: &Scene, joint: usize) -> (Array1<f64>, Array1<f64>, Array1<f64>) {
        let omega = std::f64::consts::TAU * self.frequency;
        let step = scene.scale.step;
        let substeps = (step * omega / STEP_PHASE).ceil().max(1.0) as usize;
        let h = step / substeps as f64;
        let torque = scene.rigid.column(joint);
        let inertia = scene.tangents[joint].qdd.column(joint);
        let mut out = (
            Array1::zeros(scene.len()),
            Array1::zeros(scene.len()),
            Array1::zeros(scene.len()),
        );
        for segment in &scene.motion.segments {
            let needed = |i: usize| torque[i] / inertia[i].max(1e-9);
            let first = needed(segment.start);
            let mut x = first / (omega * omega) + self.half_play * first.signum();
            let mut v = 0.0;
            for i in segment.clone() {
                let mut sum = 0.0;
                for _ in 0..substeps {
                    let pressed = x - x.clamp(-self.half_play, self.half_play);
                    let contact = if pressed == 0.0 {
                        0.0
                    } else {
                        2.0 * self.damping * omega
                    };
                    let a =
                        (needed(i) - omega * omega * pressed - contact * v) / (1.0 + h * contact);
                    v += h * a;
                    x += h * v;
                    sum += a;
                }
                out.0[i] = x;
                out.1[i] = v;
                out.2[i] = sum / substeps as f64;
            }
        }
        out
    }
}
