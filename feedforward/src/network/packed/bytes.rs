//! A matrix of bytes and the bytes of the inputs at hand.

use super::tile::{ROWS, TILE};
use std::sync::Arc;

/// Inputs of a step: a processor multiplies and adds four bytes at once.
pub(super) const QUAD: usize = 4;
/// Largest weight.
const LARGEST: f32 = 127.0;
/// Number that an input of 1 becomes.
pub(super) const ONE: f32 = 32_767.0;

/// Weights of four inputs to the outputs of a tile, output by output.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Block(pub [[i8; QUAD]; TILE]);

/// What turns the sums of a tile into its outputs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// 128 times the sum of an output's weights: upper bytes of inputs are stored with 128 added.
    shift: [i32; TILE],
    /// Value of one unit of input times one of weight.
    unit: [f32; TILE],
}

/// Upper and lower bytes of an input row.
pub(super) type Bytes<'a> = (&'a [[u8; QUAD]], &'a [[u8; QUAD]]);
/// Sums of a tile for one row, with upper and with lower bytes.
pub(super) type Sums = [[i32; TILE]; 2];

/// Tiles of weights, and the bytes of the inputs at hand.
#[derive(Debug, Clone)]
pub(super) struct Matrix {
    pub blocks: Arc<[Block]>,
    pub scales: Arc<[Scale]>,
    pub inputs: usize,
    /// Blocks of a tile.
    pub quads: usize,
    /// Upper and lower bytes of the inputs' numbers, row by row.
    pub upper: Vec<[u8; QUAD]>,
    pub lower: Vec<[u8; QUAD]>,
}

impl Matrix {
    /// Rounds row-major `weights` (inputs × outputs).
    pub(super) fn new(weights: &[f32], inputs: usize) -> Self {
        let outputs = weights.len() / inputs;
        let (quads, tiles) = (inputs.div_ceil(QUAD), outputs.div_ceil(TILE));
        let mut blocks = vec![Block([[0; QUAD]; TILE]); quads * tiles];
        let none = Scale {
            shift: [0; TILE],
            unit: [0.0; TILE],
        };
        let mut scales = vec![none; tiles];
        for output in 0..outputs {
            let column = || (0..inputs).map(|k| weights[k * outputs + output]);
            let largest = column().fold(0.0_f32, |m, w| m.max(w.abs()));
            let (tile, j) = (output / TILE, output % TILE);
            let scale = &mut scales[tile];
            scale.unit[j] = largest / LARGEST / ONE;
            for (k, w) in column().enumerate().filter(|_| largest > 0.0) {
                let code = (w / largest * LARGEST).round_ties_even() as i8;
                scale.shift[j] += 128 * i32::from(code);
                blocks[tile * quads + k / QUAD].0[j][k % QUAD] = code;
            }
        }
        Self {
            blocks: blocks.into(),
            scales: scales.into(),
            inputs,
            quads,
            upper: vec![[0; QUAD]; quads * ROWS],
            lower: vec![[0; QUAD]; quads * ROWS],
        }
    }

    /// Bytes of the input row `b`.
    #[inline(always)]
    pub(super) fn row(&self, b: usize) -> Bytes<'_> {
        let of = b * self.quads..(b + 1) * self.quads;
        (&self.upper[of.clone()], &self.lower[of])
    }
}

impl Scale {
    /// Adds the value of `sums` to the outputs of a tile.
    #[inline(always)]
    pub(super) fn add(&self, [upper, lower]: &Sums, out: &mut [f32; TILE]) {
        for j in 0..TILE {
            let whole = 256.0 * (upper[j] - self.shift[j]) as f32 + lower[j] as f32;
            out[j] += whole * self.unit[j];
        }
    }
}
