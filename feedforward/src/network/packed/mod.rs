//! Weight matrix packed for matrix × vector at run-time.

mod bytes;
mod float;
mod int8;
mod tile;
mod vnni;

use super::Weights;
use float::{Float, Half, Single};
use int8::Int8;
use pulp::Arch;
use tile::{ROWS, TILE};

/// Matrix W (inputs × outputs) cut into tiles of 32 outputs, each stored input by input, so one pass streams the weights in
/// order. The instruction set is chosen at run-time. Copies share the weights: a loop faster than the network has one state for
/// each of its periods, and all of them stay in the processor's cache.
#[derive(Debug, Clone)]
pub(super) struct Packed {
    store: Store,
    inputs: usize,
    /// Outputs rounded up to whole tiles.
    padded: usize,
}

#[derive(Debug, Clone)]
enum Store {
    F32(Float<Single>),
    Bf16(Float<Half>),
    Int8(Int8),
}

impl Packed {
    /// Packs row-major `weights` (inputs × outputs). With [`Weights::Int8`] inputs must lie within ±1.
    pub(super) fn new(weights: &[f32], inputs: usize, form: Weights) -> Self {
        let outputs = weights.len() / inputs;
        Self {
            store: match form {
                Weights::F32 => Store::F32(Float::new(weights, inputs)),
                Weights::Bf16 => Store::Bf16(Float::new(weights, inputs)),
                Weights::Int8 => Store::Int8(Int8::new(weights, inputs)),
            },
            inputs,
            padded: outputs.next_multiple_of(TILE),
        }
    }

    /// Length of a row of outputs: rounded up to whole tiles.
    pub(super) fn padded(&self) -> usize {
        self.padded
    }

    /// Number of inputs of the matrix.
    pub(super) fn inputs(&self) -> usize {
        self.inputs
    }

    /// Adds x·W to each row of `out` ([`Self::padded`] elements) for each row of `x` ([`Self::inputs`] elements).
    pub(super) fn add(&mut self, arch: Arch, x: &[f32], out: &mut [f32]) {
        let rows = x.chunks(ROWS * self.inputs);
        for (x, out) in rows.zip(out.chunks_mut(ROWS * self.padded)) {
            match &mut self.store {
                Store::F32(store) => store.add(arch, x, out),
                Store::Bf16(store) => store.add(arch, x, out),
                Store::Int8(store) => store.add(arch, x, out),
            }
        }
    }
}

/// `row` repeated `count` times, each followed by zeros up to `width`: where sums start.
pub(super) fn starts(row: &[f32], width: usize, count: usize) -> Vec<f32> {
    let mut all = vec![0.0; width * count];
    for start in all.chunks_exact_mut(width) {
        start[..row.len()].copy_from_slice(row);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest weight of [`error`].
    const LARGEST: f64 = 50.0 / 64.0;

    /// Largest difference from the plain product in double precision, over the inputs' sizes times the largest weight.
    fn error(form: Weights, inputs: usize, outputs: usize, rows: usize, arch: Arch) -> f64 {
        let w: Vec<f32> = (0..inputs * outputs)
            .map(|i| ((i * 37 % 101) as f32 - 50.0) / 64.0)
            .collect();
        let x: Vec<f32> = (0..rows * inputs)
            .map(|i| ((i * 29 % 83) as f32 - 41.0) / 41.0)
            .collect();
        let start: Vec<f32> = (0..outputs).map(|i| i as f32 / 64.0).collect();
        let mut packed = Packed::new(&w, inputs, form);
        let width = packed.padded();
        let mut out = starts(&start, width, rows);
        packed.add(arch, &x, &mut out);
        let mut worst = 0.0_f64;
        for (x, out) in x.chunks(inputs).zip(out.chunks(width)) {
            for j in 0..outputs {
                let terms = (0..inputs).map(|k| f64::from(x[k]) * f64::from(w[k * outputs + j]));
                let size: f64 = 1.0 + x.iter().map(|x| f64::from(x.abs()) * LARGEST).sum::<f64>();
                let sum = f64::from(start[j]) + terms.sum::<f64>();
                worst = worst.max((f64::from(out[j]) - sum).abs() / size);
            }
        }
        worst
    }

    #[test]
    fn equals_the_plain_product_whatever_the_shape_and_instruction_set() {
        for (inputs, outputs) in [(1, 1), (3, 40), (18, 512), (146, 33), (5, 64)] {
            for rows in 1..=6 {
                for arch in [Arch::new(), Arch::Scalar] {
                    for (form, most) in [
                        (Weights::F32, 1e-6),
                        // Half a unit in the last of eight bits; half a step of the largest weight in 127.
                        (Weights::Bf16, 1.0 / 512.0),
                        (Weights::Int8, 1.0 / 254.0 + 1e-4),
                    ] {
                        let worst = error(form, inputs, outputs, rows, arch);
                        assert!(
                            worst < most,
                            "{form:?}, {rows} × {inputs} × {outputs}: {worst}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn whole_numbers_are_the_same_on_every_instruction_set() {
        let w: Vec<f32> = (0..130 * 70).map(|i| (i as f32 * 0.37).sin()).collect();
        let x: Vec<f32> = (0..3 * 130).map(|i| (i as f32 * 0.71).cos()).collect();
        let mut packed = Packed::new(&w, 130, Weights::Int8);
        let mut sums = [Arch::new(), Arch::Scalar].map(|arch| {
            let mut out = vec![0.0; 3 * packed.padded()];
            packed.add(arch, &x, &mut out);
            out
        });
        let worst = |a: &[f32], b: &[f32]| {
            let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            differences.fold(0.0_f32, f32::max)
        };
        // One rounding: a fused multiplication has one, the others two.
        let [a, b] = &mut sums;
        assert!(worst(a, b) < 1e-5, "{}", worst(a, b));
    }
}
