//! Equality with MuJoCo.

use super::models::{State, departure, fixture, model};
use physics::dynamics::{
    Workspace, forward_dynamics, inverse_dynamics, mass_matrix, potential_energy, regressor,
};
use physics::robot::Robot;

/// What the robot as given predicts, from a rigid torque.
fn with_drives(robot: &Robot, state: &State, rigid: &[f64]) -> Vec<f64> {
    let mut tau = rigid.to_vec();
    for (j, joint) in robot.joints().iter().enumerate() {
        tau[j] += joint.rotor_inertia * state.qdd[j]
            + joint.damping * state.qd[j]
            + joint.friction * state.qd[j].signum();
    }
    for p in robot.passive() {
        tau[p.joint()] += p.torque(state.q[p.joint()]);
    }
    tau
}

#[test]
fn values_equal_mujoco() {
    let cases = fixture().cases;
    assert!(cases.len() >= 16);
    for case in &cases {
        let (_, robot) = model(&case.file, &case.chosen);
        assert_eq!(robot.joint_names(), case.joints, "{}", case.file);
        let n = robot.dof();
        let mut workspace = Workspace::new(&robot);
        let parameters = robot.parameters();
        for state in &case.states {
            let State { q, qd, qdd, .. } = state;
            let close = |what: &str, ours: &[f64], theirs: &[f64]| {
                let d = departure(ours, theirs);
                assert!(d < 1e-9, "{}: {what} departs by {d:.1e}", case.file);
            };
            let mut rigid = vec![0.0; n];
            inverse_dynamics(&robot, &mut workspace, q, qd, qdd, &mut rigid);
            close("torque", &with_drives(&robot, state, &rigid), &state.tau);

            let mut y = vec![0.0; n * 10 * n];
            regressor(&robot, &mut workspace, q, qd, qdd, &mut y);
            let product: Vec<f64> = y
                .chunks(10 * n)
                .map(|row| row.iter().zip(&parameters).map(|(y, p)| y * p).sum())
                .collect();
            close(
                "regressor",
                &with_drives(&robot, state, &product),
                &state.tau,
            );

            let mut mass = vec![0.0; n * n];
            mass_matrix(&robot, &mut workspace, q, &mut mass);
            for (j, inertia) in robot.rotor_inertia().iter().enumerate() {
                mass[j * n + j] += inertia;
            }
            close("mass matrix", &mass, &state.mass);

            let mut back = vec![0.0; n];
            forward_dynamics(&robot, &mut workspace, q, qd, &rigid, &[], &mut back);
            close("acceleration", &back, qdd);
        }
    }
}

/// The energy of the weight that nothing holds has the torque at rest as its slope.
#[test]
fn compensated_weight_is_no_energy() {
    let (_, robot) = model("springs.xml", &[]);
    let n = robot.dof();
    let (q, still) = ([0.4, -0.7, 0.9, 0.2], vec![0.0; n]);
    let mut tau = vec![0.0; n];
    let mut workspace = Workspace::new(&robot);
    inverse_dynamics(&robot, &mut workspace, &q, &still, &still, &mut tau);
    let step = 1e-5;
    for j in 0..n {
        let energy = |d: f64| {
            let mut at = q;
            at[j] += d;
            potential_energy(&robot, &at)
        };
        let slope = (energy(step) - energy(-step)) / (2.0 * step);
        assert!((slope - tau[j]).abs() < 1e-6, "{j}: {slope} {}", tau[j]);
    }
}
