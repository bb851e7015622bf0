//! Poses of bodies and frames.

use nalgebra::{Matrix3, Vector3};

/// A pose: orientation and origin.
pub(super) type Pose = (Matrix3<f64>, Vector3<f64>);

/// `a`, then `b` in its frame.
pub(super) fn compose(a: &Pose, b: &Pose) -> Pose {
    (a.0 * b.0, a.0 * b.1 + a.1)
}

/// The pose of the frame around a pose, seen from it.
pub(super) fn inverse(pose: &Pose) -> Pose {
    let rotation = pose.0.transpose();
    (rotation, -(rotation * pose.1))
}
