//! Rigid-body dynamics of a serial chain: free functions over an immutable [`Robot`](crate::robot::Robot) and a
//! [`Workspace`] that is reused. After the workspace is made nothing allocates.
//!
//! Vectors of joint quantities have N values, base first. Only rigid bodies under gravity (less the part of it that
//! [`crate::robot::Robot::gravity_compensation`] takes off): friction, rotor inertia, springs, counterbalance and everything
//! else are effects added elsewhere (rotor inertia enters [`forward_dynamics`] as `armature`).

mod articulated;
mod derivatives;
mod forward;
mod inverse;
mod kinematics;
mod mass;
mod regressor;
mod workspace;

pub use derivatives::{Derivatives, inverse_dynamics_derivatives};
pub use forward::forward_dynamics;
pub use inverse::{inverse_dynamics, inverse_dynamics_with_gravity};
pub use kinematics::{
    Placement, kinetic_energy, link_placements, point_jacobian, potential_energy,
};
pub use mass::mass_matrix;
pub use regressor::{regressor, regressor_with_gravity};
pub use workspace::Workspace;
