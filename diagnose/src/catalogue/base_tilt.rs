//! `base_tilt`: gravity points elsewhere in the base frame. Two small rotations shared by all joints.
//! Confounders: first moments of the links, encoder offset of the first joints, offsets.

use super::candidate::{Bound, Candidate, Column, Quantity, Shape};
use super::effect::Effect;
use super::experiment::Experiment;
use super::info::{Carried, Correction, Info};
use super::reported::{Parameter, size};
use super::unit::Unit;
use crate::motion::scene::Scene;
use nalgebra::{Rotation3, Vector3};
use ndarray::Array2;

/// Name of the shape parameter where all axes feel one direction alone: angle of the tilt's axis in the base frame, rad.
pub const DIRECTION: &str = "direction";

/// Description of `base_tilt`: confounders, remedy, experiment, rules.
pub(super) const INFO: Info = Info {
    name: "base_tilt",
    plain: "a tilted base",
    confounders: &[
        Effect::LinkParameters,
        Effect::EncoderOffset,
        Effect::Counterbalance,
        Effect::TorqueOffset,
    ],
    absorbable: true,
    place: Some("URDF"),
    correction: Some(Correction::Tilt),
    unplanned: "no tilt changes the torque",
    remedy: "turn gravity in the base frame ({})",
    carried: |_| Carried::Gravity,
    reported: by_axes,
    experiments: &[(Effect::EncoderOffset, Experiment::Level)],
    ..Info::NEW
};

/// Step of the finite difference of the torque, rad.
const STEP: f64 = 1e-3;
/// Torque of a tilt in one direction, over that across it, below which it is unobservable. An arm with parallel
/// axes does not feel a tilt about a line across them.
const SEEN: f64 = 0.1;

pub(super) fn candidates(scene: &Scene) -> Vec<Candidate> {
    let dof = scene.dof();
    let about = |axis: Vector3<f64>| Column::whole(dof, move |s| change(s, axis));
    let tilt = |name| Quantity::plain(name, Unit::Rad, None);
    let (angle, seen) = directions(scene);
    let (columns, quantities, shape) = if seen < SEEN {
        let axis = Vector3::new(angle.cos(), angle.sin(), 0.0);
        let direction = vec![Shape::new(DIRECTION, angle, Unit::Rad)];
        (vec![about(axis)], vec![tilt("tilt")], direction)
    } else {
        let columns = vec![about(Vector3::x()), about(Vector3::y())];
        (columns, vec![tilt("tilt_x"), tilt("tilt_y")], Vec::new())
    };
    vec![Candidate {
        effect: Effect::BaseTilt,
        joints: (0..dof).collect(),
        driver: None,
        bounds: vec![Bound::Free; columns.len()],
        columns,
        quantities,
        change: None,
        shape,
        sizes: Vec::new(),
        known: None,
        evidence: 0.0,
        shown: None,
    }]
}

/// Horizontal axis about which a tilt changes the torque most, as its angle from x, rad, and the ratio of the
/// torque about the axis across it.
fn directions(scene: &Scene) -> (f64, f64) {
    let [x, y] = [Vector3::x(), Vector3::y()].map(|axis| change(scene, axis));
    let product = |a: &Array2<f64>, b: &Array2<f64>| -> f64 {
        let of = |j: usize| a.column(j).dot(&b.column(j)) / scene.scale.torque[j].powi(2);
        (0..scene.dof()).map(of).sum()
    };
    let (xx, xy, yy) = (product(&x, &x), product(&x, &y), product(&y, &y));
    let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let least = (mean - half).max(0.0) / (mean + half).max(f64::MIN_POSITIVE);
    (0.5 * (2.0 * xy).atan2(xx - yy), least.sqrt())
}

/// Torque per angle of a base turned about an axis, N·m/rad, shape (samples, joints).
fn change(scene: &Scene, axis: Vector3<f64>) -> Array2<f64> {
    // The base turned by +angle sees gravity turned by −angle.
    let gravity = Rotation3::new(-STEP * axis) * scene.robot.gravity();
    scene.gravity_change(gravity) / STEP
}

/// Converts one tilt in a direction into tilts about both axes.
fn by_axes(parameters: &mut Vec<Parameter>) {
    let (Some((tilt, std)), Some((angle, _))) =
        (size(parameters, "tilt"), size(parameters, DIRECTION))
    else {
        return;
    };
    let (sin, cos) = angle.sin_cos();
    *parameters = [("tilt_x", cos), ("tilt_y", sin)]
        .map(|(name, part)| Parameter {
            name: name.to_owned(),
            value: tilt * part,
            std: std.map(|s| s * part.abs()),
            ..parameters[0].clone()
        })
        .to_vec();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::scene::Scale;
    use physics::robot::Robot;
    use signal::Motion;

    /// Two links of 1 kg, the first about y turned by 0.2 rad about z, the second about `axis`.
    fn arm(axis: &str) -> Robot {
        let link = |name: &str| {
            format!(
                r#"<link name="{name}"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
                <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>"#
            )
        };
        let text = format!(
            r#"<robot name="r"><link name="b"/>{}{}<joint name="j1" type="continuous"><origin xyz="0 0 0" rpy="0 0 0.2"/>
            <parent link="b"/><child link="l1"/><axis xyz="0 1 0"/></joint><joint name="j2" type="continuous">
            <origin xyz="0.4 0 0"/><parent link="l1"/><child link="l2"/><axis xyz="{axis}"/></joint></robot>"#,
            link("l1"),
            link("l2")
        );
        Robot::from_urdf_str(&text).unwrap()
    }

    fn candidate(robot: &Robot) -> Candidate {
        let n = 200;
        let table = |f: &dyn Fn(f64, f64) -> f64| {
            Array2::from_shape_fn((n, 2), |(i, j)| f(0.05 * i as f64, 1.0 + 0.7 * j as f64))
        };
        let motion = Motion {
            time: (0..n).map(|i| 0.05 * i as f64).collect(),
            q: table(&|t, w| (w * t).sin()),
            qd: table(&|t, w| w * (w * t).cos()),
            qdd: table(&|t, w| -w * w * (w * t).sin()),
            segments: std::iter::once(0..n).collect(),
        };
        let scale = Scale {
            softness: vec![0.01; 2],
            lead: vec![0.0; 2],
            speed: vec![1.0; 2],
            range: vec![(-1.0, 1.0); 2],
            torque: vec![3.0, 1.0],
            session: (0.0, 10.0),
            step: 0.05,
            channel: None,
            correlation_rows: None,
        };
        candidates(&Scene::new(robot, &motion, &scale)).swap_remove(0)
    }

    #[test]
    fn parallel_axes_feel_one_direction() {
        let flat = candidate(&arm("0 1 0"));
        assert_eq!(flat.columns.len(), 1);
        let Shape {
            name, value: angle, ..
        } = flat.shape[0];
        // The axes' own line: y turned by 0.2 rad, as exact as a difference over a milliradian is.
        let along = std::f64::consts::FRAC_PI_2 + 0.2;
        assert_eq!(name, DIRECTION);
        assert!((angle - along).sin().abs() < 1e-4, "{angle}");
        assert_eq!(candidate(&arm("0 0 1")).columns.len(), 2);
    }
}
