//! Equality with Pinocchio on the values of `fixtures/rigid_body.py`.

use nalgebra::Vector3;
use physics::dynamics::*;
use physics::robot::Robot;
use serde::Deserialize;

#[derive(Deserialize)]
struct Fixture {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    name: String,
    urdf: String,
    gravity: [f64; 3],
    parameters: Vec<f64>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    tau: Vec<f64>,
    mass: Vec<f64>,
    regressor: Vec<f64>,
    effort: Vec<f64>,
    acceleration: Vec<f64>,
    kinetic: f64,
    potential: f64,
    last_origin: Vec<f64>,
    last_rotation: Vec<f64>,
}

/// Both in double precision, so only rounding is left: 1e-10 of the largest value.
fn equal(what: &str, ours: &[f64], theirs: &[f64]) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let scale = theirs.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    for (a, b) in ours.iter().zip(theirs) {
        assert!((a - b).abs() < 1e-10 * scale, "{what}: {a} {b}");
    }
}

#[test]
fn values_equal_pinocchio() {
    let fixture: Fixture = serde_json::from_str(include_str!("../fixtures/rigid_body.json"))
        .expect("the fixture is valid");
    assert_eq!(fixture.cases.len(), 3);
    for case in &fixture.cases {
        let robot = Robot::from_urdf_str(&case.urdf)
            .expect("a valid robot")
            .with_gravity(case.gravity.into());
        let n = robot.dof();
        let name = |what: &str| format!("{}: {what}", case.name);
        equal(&name("parameters"), &robot.parameters(), &case.parameters);
        let mut workspace = Workspace::new(&robot);
        for state in &case.states {
            let State { q, qd, qdd, .. } = state;
            let mut values = vec![0.0; n];
            inverse_dynamics(&robot, &mut workspace, q, qd, qdd, &mut values);
            equal(&name("inverse dynamics"), &values, &state.tau);

            let still = robot.clone().with_gravity(Vector3::zeros());
            let mut other = vec![0.0; n];
            let gravity = robot.gravity();
            inverse_dynamics_with_gravity(&still, &mut workspace, &gravity, q, qd, qdd, &mut other);
            assert_eq!(values, other);

            forward_dynamics(
                &robot,
                &mut workspace,
                q,
                qd,
                &state.effort,
                &[],
                &mut values,
            );
            equal(&name("forward dynamics"), &values, &state.acceleration);

            let mut mass = vec![0.0; n * n];
            mass_matrix(&robot, &mut workspace, q, &mut mass);
            equal(&name("mass matrix"), &mass, &state.mass);

            let mut y = vec![0.0; n * 10 * n];
            regressor(&robot, &mut workspace, q, qd, qdd, &mut y);
            equal(&name("regressor"), &y, &state.regressor);

            let energies = [kinetic_energy(&robot, q, qd), potential_energy(&robot, q)];
            equal(
                &name("energies"),
                &energies,
                &[state.kinetic, state.potential],
            );

            let last = link_placements(&robot, q).last().expect("a joint");
            equal(
                &name("origin"),
                last.translation.as_slice(),
                &state.last_origin,
            );
            let rotation = last.rotation.transpose();
            equal(&name("rotation"), rotation.as_slice(), &state.last_rotation);
        }
    }
}
