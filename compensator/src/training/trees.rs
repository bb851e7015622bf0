//! Boosted regression trees on a unit's windows, as grown and stored: a strong learner without a network for comparison.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::samples::Samples;
use crate::Error;

/// Boosted trees of one joint. They stay within the torques of training by themselves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trees {
    /// Joint whose residual torque they predict.
    pub joint: usize,
    /// Whether the trees lower the error on the validation trajectories; true without such trajectories.
    pub enabled: bool,
    /// Indices of the input columns.
    pub(super) columns: Vec<usize>,
    /// Number of samples of a window.
    pub(super) timestep: usize,
    /// Torque before the first tree, N·m.
    pub(super) base: f64,
    /// Nodes of each tree, the root first.
    pub(super) trees: Vec<Vec<Node>>,
}

/// Column of the flattened window, border or torque (N·m), child where the value is below the border, child elsewhere; a leaf
/// has 0 for children.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Node(
    pub(super) usize,
    pub(super) f64,
    pub(super) usize,
    pub(super) usize,
);

impl Trees {
    /// Number of trees of the joint.
    pub fn count(&self) -> usize {
        self.trees.len()
    }

    /// Number of leaves of all trees.
    pub fn leaves(&self) -> usize {
        let nodes = self.trees.iter().flatten();
        nodes.filter(|n| n.is_leaf()).count()
    }

    /// Residual torque, N·m, of every sample in the given trajectories; 0 in the others, and everywhere where they are off.
    ///
    /// # Errors
    /// [`Error::Trees`] where they contradict themselves or see other columns than there are.
    pub fn predict(&self, samples: &Samples, trajectories: &[usize]) -> Result<Vec<f32>, Error> {
        self.check(samples.columns())?;
        let mut torque = vec![0.0; samples.rows()];
        if !self.enabled {
            return Ok(torque);
        }
        let mut window = vec![0.0; self.timestep * self.columns.len()];
        for &t in trajectories {
            let Range { start, end } = samples.trajectories()[t].clone();
            for (row, torque) in (start..end).zip(&mut torque[start..end]) {
                samples.window(row, start, &self.columns, &mut window);
                let grown = self.trees.iter().map(|tree| leaf(tree, &window));
                *torque = (self.base + grown.sum::<f64>()) as f32;
            }
        }
        Ok(torque)
    }

    /// Refuses contents that a damaged file could have: columns that do not exist, children that lead nowhere or back.
    fn check(&self, columns: usize) -> Result<(), Error> {
        let size = self.timestep * self.columns.len();
        let sound = |tree: &Vec<Node>| {
            let nodes = tree.iter().enumerate();
            let below = |at: usize, child: usize| child > at && child < tree.len();
            let mut fine = nodes
                .map(|(at, n)| n.is_leaf() || (n.0 < size && below(at, n.2) && below(at, n.3)));
            !tree.is_empty() && fine.all(|fine| fine)
        };
        let fits = size > 0 && self.columns.iter().all(|&c| c < columns);
        match fits && self.trees.iter().all(sound) {
            true => Ok(()),
            false => Err(Error::Trees("their parts do not fit together".into())),
        }
    }
}

impl Node {
    /// Whether the node is a leaf: it has no children.
    fn is_leaf(self) -> bool {
        self.2 == 0 && self.3 == 0
    }
}

/// Torque of the leaf that a window falls into.
fn leaf(tree: &[Node], window: &[f32]) -> f64 {
    let mut node = tree[0];
    while !node.is_leaf() {
        let below = f64::from(window[node.0]) < node.1;
        node = tree[if below { node.2 } else { node.3 }];
    }
    node.1
}
