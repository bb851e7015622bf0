//! Weight matrix packed for matrix × vector at run-time.

use pulp::{Arch, Simd, WithSimd};
use std::sync::Arc;

/// Number of outputs computed together; their accumulators stay in vector registers over all inputs.
const TILE: usize = 32;

/// y = xᵀ·W + b with W cut into tiles of 32 outputs, each stored input by input, so one pass streams the
/// weights in order. The instruction set is chosen at run-time. Copies share the weights: a loop faster than the network has
/// one state for each of its periods, and all of them stay in the processor's cache.
#[derive(Debug, Clone)]
pub(super) struct Packed {
    tiles: Arc<[[f32; TILE]]>,
    bias: Arc<[[f32; TILE]]>,
    inputs: usize,
}

impl Packed {
    /// Packs row-major `weights` (inputs × outputs) and `bias` (outputs, or empty for none).
    pub(super) fn new(weights: &[f32], bias: &[f32], inputs: usize) -> Self {
        let outputs = weights.len() / inputs;
        let count = outputs.div_ceil(TILE);
        let mut tiles = vec![[0.0; TILE]; count * inputs];
        for (k, row) in weights.chunks_exact(outputs).enumerate() {
            for (t, part) in row.chunks(TILE).enumerate() {
                tiles[t * inputs + k][..part.len()].copy_from_slice(part);
            }
        }
        let mut padded = vec![[0.0; TILE]; count];
        for (tile, part) in padded.iter_mut().zip(bias.chunks(TILE)) {
            tile[..part.len()].copy_from_slice(part);
        }
        Self {
            tiles: tiles.into(),
            bias: padded.into(),
            inputs,
        }
    }

    /// Length of the output buffer: the outputs rounded up to whole tiles.
    pub(super) fn padded(&self) -> usize {
        self.bias.len() * TILE
    }

    /// Number of inputs of the matrix.
    pub(super) fn inputs(&self) -> usize {
        self.inputs
    }

    /// Writes xᵀ·W + b to `out` (of [`Self::padded`] elements). Inputs beyond the end of `x` count as zero and
    /// cost nothing: the first step of a recurrence omits its zero state.
    pub(super) fn apply(&self, arch: Arch, x: &[f32], out: &mut [f32]) {
        match arch {
            Arch::Scalar => product::<false>(self, x, out),
            arch => arch.dispatch(Product {
                packed: self,
                x,
                out,
            }),
        }
    }
}

/// Product for an instruction set with fused multiply-add. (A closure would not do: it is compiled for
/// the default instruction set and called.)
struct Product<'a> {
    packed: &'a Packed,
    x: &'a [f32],
    out: &'a mut [f32],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        product::<true>(self.packed, self.x, self.out);
    }
}

#[inline(always)]
fn product<const FUSED: bool>(packed: &Packed, x: &[f32], out: &mut [f32]) {
    let (out, _) = out.as_chunks_mut::<TILE>();
    let tiles = packed.tiles.chunks_exact(packed.inputs);
    for ((tile, bias), out) in tiles.zip(&packed.bias[..]).zip(out) {
        let mut sum = *bias;
        for (row, &x) in tile.iter().zip(x) {
            for j in 0..TILE {
                sum[j] = if FUSED {
                    x.mul_add(row[j], sum[j])
                } else {
                    x * row[j] + sum[j]
                };
            }
        }
        *out = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equals_the_plain_product_whatever_the_shape_and_instruction_set() {
        for (inputs, outputs) in [(1, 1), (3, 40), (18, 512), (146, 33), (5, 64)] {
            let w: Vec<f32> = (0..inputs * outputs)
                .map(|i| ((i * 37 % 101) as f32 - 50.0) / 64.0)
                .collect();
            let b: Vec<f32> = (0..outputs).map(|i| i as f32 / 8.0).collect();
            let x: Vec<f32> = (0..inputs).map(|i| (i as f32 - 2.0) / 4.0).collect();
            let packed = Packed::new(&w, &b, inputs);
            let mut out = vec![f32::NAN; packed.padded()];
            for used in [inputs, inputs / 2] {
                for arch in [Arch::new(), Arch::Scalar] {
                    packed.apply(arch, &x[..used], &mut out);
                    for j in 0..outputs {
                        let sum: f32 = (0..used).map(|k| x[k] * w[k * outputs + j]).sum();
                        assert!(
                            (out[j] - sum - b[j]).abs() < 1e-3,
                            "{inputs}×{outputs}, output {j}"
                        );
                    }
                }
            }
        }
    }
}
