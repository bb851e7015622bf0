//! Base parameters of the built-in robots against the papers.

use identify::base::{BaseParameters, Extra};
use physics::dynamics::{Workspace, regressor};
use physics::robot::Robot;

fn robot(name: &str) -> Robot {
    Robot::builtin(name).expect("the robot is built in")
}

#[test]
fn ur5_has_36_rigid_and_12_friction_parameters() {
    let robot = robot("ur5");
    assert_eq!(BaseParameters::of_robot(&robot, &[]).len(), 36);
    let friction = [Extra::Viscous, Extra::Coulomb];
    assert_eq!(BaseParameters::of_robot(&robot, &friction).len(), 48);
}

#[test]
fn kr300_has_36_rigid_parameters() {
    let base = BaseParameters::of_robot(&robot("kr300"), &[]);
    assert_eq!(base.len(), 36);
    // A vertical first axis: of link 1 only the inertia about it acts. mz2 lies along a horizontal axis that
    // keeps its distance from the first.
    let silent: Vec<&str> = base
        .unidentifiable()
        .iter()
        .map(|&i| base.names()[i].as_str())
        .collect();
    let expected = [
        "m1", "mx1", "my1", "mz1", "Ixx1", "Ixy1", "Iyy1", "Ixz1", "Iyz1", "mz2",
    ];
    assert_eq!(silent, expected);
}

/// Han et al. (2020), appendix: 58 parameters, of which these formulae are printed.
#[test]
fn foxbot_has_the_58_parameters_of_the_paper() {
    let extras = [
        Extra::RotorInertia,
        Extra::Viscous,
        Extra::Coulomb,
        Extra::Offset,
    ];
    let base = BaseParameters::of_robot(&robot("foxbot_a05"), &extras);
    assert_eq!(base.len(), 58);
    let (a2, a3, a4, d4) = (0.075, 0.27, 0.11, 0.306);
    let coefficient = |of: &str, parameter: &str| {
        let row = base.base_names().iter().position(|n| n == of).expect(of);
        let column = base
            .names()
            .iter()
            .position(|n| n == parameter)
            .expect(parameter);
        base.grouping()[(row, column)]
    };
    let check = |of: &str, terms: &[(&str, f64)]| {
        for &(parameter, expected) in terms {
            let found = coefficient(of, parameter);
            assert!(
                (found - expected).abs() < 1e-9,
                "{of}, {parameter}: {found}"
            );
        }
        let row = base.base_names().iter().position(|n| n == of).expect(of);
        let count = base
            .grouping()
            .row(row)
            .iter()
            .filter(|g| **g != 0.0)
            .count();
        assert_eq!(count, terms.len(), "{}", base.formulae()[row]);
    };
    // (36): π₂ = XX₂ − YY₂ − a₃² Σ_{j≥3} M_j.
    check(
        "Ixx2",
        &[
            ("Ixx2", 1.0),
            ("Iyy2", -1.0),
            ("m3", -a3 * a3),
            ("m4", -a3 * a3),
            ("m5", -a3 * a3),
            ("m6", -a3 * a3),
        ],
    );
    // (37): π₆ = ZZ₂ + Ia₂ + a₃² Σ_{j≥3} M_j.
    check(
        "Izz2",
        &[
            ("Izz2", 1.0),
            ("Ia2", 1.0),
            ("m3", a3 * a3),
            ("m4", a3 * a3),
            ("m5", a3 * a3),
            ("m6", a3 * a3),
        ],
    );
    // (38): π₇ = XX₃ − YY₃ + YY₄ + 2 d₄ MZ₄ + (d₄² − a₄²) Σ_{j≥4} M_j.
    let m = d4 * d4 - a4 * a4;
    check(
        "Ixx3",
        &[
            ("Ixx3", 1.0),
            ("Iyy3", -1.0),
            ("Iyy4", 1.0),
            ("mz4", 2.0 * d4),
            ("m4", m),
            ("m5", m),
            ("m6", m),
        ],
    );
    // (39): π₈ = XY₃ − a₄ MZ₄ − a₄ d₄ Σ_{j≥4} M_j.
    check(
        "Ixy3",
        &[
            ("Ixy3", 1.0),
            ("mz4", -a4),
            ("m4", -a4 * d4),
            ("m5", -a4 * d4),
            ("m6", -a4 * d4),
        ],
    );
    // (50): MY₃ + MZ₄ + d₄ Σ_{j≥4} M_j; (51): MY₄ − MZ₅ and MY₅ + MZ₆.
    check(
        "my3",
        &[
            ("my3", 1.0),
            ("mz4", 1.0),
            ("m4", d4),
            ("m5", d4),
            ("m6", d4),
        ],
    );
    check("my4", &[("my4", 1.0), ("mz5", -1.0)]);
    check("my5", &[("my5", 1.0), ("mz6", 1.0)]);
    // (35): the first joint.
    for (parameter, expected) in [
        ("Izz1", 1.0),
        ("Ia1", 1.0),
        ("Iyy2", 1.0),
        ("Iyy3", 1.0),
        ("m2", a2 * a2),
        ("m3", a2 * a2 + a3 * a3),
        ("m6", a2 * a2 + a3 * a3 + a4 * a4),
    ] {
        assert!(
            (coefficient("Izz1", parameter) - expected).abs() < 1e-9,
            "{parameter}"
        );
    }
}

#[test]
fn grouped_columns_predict_the_same_torque() {
    for name in physics::robot::Builtin::ALL.map(physics::robot::Builtin::name) {
        let robot = robot(name);
        let base = BaseParameters::of_robot(&robot, &[]);
        let beta = base.base_from(&robot.parameters());
        let simplest = base.standard_from(&beta);
        let n = robot.dof();
        let mut y = vec![0.0; 10 * n * n];
        let (q, qd, qdd) = (
            [0.3, -0.8, 1.1, 0.4, -1.3, 2.0],
            [1.0, -0.7, 0.5, 2.0, -1.5, 0.2],
            [3.0; 6],
        );
        regressor(&robot, &mut Workspace::new(&robot), &q, &qd, &qdd, &mut y);
        for row in y.chunks_exact(10 * n) {
            let dot = |p: &[f64]| row.iter().zip(p).map(|(y, p)| y * p).sum::<f64>();
            let full = dot(&robot.parameters());
            assert!(
                (dot(&simplest) - full).abs() < 1e-9 * full.abs().max(1.0),
                "{name}"
            );
        }
    }
}
