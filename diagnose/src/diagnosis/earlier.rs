//! Baseline of a robot's earlier recordings for a later one, beside the model that was identified from them.

use crate::traces::unknown::Misfit;

/// Gain and residual where nothing has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Baseline {
    /// Largest gain of a cause, nats per row.
    pub(crate) earned: f64,
    /// Root mean square residual in motion, by joint, N·m (N).
    pub(crate) left: Vec<f64>,
    /// Structured part of that residual, by joint, over the deviation of the joint's torque.
    pub(crate) structured: Vec<f64>,
}

impl Baseline {
    /// Baseline with the larger value of each figure of two.
    pub(super) fn most(self, other: Self) -> Self {
        let larger =
            |a: Vec<f64>, b: Vec<f64>| a.into_iter().zip(b).map(|(a, b)| a.max(b)).collect();
        Self {
            earned: self.earned.max(other.earned),
            left: larger(self.left, other.left),
            structured: larger(self.structured, other.structured),
        }
    }
}

/// Relation of the earlier recordings to a later one.
#[derive(Clone, Debug, PartialEq)]
pub enum Earlier {
    /// The motion is repeated: torque that the model lacks cancels.
    Repeated {
        /// Mean number of earlier executions, whose noise is added.
        executions: f64,
        /// Repeatability of the robot: the spread of executions on one side. Of single executions, their deviation from
        /// the model that was identified from them.
        usual: Baseline,
        /// Whether no motion was executed more than once on one side.
        single: bool,
    },
    /// The motion is new: the model's misfit on unknown motions is the least change that shows. None where the
    /// earlier recordings are one trajectory.
    Other(Option<Baseline>),
}

impl Earlier {
    /// Baseline where nothing has changed, where it was determined.
    pub(crate) fn usual(&self) -> Option<&Baseline> {
        match self {
            Self::Other(usual) => usual.as_ref(),
            Self::Repeated { .. } => None,
        }
    }

    /// Gain by chance on so many rows, nats.
    pub(super) fn chance(&self, rows: usize) -> f64 {
        self.usual().map_or(0.0, |u| u.earned * rows as f64)
    }

    /// Noise floor by joint, N·m (N).
    pub(super) fn floors(&self, floors: Vec<Option<f64>>) -> Vec<Option<f64>> {
        match self {
            Self::Repeated {
                executions, usual, ..
            } => {
                let both = with_earlier(*executions);
                let each = floors.into_iter().zip(&usual.left);
                each.map(|(f, l)| Some(both * f.map_or(*l, |f| f.max(*l))))
                    .collect()
            }
            Self::Other(Some(usual)) => {
                let both = floors.into_iter().zip(&usual.left);
                both.map(|(f, l)| Some(f.map_or(*l, |f| f.max(*l))))
                    .collect()
            }
            Self::Other(None) => floors,
        }
    }

    /// Whether the errors (RMS by joint) of the model as given are those between executions of one motion. With a
    /// known spread every joint's error is compared with its floor, and nothing has changed, whatever part of it a
    /// cause would explain. Of single executions the model's own residual is known by few independent samples a
    /// joint: the joints' errors over it are judged together.
    pub(super) fn is_usual(
        &self,
        errors: &[Option<f64>],
        floors: &[Option<f64>],
        at_floor: f64,
    ) -> bool {
        match self {
            Self::Repeated { single: false, .. } => errors
                .iter()
                .zip(floors)
                .all(|(e, floor)| e.is_none_or(|e| e <= at_floor * floor.unwrap_or(0.0))),
            Self::Repeated {
                executions, usual, ..
            } => {
                let each = errors.iter().zip(&usual.left);
                let squares: Vec<f64> = each
                    .filter_map(|(e, left)| Some((e.as_ref()? / left).powi(2)))
                    .collect();
                let mean = squares.iter().sum::<f64>() / squares.len() as f64;
                mean.sqrt() <= at_floor * with_earlier(*executions)
            }
            Self::Other(_) => false,
        }
    }

    /// Whether one motion is compared that was executed once on each side.
    pub(super) fn is_single(&self) -> bool {
        matches!(self, Self::Repeated { single: true, .. })
    }

    /// Structure of each joint that exceeds `margin` times what the baseline shows where nothing has changed. With an
    /// unknown baseline of other motions, no structure.
    pub(super) fn beyond(&self, left: Vec<Option<Misfit>>, margin: f64) -> Vec<Option<Misfit>> {
        let beyond = |(j, l): (usize, Option<Misfit>)| match self {
            Self::Repeated { usual, .. } | Self::Other(Some(usual)) => {
                l.filter(|l| l.structured() > margin * usual.structured[j])
            }
            Self::Other(None) => None,
        };
        left.into_iter().enumerate().map(beyond).collect()
    }
}

/// Error of a difference to the mean of so many earlier executions, over that of one execution.
fn with_earlier(executions: f64) -> f64 {
    (1.0 + 1.0 / executions.max(1.0)).sqrt()
}

/// What of each joint's structure follows the motion beyond `chance`, the learnable part by chance. What lasts beside
/// the motion is how executions differ.
pub(super) fn following(left: Vec<Option<Misfit>>, chance: &[Option<f64>]) -> Vec<Option<Misfit>> {
    let follows = |l: Misfit, chance: Option<f64>| Misfit {
        lasting: 0.0,
        learnable: match chance {
            Some(chance) if l.learnable <= chance => 0.0,
            _ => l.learnable,
        },
        ..l
    };
    let each = left.into_iter().zip(chance);
    each.map(|(l, chance)| Some(follows(l?, *chance))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn earlier(single: bool) -> Earlier {
        Earlier::Repeated {
            executions: 1.0,
            usual: Baseline {
                earned: 0.0,
                left: vec![1.0, 2.0],
                structured: vec![0.0; 2],
            },
            single,
        }
    }

    #[test]
    fn single_executions_are_judged_by_all_joints_together() {
        let usual = |single, errors: [f64; 2]| {
            let earlier = earlier(single);
            let floors = earlier.floors(vec![None, Some(0.5)]);
            earlier.is_usual(&errors.map(Some), &floors, 1.5)
        };
        // Twice √2 times the first joint's residual, half of that of the second.
        let uneven = [2.0, 2.0 * 0.5].map(|x| x * 2f64.sqrt());
        assert!(usual(true, uneven) && !usual(false, uneven));
        let even = [1.4, 2.0 * 1.4].map(|x| x * 2f64.sqrt());
        assert!(usual(true, even) && usual(false, even));
        let large = [0.1, 2.0 * 2.2].map(|x| x * 2f64.sqrt());
        assert!(!usual(true, large) && !usual(false, large));
        // Where no joint has an error nothing is known.
        assert!(!earlier(true).is_usual(&[None, None], &[None, None], 1.5));
    }

    #[test]
    fn what_follows_the_motion_beyond_chance_is_kept() {
        let misfit = |learnable| {
            Some(Misfit {
                error: 0.2,
                lasting: 0.9,
                learnable,
                rows: 1000,
            })
        };
        let left = following(
            vec![misfit(0.3), misfit(0.3), None],
            &[Some(0.2), Some(0.4), Some(0.2)],
        );
        let structured: Vec<Option<f64>> = left
            .iter()
            .map(|l| Some(l.as_ref()?.structured()))
            .collect();
        assert!((structured[0].unwrap() - 0.2 * 0.3f64.sqrt()).abs() < 1e-12);
        assert_eq!(structured[1..], [Some(0.0), None]);
    }
}
