//! Other joints whose motion a joint's residual torque follows.
//!
//! A hose pulls by the posture of several joints, and friction may grow with the speed of another one. No description
//! says which. Each other joint's position and velocity is tried beside the joint's own, and taken where it lowers the
//! error on folds left out. The motion of all joints at once would let a network recognise the trajectories.

use crate::identify::selection::ForwardOptions;
use ::identify::least_squares::{Gram, LeastSquaresError, Triangle};
use datasets::folds::FEWEST;
use ndarray::{Array1, Array2, ArrayView2, Axis, concatenate};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, Uniform};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Number of random waves of a fit (Rahimi and Recht, 2007): a smooth function of a few inputs.
const WAVES: usize = 100;
/// Ridges relative to the columns' norms, from a fit of everything to one of nearly nothing.
const RIDGES: [f64; 7] = [1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0];
/// Conditions for an input: on folds left out, as for terms of friction.
const TAKEN: ForwardOptions = ForwardOptions {
    least_gain: 0.01,
    standard_errors: 1.0,
    most: 3,
    ridge: 0.0,
};

/// Rows from which the inputs of all joints are chosen.
pub struct Rows<'a> {
    /// Positions of all joints, then their velocities, each over its own deviation, shape (rows, 2 joints).
    motion: Array2<f64>,
    /// Index of the fold of each row.
    fold: &'a [usize],
}

impl<'a> Rows<'a> {
    /// Rows of a motion: positions, then velocities, shape (rows, 2 joints). Columns that stand still are zero.
    pub fn new(mut motion: Array2<f64>, fold: &'a [usize]) -> Self {
        for mut column in motion.columns_mut() {
            let (mean, deviation) = (column.mean().unwrap_or(0.0), column.std(0.0));
            let scale = if deviation > 0.0 {
                1.0 / deviation
            } else {
                0.0
            };
            column.mapv_inplace(|x| scale * (x - mean));
        }
        Self { motion, fold }
    }

    /// Columns of other joints' motion that the residual `left` of a joint follows, the strongest first. None with few folds.
    ///
    /// # Errors
    /// Values that are not finite.
    pub fn followed(&self, joint: usize, left: &[f64]) -> Result<Vec<usize>, LeastSquaresError> {
        let folds = self.fold.iter().map(|f| f + 1).max().unwrap_or(0);
        if folds < FEWEST {
            return Ok(Vec::new());
        }
        let joints = self.motion.ncols() / 2;
        let own = [joint, joints + joint];
        let total = |errors: &[f64]| errors.iter().sum::<f64>();
        let mut best = vec![0.0; folds];
        for (l, &fold) in left.iter().zip(self.fold) {
            best[fold] += l * l;
        }
        let alone = self.errors(&own, left, folds)?;
        if total(&alone) < total(&best) {
            best = alone;
        }
        let mut taken = Vec::new();
        while taken.len() < TAKEN.most {
            let others = (0..2 * joints).filter(|c| c % joints != joint && !taken.contains(c));
            let tried = others.collect::<Vec<_>>().into_par_iter().map(|column| {
                let columns: Vec<usize> =
                    own.iter().chain(&taken).copied().chain([column]).collect();
                Ok((self.errors(&columns, left, folds)?, column))
            });
            let tried: Vec<_> = tried.collect::<Result<_, LeastSquaresError>>()?;
            let least = tried
                .into_iter()
                .min_by(|a, b| total(&a.0).total_cmp(&total(&b.0)));
            match least {
                Some((errors, column)) if TAKEN.falls(&best, &errors) => {
                    best = errors;
                    taken.push(column);
                }
                _ => break,
            }
        }
        Ok(taken)
    }

