//! Friction of a joint as one curve over speed: all torque that resists its motion, whatever cause it is assigned to.

use crate::input::frames::Frames;
use crate::motion::frame::Frame;
use crate::motion::scene::{Scale, Scene};
use crate::schema::Friction;
use crate::search::find::{Columns, Findings};
use crate::simulator::NominalModel;
use ndarray::{Array1, Array2, ArrayView1};
use physics::robot::PARAMETERS_PER_LINK;

/// Speeds at which friction is stated where a joint moved so fast, rad/s (m/s).
const SPEEDS: [f64; 9] = [0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0, 1.5, 2.0];
/// Half width of a speed's samples: factor on the speed.
const BAND: f64 = 1.25;

/// Friction of every joint, from the fit near the given parameters on the fitted recording.
pub fn friction(model: &NominalModel, frames: &Frames, found: &Findings) -> Vec<Friction> {
    let frame = &frames.data;
    // What a joint's friction is at its speed, however late it is recorded.
    let on_time = Scale {
        channel: None,
        ..frames.scale.clone()
    };
    let scene = Scene::new(&found.session.present, frames.passage(), &on_time);
    let torque = resisting(model, found, &scene, frame);
    let qd = &frame.samples().qd;
    let joints = model.robot.joints();
    let least = (found.settings.measure.said.friction * frame.report().rate_hz).ceil() as usize;
    joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let at = |v: &f64| at_speed(qd.column(j), torque.column(j), *v, least);
            Friction {
                joint: joint.name.clone(),
                speed: SPEEDS.to_vec(),
                given: SPEEDS
                    .iter()
                    .map(|v| joint.friction + joint.damping * v)
                    .collect(),
                found: SPEEDS.iter().map(at).collect(),
                unit: if joint.kind.is_rotation() {
                    "N·m"
                } else {
                    "N"
                },
            }
        })
        .collect()
}

/// Torque of all friction in the fit near the given parameters, at a frame's recorded samples, N·m (N), shape
/// (samples, joints). `scene` shows the frame's motion.
pub(super) fn resisting(
    model: &NominalModel,
    found: &Findings,
    scene: &Scene,
    frame: &Frame,
) -> Array2<f64> {
    let (variables, beta) = &found.tight;
    let rubs = |i: usize| {
        let n = PARAMETERS_PER_LINK * model.robot.dof();
        let of = |c: usize| {
            found.accepted[c].variables.contains(&i) && found.candidate(c).effect.info().friction
        };
        (n..found.base).contains(&i) || (0..found.accepted.len()).any(of)
    };
    let kept: Vec<usize> = (0..variables.len()).filter(|i| rubs(*i)).collect();
    let variables: Vec<_> = kept.iter().map(|&i| variables[i]).collect();
    let beta: Array1<f64> = kept.iter().map(|&i| beta[i]).collect();
    let columns = Columns::new(&found.dictionary, scene, frame, &variables);
    let mut torque: Array2<f64> = columns.torque(frame.tau.dim(), &variables, &beta);
    let qd = &frame.samples().qd;
    let sign = frame.table_to_samples(&scene.sign);
    for (j, joint) in model.robot.joints().iter().enumerate() {
        let mut own = torque.column_mut(j);
        own.scaled_add(joint.damping, &qd.column(j));
        own.scaled_add(joint.friction, &sign.column(j));
    }
    torque
}

/// Friction at a speed, N·m (N): half the difference between the torques of both directions. Each is read from
/// a line through the samples near that speed. None where one direction has fewer than `least` samples.
fn at_speed(qd: ArrayView1<f64>, torque: ArrayView1<f64>, speed: f64, least: usize) -> Option<f64> {
    let side = |sign: f64| {
        let near = |v: &f64| (speed / BAND..=speed * BAND).contains(v);
        let points: Vec<(f64, f64)> = qd
            .iter()
            .zip(torque)
            .map(|(v, t)| (sign * v, sign * t))
            .filter(|(v, _)| near(v))
            .collect();
        (points.len() >= least.max(2)).then(|| line_at(&points, speed))
    };
    Some(0.5 * (side(1.0)? + side(-1.0)?))
}

/// Value at `x` of the least-squares line through some points; their mean where all have the same x.
fn line_at(points: &[(f64, f64)], x: f64) -> f64 {
    let n = points.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (mx, my) = (mean(&|p| p.0), mean(&|p| p.1));
    let spread = mean(&|p| (p.0 - mx).powi(2));
    let slope = if spread > 0.0 {
        mean(&|p| (p.0 - mx) * (p.1 - my)) / spread
    } else {
        0.0
    };
    my + slope * (x - mx)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_directions_by_hand() {
        // 2 + 3 v forwards, 1 + v backwards: at 0.5 they are 3.5 and 1.5.
        let qd: Array1<f64> = (-100..=100).map(|i| 0.01 * f64::from(i)).collect();
        let torque = qd.mapv(|v| if v > 0.0 { 2.0 + 3.0 * v } else { -1.0 + v });
        let value = at_speed(qd.view(), torque.view(), 0.5, 5).unwrap();
        assert!((value - 2.5).abs() < 1e-9, "{value}");
        let forward = qd.mapv(f64::abs);
        assert_eq!(at_speed(forward.view(), torque.view(), 0.5, 5), None);
    }
}
