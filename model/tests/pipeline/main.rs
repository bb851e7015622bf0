//! The steps from recordings to a model, each on its own.

mod baselines_kr300;
mod baselines_numpy;
mod channel;
mod check;
mod estimators;
#[path = "../../../tests/src/shared.rs"]
mod shared;
mod torque_band;
