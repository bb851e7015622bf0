//! Cut-off of the motion with the least error of the true equations.

use model::failure::Failure;

/// Cut-offs of the motion that are tried beside its own, Hz: the true equations need not do best where the model does.
const CUTOFFS: [f64; 4] = [10.0, 15.0, 25.0, 40.0];
/// Highest cut-off that is tried, relative to the recording's rate.
const HIGHEST: f64 = 0.4;

/// Result of `attempt` at the cut-off with its least score, and that cut-off, Hz (None: the motion's own
/// preparation). An attempt gets a cut-off and returns its score and result.
///
/// # Errors
/// The first attempt that fails.
pub fn at_best_cutoff<T>(
    rate_hz: f64,
    mut attempt: impl FnMut(Option<f64>) -> Result<(f64, T), Failure>,
) -> Result<(T, Option<f64>), Failure> {
    let (mut least, mut best) = attempt(None)?;
    let mut at = None;
    for hz in CUTOFFS.into_iter().filter(|&hz| hz < HIGHEST * rate_hz) {
        let (score, made) = attempt(Some(hz))?;
        if score < least {
            (least, best, at) = (score, made, Some(hz));
        }
    }
    Ok((best, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_score_below_the_bound_wins() {
        let tried = |rate_hz: f64, scores: [f64; 5]| {
            let mut left = scores.into_iter();
            let mut seen = Vec::new();
            let best = at_best_cutoff(rate_hz, |hz| {
                seen.push(hz);
                Ok((left.next().unwrap(), hz))
            });
            (best.unwrap(), seen.len())
        };
        assert_eq!(
            tried(125.0, [3.0, 2.0, 1.0, 2.0, 0.5]),
            ((Some(40.0), Some(40.0)), 5)
        );
        // At 60 Hz the bound is 24 Hz; a tie leaves what came first.
        assert_eq!(tried(60.0, [1.0, 2.0, 1.0, 0.0, 0.0]), ((None, None), 3));
    }
}
