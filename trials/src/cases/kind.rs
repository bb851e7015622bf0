//! Which effect a case withholds.

use crate::effects::EFFECTS;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

/// What separates a case's recording from its model, beside small errors of the parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Kind {
    /// Nothing.
    None,
    /// One effect of the catalogue: an index into [`EFFECTS`].
    Single(usize),
    /// Two effects of the catalogue.
    Two,
    /// A mechanism that the catalogue does not list.
    Outside,
}

impl Kind {
    /// Name in the answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Single(effect) => EFFECTS[effect],
            Self::Two => "two",
            Self::Outside => "outside",
        }
    }
}

/// A case to be generated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct CaseSpec {
    /// Its place in the run.
    pub index: u64,
    /// Its kind.
    pub kind: Kind,
}

/// Cases after which kinds are balanced: 30 without effect, 30 outside the catalogue, 16 with two, 164 with one (every
/// effect seven or eight times).
pub const ROUND: u64 = 240;

/// The case at `index` of the run with this seed.
pub fn draw(index: u64, seed: u64) -> CaseSpec {
    let mut kinds = vec![Kind::None; 30];
    kinds.extend([Kind::Outside; 30]);
    kinds.extend([Kind::Two; 16]);
    let round = index / ROUND;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ round.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let mut effects: Vec<usize> = (0..EFFECTS.len()).collect();
    effects.shuffle(&mut rng);
    kinds.extend(effects.iter().cycle().take(164).map(|&e| Kind::Single(e)));
    kinds.shuffle(&mut rng);
    CaseSpec {
        index,
        kind: kinds[(index % ROUND) as usize],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_is_balanced() {
        let kinds: Vec<Kind> = (ROUND..2 * ROUND).map(|i| draw(i, 7).kind).collect();
        let count = |kind| kinds.iter().filter(|&&k| k == kind).count();
        assert_eq!(
            (count(Kind::None), count(Kind::Outside), count(Kind::Two)),
            (30, 30, 16)
        );
        for (e, name) in EFFECTS.iter().enumerate() {
            assert!((7..=8).contains(&count(Kind::Single(e))), "{name}");
        }
        assert_ne!(
            draw(0, 7),
            CaseSpec {
                index: 0,
                ..draw(1, 7)
            }
        );
        assert_eq!(draw(17, 7), draw(17, 7));
    }
}
