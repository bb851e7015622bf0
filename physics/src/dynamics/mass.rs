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
        (r, o) = if i == 0 {
            (step, p)
        } else {
            (turn(&r, &step), r * p + o)
        };
        let z = Vector3::new(r.m13, r.m23, r.m33);
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
    let (mut mass, mut moment, mut inertia) = (0.0, Vector3::zeros(), [0.0; 6]);
    for (i, joint) in joints.iter().enumerate().rev() {
        let link = &workspace.links[i];
        let (r, o) = (&link.rotation, &link.translation);
        let h = r * joint.first_moment;
        mass += joint.mass;
        moment += h + o * joint.mass;
        add_inertia(
            &mut inertia,
            r,
            &joint.inertia,
            o,
            &(h + o * (0.5 * joint.mass)),
        );
        let s = workspace.screws[i];
        let force = s.linear * mass + s.angular.cross(&moment);
        let torque = times(&inertia, &s.angular) + moment.cross(&s.linear);
        let row = &mut m[i * n..][..=i];
        for (entry, screw) in row.iter_mut().zip(&workspace.screws) {
            let (w, v) = (&screw.angular, &screw.linear);
            // In this order both halves are one sequence of packed operations.
            *entry = (w.x * torque.x + w.z * torque.z + v.y * force.y)
                + (w.y * torque.y + v.x * force.x + v.z * force.z);
        }
    }
    for i in 1..n {
        for j in 0..i {
            m[j * n + i] = m[i * n + j];
        }
    }
}

/// Adds R I Rᵀ + 2 (k·o)·1 − k oᵀ − o kᵀ: an inertia about a body's origin o, taken to the base's origin, with
/// k = h + m o/2. Symmetric matrices are `[xx, xy, xz, yy, yz, zz]` here.
#[inline(always)]
fn add_inertia(
    sum: &mut [f64; 6],
    r: &Matrix3<f64>,
    inertia: &Matrix3<f64>,
    o: &Vector3<f64>,
    k: &Vector3<f64>,
) {
    // Five entries of the turned matrix; the sixth follows because turning keeps the trace.
    let row = |a: usize| {
        let (x, y, z) = (r[(a, 0)], r[(a, 1)], r[(a, 2)]);
        Vector3::new(
            x * inertia.m11 + y * inertia.m12 + z * inertia.m13,
            x * inertia.m12 + y * inertia.m22 + z * inertia.m23,
            x * inertia.m13 + y * inertia.m23 + z * inertia.m33,
        )
    };
    let (first, second) = (row(0), row(1));
    let along = |v: &Vector3<f64>, b: usize| v.x * r[(b, 0)] + v.y * r[(b, 1)] + v.z * r[(b, 2)];
    let (xx, yy) = (along(&first, 0), along(&second, 1));
    let zz = inertia.m11 + inertia.m22 + inertia.m33 - xx - yy;
    let (x, y, z) = (2.0 * k.x * o.x, 2.0 * k.y * o.y, 2.0 * k.z * o.z);
    sum[0] += xx + y + z;
    sum[1] += along(&first, 1) - k.x * o.y - o.x * k.y;
    sum[2] += along(&first, 2) - k.x * o.z - o.x * k.z;
    sum[3] += yy + x + z;
    sum[4] += along(&second, 2) - k.y * o.z - o.y * k.z;
    sum[5] += zz + x + y;
}

/// Product of two rotations; its third column is the cross product of the others.
#[inline(always)]
fn turn(a: &Matrix3<f64>, b: &Matrix3<f64>) -> Matrix3<f64> {
    let x = a * Vector3::new(b.m11, b.m21, b.m31);
    let y = a * Vector3::new(b.m12, b.m22, b.m32);
    Matrix3::from_columns(&[x, y, x.cross(&y)])
}

/// Symmetric matrix times vector.
#[inline(always)]
fn times([xx, xy, xz, yy, yz, zz]: &[f64; 6], v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        xx * v.x + xy * v.y + xz * v.z,
        xy * v.x + yy * v.y + yz * v.z,
        xz * v.x + yz * v.y + zz * v.z,
    )
}