    /// Squared error on each fold of a smooth function of some columns that was fitted to the other folds, with the best ridge.
    fn errors(
        &self,
        columns: &[usize],
        left: &[f64],
        folds: usize,
    ) -> Result<Vec<f64>, LeastSquaresError> {
        let functions = functions(self.motion.select(Axis(1), columns).view());
        let sums: Vec<Gram> = (0..folds)
            .map(|fold| {
                let rows: Vec<usize> = (0..left.len()).filter(|&r| self.fold[r] == fold).collect();
                let targets: Array1<f64> = rows.iter().map(|&r| left[r]).collect();
                let own = functions.select(Axis(0), &rows);
                Ok(Gram::from(&Triangle::of(own.view(), targets.view())?))
            })
            .collect::<Result<_, LeastSquaresError>>()?;
        let all = Gram::sum(&sums)?;
        let every: Vec<usize> = (0..functions.ncols()).collect();
        let mut best: Option<Vec<f64>> = None;
        for ridge in RIDGES {
            let left_out = |own: &Gram| -> Result<f64, LeastSquaresError> {
                match all.less(own)?.fit(&every, ridge)? {
                    Some(fit) => own.residual_sum_of_squares(&every, &fit.parameters),
                    None => Ok(f64::INFINITY),
                }
            };
            let errors: Vec<f64> = sums.iter().map(left_out).collect::<Result<_, _>>()?;
            let less = |b: &Vec<f64>| errors.iter().sum::<f64>() < b.iter().sum();
            if best.as_ref().is_none_or(less) {
                best = Some(errors);
            }
        }
        Ok(best.unwrap_or_default())
    }
}

/// A constant, the inputs and random waves of them, shape (rows, functions). The waves' length is the inputs' usual distance.
fn functions(inputs: ArrayView2<f64>) -> Array2<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let far = (2.0 * inputs.ncols() as f64).sqrt();
    let direction = Array2::from_shape_simple_fn((inputs.ncols(), WAVES), || {
        let drawn: f64 = StandardNormal.sample(&mut random);
        drawn / far
    });
    let mut waves = inputs.dot(&direction);
    if let Ok(phases) = Uniform::new(0.0, TAU) {
        for mut wave in waves.columns_mut() {
            let phase = phases.sample(&mut random);
            wave.mapv_inplace(|x| (x + phase).cos());
        }
    }
    let constant = Array2::ones((inputs.nrows(), 1));
    concatenate(Axis(1), &[constant.view(), inputs, waves.view()]).unwrap_or(constant)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOLDS: usize = 5;

    /// Three joints on their own courses for 5 folds.
    fn motion() -> (Array2<f64>, Vec<usize>) {
        let rows = 3000;
        let motion = Array2::from_shape_fn((rows, 6), |(r, c)| {
            let t = 0.05 * r as f64;
            let pace = [1.0, 0.73, 0.41][c % 3];
            let wander = 0.4 * (0.113 * t * pace + c as f64).sin();
            if c < 3 {
                (pace * t).sin() + wander
            } else {
                pace * (pace * t).cos() + wander
            }
        });
        (motion, (0..rows).map(|r| r * FOLDS / rows).collect())
    }

    #[test]
    fn the_joint_that_pulls_is_found_and_no_other() {
        let (motion, fold) = motion();
        let pull: Vec<f64> = motion
            .rows()
            .into_iter()
            .map(|m| (m[0] + 0.3 * m[2]).max(0.2) + 0.1 * (37.0 * m[1]).sin())
            .collect();
        let drag: Vec<f64> = motion
            .rows()
            .into_iter()
            .map(|m| m[3].powi(2) * (10.0 * m[5]).tanh())
            .collect();
        let rows = Rows::new(motion, &fold);
        assert_eq!(rows.followed(0, &pull).unwrap(), [2]);
        assert_eq!(rows.followed(2, &drag).unwrap(), [3]);
    }

    #[test]
    fn own_motion_noise_and_few_folds_take_none() {
        let (motion, fold) = motion();
        let own: Vec<f64> = motion.column(1).iter().map(|q| (3.0 * q).sin()).collect();
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let noise: Vec<f64> = own
            .iter()
            .map(|_| StandardNormal.sample(&mut random))
            .collect();
        let two: Vec<usize> = fold.iter().map(|f| f % 2).collect();
        let rows = Rows::new(motion.clone(), &fold);
        assert!(rows.followed(1, &own).unwrap().is_empty());
        assert!(rows.followed(1, &noise).unwrap().is_empty());
        let other: Vec<f64> = motion.column(0).to_vec();
        assert_eq!(rows.followed(1, &other).unwrap(), [0]);
        assert!(
            Rows::new(motion, &two)
                .followed(1, &other)
                .unwrap()
                .is_empty()
        );
    }
}
