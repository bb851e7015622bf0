//! The published unit: encoder, attention, merge, re-encoder, dense output.

use feedforward::network::{Memory, Recurrent as Shape, Tensor};
use pulp::Arch;

use super::attention::{Attention, Weights};
use super::lstm::{Lstm, Widths};
use super::real::{Real, add_scaled, dot};
use super::span::{Dropout, Span};

/// Parameters of the recurrent network, or their gradients, in the order of the flat vector.
struct Parts<V> {
    /// Weight matrix and bias of the encoder LSTM.
    encoder: (V, V),
    /// Weights of the attention; none without one.
    attention: Option<Weights<V>>,
    /// Weight matrix and bias of the re-encoder LSTM.
    reencoder: (V, V),
    /// Weight and bias of the dense output.
    output: (V, V),
}

impl<V> Parts<V> {
    /// Parts from the tensors that `next` hands out in order.
    fn collect(attention: bool, mut next: impl FnMut() -> V) -> Self {
        Self {
            encoder: (next(), next()),
            attention: attention.then(|| Weights {
                query: next(),
                key: next(),
                bias: next(),
                score: next(),
            }),
            reencoder: (next(), next()),
            output: (next(), next()),
        }
    }
}

/// Recurrent network: forward and backward pass with their buffers.
#[derive(Debug)]
pub(crate) struct Recurrent<T> {
    arch: Arch,
    tensors: Vec<Tensor>,
    memory: Memory,
    encoder: Lstm<T>,
    attention: Option<Attention<T>>,
    reencoder: Lstm<T>,
    span: Span,
    /// Encoder states after dropout, one block of batch × encoder for each step.
    states: Vec<T>,
    /// Gradient of `states`, in their layout.
    state_gradient: Vec<T>,
    /// Re-encoder states after dropout, one block of batch × re-encoder per output step.
    heads: Vec<T>,
    /// Gradient ∂L/∂h of the hidden state in the present backward step.
    hidden_gradient: Vec<T>,
    /// Gradient ∂L/∂c of the cell state in the present backward step.
    cell_gradient: Vec<T>,
    /// Gradient ∂L/∂z of the layer's inputs in the present backward step.
    joined_gradient: Vec<T>,
}

impl<T: Real> Recurrent<T> {
    /// Network of this shape for `inputs` input columns. `tensors` lays out its parameters.
    pub(crate) fn new(shape: &Shape, inputs: usize, tensors: Vec<Tensor>) -> Self {
        let merged = if shape.attention.is_some() {
            2 * shape.encoder
        } else {
            shape.encoder
        };
        Self {
            arch: Arch::new(),
            tensors,
            memory: shape.memory,
            encoder: Lstm::new(Widths {
                input: inputs,
                hidden: shape.encoder,
            }),
            attention: shape
                .attention
                .map(|width| Attention::new(shape.encoder, width)),
            reencoder: Lstm::new(Widths {
                input: merged,
                hidden: shape.reencoder,
            }),
            span: Span::default(),
            states: Vec::new(),
            state_gradient: Vec::new(),
            heads: Vec::new(),
            hidden_gradient: Vec::new(),
            cell_gradient: Vec::new(),
            joined_gradient: Vec::new(),
        }
    }

    /// Starts a pass of this size.
    pub(crate) fn begin(&mut self, span: Span) {
        self.span = span;
        self.encoder.begin(span.batch, span.steps);
        self.reencoder.begin(span.batch, span.steps);
    }

    /// Input of step t of one row, to be written before [`Self::forward`].
    pub(crate) fn input_mut(&mut self, t: usize, row: usize) -> &mut [T] {
        self.encoder.input_mut(t, row)
    }

