//! What a robot's earlier recordings say of a later one, beside the model that was identified from them.

use crate::traces::unknown::Misfit;

/// What is found and left where nothing has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Baseline {
    /// Most that a cause earned, nats by row.
    pub(crate) earned: f64,
    /// Root mean square of what was left in motion, N·m (N), by joint.
    pub(crate) left: Vec<f64>,
    /// The part of it with structure, over the joint's torque.
    pub(crate) structured: Vec<f64>,
}

impl Baseline {
    /// The larger of each.
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

/// What the earlier recordings say of a later one.
#[derive(Clone, Debug, PartialEq)]
pub enum Earlier {
    /// The motion is the same: what the model lacks cancels.
    Repeated {
        /// Earlier executions on average, whose noise is added.
        executions: f64,
        /// How well the robot repeats itself; none where no motion was executed more than once on one side.
        usual: Option<Baseline>,
    },
    /// It is another: the model's misfit on motions that it does not know is the least that can be told; none where the
    /// earlier recordings are one trajectory.
    Other(Option<Baseline>),
}

impl Earlier {
    /// What the earlier recordings show where nothing has changed, where that was looked for.
    pub(crate) fn usual(&self) -> Option<&Baseline> {
        match self {
            Self::Other(usual) => usual.as_ref(),
            Self::Repeated { .. } => None,
        }
    }

    /// What chance earns on so many rows, nats.
    pub(super) fn chance(&self, rows: usize) -> f64 {
        self.usual().map_or(0.0, |u| u.earned * rows as f64)
    }

    /// The least that can be left, joint by joint.
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

    /// Whether the errors (RMS by joint) of the model as given are at the floors, which hold what executions of one motion differ by:
    /// nothing has changed then, whatever part of them a cause would explain.
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

    /// What has structure beyond `margin` times the usual; nothing where nobody knows what is usual.
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
