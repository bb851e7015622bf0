//! Robots with possible bodies that have the fitted torques.

use identify::base::BaseParameters;
use identify::feasible::{Constraints, Feasibility, Nominal};
use physics::robot::{Robot, RobotError, to_urdf};

/// `fitted` itself where its links are possible bodies. Else the possible robot nearest to `nominal` with the
/// same base parameters, hence the same torques.
///
/// # Errors
/// Neither makes a robot.
pub(crate) fn robot(nominal: &Robot, fitted: &Robot) -> Result<Robot, RobotError> {
    let readable = |r: &Robot| Robot::from_urdf_str(&to_urdf(r));
    let links_possible = fitted
        .joints()
        .iter()
        .all(|j| j.link.inertia.is_consistent(1e-6));
    if links_possible && readable(fitted).is_ok() {
        return Ok(fitted.clone());
    }
    let base = BaseParameters::of_robot(nominal, &[]);
    let near = Feasibility::new(
        base.grouping(),
        Constraints::new(nominal.dof(), []),
        Nominal::of_robot(nominal, &[]),
    )
    .and_then(|f| f.standard_from(&base.base_from(&fitted.parameters())));
    match near {
        Ok(near) => {
            let robot = fitted.with_parameters(&near.standard)?;
            readable(&robot).map(|_| robot)
        }
        // The fit itself says what is impossible about it.
        Err(_) => readable(fitted).map(|_| fitted.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::robot;
    use physics::dynamics::{Workspace, inverse_dynamics};
    use physics::robot::Robot;

    /// A mass below zero is moved between links; the torques stay.
    #[test]
    fn an_impossible_estimate_keeps_its_torques() {
        let nominal = Robot::builtin("ur5").unwrap();
        let mut parameters = nominal.parameters();
        // Gravity of a point mass on the first axis loads no joint: it can go below zero unseen.
        parameters[0] = -1.0;
        let fitted = nominal.with_parameters(&parameters).unwrap();
        let found = robot(&nominal, &fitted).unwrap();
        assert!(found.parameters()[0] > 0.0);
        let state = ([0.3, -1.0, 0.8, 0.2, -0.5, 0.4], [0.5; 6], [1.0; 6]);
        let torque = |r: &Robot| {
            let mut tau = [0.0; 6];
            inverse_dynamics(
                r,
                &mut Workspace::new(r),
                &state.0,
                &state.1,
                &state.2,
                &mut tau,
            );
            tau
        };
        for (a, b) in torque(&fitted).iter().zip(torque(&found)) {
            assert!((a - b).abs() < 1e-3 * (1.0 + a.abs()), "{a} {b}");
        }
    }
}