    /// Tensors of the network as parts of the flat vector `parameters`.
    fn parts<'a>(&self, parameters: &'a [T]) -> Parts<&'a [T]> {
        let mut tensors = self.tensors.iter();
        Parts::collect(self.attention.is_some(), || {
            tensors
                .next()
                .map_or(&[][..], |t| &parameters[t.range.clone()])
        })
    }

    /// Gradients of the tensors as parts of the flat vector `gradient`.
    fn parts_mut<'a>(&self, mut gradient: &'a mut [T]) -> Parts<&'a mut [T]> {
        let mut tensors = self.tensors.iter();
        Parts::collect(self.attention.is_some(), || {
            let size = tensors.next().map_or(0, |t| t.range.len());
            let (tensor, rest) = std::mem::take(&mut gradient).split_at_mut(size);
            gradient = rest;
            tensor
        })
    }

    /// States that step t attends to: the whole window, or the last ones of a carried sequence.
    fn attended(&self, t: usize) -> std::ops::Range<usize> {
        match self.memory {
            Memory::Window { .. } => 0..self.span.steps,
            Memory::Carried { attended } => (t + 1).saturating_sub(attended)..t + 1,
        }
    }

    /// Largest number of states that a step attends to.
    fn reach(&self) -> usize {
        match self.memory {
            Memory::Window { .. } => self.span.steps,
            Memory::Carried { attended } => attended.min(self.span.steps),
        }
    }

    /// Writes the outputs of the steps `span.first..span.steps`, (output step, row).
    pub(crate) fn forward(
        &mut self,
        parameters: &[T],
        dropout: Option<&Dropout<T>>,
        outputs: &mut [T],
    ) {
        let Span {
            batch,
            steps,
            first,
        } = self.span;
        let Parts {
            encoder,
            attention,
            reencoder,
            output,
        } = self.parts(parameters);
        let n = self.encoder.widths.hidden;
        let s = self.reencoder.widths.hidden;
        self.states.resize(steps * batch * n, T::ZERO);
        for t in 0..steps {
            self.encoder.step(self.arch, t, encoder.0, encoder.1);
            for row in 0..batch {
                self.states[(t * batch + row) * n..][..n]
                    .copy_from_slice(self.encoder.previous_row(t + 1, row));
            }
        }
        if let Some(dropout) = dropout {
            scale(&mut self.states, &dropout.encoder);
        }
        let reach = self.reach();
        if let (Some(net), Some(weights)) = (&mut self.attention, &attention) {
            net.begin(batch, steps, reach, &self.states, weights);
        }
        for t in 0..steps {
            for row in 0..batch {
                let h = &self.states[(t * batch + row) * n..][..n];
                self.reencoder.input_mut(t, row)[..n].copy_from_slice(h);
            }
            let attended = self.attended(t);
            if let (Some(net), Some(weights)) = (&mut self.attention, &attention) {
                net.ask((t > 0).then(|| self.reencoder.previous(t)), weights);
                net.context(
                    self.arch,
                    t,
                    attended,
                    &self.states,
                    weights.score,
                    self.reencoder.inputs_mut(t, n),
                );
            }
            self.reencoder.step(self.arch, t, reencoder.0, reencoder.1);
        }
        self.heads.resize((steps - first) * batch * s, T::ZERO);
        for (k, head) in self.heads.chunks_exact_mut(s).enumerate() {
            head.copy_from_slice(
                self.reencoder
                    .previous_row(first + k / batch + 1, k % batch),
            );
        }
        if let Some(dropout) = dropout {
            scale(&mut self.heads, &dropout.output);
        }
        for (y, head) in outputs.iter_mut().zip(self.heads.chunks_exact(s)) {
            *y = dot(head, output.0) + output.1[0];
        }
    }

    /// Adds the gradient of Σ outputs·`output_gradient` with respect to the parameters, after
    /// [`Self::forward`] with the same arguments.
    pub(crate) fn backward(
        &mut self,
        parameters: &[T],
        dropout: Option<&Dropout<T>>,
        output_gradient: &[T],
        gradient: &mut [T],
    ) {
        let Span {
            batch,
            steps,
            first,
        } = self.span;
        let weights = self.parts(parameters);
        let mut to = self.parts_mut(gradient);
        let (n, s) = (self.encoder.widths.hidden, self.reencoder.widths.hidden);
        let merged = self.reencoder.widths.input;

        clear(&mut self.state_gradient, steps * batch * n);
        clear(&mut self.hidden_gradient, batch * s);
        clear(&mut self.cell_gradient, batch * s);
        if let Some(net) = &mut self.attention {
            net.begin_back(steps);
        }
        for t in (0..steps).rev() {
            if t >= first {
                let rows = (t - first) * batch..(t - first + 1) * batch;
                for (row, k) in rows.enumerate() {
                    let d = output_gradient[k];
                    add_scaled(to.output.0, d, &self.heads[k * s..][..s]);
                    to.output.1[0] += d;
                    let hidden = &mut self.hidden_gradient[row * s..][..s];
                    match dropout {
                        Some(dropout) => {
                            let mask = &dropout.output[k * s..][..s];
                            hidden
                                .iter_mut()
                                .zip(weights.output.0)
                                .zip(mask)
                                .for_each(|((h, &w), &m)| *h += d * w * m);
                        }
                        None => add_scaled(hidden, d, weights.output.0),
                    }
                }
            }
            self.reencoder
                .step_back(self.arch, t, &self.hidden_gradient, &mut self.cell_gradient);
            let joined = if t > 0 { merged + s } else { merged };
            self.joined_gradient.resize(batch * joined, T::ZERO);
            self.reencoder.joined_gradient(
                t,
                weights.reencoder.0,
                0..joined,
                &mut self.joined_gradient,
            );
            for (row, z) in self.joined_gradient.chunks_exact(joined).enumerate() {
                add_scaled(
                    &mut self.state_gradient[(t * batch + row) * n..][..n],
                    T::ONE,
                    &z[..n],
                );
                if t > 0 {
                    self.hidden_gradient[row * s..][..s].copy_from_slice(&z[merged..]);
                }
            }
            let attended = self.attended(t);
            if let (Some(net), Some(weights), Some(to)) =
                (&mut self.attention, &weights.attention, &mut to.attention)
            {
                net.context_back(
                    self.arch,
                    t,
                    attended,
                    (&self.joined_gradient[n..], joined),
                    (&self.states, &mut self.state_gradient),
                    (weights.score, to.score),
                );
                if t > 0 {
                    net.ask_back(
                        self.reencoder.previous(t),
                        weights.query,
                        &mut self.hidden_gradient,
                        to.query,
                    );
                }
            }
        }
        if let (Some(net), Some(weights), Some(to)) =
            (&self.attention, &weights.attention, &mut to.attention)
        {
            net.end_back(
                (&self.states, &mut self.state_gradient),
                weights.key,
                to.key,
                to.bias,
            );
        }
        self.reencoder
            .weight_gradient(steps, to.reencoder.0, to.reencoder.1);

        if let Some(dropout) = dropout {
            scale(&mut self.state_gradient, &dropout.encoder);
        }
        clear(&mut self.hidden_gradient, batch * n);
        clear(&mut self.cell_gradient, batch * n);
        let inputs = self.encoder.widths.input;
        for t in (0..steps).rev() {
            let from_output = &self.state_gradient[t * batch * n..][..batch * n];
            add_scaled(&mut self.hidden_gradient, T::ONE, from_output);
            self.encoder
                .step_back(self.arch, t, &self.hidden_gradient, &mut self.cell_gradient);
            if t > 0 {
                self.encoder.joined_gradient(
                    t,
                    weights.encoder.0,
                    inputs..inputs + n,
                    &mut self.hidden_gradient,
                );
            }
        }
        self.encoder
            .weight_gradient(steps, to.encoder.0, to.encoder.1);
    }
}

/// Sets a buffer to `size` zeros.
fn clear<T: Real>(buffer: &mut Vec<T>, size: usize) {
    buffer.clear();
    buffer.resize(size, T::ZERO);
}

/// Multiplies values by the factors of dropout, element by element.
fn scale<T: Real>(values: &mut [T], mask: &[T]) {
    for (v, &m) in values.iter_mut().zip(mask) {
        *v = *v * m;
    }
}
