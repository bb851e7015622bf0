//! `saturation` of the held-out recording alone.
//!
//! A limit that the fitted recordings never reach leaves nothing that a candidate could be fitted to; where the held-out
//! recording reaches it, its torque has a flat top. Like contact, it is then measured in the recording that is scored:
//! the limit is the plateau's, the torque what the limit takes off the prediction.

use crate::frame::Frame;
use datasets::check::plateau;
use ndarray::Array2;

/// Part of the joint's squared error that the cut has to remove.
const REMOVED: f64 = 0.5;

/// A joint whose torque is cut.
#[derive(Clone, Debug)]
pub struct Saturated {
    /// The joint.
    pub joint: usize,
    /// Largest torque recorded, N·m.
    pub limit: f64,
    /// Torque that the limit takes off, shape (samples, joints); zero on other joints.
    pub torque: Array2<f64>,
}

/// Joints of which a limit explains most of what is left. `residual` at the recorded samples, shape (samples, joints).
pub fn saturated(frame: &Frame, residual: &Array2<f64>) -> Vec<Saturated> {
    let of = |joint: usize| {
        let (limit, _) = plateau(&frame.tau.column(joint).to_vec())?;
        let left = residual.column(joint);
        let cut = (&frame.tau.column(joint) - &left).mapv(|t| t.clamp(-limit, limit) - t);
        let rest = &left - &cut;
        if rest.dot(&rest) > (1.0 - REMOVED) * left.dot(&left) {
            return None;
        }
        let mut torque = Array2::zeros(residual.dim());
        torque.column_mut(joint).assign(&cut);
        Some(Saturated {
            joint,
            limit,
            torque,
        })
    };
    (0..frame.dof()).filter_map(of).collect()
}
