//! Laws of rigid-body dynamics over random chains of 1 to 10 joints.

use nalgebra::{Cholesky, DMatrix, DVector, Matrix3, Rotation3, Unit, Vector3};
use physics::dynamics::*;
use physics::robot::{Inertia, Joint, JointKind, Limits, Link, Robot};
use proptest::prelude::*;

/// A joint with a random placement, axis and consistent inertia; one in four slides, half have an axis along a
/// coordinate.
fn joint() -> impl Strategy<Value = Joint> {
    let vector = || prop::array::uniform3(-1.0..1.0f64);
    (
        0..4u8,
        0..6u8,
        vector(),
        vector(),
        vector(),
        0.1..5.0f64,
        vector(),
        prop::array::uniform6(-0.4..0.4f64),
    )
        .prop_map(|(kind, axis, free, rpy, xyz, mass, com, l)| {
            let axis = match axis {
                0 => Vector3::x(),
                1 => -Vector3::y(),
                2 => Vector3::z(),
                3 => -Vector3::z(),
                _ => Unit::new_normalize(Vector3::from(free) + Vector3::new(0.0, 0.0, 1.5))
                    .into_inner(),
            };
            // Second moments Σ = L Lᵀ + 0.01, so that a mass distribution exists.
            let l = Matrix3::new(l[0], 0.0, 0.0, l[1], l[2], 0.0, l[3], l[4], l[5]);
            let sigma = l * l.transpose() + Matrix3::identity() * 0.01;
            let about_com = (Matrix3::identity() * sigma.trace() - sigma) * mass;
            Joint {
                name: String::new(),
                kind: if kind == 0 {
                    JointKind::Prismatic
                } else {
                    JointKind::Revolute
                },
                axis,
                rotation: Rotation3::from_euler_angles(3.0 * rpy[0], 3.0 * rpy[1], 3.0 * rpy[2])
                    .into_inner(),
                translation: xyz.into(),
                limits: Limits::NONE,
                damping: 0.0,
                friction: 0.0,
                rotor_inertia: 0.0,
                gear_ratio: None,
                torque_constant: None,
                link: Link {
                    name: String::new(),
                    inertia: Inertia::from_com(mass, Vector3::from(com) * 0.3, about_com),
                },
            }
        })
}

/// A robot under gravity in any direction, with q, q̇ and a third vector (q̈ or τ).
fn case() -> impl Strategy<Value = (Robot, Vec<f64>, Vec<f64>, Vec<f64>)> {
    (1usize..=10).prop_flat_map(|n| {
        let state = |bound: f64| prop::collection::vec(-bound..bound, n);
        let joints = prop::collection::vec(joint(), n);
        let gravity = prop::array::uniform3(-10.0..10.0f64);
        (joints, gravity, state(3.0), state(2.0), state(5.0)).prop_map(|(joints, g, q, qd, x)| {
            let robot = Robot::new("random", joints).expect("every generated robot is possible");
            (robot.with_gravity(g.into()), q, qd, x)
        })
    })
}

fn torque(robot: &Robot, q: &[f64], qd: &[f64], qdd: &[f64]) -> DVector<f64> {
    let mut tau = vec![0.0; robot.dof()];
    inverse_dynamics(robot, &mut Workspace::new(robot), q, qd, qdd, &mut tau);
    DVector::from_vec(tau)
}

fn mass(robot: &Robot, q: &[f64]) -> DMatrix<f64> {
    let n = robot.dof();
    let mut m = vec![0.0; n * n];
    mass_matrix(robot, &mut Workspace::new(robot), q, &mut m);
    DMatrix::from_row_slice(n, n, &m)
}

