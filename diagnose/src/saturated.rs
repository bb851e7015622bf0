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

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::Recording;

    #[test]
    fn a_cut_torque_is_told_from_a_wrong_one() {
        let time: Vec<f64> = (0..4000).map(|i| 0.005 * f64::from(i)).collect();
        let table =
            |f: &dyn Fn(f64) -> f64| Array2::from_shape_fn((time.len(), 1), |(i, _)| f(time[i]));
        let predicted = table(&|t| 10.0 * (1.3 * t).sin() + 3.0 * (3.1 * t).cos());
        let found = |tau: &Array2<f64>| {
            let q = table(&|t| (1.3 * t).sin());
            let recording = Recording::new("r", time.clone(), q, Some(tau.clone()));
            let frame = Frame::new(&recording, tau.clone(), Some(20.0)).unwrap();
            saturated(&frame, &(tau - &predicted))
        };
        let cut = found(&predicted.mapv(|t| t.clamp(-8.0, 8.0)));
        assert_eq!(cut.len(), 1);
        assert!((cut[0].limit - 8.0).abs() < 1e-9, "{}", cut[0].limit);
        assert!(found(&(0.8 * &predicted)).is_empty());
    }
}
