//! Derivatives of inverse dynamics.

use crate::robot::{ChainJoint, Robot};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// Buffers of [`inverse_dynamics_derivatives`] for one robot's size; make one per thread.
#[derive(Debug, Clone)]
pub struct Derivatives {
    /// Derivative ∂τ/∂q, N × N, row-major: row of the torque, column of the position.
    pub dq: Vec<f64>,
    /// Derivative ∂τ/∂q̇, N × N, row-major.
    pub dqd: Vec<f64>,
    /// Mass matrix M(q) = ∂τ/∂q̈, N × N, row-major, symmetric.
    pub mass: Vec<f64>,
    /// Torque of the rigid body itself, N values, as [`super::inverse_dynamics`] gives it.
    pub tau: Vec<f64>,
    links: Vec<Subtree>,
}

/// Quantities of one link in the base frame about its origin; after the backward pass those of all links it carries.
#[derive(Debug, Clone, Copy)]
struct Subtree {
    /// Unit motion of the joint, S.
    screw: Vector6<f64>,
    /// Change of the link's acceleration with q and with q̇ beyond the rigid transport of the subtree.
    with_q: Vector6<f64>,
    with_qd: Vector6<f64>,
    /// Product v_λ × S of the parent's velocity and the joint's unit motion.
    turned: Vector6<f64>,
    inertia: Matrix6<f64>,
    /// B with B m = v ×* (I m) + m ×* (I v) − I (v × m).
    bias: Matrix6<f64>,
    force: Vector6<f64>,
    /// Part of mass and first moment whose weight is held from outside.
    held: (f64, Vector3<f64>),
}

impl Derivatives {
    /// Buffers for `robot` and every robot with as many joints.
    pub fn new(robot: &Robot) -> Self {
        let n = robot.dof();
        let (zero, none) = (Vector6::zeros(), Matrix6::zeros());
        let empty = Subtree {
            screw: zero,
            with_q: zero,
            with_qd: zero,
            turned: zero,
            inertia: none,
            bias: none,
            force: zero,
            held: (0.0, Vector3::zeros()),
        };
        Self {
            dq: vec![0.0; n * n],
            dqd: vec![0.0; n * n],
            mass: vec![0.0; n * n],
            tau: vec![0.0; n],
            links: vec![empty; n],
        }
    }
}

/// ∂τ/∂q, ∂τ/∂q̇ and M of [`super::inverse_dynamics`] at (q, q̇, q̈), analytically and without allocating, in O(N²)
/// (Carpentier and Mansard, 2018, "Analytical derivatives of rigid body dynamics algorithms").
///
/// All quantities are expressed in the base frame at its origin. Moving joint j carries its subtree along
/// rigidly, which changes no torque inside it; there remains a change of velocity v_λ × S_j and of
/// acceleration.
///
/// # Panics
/// When a slice or the buffers have another size than the robot.
pub fn inverse_dynamics_derivatives(
    robot: &Robot,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    out: &mut Derivatives,
) {
    let n = robot.dof();
    let sizes = [q.len(), qd.len(), qdd.len(), out.links.len()];
    assert!(
        sizes.iter().all(|&s| s == n),
        "one value per joint is needed"
    );
    forward(robot, q, qd, qdd, &mut out.links);
    let down = robot.gravity();
    for i in (0..n).rev() {
        let link = out.links[i];
        // Rows of this joint for itself and the joints before it.
        let (inertia, bias) = (link.inertia * link.screw, link.bias.tr_mul(&link.screw));
        out.tau[i] = link.screw.dot(&link.force);
        for j in 0..=i {
            let other = &out.links[j];
            let weight = held(&link, other, &down);
            out.dq[i * n + j] =
                inertia.dot(&other.with_q) + bias.dot(&other.turned) - link.screw.dot(&weight);
            out.dqd[i * n + j] = inertia.dot(&other.with_qd) + bias.dot(&other.screw);
            out.mass[i * n + j] = inertia.dot(&other.screw);
            out.mass[j * n + i] = out.mass[i * n + j];
        }
        // Columns of this joint for the joints before it.
        let by_q = link.inertia * link.with_q
            + link.bias * link.turned
            + force_cross(&link.screw, &link.force)
            - held(&link, &link, &down);
        let by_qd = link.inertia * link.with_qd + link.bias * link.screw;
        for j in 0..i {
            let screw = &out.links[j].screw;
            out.dq[j * n + i] = screw.dot(&by_q);
            out.dqd[j * n + i] = screw.dot(&by_qd);
        }
        if i > 0 {
            let before = &mut out.links[i - 1];
            before.inertia += link.inertia;
            before.bias += link.bias;
            before.force += link.force;
            before.held.0 += link.held.0;
            before.held.1 += link.held.1;
        }
    }
}

