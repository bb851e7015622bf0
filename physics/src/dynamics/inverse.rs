//! Inverse dynamics by recursive Newton–Euler.

use super::Workspace;
use super::workspace::back;
use crate::robot::Robot;
use nalgebra::Vector3;

/// Torque of the rigid body, τ = M(q) q̈ + C(q, q̇) q̇ + g(q), by recursive Newton–Euler (Luh, Walker and
/// Paul, 1980; Featherstone, 2008, table 5.1).
///
/// `q`, `qd`, `qdd` and `tau` have N values (rad or m, per s, per s²; N·m or N). Friction, rotor inertia and
/// counterbalance are not included.
///
/// # Panics
/// When a slice or the workspace has another size than the robot.
pub fn inverse_dynamics(
    robot: &Robot,
    workspace: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    tau: &mut [f64],
) {
    inverse_dynamics_with_gravity(robot, workspace, &robot.gravity(), q, qd, qdd, tau);
}

/// [`inverse_dynamics`] with another gravity vector than the robot's (base frame, m/s²).
///
/// # Panics
/// As [`inverse_dynamics`].
pub fn inverse_dynamics_with_gravity(
    robot: &Robot,
    workspace: &mut Workspace,
    gravity: &Vector3<f64>,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    tau: &mut [f64],
) {
    workspace.check(robot, &[q, qd, qdd, tau]);
    let joints = &robot.chain().joints;
    let (held, mut down) = (robot.chain().held, *gravity);
    // Accelerating the base upwards has the effect of gravity.
    let (mut w, mut wd, mut a) = (Vector3::zeros(), Vector3::zeros(), -gravity);
    for (i, (joint, link)) in joints.iter().zip(&mut workspace.links).enumerate() {
        let (r, p) = joint.place(q[i]);
        // Acceleration of this origin as a point of the parent: a + ẇ×p + w×(w×p).
        let a_origin = a + wd.cross(&p) + w.cross(&w.cross(&p));
        a = back(&r, &a_origin);
        w = back(&r, &w);
        wd = back(&r, &wd);
        if joint.prismatic {
            // Coriolis 2 w × z q̇, and the joint's own acceleration.
            a.x += 2.0 * w.y * qd[i];
            a.y -= 2.0 * w.x * qd[i];
            a.z += qdd[i];
        } else {
            // ẇ gains w × z q̇ + z q̈.
            wd.x += w.y * qd[i];
            wd.y -= w.x * qd[i];
            wd.z += qdd[i];
            w.z += qd[i];
        }
        // What holds a part of the weight takes that part of gravity off.
        let felt = if held {
            down = back(&r, &down);
            a + down * joint.held
        } else {
            a
        };
        let h = &joint.first_moment;
        link.force = felt * joint.mass + wd.cross(h) + w.cross(&w.cross(h));
        link.moment = joint.inertia * wd + w.cross(&(joint.inertia * w)) + h.cross(&felt);
        link.rotation = r;
        link.translation = p;
    }
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (i, (joint, link)) in joints.iter().zip(&workspace.links).enumerate().rev() {
        force += link.force;
        moment += link.moment;
        tau[i] = if joint.prismatic { force.z } else { moment.z };
        force = link.rotation * force;
        moment = link.rotation * moment + link.translation.cross(&force);
    }
}
