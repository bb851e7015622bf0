//! Cross-validation by whole trajectories, or whole groups of repeats.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::samples::Split;
use crate::Error;

/// Fold: indices of the trajectories for training, validation and test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fold {
    /// Fitted and validated trajectories.
    pub split: Split,
    /// Trajectories held out for the test.
    pub test: Vec<usize>,
}

/// `k` folds of trajectories; those with the same entry in `groups` (repeats of one motion) stay together.
///
/// Groups are shuffled by the seed and dealt out; fold f tests on part f, validates on part f + 1 and
/// fits all other parts.
///
/// # Errors
/// [`Error::TooLittleData`] where there are fewer than `k` groups, or `k` is below 3.
pub fn folds(groups: &[usize], k: usize, seed: u64) -> Result<Vec<Fold>, Error> {
    let mut distinct = groups.to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    if k < 3 || distinct.len() < k {
        let problem = format!(
            "{} groups of trajectories for {k} folds; 3 or more folds need a group each",
            distinct.len()
        );
        return Err(Error::TooLittleData(problem));
    }
    distinct.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    let part = |group: usize| {
        distinct
            .iter()
            .position(|&g| g == group)
            .map_or(0, |p| p % k)
    };
    let of = |wanted: &dyn Fn(usize) -> bool| {
        (0..groups.len())
            .filter(|&t| wanted(part(groups[t])))
            .collect()
    };
    let fold = |f: usize| {
        let next = (f + 1) % k;
        let split = Split {
            train: of(&|p| p != f && p != next),
            validation: of(&|p| p == next),
        };
        Fold {
            split,
            test: of(&|p| p == f),
        }
    };
    Ok((0..k).map(fold).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_trajectory_is_tested_once_and_groups_stay_together() {
        let groups = [0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5];
        let folds = folds(&groups, 3, 1).unwrap();
        let mut tested = [0; 12];
        for fold in &folds {
            fold.test.iter().for_each(|&t| tested[t] += 1);
            let sides = [&fold.test, &fold.split.train, &fold.split.validation];
            assert_eq!(sides.iter().map(|s| s.len()).sum::<usize>(), 12);
            for side in sides {
                assert!(
                    side.iter().all(|t| side.contains(&((t + 6) % 12))),
                    "a group was torn apart"
                );
            }
        }
        assert_eq!(tested, [1; 12]);
    }

    #[test]
    fn too_few_groups_are_refused() {
        assert!(folds(&[0, 0, 1], 3, 0).is_err());
        assert!(folds(&[0, 1, 2], 2, 0).is_err());
    }
}
