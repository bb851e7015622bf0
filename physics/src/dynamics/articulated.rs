//! Articulated-body quantities of one link.

use nalgebra::{Matrix3, Vector3};

/// Articulated-body quantities of one link in its own frame. The inertia maps an acceleration (angular ẇ,
/// linear a at the origin) to a wrench: n = I ẇ + H a, f = Hᵀ ẇ + M a.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Articulated {
    pub(super) rotational: Matrix3<f64>,
    pub(super) coupling: Matrix3<f64>,
    pub(super) translational: Matrix3<f64>,
    /// Velocity-dependent acceleration (angular, linear).
    pub(super) bias_angular: Vector3<f64>,
    pub(super) bias_linear: Vector3<f64>,
    /// Bias wrench: moment and force.
    pub(super) moment: Vector3<f64>,
    pub(super) force: Vector3<f64>,
    /// U = inertia · axis, as a wrench.
    pub(super) u_moment: Vector3<f64>,
    pub(super) u_force: Vector3<f64>,
    /// 1/(axisᵀ U + armature), and the torque left after the bias.
    pub(super) inverse: f64,
    pub(super) rest: f64,
}
