//! Order statistics.

/// The value below which a part `p` (0 to 1) of the values lies: that of the nearest rank. None without values.
pub fn quantile(mut values: Vec<f64>, p: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let rank = p.clamp(0.0, 1.0) * values.len().saturating_sub(1) as f64;
    values.get(rank.round() as usize).copied()
}

/// Median of the values, the upper one of two in the middle. None without values.
pub fn median(values: Vec<f64>) -> Option<f64> {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 3.0, 2.0]), Some(3.0));
        assert_eq!(median(Vec::new()), None);
        let ten = || (0..=10).map(f64::from).rev().collect::<Vec<_>>();
        assert_eq!(quantile(ten(), 0.0), Some(0.0));
        assert_eq!(quantile(ten(), 0.9), Some(9.0));
        assert_eq!(quantile(ten(), 1.0), Some(10.0));
    }
}
