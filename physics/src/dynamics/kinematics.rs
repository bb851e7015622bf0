//! Poses, Jacobians and energies.

use super::Workspace;
use super::workspace::back;
use crate::robot::Robot;
use nalgebra::{Matrix3, Vector3};

/// Pose of a link's joint frame in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Orientation: x_base = R x_link.
    pub rotation: Matrix3<f64>,
    /// Position of the origin, m.
    pub translation: Vector3<f64>,
}

/// Poses of all joint frames in the base frame at `q`, base first, without allocating.
///
/// # Panics
/// When `q` has another length than the robot.
pub fn link_placements<'a>(robot: &'a Robot, q: &'a [f64]) -> impl Iterator<Item = Placement> + 'a {
    assert_eq!(q.len(), robot.dof(), "one value per joint is needed");
    let base = (Matrix3::identity(), Vector3::zeros());
    let joints = robot.chain().joints.iter().zip(q);
    joints.scan(base, |(rotation, translation), (joint, &q)| {
        let (r, p) = joint.place_described(q);
        *translation += *rotation * p;
        *rotation *= r;
        Some(Placement {
            rotation: *rotation,
            translation: *translation,
        })
    })
}

/// Jacobian of a point of link `link` (index from 0), given in that link's joint frame (m).
///
/// `jacobian` is row-major 6 × N in the base frame: rows 0–2 the point's velocity, rows 3–5 the link's angular
/// velocity. A force f and moment n on the point cost the joints −Jᵀ[f; n].
///
/// # Panics
/// When a slice or the workspace has another size than the robot, or the link does not exist.
pub fn point_jacobian(
    robot: &Robot,
    workspace: &mut Workspace,
    q: &[f64],
    link: usize,
    point: &Vector3<f64>,
    jacobian: &mut [f64],
) {
    workspace.check(robot, &[q]);
    let n = robot.dof();
    assert_eq!(jacobian.len(), 6 * n, "the Jacobian has 6 × N entries");
    assert!(link < n, "link index out of range");
    for (state, placement) in workspace.links.iter_mut().zip(link_placements(robot, q)) {
        state.rotation = placement.rotation;
        state.translation = placement.translation;
    }
    let target = workspace.links[link].rotation * point + workspace.links[link].translation;
    jacobian.fill(0.0);
    let joints = robot.chain().joints.iter().zip(&workspace.links);
    for (j, (joint, state)) in joints.take(link + 1).enumerate() {
        let axis = state.rotation * joint.axis;
        let (linear, angular) = if joint.prismatic {
            (axis, Vector3::zeros())
        } else {
            (axis.cross(&(target - state.translation)), axis)
        };
        for k in 0..3 {
            jacobian[k * n + j] = linear[k];
            jacobian[(k + 3) * n + j] = angular[k];
        }
    }
}

/// Kinetic energy ½ q̇ᵀ M(q) q̇ of the rigid bodies, J.
///
/// # Panics
/// When a slice has another length than the robot.
pub fn kinetic_energy(robot: &Robot, q: &[f64], qd: &[f64]) -> f64 {
    let n = robot.dof();
    assert!(
        q.len() == n && qd.len() == n,
        "one value per joint is needed"
    );
    let (mut w, mut v) = (Vector3::zeros(), Vector3::zeros());
    let mut energy = 0.0;
    for (i, joint) in robot.chain().joints.iter().enumerate() {
        let (r, p) = joint.place(q[i]);
        v = back(&r, &(v + w.cross(&p)));
        w = back(&r, &w);
        if joint.prismatic {
            v.z += qd[i];
        } else {
            w.z += qd[i];
        }
        energy += 0.5 * joint.mass * v.norm_squared()
            + joint.first_moment.dot(&v.cross(&w))
            + 0.5 * w.dot(&(joint.inertia * w));
    }
    energy
}

/// Potential energy −Σ m gᵀ c of the rigid bodies in the robot's gravity (of the weight that nothing outside holds),
/// J; zero for masses at the base's origin.
///
/// # Panics
/// When `q` has another length than the robot.
pub fn potential_energy(robot: &Robot, q: &[f64]) -> f64 {
    let moment: Vector3<f64> = link_placements(robot, q)
        .zip(robot.joints())
        .zip(&robot.chain().joints)
        .map(|((at, joint), chain)| {
            let inertia = &joint.link.inertia;
            (at.rotation * inertia.first_moment + at.translation * inertia.mass)
                * (1.0 - chain.held)
        })
        .sum();
    -robot.gravity().dot(&moment)
}
