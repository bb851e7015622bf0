//! Inertia that an actuator meets at its joint: a damping ratio refers to it.

use super::chain::Chain;
use super::scene::{Kind, Scene};
use crate::robot::{Inertia, Robot, RobotError};
use nalgebra::{DMatrix, Matrix3, Rotation3, Unit, Vector3};

/// Inertia at each joint, rotor included, when the other joints are free, all at their reference: 1/(M⁻¹)ᵢᵢ in kg·m²
/// (kg). So has MuJoCo 4.0.0, except that joints which were not chosen stand still here.
///
/// # Errors
/// A `ref` that is not a number.
pub(super) fn inertias(
    scene: &Scene<'_, '_, '_>,
    chain: &Chain,
    robot: &Robot,
) -> Result<Vec<f64>, RobotError> {
    let joints = robot.joints();
    let slides = |k: usize| scene.joints[chain.joints[k]].kind == Kind::Slide;
    let mut places: Vec<(Matrix3<f64>, Vector3<f64>)> = Vec::new();
    for (k, joint) in joints.iter().enumerate() {
        let own = &scene.joints[chain.joints[k]];
        let reference = own.attributes.number("ref")?.unwrap_or(0.0);
        let (mut rotation, mut origin) = (joint.rotation, joint.translation);
        if slides(k) {
            origin += rotation * joint.axis * reference;
        } else {
            let axis = Unit::new_unchecked(joint.axis);
            let angle = reference * own.angle;
            rotation *= Rotation3::from_axis_angle(&axis, angle).into_inner();
        }
        places.push((rotation, origin));
    }
    let n = joints.len();
    let mut mass = DMatrix::zeros(n, n);
    let mut carried = Inertia::default();
    for j in (0..n).rev() {
        let axis = joints[j].axis;
        carried = carried.plus(&joints[j].link.inertia);
        // Force and moment that turn (push) all that the joint carries at one unit of acceleration, in its frame.
        let (mut force, mut moment) = if slides(j) {
            (axis * carried.mass, carried.first_moment.cross(&axis))
        } else {
            (
                axis.cross(&carried.first_moment),
                carried.about_origin * axis,
            )
        };
        for i in (0..=j).rev() {
            let felt = if slides(i) { force } else { moment };
            mass[(i, j)] = joints[i].axis.dot(&felt);
            mass[(j, i)] = mass[(i, j)];
            let (rotation, origin) = &places[i];
            force = rotation * force;
            moment = rotation * moment + origin.cross(&force);
        }
        mass[(j, j)] += joints[j].rotor_inertia;
        carried = carried.transformed(&places[j].0, &places[j].1);
    }
    let inverse = mass.try_inverse();
    Ok((0..n)
        .map(|k| inverse.as_ref().map_or(0.0, |m| 1.0 / m[(k, k)]))
        .collect())
}
