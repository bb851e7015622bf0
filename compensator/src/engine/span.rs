//! Size of one pass and the factors of its dropout.

use feedforward::network::Architecture;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;

use super::real::Real;

/// Size of one forward or backward pass.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Span {
    /// Number of rows (windows or chunks).
    pub(crate) batch: usize,
    /// Number of steps of each row.
    pub(crate) steps: usize,
    /// First step that has an output; all later ones have one, too.
    pub(crate) first: usize,
}

impl Span {
    /// Number of outputs, ordered (output step, row).
    pub(crate) fn outputs(&self) -> usize {
        (self.steps - self.first) * self.batch
    }
}

/// Inverted dropout: factors 0 or 1/(1 − p) on the encoder's states and on the inputs of the dense output.
#[derive(Debug, Default)]
pub(crate) struct Dropout<T> {
    /// Factors on the encoder's states, steps blocks of batch × encoder.
    pub(crate) encoder: Vec<T>,
    /// Factors on the inputs of the dense output.
    pub(crate) output: Vec<T>,
    /// Random bytes from which the factors were drawn, two for each.
    random: Vec<u8>,
}

impl<T: Real> Dropout<T> {
    /// Draws fresh factors for probability `p` in [0, 1).
    pub(crate) fn draw(
        &mut self,
        architecture: &Architecture,
        span: Span,
        p: f32,
        rng: &mut ChaCha8Rng,
    ) {
        let (encoder, output) = match architecture {
            Architecture::Recurrent(r) => (
                span.steps * span.batch * r.encoder,
                span.outputs() * r.reencoder,
            ),
            Architecture::Perceptron { hidden, .. } => {
                (0, span.batch * hidden.last().copied().unwrap_or(0))
            }
        };
        self.random.resize(2 * (encoder + output), 0);
        rng.fill_bytes(&mut self.random);
        let (draws, _) = self.random.as_chunks::<2>();
        let threshold = (p * 65536.0) as u16;
        let kept = T::from_f32(1.0 / (1.0 - p));
        let factor = |b: &[u8; 2]| {
            if u16::from_le_bytes(*b) < threshold {
                T::ZERO
            } else {
                kept
            }
        };
        self.encoder.clear();
        self.encoder.extend(draws[..encoder].iter().map(factor));
        self.output.clear();
        self.output.extend(draws[encoder..].iter().map(factor));
    }
}
