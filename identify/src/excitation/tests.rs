use super::*;
use crate::base::{BaseParameters, Extra};
use physics::robot::Robot;

const LIMITS: MotionLimits = MotionLimits {
    lower: -2.0,
    upper: 1.0,
    velocity: 1.5,
    acceleration: 4.0,
};
const EXTRAS: [Extra; 2] = [Extra::Viscous, Extra::Coulomb];

fn state(trajectory: &Fourier, t: f64) -> [Vec<f64>; 3] {
    let n = trajectory.dof();
    let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    trajectory.at(t, &mut q, &mut qd, &mut qdd);
    [q, qd, qdd]
}

#[test]
fn optimised_trajectories_excite_more_and_keep_the_limits() {
    let robot = Robot::builtin("ur5").unwrap();
    let base = BaseParameters::of_robot(&robot, &EXTRAS);
    let limits = vec![LIMITS; 6];
    let options = SearchOptions {
        starts: 3,
        sweeps: 1,
        ..SearchOptions::default()
    };
    for criterion in [
        Criterion::Condition,
        Criterion::SubRegressors,
        Criterion::DOptimal,
    ] {
        let mut task = Excitation {
            rows: BaseRows::new(&robot, &base, &EXTRAS),
            criterion,
            noise: vec![3.0, 3.0, 2.0, 0.5, 0.5, 0.5],
            samples: 60,
            before: None,
        };
        let found = optimise(&limits, &options, |t| task.cost(t)).unwrap();
        assert!(found.cost < found.start_cost, "{criterion:?}");
        if criterion != Criterion::DOptimal {
            assert!(found.cost < 0.8 * found.start_cost, "{criterion:?}");
        }
        let again = optimise(&limits, &options, |t| task.cost(t)).unwrap();
        assert_eq!(again, found);
        let rest = state(&found.trajectory, 0.0);
        assert!(rest[1].iter().all(|v| v.abs() < 1e-12));
        for k in 0..2000 {
            let [q, qd, qdd] = state(&found.trajectory, 12.5 * k as f64 / 2000.0);
            for j in 0..6 {
                assert!(q[j] > LIMITS.lower - 1e-9 && q[j] < LIMITS.upper + 1e-9);
                assert!(qd[j].abs() < LIMITS.velocity + 1e-9);
                assert!(qdd[j].abs() < LIMITS.acceleration + 1e-9);
            }
        }
        // A second trajectory, chosen to complement the first, never knows less.
        let first = task.triangle(&found.trajectory).unwrap();
        task.before = Some(first.clone());
        let both = task.triangle(&found.trajectory).unwrap();
        assert_eq!(both.rows(), 2 * first.rows());
    }
}

#[test]
fn derivatives_are_those_of_the_position() {
    let trajectory = Fourier {
        period: 7.0,
        offset: vec![0.2],
        sine: ndarray::arr2(&[[0.3, -0.1]]),
        cosine: ndarray::arr2(&[[0.05, 0.2]]),
    };
    let (t, h) = (1.3, 1e-5);
    let [before, at, after] = [t - h, t, t + h].map(|t| state(&trajectory, t));
    for order in 0..2 {
        let slope = (after[order][0] - before[order][0]) / (2.0 * h);
        assert!((slope - at[order + 1][0]).abs() < 1e-9);
    }
}

#[test]
fn bad_input_is_refused() {
    let flat = MotionLimits {
        lower: 1.0,
        upper: 1.0,
        ..LIMITS
    };
    let options = SearchOptions::default();
    assert_eq!(
        optimise(&[LIMITS, flat], &options, |_| Ok(0.0)).unwrap_err(),
        ExcitationError::NoRoom { joint: 1 }
    );
    assert!(optimise(&[], &options, |_| Ok(0.0)).is_err());
    let still = SearchOptions {
        period: 0.0,
        ..options
    };
    assert!(optimise(&[LIMITS], &still, |_| Ok(0.0)).is_err());
}
