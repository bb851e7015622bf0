//! Regressor of the rigid-body torque.

use super::Workspace;
use super::workspace::{Screw, back};
use crate::robot::{PARAMETERS_PER_LINK, Robot};
use nalgebra::Vector3;

/// The matrix Y(q, q̇, q̈) with Y·[`Robot::parameters`] = [`super::inverse_dynamics`] (Atkeson, An and
/// Hollerbach, 1986).
///
/// `y` is row-major, N × 10 N: the torque of joint i is `y[i * 10 * N..][..10 * N]`·π.
///
/// # Panics
/// When a slice or the workspace has another size than the robot.
pub fn regressor(
    robot: &Robot,
    workspace: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    y: &mut [f64],
) {
    regressor_with_gravity(robot, workspace, &robot.gravity(), q, qd, qdd, y);
}

/// [`regressor`] with another gravity vector than the robot's (base frame, m/s²).
///
/// Link i's wrench is linear in its parameters; the torque of joint j ≤ i is its power along the unit motion
/// of joint j, whose screw is carried along in link i's frame. So every entry is computed once, in the frame
/// of the description, and nothing is summed.
///
/// # Panics
/// As [`regressor`].
pub fn regressor_with_gravity(
    robot: &Robot,
    workspace: &mut Workspace,
    gravity: &Vector3<f64>,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    y: &mut [f64],
) {
    workspace.check(robot, &[q, qd, qdd]);
    let n = robot.dof();
    let width = PARAMETERS_PER_LINK * n;
    assert_eq!(y.len(), n * width, "the regressor has N × 10 N entries");
    let screws = &mut workspace.screws;
    let (held, mut down) = (robot.chain().held, *gravity);
    let (mut w, mut wd, mut a) = (Vector3::zeros(), Vector3::zeros(), -gravity);
    for (i, joint) in robot.chain().joints.iter().enumerate() {
        let (r, p) = joint.place_described(q[i]);
        let a_origin = a + wd.cross(&p) + w.cross(&w.cross(&p));
        a = back(&r, &a_origin);
        w = back(&r, &w);
        wd = back(&r, &wd);
        for screw in &mut screws[..i] {
            screw.linear = back(&r, &(screw.linear + screw.angular.cross(&p)));
            screw.angular = back(&r, &screw.angular);
        }
        let rate = joint.axis * qd[i];
        if joint.prismatic {
            a += w.cross(&rate) * 2.0 + joint.axis * qdd[i];
            screws[i] = Screw {
                angular: Vector3::zeros(),
                linear: joint.axis,
            };
        } else {
            wd += w.cross(&rate) + joint.axis * qdd[i];
            w += rate;
            screws[i] = Screw {
                angular: joint.axis,
                linear: Vector3::zeros(),
            };
        }
        let felt = if held {
            down = back(&r, &down);
            a + down * joint.held
        } else {
            a
        };
        let column = PARAMETERS_PER_LINK * i;
        for (j, screw) in screws[..=i].iter().enumerate() {
            let row = &mut y[j * width + column..][..PARAMETERS_PER_LINK];
            fill(row, screw, &w, &wd, &felt);
        }
        for j in i + 1..n {
            y[j * width + column..][..PARAMETERS_PER_LINK].fill(0.0);
        }
    }
}

/// Power along `screw` of the wrench that each unit parameter needs at angular velocity w, angular
/// acceleration ẇ and acceleration a of the origin, gravity included:
/// f = m a + ẇ×h + w×(w×h), n = h×a + I ẇ + w×(I w); power = screw.linear·f + screw.angular·n.
#[inline(always)]
fn fill(row: &mut [f64], screw: &Screw, w: &Vector3<f64>, wd: &Vector3<f64>, a: &Vector3<f64>) {
    let (s, v) = (&screw.angular, &screw.linear);
    // v·(ẇ×h + w×(w×h)) + s·(h×a) = h·(v×ẇ + (v×w)×w + a×s).
    let h = v.cross(wd) + v.cross(w).cross(w) + a.cross(s);
    // s·(w×(I w)) = (s×w)·(I w).
    let c = s.cross(w);
    row[0] = v.dot(a);
    row[1] = h.x;
    row[2] = h.y;
    row[3] = h.z;
    row[4] = s.x * wd.x + c.x * w.x;
    row[5] = s.x * wd.y + s.y * wd.x + c.x * w.y + c.y * w.x;
    row[6] = s.y * wd.y + c.y * w.y;
    row[7] = s.x * wd.z + s.z * wd.x + c.x * w.z + c.z * w.x;
    row[8] = s.y * wd.z + s.z * wd.y + c.y * w.z + c.z * w.y;
    row[9] = s.z * wd.z + c.z * w.z;
}
