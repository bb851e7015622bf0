//! A unit composed of burn's plain tensor operations: for all backends of burn, and as reference of the fused
//! operation. It shares nothing with the kernels but the layout of the parameters.

use std::collections::BTreeMap;
use std::ops::Range;

use burn::optim::GradientsParams;
use burn::tensor::Tensor;
use burn::tensor::activation::{sigmoid, softmax};
use feedforward::network::{Architecture, Memory};

use super::batch::{Batch, Cost};
use super::operation::NotFinite;
use super::tensors::Tensors;
use super::weights::Weights;
use crate::config::Loss;
use crate::engine::{Dropout, Span};

/// Cost computed by burn's plain tensor operations instead of the kernels, and what that needs.
#[derive(Debug, Clone)]
pub(crate) struct Means {
    /// Device on which the operations run.
    pub(crate) tensors: Tensors,
    /// Architecture of the network.
    pub(crate) architecture: Architecture,
    /// Number of input columns of the network.
    pub(crate) inputs: usize,
}

impl Means {
    /// Gradient of the batch's mean cost, and the cost.
    ///
    /// # Errors
    /// Cost or gradient that is not finite.
    pub(super) fn gradients(
        &self,
        weights: &Weights,
        batch: &mut Batch,
    ) -> Result<(GradientsParams, Cost), NotFinite> {
        let flat = weights.tensor();
        let composed = Composed::new(&self.architecture, self.inputs, flat, &self.tensors);
        let mean = composed.cost(batch);
        let weight = batch.weight();
        let sum = weight * number(mean.clone());
        if !sum.is_finite() {
            return Err(NotFinite::Loss);
        }
        let gradients = GradientsParams::from_grads(mean.backward(), weights);
        let norm_squared = gradients
            .get::<1>(weights.name())
            .map_or(0.0, |g| number(g.powi_scalar(2).sum()) as f32);
        if !norm_squared.is_finite() {
            return Err(NotFinite::Gradient);
        }
        let cost = Cost {
            sum,
            weight,
            norm_squared,
        };
        Ok((gradients, cost))
    }
}

/// Network composed of burn's plain tensor operations.
pub(super) struct Composed<'a> {
    /// Architecture of the network.
    architecture: &'a Architecture,
    /// Number of input columns of the network.
    inputs: usize,
    /// Parameters by name.
    parameters: BTreeMap<String, Tensor<2>>,
    /// Device on which the operations run.
    on: &'a Tensors,
}

/// Hidden and cell state, each (batch, width).
type State = (Tensor<2>, Tensor<2>);

impl<'a> Composed<'a> {
    /// Network with the parameters `flat`, which [`Architecture::tensors`] lays out.
    pub(super) fn new(
        architecture: &'a Architecture,
        inputs: usize,
        flat: Tensor<1>,
        on: &'a Tensors,
    ) -> Self {
        let tensors = architecture.tensors(inputs).unwrap_or_default();
        let part = |range| flat.clone().slice([range]);
        Self {
            architecture,
            inputs,
            parameters: tensors
                .into_iter()
                .map(|t| (t.name, part(t.range).reshape(t.shape)))
                .collect(),
            on,
        }
    }

    /// Mean cost of the batch, differentiable in the parameters; the weights must not all be zero.
    pub(super) fn cost(&self, batch: &mut Batch) -> Tensor<1> {
        let span = batch.span();
        let steps: Vec<Tensor<2>> = (0..span.steps)
            .map(|t| {
                let rows = (0..span.batch).flat_map(|row| batch.network.input_mut(t, row).to_vec());
                let values: Vec<f32> = rows.collect();
                self.on.tensor(&values, [span.batch, self.inputs])
            })
            .collect();
        let outputs = self.outputs(&steps, span, batch.dropout.as_ref());
        let (targets, weights): (Vec<f32>, Vec<f32>) = batch.targets.iter().copied().unzip();
        let residual = outputs - self.on.tensor(&targets, [span.outputs(), 1]);
        self.mean_cost(batch.loss(), residual, &weights, batch.weight())
    }

    /// Weighted mean of the loss of all residuals. `total` is the sum of the weights.
    fn mean_cost(&self, loss: Loss, residual: Tensor<2>, weights: &[f32], total: f64) -> Tensor<1> {
        let size = residual.abs();
        let linear = match loss {
            Loss::Mse => size.clone(),
            Loss::Huber { delta } => size.clone().clamp_max(f64::from(delta)),
        };
        let cost = linear.clone() * (size - linear * 0.5);
        (cost * self.on.tensor(weights, [weights.len(), 1])).sum() / total
    }