/// Differences relative to the largest number that entered.
fn close(a: &DVector<f64>, b: &DVector<f64>, tolerance: f64) -> Result<(), TestCaseError> {
    let scale = a.amax().max(b.amax()).max(1.0);
    let worst = (a - b).amax() / scale;
    prop_assert!(worst < tolerance, "{worst:.3e}: {a} against {b}");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn regressor_times_parameters_is_inverse_dynamics((robot, q, qd, qdd) in case()) {
        let n = robot.dof();
        let mut y = vec![f64::NAN; n * 10 * n];
        regressor(&robot, &mut Workspace::new(&robot), &q, &qd, &qdd, &mut y);
        let product = DMatrix::from_row_slice(n, 10 * n, &y) * DVector::from_vec(robot.parameters());
        close(&product, &torque(&robot, &q, &qd, &qdd), 1e-12)?;
    }

    #[test]
    fn mass_matrix_is_the_derivative_of_torque_by_acceleration((robot, q, qd, qdd) in case()) {
        let m = mass(&robot, &q);
        prop_assert_eq!(&m, &m.transpose());
        prop_assert!(Cholesky::new(m.clone()).is_some(), "not positive definite");
        let bias = torque(&robot, &q, &qd, &vec![0.0; robot.dof()]);
        close(
            &(m * DVector::from_column_slice(&qdd) + bias),
            &torque(&robot, &q, &qd, &qdd),
            1e-12,
        )?;
    }

    #[test]
    fn forward_dynamics_inverts_inverse_dynamics((robot, q, qd, qdd) in case(), armature in 0.0..2.0f64) {
        let n = robot.dof();
        let rotor: Vec<f64> = (0..n).map(|i| armature * (1.0 + i as f64)).collect();
        let mut tau = torque(&robot, &q, &qd, &qdd);
        for i in 0..n {
            tau[i] += rotor[i] * qdd[i];
        }
        let mut back = vec![0.0; n];
        let mut workspace = Workspace::new(&robot);
        forward_dynamics(&robot, &mut workspace, &q, &qd, tau.as_slice(), &rotor, &mut back);
        // The inverse amplifies rounding by the condition of M.
        let rotor = DMatrix::from_diagonal(&DVector::from_vec(rotor));
        let values = (mass(&robot, &q) + rotor).symmetric_eigenvalues();
        let condition = values.max() / values.min();
        close(&DVector::from_vec(back), &DVector::from_vec(qdd), 1e-13 * condition.max(10.0))?;
    }

    #[test]
    fn power_is_the_rate_of_energy((robot, q, qd, qdd) in case()) {
        let energy = |t: f64| {
            let at: Vec<f64> = (0..q.len()).map(|i| q[i] + t * (qd[i] + 0.5 * t * qdd[i])).collect();
            let rate: Vec<f64> = (0..q.len()).map(|i| qd[i] + t * qdd[i]).collect();
            kinetic_energy(&robot, &at, &rate) + potential_energy(&robot, &at)
        };
        // Fourth-order difference: the step balances its error against rounding.
        let h = 1e-3;
        let rate = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
        let power = torque(&robot, &q, &qd, &qdd).dot(&DVector::from_column_slice(&qd));
        let scale = power.abs().max(energy(0.0).abs()).max(1.0);
        prop_assert!((rate - power).abs() < 1e-6 * scale, "dE/dt {rate}, power {power}");
    }

    #[test]
    fn kinetic_energy_is_half_the_quadratic_form((robot, q, qd, _) in case()) {
        let v = DVector::from_column_slice(&qd);
        let half = 0.5 * v.dot(&(mass(&robot, &q) * &v));
        let energy = kinetic_energy(&robot, &q, &qd);
        prop_assert!((half - energy).abs() < 1e-12 * half.max(1.0));
    }

    #[test]
    fn jacobian_is_the_derivative_of_the_point((robot, q, _, _) in case(), point in prop::array::uniform3(-1.0..1.0f64)) {
        let (n, link) = (robot.dof(), robot.dof() - 1);
        let point = Vector3::from(point);
        let mut jacobian = vec![0.0; 6 * n];
        point_jacobian(&robot, &mut Workspace::new(&robot), &q, link, &point, &mut jacobian);
        let at = |q: &[f64]| {
            let end = link_placements(&robot, q).last().expect("there is a joint");
            end.rotation * point + end.translation
        };
        for j in 0..n {
            let (h, mut up, mut down) = (1e-6, q.clone(), q.clone());
            up[j] += h;
            down[j] -= h;
            let difference = (at(&up) - at(&down)) / (2.0 * h);
            for k in 0..3 {
                prop_assert!((difference[k] - jacobian[k * n + j]).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn a_force_on_a_link_costs_its_transposed_jacobian((robot, q, _, _) in case(), point in prop::array::uniform3(-1.0..1.0f64), extra in 0.1..3.0f64) {
        // A point mass at rest pulls with m·g: the torque it costs is −Jᵀ m g.
        let (n, link) = (robot.dof(), robot.dof() / 2);
        let point = Vector3::from(point);
        let zero = vec![0.0; n];
        let mut parameters = robot.parameters();
        let body = Inertia::from_com(extra, point, Matrix3::zeros()).parameters();
        for (p, b) in parameters[10 * link..].iter_mut().zip(body) {
            *p += b;
        }
        let heavier = robot.with_parameters(&parameters).expect("the length is right");
        let added = torque(&heavier, &q, &zero, &zero) - torque(&robot, &q, &zero, &zero);
        let mut jacobian = vec![0.0; 6 * n];
        point_jacobian(&robot, &mut Workspace::new(&robot), &q, link, &point, &mut jacobian);
        let force = robot.gravity() * extra;
        let expected = DVector::from_fn(n, |j, _| {
            -(0..3).map(|k| jacobian[k * n + j] * force[k]).sum::<f64>()
        });
        close(&added, &expected, 1e-11)?;
    }
}
