//! Kinds of cases: the withheld effect.

use crate::effects::EFFECTS;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

/// Difference between a case's recording and its model, besides small errors of the parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Kind {
    /// No difference beside small errors of parameters.
    None,
    /// Single effect of the catalogue: an index into [`EFFECTS`].
    Single(usize),
    /// Two effects of the catalogue.
    Two,
    /// Two effects of friction, memory, ripple, load or drift on one joint.
    TwoOfOneJoint,
    /// Pushes while the arm stands, in one of the two files.
    ContactAtRest,
    /// A mechanism that the catalogue does not list.
    Outside,
}

impl Kind {
    /// Name of the kind in the answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Single(effect) => EFFECTS[effect],
            Self::Two => "two",
            Self::TwoOfOneJoint => "two_same_joint",
            Self::ContactAtRest => "contact_at_rest",
            Self::Outside => "outside",
        }
    }
}

/// Specification of a case to be generated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct CaseSpec {
    /// Index of the case in the run.
    pub index: u64,
    /// Kind of the case: its withheld effect.
    pub kind: Kind,
    /// Whether the case is drawn nearer to real recordings.
    pub hard: bool,
    /// Effect that is not drawn, as before it entered the catalogue: an index into [`EFFECTS`].
    pub without: Option<usize>,
    /// Version of the generator, see [`GENERATOR`](super::GENERATOR). Cases drawn here have the first version.
    pub generator: u8,
}

impl CaseSpec {
    /// The case with another version of the generator.
    pub fn by(self, generator: u8) -> Self {
        Self { generator, ..self }
    }
}

/// Index into [`EFFECTS`] of the effect with a name.
pub fn effect_index(name: &str) -> Option<usize> {
    EFFECTS.iter().position(|e| *e == name)
}

/// Number of cases after which kinds are balanced: 30 without effect, 30 outside the catalogue, 16 with two,
/// 164 with one (every effect seven or eight times).
pub const ROUND: u64 = 240;

/// The case at `index` of the run with this seed.
pub fn draw(index: u64, seed: u64) -> CaseSpec {
    draw_without(index, seed, None)
}

/// A case drawn from a catalogue that lacks an effect, an index into [`EFFECTS`]: that of this seed before the effect was added.
pub fn draw_without(index: u64, seed: u64, without: Option<usize>) -> CaseSpec {
    let mut kinds = vec![Kind::None; 30];
    kinds.extend([Kind::Outside; 30]);
    kinds.extend([Kind::Two; 16]);
    let round = index / ROUND;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ round.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let mut effects: Vec<usize> = (0..EFFECTS.len()).filter(|e| Some(*e) != without).collect();
    effects.shuffle(&mut rng);
    kinds.extend(effects.iter().cycle().take(164).map(|&e| Kind::Single(e)));
    kinds.shuffle(&mut rng);
    CaseSpec {
        index,
        kind: kinds[(index % ROUND) as usize],
        hard: false,
        without,
        generator: 1,
    }
}

/// The cases of one kind, by its name, that the run with this seed deals.
pub fn draw_only(kind: &str, seed: u64) -> impl Iterator<Item = CaseSpec> {
    (0..)
        .map(move |index| draw(index, seed))
        .filter(move |spec| spec.kind.name() == kind)
}

/// The hard cases of one kind, by its name, that the run with this seed deals.
pub fn draw_hard_only(kind: &str, seed: u64) -> impl Iterator<Item = CaseSpec> {
    (0..)
        .map(move |index| draw_hard(index, seed))
        .filter(move |spec| spec.kind.name() == kind)
}

/// Hard cases after which kinds are balanced: 60 without effect, 60 outside the catalogue, 48 of contact (half at rest), 44 of
/// elasticity, of backlash and of two effects on one joint each, and 200 of the other effects, ten each.
pub const HARD_ROUND: u64 = 500;

/// The hard case at `index` of the run with this seed.
pub fn draw_hard(index: u64, seed: u64) -> CaseSpec {
    let mut kinds = vec![Kind::None; 60];
    kinds.extend([Kind::Outside; 60]);
    kinds.extend([Kind::ContactAtRest; 24]);
    kinds.extend([Kind::TwoOfOneJoint; 44]);
    let many = [
        ("external_contact", 24),
        ("joint_elasticity", 44),
        ("backlash", 44),
    ];
    let mut few: Vec<usize> = (0..EFFECTS.len()).collect();
    for (effect, count) in many
        .iter()
        .filter_map(|(name, count)| Some((effect_index(name)?, *count)))
    {
        kinds.extend(std::iter::repeat_n(Kind::Single(effect), count));
        few.retain(|e| *e != effect);
    }
    let round = index / HARD_ROUND;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ round.wrapping_mul(0xD1B5_4A32_D192_ED03));
    few.shuffle(&mut rng);
    let left = HARD_ROUND as usize - kinds.len();
    kinds.extend(few.iter().cycle().take(left).map(|&e| Kind::Single(e)));
    kinds.shuffle(&mut rng);
    CaseSpec {
        index,
        kind: kinds[(index % HARD_ROUND) as usize],
        hard: true,
        without: None,
        generator: 1,
    }
}

/// Kinds that a run deals, hard or plain, and the part of its cases that each has on average.
pub fn frequencies(hard: bool) -> Vec<(Kind, f64)> {
    // As many rounds as there are effects: each effect is dealt as often as any other of its class.
    let (rounds, round) = match hard {
        true => (1, HARD_ROUND),
        false => (EFFECTS.len() as u64, ROUND),
    };
    let mut counts: Vec<(Kind, f64)> = Vec::new();
    for index in 0..rounds * round {
        let kind = if hard {
            draw_hard(index, 0)
        } else {
            draw(index, 0)
        }
        .kind;
        match counts.iter_mut().find(|(k, _)| *k == kind) {
            Some((_, count)) => *count += 1.0,
            None => counts.push((kind, 1.0)),
        }
    }
    let all = (rounds * round) as f64;
    counts.into_iter().map(|(k, c)| (k, c / all)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hard_round_has_enough_of_each() {
        let kinds: Vec<Kind> = (0..HARD_ROUND).map(|i| draw_hard(i, 7).kind).collect();
        let count = |kind| kinds.iter().filter(|&&k| k == kind).count();
        assert_eq!((count(Kind::None), count(Kind::Outside)), (60, 60));
        assert_eq!(
            (count(Kind::TwoOfOneJoint), count(Kind::ContactAtRest)),
            (44, 24)
        );
        for (e, name) in EFFECTS.iter().enumerate() {
            let expected = match *name {
                "external_contact" => 24,
                "joint_elasticity" | "backlash" => 44,
                _ => 10,
            };
            assert_eq!(count(Kind::Single(e)), expected, "{name}");
        }
    }

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
        let lacks = |i| draw_without(i, 7, Some(3)).kind;
        assert!((0..ROUND).all(|i| lacks(i) != Kind::Single(3)));
        assert!((0..ROUND).any(|i| lacks(i) == Kind::Single(4)));
    }
}
