//! Weights in single precision or its upper half.

use super::tile::TILE;
use pulp::{Arch, Simd, WithSimd};
use std::fmt::Debug;
use std::sync::Arc;

/// Weights of one input to the outputs of a tile, as they are kept.
pub(super) trait Row: Debug + Copy {
    fn pack(weights: &[f32; TILE]) -> Self;
    fn unpack(&self) -> [f32; TILE];
}

/// Single precision.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Single([f32; TILE]);

impl Row for Single {
    fn pack(weights: &[f32; TILE]) -> Self {
        Self(*weights)
    }

    #[inline(always)]
    fn unpack(&self) -> [f32; TILE] {
        self.0
    }
}

/// Upper halves: word `j` holds output `j` in its lower half and output `j + 16` in its upper one, so that a shift and a mask
/// unpack both.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Half([u32; TILE / 2]);

/// Upper half of a finite number, rounded to the nearest, to even on a tie.
fn upper(x: f32) -> u32 {
    let bits = x.to_bits();
    let rounded = bits + 0x7fff + (bits >> 16 & 1);
    // Beyond the largest number of this form: the largest instead of infinity.
    if f32::from_bits(rounded & 0xffff_0000).is_finite() {
        rounded >> 16
    } else {
        bits >> 16
    }
}

impl Row for Half {
    fn pack(weights: &[f32; TILE]) -> Self {
        Self(std::array::from_fn(|j| {
            upper(weights[j]) | upper(weights[j + TILE / 2]) << 16
        }))
    }

    #[inline(always)]
    fn unpack(&self) -> [f32; TILE] {
        let mut all = [0.0; TILE];
        for j in 0..TILE / 2 {
            all[j] = f32::from_bits(self.0[j] << 16);
            all[j + TILE / 2] = f32::from_bits(self.0[j] & 0xffff_0000);
        }
        all
    }
}

/// Tiles of weights, input by input.
#[derive(Debug, Clone)]
pub(super) struct Float<R> {
    tiles: Arc<[R]>,
    inputs: usize,
}

impl<R: Row> Float<R> {
    pub(super) fn new(weights: &[f32], inputs: usize) -> Self {
        let outputs = weights.len() / inputs;
        let starts = (0..outputs).step_by(TILE);
        let row = |start: usize, k: usize| {
            let mut tile = [0.0; TILE];
            let count = TILE.min(outputs - start);
            tile[..count].copy_from_slice(&weights[k * outputs + start..][..count]);
            R::pack(&tile)
        };
        Self {
            tiles: starts
                .flat_map(|start| (0..inputs).map(move |k| row(start, k)))
                .collect(),
            inputs,
        }
    }

    /// Adds x·W to `out` for at most [`ROWS`](super::tile::ROWS) rows.
    pub(super) fn add(&self, arch: Arch, x: &[f32], out: &mut [f32]) {
        match arch {
            Arch::Scalar => add::<R, false>(self, x, out),
            arch => arch.dispatch(Add {
                matrix: self,
                x,
                out,
            }),
        }
    }
}

/// Product for an instruction set with fused multiply-add. (A closure would not do: it is compiled for
/// the default instruction set and called.)
struct Add<'a, R> {
    matrix: &'a Float<R>,
    x: &'a [f32],
    out: &'a mut [f32],
}

impl<R: Row> WithSimd for Add<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        add::<R, true>(self.matrix, self.x, self.out);
    }
}

#[inline(always)]
fn add<R: Row, const FUSED: bool>(matrix: &Float<R>, x: &[f32], out: &mut [f32]) {
    match x.len() / matrix.inputs {
        1 => one::<R, FUSED>(matrix, x, out),
        2 => several::<R, 2, FUSED>(matrix, x, out),
        3 => several::<R, 3, FUSED>(matrix, x, out),
        _ => several::<R, 4, FUSED>(matrix, x, out),
    }
}

#[inline(always)]
fn accumulate<const FUSED: bool>(sum: &mut [f32; TILE], x: f32, weights: &[f32; TILE]) {
    for j in 0..TILE {
        sum[j] = if FUSED {
            x.mul_add(weights[j], sum[j])
        } else {
            x * weights[j] + sum[j]
        };
    }
}

/// One row. Even and odd inputs have sums of their own: an addition takes several cycles, and two chains hide that.
#[inline(always)]
fn one<R: Row, const FUSED: bool>(matrix: &Float<R>, x: &[f32], out: &mut [f32]) {
    let (out, _) = out.as_chunks_mut::<TILE>();
    let (pairs, last) = x.as_chunks::<2>();
    for (tile, out) in matrix.tiles.chunks_exact(matrix.inputs).zip(out) {
        let (rows, last_row) = tile.as_chunks::<2>();
        let (mut even, mut odd) = (*out, [0.0; TILE]);
        for (rows, x) in rows.iter().zip(pairs) {
            accumulate::<FUSED>(&mut even, x[0], &rows[0].unpack());
            accumulate::<FUSED>(&mut odd, x[1], &rows[1].unpack());
        }
        for (row, x) in last_row.iter().zip(last) {
            accumulate::<FUSED>(&mut even, *x, &row.unpack());
        }
        for j in 0..TILE {
            out[j] = even[j] + odd[j];
        }
    }
}

/// `B` rows: every weight is read once.
#[inline(always)]
fn several<R: Row, const B: usize, const FUSED: bool>(
    matrix: &Float<R>,
    x: &[f32],
    out: &mut [f32],
) {
    let inputs = matrix.inputs;
    let (out, _) = out.as_chunks_mut::<TILE>();
    let count = out.len() / B;
    let rows: [&[f32]; B] = std::array::from_fn(|b| &x[b * inputs..][..inputs]);
    for (t, tile) in matrix.tiles.chunks_exact(inputs).enumerate() {
        let mut sums: [[f32; TILE]; B] = std::array::from_fn(|b| out[b * count + t]);
        for (k, row) in tile.iter().enumerate() {
            let weights = row.unpack();
            for b in 0..B {
                accumulate::<FUSED>(&mut sums[b], rows[b][k], &weights);
            }
        }
        for b in 0..B {
            out[b * count + t] = sums[b];
        }
    }
}
