//! Memory that the algorithms reuse.

use super::articulated::Articulated;
use crate::robot::{ChainJoint, Robot};
use nalgebra::{Matrix3, Vector3};

/// Buffers for one robot's size; make one per thread and use it for every call. After construction no
/// algorithm allocates.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(super) links: Vec<LinkState>,
    pub(super) articulated: Vec<Articulated>,
    pub(super) screws: Vec<Screw>,
}

/// State of one link during a recursion, in the link's own frame unless a field names another.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinkState {
    /// Orientation of the link in its parent's frame.
    pub rotation: Matrix3<f64>,
    /// Origin of the link in its parent's frame, m.
    pub translation: Vector3<f64>,
    /// Force (all that the joint transmits), then moment about the origin.
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

/// Velocity field of a unit motion of a joint: angular part, and linear part at a frame's origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screw {
    pub angular: Vector3<f64>,
    pub linear: Vector3<f64>,
}

impl Workspace {
    /// Buffers for `robot` and every robot with as many joints.
    pub fn new(robot: &Robot) -> Self {
        let n = robot.dof();
        let zero = Vector3::zeros();
        Self {
            links: vec![
                LinkState {
                    rotation: Matrix3::identity(),
                    translation: zero,
                    force: zero,
                    moment: zero,
                };
                n
            ],
            articulated: vec![Articulated::default(); n],
            screws: vec![
                Screw {
                    angular: zero,
                    linear: zero
                };
                n
            ],
        }
    }

    /// Checks the lengths that every algorithm relies on.
    pub(super) fn check(&self, robot: &Robot, inputs: &[&[f64]]) {
        assert_eq!(
            self.links.len(),
            robot.dof(),
            "the workspace belongs to a robot with another number of joints"
        );
        for input in inputs {
            assert_eq!(input.len(), robot.dof(), "one value per joint is needed");
        }
    }
}

impl ChainJoint {
    /// Pose of the inner frame in the parent's inner frame at joint position `q`.
    #[inline(always)]
    pub(super) fn place(&self, q: f64) -> (Matrix3<f64>, Vector3<f64>) {
        if self.prismatic {
            let z: Vector3<f64> = self.rotation.column(2).into_owned();
            return (self.rotation, self.translation + z * q);
        }
        let (s, c) = q.sin_cos();
        let r = &self.rotation;
        let rotation = Matrix3::new(
            c * r.m11 + s * r.m12,
            c * r.m12 - s * r.m11,
            r.m13,
            c * r.m21 + s * r.m22,
            c * r.m22 - s * r.m21,
            r.m23,
            c * r.m31 + s * r.m32,
            c * r.m32 - s * r.m31,
            r.m33,
        );
        (rotation, self.translation)
    }

    /// Pose of the described frame in the parent's described frame at joint position `q`.
    #[inline(always)]
    pub(super) fn place_described(&self, q: f64) -> (Matrix3<f64>, Vector3<f64>) {
        if self.prismatic {
            return (
                self.constant,
                self.described_translation + self.described_axis * q,
            );
        }
        let (s, c) = q.sin_cos();
        (
            self.constant + self.cosine * c + self.sine * s,
            self.described_translation,
        )
    }
}

/// Rᵀ v without forming the transpose.
#[inline(always)]
pub(super) fn back(r: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        r.m11 * v.x + r.m21 * v.y + r.m31 * v.z,
        r.m12 * v.x + r.m22 * v.y + r.m32 * v.z,
        r.m13 * v.x + r.m23 * v.y + r.m33 * v.z,
    )
}
