//! Sums by AVX-512 VNNI, which multiplies 64 bytes by 64 and adds them by fours.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
pub(super) use x86::Vnni;

/// Instructions that this kind of processor does not have.
#[cfg(not(target_arch = "x86_64"))]
#[derive(Debug, Clone, Copy)]
pub(super) enum Vnni {}

#[cfg(not(target_arch = "x86_64"))]
impl Vnni {
    pub(super) fn new() -> Option<Self> {
        None
    }

    pub(super) fn add(self, _: &super::bytes::Matrix, _: usize, _: &mut [f32]) {
        match self {}
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::super::bytes::{Block, Bytes, Matrix, Sums};
    use super::super::tile::TILE;
    use std::arch::x86_64::{
        __m512i, _mm512_add_epi32, _mm512_dpbusd_epi32, _mm512_loadu_si512, _mm512_set1_epi32,
        _mm512_setzero_si512, _mm512_storeu_si512,
    };

    /// Proof that the processor has the instructions.
    #[derive(Debug, Clone, Copy)]
    pub(crate) struct Vnni(());

    impl Vnni {
        pub(crate) fn new() -> Option<Self> {
            std::is_x86_feature_detected!("avx512vnni").then_some(Self(()))
        }

        /// Adds the sums of `rows` input rows, at most four, to `out`.
        pub(crate) fn add(self, matrix: &Matrix, rows: usize, out: &mut [f32]) {
            // SAFETY: the processor was found to know AVX-512 VNNI, which includes AVX-512F.
            unsafe {
                match rows {
                    1 => several::<1, 2>(matrix, out),
                    2 => several::<2, 1>(matrix, out),
                    3 => several::<3, 1>(matrix, out),
                    _ => several::<4, 1>(matrix, out),
                }
            }
        }
    }

    /// `B` rows, every weight read once. `C` chains of sums take turns: an addition takes several cycles, and more chains hide that.
    #[target_feature(enable = "avx512f,avx512vnni")]
    fn several<const B: usize, const C: usize>(matrix: &Matrix, out: &mut [f32]) {
        let (out, _) = out.as_chunks_mut::<TILE>();
        let count = matrix.scales.len();
        let rows: [_; B] = std::array::from_fn(|b| matrix.row(b));
        let tiles = matrix.blocks.chunks_exact(matrix.quads);
        for (t, (tile, scale)) in tiles.zip(&matrix.scales[..]).enumerate() {
            let mut chains = [[[[_mm512_setzero_si512(); 2]; 2]; B]; C];
            let (groups, rest) = tile.as_chunks::<C>();
            for (group, blocks) in groups.iter().enumerate() {
                for c in 0..C {
                    add_quad(&mut chains[c], &blocks[c], &rows, group * C + c);
                }
            }
            for (c, block) in rest.iter().enumerate() {
                add_quad(&mut chains[0], block, &rows, groups.len() * C + c);
            }
            for b in 0..B {
                let mut sums = chains[0][b];
                for chain in &chains[1..] {
                    for part in 0..2 {
                        for half in 0..2 {
                            sums[part][half] =
                                _mm512_add_epi32(sums[part][half], chain[b][part][half]);
                        }
                    }
                }
                scale.add(&store(&sums), &mut out[b * count + t]);
            }
        }
    }

    /// Sums of a row, with upper and with lower bytes, each for two halves of the tile.
    type Registers = [[__m512i; 2]; 2];

    #[inline]
    #[target_feature(enable = "avx512f,avx512vnni")]
    fn add_quad<const B: usize>(
        sums: &mut [Registers; B],
        block: &Block,
        rows: &[Bytes<'_>; B],
        quad: usize,
    ) {
        let halves = load(block);
        for b in 0..B {
            let (upper, lower) = rows[b];
            for (x, sums) in [upper[quad], lower[quad]].iter().zip(&mut sums[b]) {
                let x = _mm512_set1_epi32(i32::from_le_bytes(*x));
                sums[0] = _mm512_dpbusd_epi32(sums[0], x, halves[0]);
                sums[1] = _mm512_dpbusd_epi32(sums[1], x, halves[1]);
            }
        }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn load(block: &Block) -> [__m512i; 2] {
        let bytes = block.0.as_flattened();
        // SAFETY: a block has 128 bytes, and the load needs no alignment.
        unsafe {
            [
                _mm512_loadu_si512(bytes.as_ptr().cast()),
                _mm512_loadu_si512(bytes[64..].as_ptr().cast()),
            ]
        }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn store(sums: &Registers) -> Sums {
        let mut all = [[0; TILE]; 2];
        for (all, sums) in all.iter_mut().zip(sums) {
            let (low, high) = all.split_at_mut(TILE / 2);
            // SAFETY: each half has 16 numbers of 32 bits, and the store needs no alignment.
            unsafe {
                _mm512_storeu_si512(low.as_mut_ptr().cast(), sums[0]);
                _mm512_storeu_si512(high.as_mut_ptr().cast(), sums[1]);
            }
        }
        all
    }
}
