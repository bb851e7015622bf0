//! Weights as whole numbers of eight bits, inputs as whole numbers of sixteen: their sums are exact.

use super::bytes::{Matrix, ONE, QUAD};
use super::tile::TILE;
use super::vnni::Vnni;
use pulp::{Arch, Simd, WithSimd};

/// A matrix of bytes with the instructions for it.
#[derive(Debug, Clone)]
pub(super) struct Int8 {
    matrix: Matrix,
    /// Instructions that multiply and add bytes, where the processor has them.
    vnni: Option<Vnni>,
}

impl Int8 {
    pub(super) fn new(weights: &[f32], inputs: usize) -> Self {
        Self {
            matrix: Matrix::new(weights, inputs),
            vnni: Vnni::new(),
        }
    }

    /// Adds x·W to `out` for at most [`ROWS`](super::tile::ROWS) rows of `x`, each within ±1.
    pub(super) fn add(&mut self, arch: Arch, x: &[f32], out: &mut [f32]) {
        let Self { matrix, vnni } = self;
        arch.dispatch(Encode {
            x,
            inputs: matrix.inputs,
            upper: matrix.upper.as_flattened_mut(),
            lower: matrix.lower.as_flattened_mut(),
        });
        let rows = x.len() / matrix.inputs;
        match vnni {
            Some(vnni) if !matches!(arch, Arch::Scalar) => vnni.add(matrix, rows, out),
            _ => arch.dispatch(Add { matrix, rows, out }),
        }
    }
}

/// Bytes of 32768 + 32767·x.
struct Encode<'a> {
    x: &'a [f32],
    inputs: usize,
    upper: &'a mut [u8],
    lower: &'a mut [u8],
}

impl WithSimd for Encode<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let width = self.inputs.next_multiple_of(QUAD);
        let rows = self.x.chunks_exact(self.inputs);
        let bytes = self
            .upper
            .chunks_exact_mut(width)
            .zip(self.lower.chunks_exact_mut(width));
        for (x, (upper, lower)) in rows.zip(bytes) {
            for ((x, upper), lower) in x.iter().zip(upper).zip(lower) {
                let code = 32_768 + (x.clamp(-1.0, 1.0) * ONE).round_ties_even() as i32;
                *upper = (code >> 8) as u8;
                *lower = code as u8;
            }
        }
    }
}

/// Sums without instructions for bytes.
struct Add<'a> {
    matrix: &'a Matrix,
    rows: usize,
    out: &'a mut [f32],
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { matrix, rows, out } = self;
        let (out, _) = out.as_chunks_mut::<TILE>();
        let tiles = matrix.blocks.chunks_exact(matrix.quads);
        for (t, (tile, scale)) in tiles.zip(&matrix.scales[..]).enumerate() {
            for b in 0..rows {
                let (upper, lower) = matrix.row(b);
                let sums = [upper, lower].map(|bytes| {
                    let mut sum = [0; TILE];
                    for (block, x) in tile.iter().zip(bytes) {
                        for (sum, weights) in sum.iter_mut().zip(&block.0) {
                            for (x, w) in x.iter().zip(weights) {
                                *sum += i32::from(*x) * i32::from(*w);
                            }
                        }
                    }
                    sum
                });
                scale.add(&sums, &mut out[b * matrix.scales.len() + t]);
            }
        }
    }
}
