//! The robot as the algorithms want it: flat joint data, computed once.

use super::{Joint, JointKind};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Precomputed joint data, base first.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    pub joints: Vec<ChainJoint>,
    /// Whether some link's weight is held from outside.
    pub held: bool,
}

/// Constants of one joint in two frames: an inner frame turned so that the axis is z (the recursions get
/// cheaper), and the frame of the description (in which parameters are expressed).
#[derive(Debug, Clone)]
pub(crate) struct ChainJoint {
    pub prismatic: bool,
    /// Orientation at q = 0 of this inner frame in the parent's inner frame.
    pub rotation: Matrix3<f64>,
    /// Origin at q = 0 in the parent's inner frame.
    pub translation: Vector3<f64>,
    pub mass: f64,
    /// Part of the link's weight that is held from outside, 0 to 1.
    pub held: f64,
    /// First moment in the inner frame.
    pub first_moment: Vector3<f64>,
    /// Inertia about the joint's origin in the inner frame.
    pub inertia: Matrix3<f64>,
    /// Axis in the described frame.
    pub axis: Vector3<f64>,
    /// Orientation at q of the described frame in the parent's described frame is
    /// `constant` + cos q·`cosine` + sin q·`sine` (Rodrigues' formula, the placement multiplied in).
    pub constant: Matrix3<f64>,
    pub cosine: Matrix3<f64>,
    pub sine: Matrix3<f64>,
    /// Origin at q = 0 in the parent's described frame.
    pub described_translation: Vector3<f64>,
    /// Axis in the parent's described frame.
    pub described_axis: Vector3<f64>,
}

impl Chain {
    /// `held` is the part of each link's weight that is held from outside, or empty for none.
    pub fn new(joints: &[Joint], held: &[f64]) -> Self {
        // Orientation of the previous joint's inner frame in its described frame.
        let mut parent = Matrix3::identity();
        let joints = joints
            .iter()
            .enumerate()
            .map(|(i, joint)| {
                let inner = z_to(&joint.axis);
                let inertia = joint
                    .link
                    .inertia
                    .transformed(&inner.transpose(), &Vector3::zeros());
                let outer = joint.axis * joint.axis.transpose();
                let prismatic = joint.kind == JointKind::Prismatic;
                let (constant, cosine, sine) = if prismatic {
                    (joint.rotation, Matrix3::zeros(), Matrix3::zeros())
                } else {
                    (
                        joint.rotation * outer,
                        joint.rotation * (Matrix3::identity() - outer),
                        joint.rotation * joint.axis.cross_matrix(),
                    )
                };
                let chain_joint = ChainJoint {
                    prismatic,
                    rotation: parent.transpose() * joint.rotation * inner,
                    translation: parent.transpose() * joint.translation,
                    mass: inertia.mass,
                    held: held.get(i).copied().unwrap_or(0.0),
                    first_moment: inertia.first_moment,
                    inertia: inertia.about_origin,
                    axis: joint.axis,
                    constant,
                    cosine,
                    sine,
                    described_translation: joint.translation,
                    described_axis: joint.rotation * joint.axis,
                };
                parent = inner;
                chain_joint
            })
            .collect();
        Self {
            joints,
            held: !held.is_empty(),
        }
    }
}

/// A rotation that takes z to `axis`; exactly the identity for z.
fn z_to(axis: &Vector3<f64>) -> Matrix3<f64> {
    Rotation3::rotation_between(&Vector3::z(), axis)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
        .into_inner()
}
