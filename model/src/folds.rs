//! Folds for cross-validation: whole trajectories, and repeats of one motion never apart.

use std::ops::Range;

/// Groups of trajectory indices that belong together, in order.
///
/// `repeats` are pairs of trajectories that execute the same motion. Repeats are joined, and so are
/// groups whose index ranges interleave (A B C A B C is one visit to the robot), so that no fold
/// contains a copy of what another is tested on.
pub fn groups(trajectories: usize, repeats: &[(usize, usize)]) -> Vec<Range<usize>> {
    // Only the largest reach of each index matters: a sweep merges overlapping index ranges.
    let mut reach: Vec<usize> = (0..trajectories).collect();
    for &(a, b) in repeats {
        let (low, high) = (a.min(b), a.max(b));
        reach[low] = reach[low].max(high);
    }
    let mut groups = Vec::new();
    let mut start = 0;
    let mut end = 0;
    for (index, &to) in reach.iter().enumerate() {
        if index > end {
            groups.push(start..end + 1);
            start = index;
        }
        end = end.max(to).max(index);
    }
    if trajectories > 0 {
        groups.push(start..end + 1);
    }
    groups
}

/// Deals groups to at most `folds` folds, round robin: fold of each trajectory.
///
/// Round robin spreads slow changes (warm-up) over all folds.
pub fn deal(groups: &[Range<usize>], folds: usize) -> Vec<usize> {
    let count = groups.last().map_or(0, |g| g.end);
    let mut fold = vec![0; count];
    for (i, group) in groups.iter().enumerate() {
        fold[group.clone()].fill(i % folds.max(1));
    }
    fold
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn two_visits_of_three_repeated_motions() {
        let repeats = [(0, 3), (1, 4), (2, 5), (6, 9), (7, 10), (8, 11)];
        assert_eq!(groups(12, &repeats), vec![0..6, 6..12]);
        assert_eq!(groups(3, &[]), vec![0..1, 1..2, 2..3]);
        assert_eq!(deal(&[0..2, 2..3, 3..5], 2), vec![0, 0, 1, 0, 0]);
    }

    proptest! {
        #[test]
        fn repeats_share_a_fold(n in 1usize..30, pairs in prop::collection::vec((0usize..30, 0usize..30), 0..20), folds in 1usize..7) {
            let pairs: Vec<_> = pairs.into_iter().filter(|&(a, b)| a < n && b < n).collect();
            let fold = deal(&groups(n, &pairs), folds);
            prop_assert_eq!(fold.len(), n);
            for (a, b) in pairs {
                prop_assert_eq!(fold[a], fold[b]);
            }
        }
    }
}
