//! Mass matrix by composite rigid bodies.

use super::Workspace;
use super::workspace::Screw;
use crate::robot::Robot;
use nalgebra::{Matrix3, Vector3};

/// Mass matrix M(q) of the rigid body (N × N, symmetric, row-major), by composite rigid bodies (Featherstone,
/// 2008, section 6.2). Everything is expressed at the base's origin, so that composite inertias are
/// plain sums and M_ij = S_jᵀ·(I_i S_i) without carrying forces from frame to frame.
///
/// # Panics
/// When a slice or the workspace has another size than the robot.
pub fn mass_matrix(robot: &Robot, workspace: &mut Workspace, q: &[f64], m: &mut [f64]) {
    workspace.check(robot, &[q]);
    let n = robot.dof();
    assert_eq!(m.len(), n * n, "the mass matrix has N × N entries");
    let joints = &robot.chain().joints;
    let (mut r, mut o) = (Matrix3::identity(), Vector3::zeros());
    for (i, joint) in joints.iter().enumerate() {
        let (step, p) = joint.place(q[i]);
        o += r * p;
        r *= step;
        let z: Vector3<f64> = r.column(2).into_owned();
        workspace.screws[i] = if joint.prismatic {
            Screw {
                angular: Vector3::zeros(),
                linear: z,
            }
        } else {
            Screw {
                angular: z,
                linear: o.cross(&z),
            }
        };
        workspace.links[i].rotation = r;
        workspace.links[i].translation = o;
    }
    let (mut mass, mut moment, mut inertia) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for (i, joint) in joints.iter().enumerate().rev() {
        let link = &workspace.links[i];
        let (r, o) = (&link.rotation, &link.translation);
        let h = r * joint.first_moment;
        mass += joint.mass;
        moment += h + o * joint.mass;
        // R I Rᵀ + 2 h·o + m o·o on the diagonal, less h oᵀ + o hᵀ + m o oᵀ.
        let k = h + o * (0.5 * joint.mass);
        inertia += r * joint.inertia * r.transpose() - k * o.transpose() - o * k.transpose()
            + Matrix3::identity() * (2.0 * k.dot(o));
        let s = workspace.screws[i];
        let force = s.linear * mass + s.angular.cross(&moment);
        let torque = inertia * s.angular + moment.cross(&s.linear);
        for (j, screw) in workspace.screws[..=i].iter().enumerate() {
            let value = screw.angular.dot(&torque) + screw.linear.dot(&force);
            m[i * n + j] = value;
            m[j * n + i] = value;
        }
    }
}
