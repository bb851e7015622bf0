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
        /// Repeatability of the robot; none where no motion was executed more than once on one side.
        usual: Option<Baseline>,
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
            Self::Repeated { executions, usual } => {
                let both = (1.0 + 1.0 / executions.max(1.0)).sqrt();
                let least = |j: usize| usual.as_ref().map(|u| u.left[j]);
                let each = floors.into_iter().enumerate();
                each.map(|(j, f)| {
                    f.into_iter()
                        .chain(least(j))
                        .reduce(f64::max)
                        .map(|f| both * f)
                })
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

    /// Whether the errors (RMS by joint) of the model as given are at the floors, which hold the difference
    /// between executions of one motion. Then nothing has changed, whatever part of them a cause would explain.
    pub(super) fn is_usual(
        &self,
        errors: &[Option<f64>],
        floors: &[Option<f64>],
        at_floor: f64,
    ) -> bool {
        let mut known = errors.iter().zip(floors);
        matches!(self, Self::Repeated { usual: Some(_), .. })
            && known.all(|(e, floor)| {
                let floor = floor.unwrap_or(0.0);
                e.is_none_or(|e| e <= at_floor * floor)
            })
    }

    /// Structure of each joint that exceeds `margin` times what the baseline shows where nothing has changed. With an
    /// unknown baseline of repeated motions all structure is kept; with one of other motions, no structure.
    pub(super) fn beyond(&self, left: Vec<Option<Misfit>>, margin: f64) -> Vec<Option<Misfit>> {
        let beyond = |(j, l): (usize, Option<Misfit>)| match self {
            Self::Repeated { usual: None, .. } => l,
            Self::Repeated {
                usual: Some(usual), ..
            }
            | Self::Other(Some(usual)) => {
                l.filter(|l| l.structured() > margin * usual.structured[j])
            }
            Self::Other(None) => None,
        };
        left.into_iter().enumerate().map(beyond).collect()
    }
}