/// Change of the held weight of `subtree` as `joint` turns it under gravity `down`, which does not turn along.
fn held(subtree: &Subtree, joint: &Subtree, down: &Vector3<f64>) -> Vector6<f64> {
    let (mass, moment) = &subtree.held;
    let turned = angular(&joint.screw).cross(down);
    join(&moment.cross(&turned), &(turned * *mass))
}

fn forward(robot: &Robot, q: &[f64], qd: &[f64], qdd: &[f64], links: &mut [Subtree]) {
    let (mut r, mut o) = (Matrix3::identity(), Vector3::zeros());
    let mut v = Vector6::zeros();
    let mut a = join(&Vector3::zeros(), &-robot.gravity());
    for (i, joint) in robot.chain().joints.iter().enumerate() {
        let (step, p) = joint.place(q[i]);
        o += r * p;
        r *= step;
        let z: Vector3<f64> = r.column(2).into_owned();
        let screw = if joint.prismatic {
            join(&Vector3::zeros(), &z)
        } else {
            join(&z, &o.cross(&z))
        };
        let turned = cross(&v, &screw);
        let with_q = cross(&a, &screw) + cross(&v, &turned);
        v += screw * qd[i];
        let own = cross(&v, &screw);
        a += screw * qdd[i] + own * qd[i];
        let (inertia, moment) = placed(joint, &r, &o);
        let down = robot.gravity() * joint.held;
        let felt = a + join(&Vector3::zeros(), &down);
        let momentum = inertia * v;
        let mut bias = Matrix6::zeros();
        for k in 0..6 {
            let mut unit = Vector6::zeros();
            unit[k] = 1.0;
            let column = force_cross(&v, &inertia.column(k).into_owned())
                + force_cross(&unit, &momentum)
                - inertia * cross(&v, &unit);
            bias.set_column(k, &column);
        }
        links[i] = Subtree {
            screw,
            with_q,
            with_qd: own + turned,
            turned,
            inertia,
            bias,
            force: inertia * felt + force_cross(&v, &momentum),
            held: (joint.held * joint.mass, moment * joint.held),
        };
    }
}

/// Spatial inertia of a link about the base's origin, and its first moment there.
fn placed(joint: &ChainJoint, r: &Matrix3<f64>, o: &Vector3<f64>) -> (Matrix6<f64>, Vector3<f64>) {
    let h = r * joint.first_moment;
    let moment = h + o * joint.mass;
    let k = h + o * (0.5 * joint.mass);
    let about = r * joint.inertia * r.transpose() + Matrix3::from_diagonal_element(2.0 * k.dot(o))
        - k * o.transpose()
        - o * k.transpose();
    let skew = moment.cross_matrix();
    let mut inertia = Matrix6::zeros();
    inertia.fixed_view_mut::<3, 3>(0, 0).copy_from(&about);
    inertia.fixed_view_mut::<3, 3>(0, 3).copy_from(&skew);
    inertia.fixed_view_mut::<3, 3>(3, 0).copy_from(&-skew);
    inertia
        .fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&Matrix3::from_diagonal_element(joint.mass));
    (inertia, moment)
}