    /// Outputs in the order (step, row), shape (outputs, 1).
    fn outputs(&self, x: &[Tensor<2>], span: Span, dropout: Option<&Dropout<f32>>) -> Tensor<2> {
        let masked = |h: Tensor<2>, mask: Option<&[f32]>| match mask {
            Some(mask) => {
                let shape = h.dims();
                h * self.on.tensor(mask, shape)
            }
            None => h,
        };
        match self.architecture {
            Architecture::Perceptron { hidden, .. } => {
                let mut y = Tensor::cat(x.to_vec(), 1);
                for k in 0..=hidden.len() {
                    y = self.dense(y, &format!("layer{k}"));
                    if k < hidden.len() {
                        y = y.tanh();
                    }
                    if k + 1 == hidden.len() {
                        y = masked(y, dropout.map(|d| &d.output[..]));
                    }
                }
                y
            }
            Architecture::Recurrent(shape) => {
                let zero = |width| {
                    let zeros = vec![0.0; span.batch * width];
                    self.on.tensor(&zeros, [span.batch, width])
                };
                let mut state = (zero(shape.encoder), zero(shape.encoder));
                let mut states = Vec::new();
                let block = span.batch * shape.encoder;
                for (t, x) in x.iter().enumerate() {
                    state = self.lstm("encoder", x.clone(), state);
                    let mask = dropout.map(|d| &d.encoder[t * block..][..block]);
                    states.push(masked(state.0.clone(), mask));
                }
                let mut s = (zero(shape.reencoder), zero(shape.reencoder));
                let mut heads = Vec::new();
                for t in 0..span.steps {
                    let seen: Range<usize> = match shape.memory {
                        Memory::Window { .. } => 0..span.steps,
                        Memory::Carried { attended } => (t + 1).saturating_sub(attended)..t + 1,
                    };
                    let mut merged = vec![states[t].clone()];
                    if shape.attention.is_some() {
                        merged.push(self.context(&states[seen], &s.0));
                    }
                    s = self.lstm("reencoder", Tensor::cat(merged, 1), s);
                    if t >= span.first {
                        heads.push(s.0.clone());
                    }
                }
                let heads = Tensor::cat(heads, 0);
                self.dense(masked(heads, dropout.map(|d| &d.output[..])), "output")
            }
        }
    }

    /// Parameter of the network by its name.
    fn parameter(&self, name: &str) -> Tensor<2> {
        self.parameters[name].clone()
    }

    /// Dense layer: x·W + b.
    fn dense(&self, x: Tensor<2>, layer: &str) -> Tensor<2> {
        x.matmul(self.parameter(&format!("{layer}.weight")))
            + self.parameter(&format!("{layer}.bias"))
    }

    /// Step of an LSTM layer: hidden and cell state after the input `x`. The gates of [x; h] are in the order input,
    /// forget, cell, output.
    fn lstm(&self, layer: &str, x: Tensor<2>, (h, c): State) -> State {
        let width = c.dims()[1];
        let gates = self.dense(Tensor::cat(vec![x, h], 1), layer);
        let gate = |k: usize| gates.clone().narrow(1, k * width, width);
        let c = sigmoid(gate(1)) * c + sigmoid(gate(0)) * gate(2).tanh();
        (sigmoid(gate(3)) * c.clone().tanh(), c)
    }

    /// Context vector Σ_u α_u h_u of the attention over `states`, at least one, for the re-encoder state `s`.
    fn context(&self, states: &[Tensor<2>], s: &Tensor<2>) -> Tensor<2> {
        let score = self.parameter("attention.score");
        let width = score.dims().iter().product::<usize>();
        let score = score.reshape([width, 1]);
        let asked = s.clone().matmul(self.parameter("attention.query"));
        let energy = states.iter().map(|h| {
            let key = h.clone().matmul(self.parameter("attention.key"));
            let bent = (key + asked.clone() + self.parameter("attention.bias")).tanh();
            bent.matmul(score.clone())
        });
        let alpha = softmax(Tensor::cat(energy.collect(), 1), 1);
        let seen = Tensor::stack::<3>(states.to_vec(), 1);
        let [rows, count, width] = seen.dims();
        let weighted = seen * alpha.reshape([rows, count, 1]);
        weighted.sum_dim(1).reshape([rows, width])
    }
}

/// Value of a tensor with one element.
fn number(tensor: Tensor<1>) -> f64 {
    let data = tensor.into_data();
    data.iter::<f64>().next().unwrap_or(f64::NAN)
}
