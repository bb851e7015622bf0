//! Share of the removable error that a compensator removes.

use datasets::metrics::Scores;
use serde::Serialize;

/// Share of (physics² − floor²) in squared NRMSE that the whole model removes. None where the physics' error is
/// not above the floor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Share of the removable error of each joint.
    pub joints: Vec<Option<f64>>,
    /// Share of the error summed over the joints.
    pub all: Option<f64>,
}

impl Share {
    /// Share from the scores of the physics, of the whole model, and of the noise floor.
    pub fn of(physics: &Scores, whole: &Scores, floor: &Scores) -> Self {
        let joint = |j: usize| {
            let [p, w, f] = [physics, whole, floor].map(|s| s.nrmse[j].map(|e| e * e));
            Some([p? - w?, p? - f?])
        };
        let squares: Vec<Option<[f64; 2]>> = (0..physics.nrmse.len()).map(joint).collect();
        let part = |[removed, removable]: [f64; 2]| (removable > 0.0).then(|| removed / removable);
        let add = |[a, b]: [f64; 2], [c, d]: &[f64; 2]| [a + c, b + d];
        Self {
            joints: squares.iter().map(|s| s.and_then(part)).collect(),
            all: part(squares.iter().flatten().fold([0.0; 2], add)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_count() {
        let scores = |nrmse: [f64; 2]| Scores::relative(nrmse.map(Some).to_vec(), &[Some(1.0); 2]);
        let found = Share::of(
            &scores([5.0, 1.0]),
            &scores([4.0, 1.0]),
            &scores([3.0, 1.0]),
        );
        assert_eq!(found.joints, [Some(9.0 / 16.0), None]);
        assert_eq!(found.all, Some(9.0 / 16.0));
    }
}
