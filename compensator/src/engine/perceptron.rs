//! Fully connected network with tanh hidden layers; without a hidden layer, a linear model.

use feedforward::network::Tensor;
use pulp::{Arch, Simd, WithSimd};

use super::matmul::{View, ViewMut, multiply, multiply_add};
use super::real::{Real, add_rows};
use super::span::{Dropout, Span};

/// Activation tanh of every element, in place.
struct Bend<'a, T>(&'a mut [T]);

impl<T: Real> WithSimd for Bend<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for v in self.0 {
            *v = v.tanh();
        }
    }
}

/// Fully connected network: forward and backward pass with their buffers.
#[derive(Debug)]
pub(crate) struct Perceptron<T> {
    arch: Arch,
    tensors: Vec<Tensor>,
    inputs: usize,
    batch: usize,
    /// Input of each layer (batch × its inputs), after activation and dropout.
    layers: Vec<Vec<T>>,
    /// Activations of the last hidden layer before dropout, from which the slope of tanh follows.
    kept: Vec<T>,
    gradient: Vec<T>,
    next: Vec<T>,
}

impl<T: Real> Perceptron<T> {
    /// Network with `inputs` columns per sample. The number of samples in a window follows from the first layer's rows.
    pub(crate) fn new(inputs: usize, tensors: Vec<Tensor>) -> Self {
        let layers = vec![Vec::new(); tensors.len() / 2];
        Self {
            arch: Arch::new(),
            tensors,
            inputs,
            batch: 0,
            layers,
            kept: Vec::new(),
            gradient: Vec::new(),
            next: Vec::new(),
        }
    }

    /// Makes room for a batch of this size.
    pub(crate) fn begin(&mut self, span: Span) {
        self.batch = span.batch;
        for (i, layer) in self.layers.iter_mut().enumerate() {
            layer.resize(span.batch * self.tensors[2 * i].shape[0], T::ZERO);
        }
    }

    /// Input of step t of one row, to be written before [`Self::forward`].
    pub(crate) fn input_mut(&mut self, t: usize, row: usize) -> &mut [T] {
        let width = self.tensors[0].shape[0];
        &mut self.layers[0][row * width + t * self.inputs..][..self.inputs]
    }

    /// Writes one output per row. Dropout acts on the last hidden layer.
    pub(crate) fn forward(
        &mut self,
        parameters: &[T],
        dropout: Option<&Dropout<T>>,
        outputs: &mut [T],
    ) {
        let last = self.layers.len() - 1;
        for i in 0..=last {
            let (weight, bias) = (&self.tensors[2 * i], &self.tensors[2 * i + 1]);
            let [rows, columns] = weight.shape;
            let (done, rest) = self.layers.split_at_mut(i + 1);
            let out = rest.first_mut().map_or(&mut *outputs, |next| &mut next[..]);
            for row in out.chunks_exact_mut(columns) {
                row.copy_from_slice(&parameters[bias.range.clone()]);
            }
            multiply_add(
                ViewMut::new(out, self.batch, columns, columns),
                View::new(&done[i], self.batch, rows, rows),
                View::new(&parameters[weight.range.clone()], rows, columns, columns),
            );
            if i < last {
                self.arch.dispatch(Bend(out));
            }
            if i + 1 == last {
                self.kept.clear();
                self.kept.extend_from_slice(out);
                if let Some(dropout) = dropout {
                    out.iter_mut()
                        .zip(&dropout.output)
                        .for_each(|(v, &m)| *v = *v * m);
                }
            }
        }
    }

    /// Adds the gradient of Σ outputs·`output_gradient` with respect to the parameters.
    pub(crate) fn backward(
        &mut self,
        parameters: &[T],
        dropout: Option<&Dropout<T>>,
        output_gradient: &[T],
        gradient: &mut [T],
    ) {
        let last = self.layers.len() - 1;
        self.gradient.clear();
        self.gradient.extend_from_slice(output_gradient);
        for i in (0..=last).rev() {
            let (weight, bias) = (&self.tensors[2 * i], &self.tensors[2 * i + 1]);
            let [rows, columns] = weight.shape;
            let delta = View::new(&self.gradient, self.batch, columns, columns);
            let input = View::new(&self.layers[i], self.batch, rows, rows);
            multiply_add(
                ViewMut::new(&mut gradient[weight.range.clone()], rows, columns, columns),
                input.t(),
                delta,
            );
            add_rows(&mut gradient[bias.range.clone()], &self.gradient);
            if i == 0 {
                break;
            }
            self.next.resize(self.batch * rows, T::ZERO);
            let weight = View::new(&parameters[weight.range.clone()], rows, columns, columns);
            multiply(
                ViewMut::new(&mut self.next, self.batch, rows, rows),
                delta,
                weight.t(),
            );
            let activated = if i == last {
                &self.kept
            } else {
                &self.layers[i]
            };
            if let (true, Some(dropout)) = (i == last, dropout) {
                self.next
                    .iter_mut()
                    .zip(&dropout.output)
                    .for_each(|(d, &m)| *d = *d * m);
            }
            self.next
                .iter_mut()
                .zip(activated)
                .for_each(|(d, &a)| *d = *d * (T::ONE - a * a));
            std::mem::swap(&mut self.gradient, &mut self.next);
        }
    }
}
