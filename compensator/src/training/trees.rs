//! Gradient-boosted regression trees on the windows a unit would see: what a strong learner without a network makes of them.

use std::ops::Range;

use forust_ml::gradientbooster::GrowPolicy;
use forust_ml::metric::Metric;
use forust_ml::objective::ObjectiveType;
use forust_ml::{GradientBooster, Matrix};
use serde::{Deserialize, Serialize};

use super::ensemble::Job;
use super::judge::judge_prediction;
use super::samples::Samples;
use crate::Error;

// What scikit-learn's HistGradientBoostingRegressor takes where it is told nothing (version 1.7); only the number of trees is
// chosen, by data left out.
/// Part of what a leaf would correct that it does correct.
const RATE: f32 = 0.1;
/// Leaves of a tree, at most.
const LEAVES: usize = 31;
/// Samples of a leaf, at least.
const LEAST: f32 = 20.0;
/// Values of a column that splits are told apart by.
const BINS: u16 = 255;
/// Trees tried, at most.
const MOST: usize = 1000;
/// Trees without a better one after which no more are tried.
const PATIENCE: usize = 20;

/// Boosted trees of one joint. They stay within the torques of training by themselves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trees {
    /// Joint whose residual torque they predict.
    pub joint: usize,
    /// Whether they helped on the validation trajectories; true where there were none.
    pub enabled: bool,
    /// Input columns.
    columns: Vec<usize>,
    /// Samples of a window.
    timestep: usize,
    /// Torque before the first tree, N·m.
    base: f64,
    trees: Vec<Vec<Node>>,
}

/// Column of the flattened window, border or torque (N·m), child where the value is below the border, child elsewhere; a leaf
/// has 0 for children.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Node(usize, f64, usize, usize);

/// How many trees err least on the validation trajectories of the job.
///
/// # Errors
/// [`Error::Samples`] and [`Error::TooLittleData`] as [`super::train`], [`Error::Trees`].
pub fn choose_trees(job: &Job) -> Result<usize, Error> {
    job.split.check(&job.samples)?;
    let judge = Table::new(job, &job.split.validation);
    let booster = fit(job, MOST, Some(&judge))?;
    Ok(booster.best_iteration.map_or(MOST, |best| best + 1))
}

/// Trees on the training trajectories of the job, judged on its validation trajectories: with their weighted RMS error there,
/// N·m (none without such trajectories).
///
/// # Errors
/// As [`choose_trees`].
pub fn grow_trees(job: &Job, count: usize) -> Result<(Trees, Option<f64>), Error> {
    job.split.check(&job.samples)?;
    let booster = fit(job, count, None)?;
    let grown = booster.trees.iter().map(|tree| {
        let nodes = tree.nodes.iter().map(|n| match n.is_leaf {
            true => Node(0, f64::from(n.weight_value), 0, 0),
            false => Node(n.split_feature, n.split_value, n.left_child, n.right_child),
        });
        nodes.collect()
    });
    let mut trees = Trees {
        joint: job.joint,
        enabled: true,
        columns: job.columns.clone(),
        timestep: job.config.architecture.timestep(),
        base: booster.base_score,
        trees: grown.collect(),
    };
    if job.split.validation.is_empty() {
        return Ok((trees, None));
    }
    let predicted = trees.predict(&job.samples, &job.split.validation)?;
    let judged = judge_prediction(&job.samples, &job.split.validation, &job.config, &predicted);
    trees.enabled = judged.helps;
    Ok((trees, Some(judged.with)))
}

impl Trees {
    /// Number of trees.
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

    /// Refuses what a damaged file could hold: columns that are not there, children that lead nowhere or back.
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

/// Windows of the samples that count, column by column.
struct Table {
    values: Vec<f64>,
    targets: Vec<f64>,
    weights: Vec<f64>,
    columns: usize,
}

impl Table {
    fn new(job: &Job, trajectories: &[usize]) -> Self {
        let samples = &job.samples;
        let places: Vec<(usize, usize)> = trajectories
            .iter()
            .map(|&t| samples.trajectories()[t].clone())
            .flat_map(|range| range.clone().map(move |row| (row, range.start)))
            .filter(|&(row, _)| samples.weight(row) > 0.0)
            .collect();
        let columns = job.config.architecture.timestep() * job.columns.len();
        let mut window = vec![0.0; columns];
        let mut values = vec![0.0; columns * places.len()];
        for (k, &(row, start)) in places.iter().enumerate() {
            samples.window(row, start, &job.columns, &mut window);
            for (j, &x) in window.iter().enumerate() {
                values[j * places.len() + k] = f64::from(x);
            }
        }
        let of = |value: &dyn Fn(usize) -> f32| {
            let rows = places.iter();
            rows.map(|&(row, _)| f64::from(value(row))).collect()
        };
        Self {
            values,
            targets: of(&|row| samples.target(row)),
            weights: of(&|row| samples.weight(row)),
            columns,
        }
    }

    fn matrix(&self) -> Matrix<'_, f64> {
        Matrix::new(&self.values, self.targets.len(), self.columns)
    }
}

/// At most `count` trees; fewer where `judge` does not get better.
fn fit(job: &Job, count: usize, judge: Option<&Table>) -> Result<GradientBooster, Error> {
    let table = Table::new(job, &job.split.train);
    let mut booster = GradientBooster::default()
        .set_objective_type(ObjectiveType::SquaredLoss)
        .set_iterations(count)
        .set_learning_rate(RATE)
        .set_max_depth(usize::MAX)
        .set_max_leaves(LEAVES)
        .set_l2(0.0)
        .set_min_leaf_weight(LEAST)
        .set_nbins(BINS)
        .set_initialize_base_score(true)
        .set_parallel(false)
        .set_evaluation_metric(Some(Metric::RootMeanSquaredError))
        .set_early_stopping_rounds(judge.map(|_| PATIENCE));
    booster.grow_policy = GrowPolicy::LossGuide;
    let judge = judge.map(|j| vec![(j.matrix(), &j.targets[..], &j.weights[..])]);
    booster
        .fit(&table.matrix(), &table.targets, &table.weights, judge)
        .map_err(|e| Error::Trees(e.to_string()))?;
    Ok(booster)
}
