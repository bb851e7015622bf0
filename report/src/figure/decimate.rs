//! Reduction of points that keeps the look of a curve.

/// Largest number of points of one curve that are drawn.
pub const MAX_POINTS: usize = 2000;

/// Largest number of points of one curve that are kept for a reader who zooms.
pub(super) const ZOOMED_POINTS: usize = 2 * MAX_POINTS;

/// Rows of `y` that keep the curve's look: the lowest and the highest row of each of
/// `max_points / 2` equal blocks, in order. Rows that are not finite are passed over.
pub(super) fn extremes(y: &[f64], max_points: usize) -> Vec<usize> {
    let finite = |i: &usize| y[*i].is_finite();
    if y.len() <= max_points {
        return (0..y.len()).filter(finite).collect();
    }
    let blocks = (max_points / 2).max(1);
    let mut kept = Vec::with_capacity(2 * blocks);
    for block in 0..blocks {
        let rows = (block * y.len() / blocks)..((block + 1) * y.len() / blocks);
        let by_value = |a: &usize, b: &usize| y[*a].total_cmp(&y[*b]);
        let low = rows.clone().filter(finite).min_by(by_value);
        let high = rows.filter(finite).max_by(by_value);
        if let (Some(low), Some(high)) = (low, high) {
            kept.push(low.min(high));
            if low != high {
                kept.push(low.max(high));
            }
        }
    }
    kept
}

/// Thins points to the first in each cell of `cell` pixels: a cloud that looks as dense as the whole one.
pub(super) fn thin(points: &[(f64, f64)], cell: f64) -> Vec<(f64, f64)> {
    let mut taken = std::collections::HashSet::new();
    points
        .iter()
        .copied()
        .filter(|(x, y)| taken.insert(((x / cell) as i64, (y / cell) as i64)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn extremes_survive_and_the_order_is_kept(
            y in proptest::collection::vec(-1e3..1e3_f64, 1..500), max in 2..60_usize,
        ) {
            let kept = extremes(&y, max);
            prop_assert!(kept.len() <= max);
            prop_assert!(kept.windows(2).all(|w| w[0] < w[1]));
            let highest = |rows: &mut dyn Iterator<Item = usize>| rows.map(|i| y[i]).fold(f64::MIN, f64::max);
            let lowest = |rows: &mut dyn Iterator<Item = usize>| rows.map(|i| y[i]).fold(f64::MAX, f64::min);
            prop_assert_eq!(highest(&mut kept.iter().copied()), highest(&mut (0..y.len())));
            prop_assert_eq!(lowest(&mut kept.iter().copied()), lowest(&mut (0..y.len())));
        }
    }

    #[test]
    fn a_cloud_keeps_one_point_per_cell() {
        let cloud = [(0.1, 0.1), (0.9, 0.9), (1.1, 0.1), (0.2, 0.3)];
        assert_eq!(thin(&cloud, 1.0), [(0.1, 0.1), (1.1, 0.1)]);
    }

    #[test]
    fn gaps_are_passed_over() {
        assert_eq!(extremes(&[1.0, f64::NAN, 2.0], 10), [0, 2]);
        assert!(extremes(&[f64::NAN; 9], 4).is_empty());
    }
}
