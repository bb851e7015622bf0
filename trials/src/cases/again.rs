//! Motions that are executed twice, as a recording of a real robot often has them.

use super::kind::CaseSpec;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Newest version of the generator. The first repeats no motion; the second does in a third of the cases, which are otherwise those of
/// the first.
pub const GENERATOR: u8 = 2;

/// Number of the random stream for repeats, which no attempt at a case uses, so that all other draws stay the same.
const STREAM: u64 = u64::MAX;
/// Part of the cases that repeat motions.
const PART: f64 = 1.0 / 3.0;

/// Order in which motions are executed twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Again {
    /// Rounds over all motions: A B C A B C.
    InRounds,
    /// Each motion twice in a row: A A B B C C.
    AtOnce,
}

impl Again {
    /// Whether and how the case with this random key repeats motions.
    pub(super) fn draw(spec: &CaseSpec, key: [u8; 32]) -> Option<Self> {
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(STREAM);
        let (repeats, rounds) = (rng.random_bool(PART), rng.random_bool(0.5));
        let order = if rounds { Self::InRounds } else { Self::AtOnce };
        (spec.generator >= 2 && repeats).then_some(order)
    }

    /// Has the `fitted` ones of a session's trajectories execute half as many motions, the first of those drawn.
    pub(super) fn repeat<T: Clone>(self, trajectories: &mut [T], fitted: &[usize]) {
        let motions = fitted.len().div_ceil(2);
        for (i, &at) in fitted.iter().enumerate() {
            let from = match self {
                Self::InRounds => fitted[i % motions],
                Self::AtOnce => fitted[i - i % 2],
            };
            trajectories[at] = trajectories[from].clone();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::generate::key;
    use super::super::kind::{draw, draw_hard};
    use super::*;

    #[test]
    fn a_third_of_the_cases_repeats_motions() {
        for hard in [false, true] {
            let orders: Vec<Option<Again>> = (0..900)
                .map(|i| {
                    let spec = if hard { draw_hard(i, 5) } else { draw(i, 5) };
                    assert_eq!(
                        Again::draw(&spec, key(&spec, 5)),
                        None,
                        "the first generator"
                    );
                    let spec = spec.by(GENERATOR);
                    Again::draw(&spec, key(&spec, 5))
                })
                .collect();
            let count = |order| orders.iter().filter(|o| **o == order).count();
            assert!((550..650).contains(&count(None)));
            assert!((110..190).contains(&count(Some(Again::InRounds))));
        }
    }

    #[test]
    fn motions_are_executed_twice() {
        let order = |again: Again, fitted: &[usize]| {
            let mut all: Vec<char> = "abcdefgh".chars().collect();
            again.repeat(&mut all, fitted);
            all.into_iter().collect::<String>()
        };
        // Those at 2 and 5 are held out.
        let fitted = [0, 1, 3, 4, 6, 7];
        assert_eq!(order(Again::InRounds, &fitted), "abcdafbd");
        assert_eq!(order(Again::AtOnce, &fitted), "aacddfgg");
        assert_eq!(order(Again::InRounds, &[0, 1, 2]), "abadefgh");
    }
}
