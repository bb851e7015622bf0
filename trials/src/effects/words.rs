//! Random words of a draw, noted so that the draw can be repeated and varied.

use rand::{Rng, TryRng};
use std::convert::Infallible;

/// Random numbers that gives words told beforehand, then those of a source, and notes all that were used. A 32-bit
/// number is the upper half of its word, so that every word is a coordinate from 0 to 2⁶⁴ in either case.
pub struct Words<'a> {
    told: &'a [u64],
    source: &'a mut dyn Rng,
    /// All words that were used, in order.
    pub used: Vec<u64>,
}

impl<'a> Words<'a> {
    /// Words of `told`, then of `source`.
    pub fn new(told: &'a [u64], source: &'a mut dyn Rng) -> Self {
        Self {
            told,
            source,
            used: Vec::new(),
        }
    }

    fn told(&self) -> Option<u64> {
        self.told.get(self.used.len()).copied()
    }
}

impl TryRng for Words<'_> {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        let word = match self.told() {
            Some(word) => word,
            None => u64::from(self.source.next_u32()) << 32,
        };
        self.used.push(word);
        Ok((word >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let word = match self.told() {
            Some(word) => word,
            None => self.source.next_u64(),
        };
        self.used.push(word);
        Ok(word)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            let word = self.try_next_u64()?.to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn a_noted_draw_is_repeated_and_varied() {
        let draw = |rng: &mut dyn Rng| {
            let joint = rng.random_range(0..6usize);
            (joint, rng.random_range(2.0..4.0f64), rng.random_bool(0.5))
        };
        let mut plain = ChaCha8Rng::seed_from_u64(5);
        let mut noted = ChaCha8Rng::seed_from_u64(5);
        let mut words = Words::new(&[], &mut noted);
        let first = draw(&mut words);
        let used = words.used.clone();
        assert_eq!(first, draw(&mut plain), "noting changes no draw");
        let mut other = ChaCha8Rng::seed_from_u64(9);
        assert_eq!(draw(&mut Words::new(&used, &mut other)), first);
        // A quarter of the second word's range is a quarter of the number's.
        let mut varied = used.clone();
        varied[1] = 1 << 62;
        let moved = draw(&mut Words::new(&varied, &mut other));
        assert!((moved.1 - 2.5).abs() < 1e-9);
        assert_eq!((moved.0, moved.2), (first.0, first.2));
    }
}
