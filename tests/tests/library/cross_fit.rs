//! The physics out of fold is the physics of a fit that never saw the fold.

use datasets::Recording;
use model::cross_fit::physics_out_of_fold;
use model::identify::identification::IdentifyOptions;
use model::physics_fit::{FitOptions, fit_physics};
use ndarray::Array2;
use physics::robot::Robot;
use tests::synthetic::{Plan, record};

fn rms(table: &Array2<f64>) -> f64 {
    table.mapv(|v| v * v).mean().unwrap_or(f64::NAN).sqrt()
}

#[test]
fn a_fold_left_out_is_predicted_as_by_a_fit_without_it() {
    let robot = Robot::builtin("ur5").expect("built in");
    let whole = record(
        &robot,
        &Plan {
            trajectories: 4,
            seconds: 8.0,
            ..Plan::default()
        },
    );
    // One recording a trajectory, so that one can be left away.
    let data: Vec<Recording> = (0..4)
        .map(|k| {
            let rows: Vec<usize> = whole.trajectories[k].range.clone().collect();
            let select = |table: &Array2<f64>| table.select(ndarray::Axis(0), &rows);
            let mut own = Recording::new(
                "part",
                rows.iter().map(|&r| whole.time[r]).collect(),
                select(&whole.q),
                whole.tau.as_ref().map(select),
            );
            own.qd = whole.qd.as_ref().map(select);
            own
        })
        .collect();
    let mut options = FitOptions {
        identify: IdentifyOptions {
            select: false,
            ..IdentifyOptions::default()
        },
        ..FitOptions::default()
    };
    options.prepare.cutoff_hz = Some(8.0);
    let fit = fit_physics(&robot, &data, None, &options).expect("a fit");
    let apart = physics_out_of_fold(&fit, &data).expect("a model");
    let mut told = 0;
    for left in 0..4 {
        let rest: Vec<Recording> = (0..4)
            .filter(|k| *k != left)
            .map(|k| data[k].clone())
            .collect();
        let other = fit_physics(&robot, &rest, Some(&data[left]), &options).expect("a fit");
        let wanted = &other.physics[3] - &fit.physics[left];
        let found = &apart[left] - &fit.physics[left];
        println!(
            "fold {left}: {:.5} N·m, off by {:.5}",
            rms(&wanted),
            rms(&(&wanted - &found))
        );
        // Joints' weights differ a little between the fits; what the fold changes is there.
        assert!(rms(&(&wanted - &found)) < 0.1 * rms(&wanted));
        told += usize::from(rms(&wanted) > 1e-3);
    }
    assert!(told > 0, "leaving a fold out changes nothing");
}
