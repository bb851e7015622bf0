//! The catalogue: one file per effect, each proposing candidates with their columns, shape grid,
//! sign constraints and units.

mod asymmetric_friction;
pub mod backlash;
mod base_tilt;
mod candidate;
pub(crate) mod confounders;
mod counterbalance;
mod encoder_offset;
mod friction_drift;
mod joint_coupling;
mod joint_elasticity;
mod load_dependent_friction;
mod nonlinear_viscous_friction;
mod parameters;
pub mod position_dependent_friction;
mod presliding_hysteresis;
pub mod saturation;
mod stribeck_friction;
mod time_delay;
mod torque_channel;
pub mod torque_ripple;
mod transmission;

use crate::motion::scene::Scene;

pub use candidate::{Bound, Candidate, Column, ColumnTorque};
pub use parameters::base_columns;

/// Everything that needs no look at the residual.
pub fn catalogue(scene: &Scene) -> Vec<Candidate> {
    let mut all = Vec::new();
    all.extend(parameters::candidates(scene));
    all.extend(base_tilt::candidates(scene));
    all.extend(time_delay::candidates(scene));
    for joint in 0..scene.dof() {
        all.extend(torque_channel::candidates(scene, joint));
        all.extend(encoder_offset::candidates(scene, joint));
        all.extend(counterbalance::candidates(scene, joint));
        all.extend(asymmetric_friction::candidates(scene, joint));
        all.extend(stribeck_friction::candidates(scene, joint));
        all.extend(nonlinear_viscous_friction::candidates(scene, joint));
        all.extend(load_dependent_friction::candidates(joint));
        all.extend(presliding_hysteresis::candidates(scene, joint));
        all.extend(friction_drift::candidates(joint));
        all.extend(joint_coupling::candidates(scene, joint));
        all.extend(joint_elasticity::candidates(scene, joint));
        all.extend(backlash::candidates(scene, joint));
    }
    all
}
