//! Ridge regression on the windows of a unit.

use crate::hysteresis::{WINDOW, hysteresis, short};
use compensator::training::{choose_ridge, fit_ridge, train_ridge};

#[test]
fn a_ridge_chosen_on_the_judging_trajectories_is_that_of_the_unit() {
    let data = hysteresis();
    let job = data.job(short(WINDOW));
    let chosen = choose_ridge(&job).unwrap();
    assert_eq!(fit_ridge(&job, chosen).unwrap(), train_ridge(&job).unwrap());
}