fn join(angular: &Vector3<f64>, linear: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(
        angular.x, angular.y, angular.z, linear.x, linear.y, linear.z,
    )
}

fn angular(m: &Vector6<f64>) -> Vector3<f64> {
    Vector3::new(m[0], m[1], m[2])
}

fn linear(m: &Vector6<f64>) -> Vector3<f64> {
    Vector3::new(m[3], m[4], m[5])
}

/// Cross product of motions a × b, each as (angular, linear).
fn cross(a: &Vector6<f64>, b: &Vector6<f64>) -> Vector6<f64> {
    let (w, v) = (angular(a), linear(a));
    join(
        &w.cross(&angular(b)),
        &(w.cross(&linear(b)) + v.cross(&angular(b))),
    )
}

/// Cross product m ×* f of a motion and a force, each as (angular, linear).
fn force_cross(m: &Vector6<f64>, f: &Vector6<f64>) -> Vector6<f64> {
    let (w, v) = (angular(m), linear(m));
    join(
        &(w.cross(&angular(f)) + v.cross(&linear(f))),
        &w.cross(&linear(f)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{Workspace, inverse_dynamics, mass_matrix};

    /// Central differences of inverse dynamics, and its torque and mass matrix, on every built-in robot, also where a part
    /// of the weight is held.
    #[test]
    fn derivatives_are_differences_of_inverse_dynamics() {
        for name in ["ur5", "kr300", "puma560"] {
            let robot = Robot::builtin(name).expect("built in");
            let n = robot.dof();
            let parts: Vec<f64> = (0..n).map(|i| 0.1 * i as f64).collect();
            let held = robot
                .clone()
                .with_gravity_compensation(&parts)
                .expect("parts");
            for robot in [robot, held] {
                let at = |k: f64| {
                    (0..n)
                        .map(|i| (k + 1.3 * i as f64).sin())
                        .collect::<Vec<_>>()
                };
                let (q, qd, qdd) = (at(0.3), at(1.1), at(2.2));
                let mut out = Derivatives::new(&robot);
                inverse_dynamics_derivatives(&robot, &q, &qd, &qdd, &mut out);
                let mut workspace = Workspace::new(&robot);
                let mut torque = |q: &[f64], qd: &[f64]| {
                    let mut tau = vec![0.0; n];
                    inverse_dynamics(&robot, &mut workspace, q, qd, &qdd, &mut tau);
                    tau
                };
                let scale = torque(&q, &qd).iter().fold(1.0, |m: f64, t| m.max(t.abs()));
                for (value, own) in torque(&q, &qd).iter().zip(&out.tau) {
                    assert!((value - own).abs() < 1e-10 * scale);
                }
                for j in 0..n {
                    let step = 1e-5;
                    let moved = |x: &[f64], by: f64| {
                        let mut x = x.to_vec();
                        x[j] += by;
                        x
                    };
                    let (up, down) = (
                        torque(&moved(&q, step), &qd),
                        torque(&moved(&q, -step), &qd),
                    );
                    let (fast, slow) = (
                        torque(&q, &moved(&qd, step)),
                        torque(&q, &moved(&qd, -step)),
                    );
                    for i in 0..n {
                        let dq = (up[i] - down[i]) / (2.0 * step);
                        let dqd = (fast[i] - slow[i]) / (2.0 * step);
                        assert!(
                            (dq - out.dq[i * n + j]).abs() < 1e-6 * scale,
                            "{name} q {i} {j}"
                        );
                        assert!(
                            (dqd - out.dqd[i * n + j]).abs() < 1e-6 * scale,
                            "{name} qd {i} {j}"
                        );
                    }
                }
                let mut mass = vec![0.0; n * n];
                mass_matrix(&robot, &mut Workspace::new(&robot), &q, &mut mass);
                for (a, b) in mass.iter().zip(&out.mass) {
                    assert!((a - b).abs() < 1e-10 * scale);
                }
            }
        }
    }
}
