//! Forward dynamics by articulated bodies.

use super::Workspace;
use super::workspace::back;
use crate::robot::Robot;
use nalgebra::{Matrix3, Vector3};

/// Acceleration q̈ = (M(q) + diag(armature))⁻¹ (τ − C q̇ − g) by articulated bodies (Featherstone, 2008, table
/// 7.1), in O(N).
///
/// `armature` is the rotor inertia seen from each joint (kg·m², or kg), N values, or empty for none. `tau` is
/// the torque that acts on the rigid body: subtract friction before.
///
/// # Panics
/// When a slice or the workspace has another size than the robot.
pub fn forward_dynamics(
    robot: &Robot,
    workspace: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    tau: &[f64],
    armature: &[f64],
    qdd: &mut [f64],
) {
    workspace.check(robot, &[q, qd, tau, qdd]);
    assert!(
        armature.is_empty() || armature.len() == robot.dof(),
        "armature has one value per joint or none"
    );
    let joints = &robot.chain().joints;
    let Workspace {
        links, articulated, ..
    } = workspace;

    let (held, mut down) = (robot.chain().held, robot.gravity());
    let (mut w, mut v) = (Vector3::zeros(), Vector3::zeros());
    for (i, joint) in joints.iter().enumerate() {
        let (r, p) = joint.place(q[i]);
        v = back(&r, &(v + w.cross(&p)));
        w = back(&r, &w);
        let body = &mut articulated[i];
        // c = (w, v) × axis·q̇, with w and v including the joint's own motion (which adds nothing).
        if joint.prismatic {
            v.z += qd[i];
            body.bias_angular = Vector3::zeros();
            body.bias_linear = Vector3::new(w.y * qd[i], -w.x * qd[i], 0.0);
        } else {
            w.z += qd[i];
            body.bias_angular = Vector3::new(w.y * qd[i], -w.x * qd[i], 0.0);
            body.bias_linear = Vector3::new(v.y * qd[i], -v.x * qd[i], 0.0);
        }
        let h = &joint.first_moment;
        let angular_momentum = joint.inertia * w + h.cross(&v);
        let momentum = v * joint.mass + w.cross(h);
        body.rotational = joint.inertia;
        body.coupling = h.cross_matrix();
        body.translational = Matrix3::from_diagonal_element(joint.mass);
        body.moment = w.cross(&angular_momentum) + v.cross(&momentum);
        body.force = w.cross(&momentum);
        if held {
            down = back(&r, &down);
            body.moment += h.cross(&down) * joint.held;
            body.force += down * (joint.held * joint.mass);
        }
        links[i].rotation = r;
        links[i].translation = p;
    }

    for (i, joint) in joints.iter().enumerate().rev() {
        let (below, from) = articulated.split_at_mut(i);
        let body = &mut from[0];
        let (u_moment, u_force): (Vector3<f64>, Vector3<f64>) = if joint.prismatic {
            (
                body.coupling.column(2).into_owned(),
                body.translational.column(2).into_owned(),
            )
        } else {
            (
                body.rotational.column(2).into_owned(),
                body.coupling.row(2).transpose(),
            )
        };
        let (along, bias) = if joint.prismatic {
            (u_force.z, body.force.z)
        } else {
            (u_moment.z, body.moment.z)
        };
        body.inverse = 1.0 / (along + armature.get(i).copied().unwrap_or(0.0));
        body.rest = tau[i] - bias;
        body.u_moment = u_moment;
        body.u_force = u_force;
        let Some(parent) = below.last_mut() else {
            break;
        };

        // What the joint passes on: inertia less U Uᵀ/d, wrench plus inertia·c + U·rest/d.
        let (um, uf) = (u_moment * body.inverse, u_force * body.inverse);
        let rotational = body.rotational - um * u_moment.transpose();
        let coupling = body.coupling - um * u_force.transpose();
        let translational = body.translational - uf * u_force.transpose();
        let (ca, cl) = (&body.bias_angular, &body.bias_linear);
        let moment = body.moment + rotational * ca + coupling * cl + um * body.rest;
        let force = body.force + coupling.tr_mul(ca) + translational * cl + uf * body.rest;

        let (r, p) = (&links[i].rotation, &links[i].translation);
        let rt = r.transpose();
        let rotational = r * rotational * rt;
        let coupling = r * coupling * rt;
        let translational = r * translational * rt;
        let shift = p.cross_matrix();
        // About the parent's origin: H' = H + [p]M, I' = I − H[p] + [p]H'ᵀ.
        let shifted = coupling + shift * translational;
        parent.rotational += rotational - coupling * shift + shift * shifted.transpose();
        parent.coupling += shifted;
        parent.translational += translational;
        let force = r * force;
        parent.force += force;
        parent.moment += r * moment + p.cross(&force);
    }

    let (mut wd, mut a) = (Vector3::zeros(), -robot.gravity());
    for (i, joint) in joints.iter().enumerate() {
        let (r, p) = (&links[i].rotation, &links[i].translation);
        let body = &articulated[i];
        a = back(r, &(a + wd.cross(p))) + body.bias_linear;
        wd = back(r, &wd) + body.bias_angular;
        qdd[i] = (body.rest - body.u_moment.dot(&wd) - body.u_force.dot(&a)) * body.inverse;
        if joint.prismatic {
            a.z += qdd[i];
        } else {
            wd.z += qdd[i];
        }
    }
}
