//! Fully connected network at run-time.

use pulp::{Arch, Simd, WithSimd};

use super::Weights;
use super::activation::tanh;
use super::architecture::Tensor;
use super::packed::{Packed, starts};

/// tanh of every element, in place.
struct Bend<'a>(&'a mut [f32]);

impl WithSimd for Bend<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for v in self.0 {
            *v = tanh(*v);
        }
    }
}

/// Packed layers with their activations.
#[derive(Debug, Clone)]
pub(super) struct Perceptron {
    layers: Vec<Layer>,
}

/// Layer with its bias, where its sums start, and their place.
#[derive(Debug, Clone)]
struct Layer {
    matrix: Packed,
    start: Vec<f32>,
    out: Vec<f32>,
}

impl Perceptron {
    pub(super) fn new(tensors: &[Tensor], parameters: &[f32]) -> Self {
        let layers = tensors.chunks_exact(2).map(|pair| {
            let matrix = Packed::new(
                &parameters[pair[0].range.clone()],
                pair[0].shape[0],
                Weights::F32,
            );
            let start = starts(&parameters[pair[1].range.clone()], matrix.padded(), 1);
            Layer {
                out: start.clone(),
                start,
                matrix,
            }
        });
        Self {
            layers: layers.collect(),
        }
    }

    /// Output for a flattened window, oldest sample first.
    pub(super) fn evaluate(&mut self, arch: Arch, window: &[f32]) -> f32 {
        let last = self.layers.len() - 1;
        for i in 0..self.layers.len() {
            let (before, rest) = self.layers.split_at_mut(i);
            let Layer { matrix, start, out } = &mut rest[0];
            let x = before.last().map_or(window, |layer| &layer.out);
            out.copy_from_slice(start);
            matrix.add(arch, &x[..matrix.inputs()], out);
            if i < last {
                arch.dispatch(Bend(out));
            }
        }
        self.layers[last].out[0]
    }
}
