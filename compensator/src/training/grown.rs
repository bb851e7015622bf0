//! Trees grown by gradient boosting.

use forust_ml::gradientbooster::GrowPolicy;
use forust_ml::metric::Metric;
use forust_ml::objective::ObjectiveType;
use forust_ml::{GradientBooster, Matrix};

use super::job::Job;
use super::judge::judge_prediction;
use super::trees::{Node, Trees};
use crate::Error;

// What scikit-learn's HistGradientBoostingRegressor takes where it is told nothing (version 1.7); only the number of trees is
// chosen, by data left out.
/// Learning rate of the trees: applied part of a leaf's correction.
const RATE: f32 = 0.1;
/// Largest number of leaves of a tree.
const LEAVES: usize = 31;
/// Least number of samples of a leaf.
const LEAST: f32 = 20.0;
/// Number of distinct values of a column between which splits can lie.
const BINS: u16 = 255;
/// Largest number of trees of a joint.
const MOST: usize = 1000;
/// Number of trees without a better validation error after which no more are tried.
const PATIENCE: usize = 20;

/// Number of trees with the least error on the validation trajectories of the job.
///
/// # Errors
/// [`Error::Samples`] and [`Error::TooLittleData`] as [`super::train`], [`Error::Trees`].
pub fn choose_trees(job: &Job) -> Result<usize, Error> {
    job.split.check(&job.samples)?;
    let judge = Table::new(job, &job.split.validation);
    let booster = fit(job, MOST, Some(&judge))?;
    Ok(booster.best_iteration.map_or(MOST, |best| best + 1))
}

/// Trees grown on the training trajectories of the job, and their weighted RMS error on its validation
/// trajectories, N·m (none without such trajectories).
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

/// Windows of the samples with weight, as the table that trees are grown on.
struct Table {
    /// Inputs of the windows, column by column.
    values: Vec<f64>,
    /// Target of each window, N·m.
    targets: Vec<f64>,
    /// Weight of each window.
    weights: Vec<f64>,
    /// Number of columns: input columns × samples of a window.
    columns: usize,
}

impl Table {
    /// Table of the windows of some trajectories.
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

    /// Inputs in the form that the library takes.
    fn matrix(&self) -> Matrix<'_, f64> {
        Matrix::new(&self.values, self.targets.len(), self.columns)
    }
}

/// Fit of at most `count` trees; fewer where the error on `judge` does not fall.
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
