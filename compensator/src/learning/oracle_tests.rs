//! The same units composed of plain tensor operations of burn, in double precision: what the fused operation
//! has to equal. Shares nothing with the kernels but the layout of the parameters.

use std::ops::Range;

use burn::optim::GradientsParams;
use burn::tensor::activation::{sigmoid, softmax};
use burn::tensor::{DType, Device, Tensor, TensorData};
use feedforward::network::{Architecture, Memory, Recurrent};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::batch::Batch;
use super::operation::cost;
use super::weights::Weights;
use crate::config::Loss;
use crate::engine::{Dropout, Network, Span};

const INPUTS: usize = 4;

fn tensor<const D: usize>(values: impl IntoIterator<Item = f32>, shape: [usize; D]) -> Tensor<D> {
    let values: Vec<f64> = values.into_iter().map(f64::from).collect();
    let device = Device::flex().autodiff();
    Tensor::from_data(TensorData::new(values, shape), (&device, DType::F64))
}

/// A unit on burn's tensors.
struct Composed<'a> {
    architecture: &'a Architecture,
    flat: Tensor<1>,
}

/// Hidden and cell state, each (batch, width).
type State = (Tensor<2>, Tensor<2>);

impl Composed<'_> {
    fn parameter(&self, name: &str) -> Tensor<2> {
        let tensors = self.architecture.tensors(INPUTS).unwrap();
        let t = tensors.iter().find(|t| t.name == name).unwrap();
        let part = self.flat.clone().slice([t.range.clone()]);
        part.reshape(t.shape)
    }

    fn dense(&self, x: Tensor<2>, layer: &str) -> Tensor<2> {
        x.matmul(self.parameter(&format!("{layer}.weight")))
            + self.parameter(&format!("{layer}.bias"))
    }

    /// Gates in the order input, forget, cell, output, on [x; h].
    fn lstm(&self, layer: &str, x: Tensor<2>, (h, c): State) -> State {
        let width = c.dims()[1];
        let gates = self.dense(Tensor::cat(vec![x, h], 1), layer);
        let gate = |k: usize| gates.clone().narrow(1, k * width, width);
        let c = sigmoid(gate(1)) * c + sigmoid(gate(0)) * gate(2).tanh();
        (sigmoid(gate(3)) * c.clone().tanh(), c)
    }

    /// Σ_u α_u h_u over the attended states.
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
        states
            .iter()
            .enumerate()
            .map(|(u, h)| h.clone() * alpha.clone().narrow(1, u, 1))
            .reduce(|a, b| a + b)
            .unwrap()
    }

    /// Outputs in the order (step, row), shape (outputs, 1).
    fn outputs(&self, x: &[Tensor<2>], span: Span, dropout: Option<&Dropout<f32>>) -> Tensor<2> {
        let masked = |h: Tensor<2>, mask: Option<&[f32]>| match mask {
            Some(mask) => {
                let shape = h.dims();
                h * tensor(mask.iter().copied(), shape)
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
                let zero = |width| tensor(vec![0.0; span.batch * width], [span.batch, width]);
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
}

/// Mean cost of residuals (outputs, 1).
fn mean_cost(loss: Loss, residual: Tensor<2>, weights: &[f32]) -> Tensor<1> {
    let size = residual.abs();
    let linear = match loss {
        Loss::Mse => size.clone(),
        Loss::Huber { delta } => size.clone().clamp_max(f64::from(delta)),
    };
    let cost = linear.clone() * (size - linear * 0.5);
    let total: f64 = weights.iter().copied().map(f64::from).sum();
    let weights = tensor(weights.iter().copied(), [weights.len(), 1]);
    (cost * weights).sum() / total
}

/// Largest difference of the gradients relative to the largest gradient, and of the costs relative to it.
fn worst(architecture: &Architecture, span: Span, dropped: Option<f32>, loss: Loss) -> (f64, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut draw = |n: usize, size: f32| -> Vec<f32> {
        (0..n).map(|_| rng.random_range(-size..size)).collect()
    };
    let parameters = draw(architecture.parameter_count(INPUTS).unwrap(), 0.5);
    let inputs: Vec<Vec<f32>> = (0..span.steps)
        .map(|_| draw(span.batch * INPUTS, 1.5))
        .collect();
    let targets = draw(span.outputs(), 1.5);
    let weights: Vec<f32> = draw(span.outputs(), 1.0).iter().map(|w| w.abs()).collect();
    let dropout = dropped.map(|p| {
        let mut dropout = Dropout::default();
        dropout.draw(architecture, span, p, &mut ChaCha8Rng::seed_from_u64(5));
        dropout
    });

    let flat = tensor(parameters.iter().copied(), [parameters.len()]).require_grad();
    let composed = Composed {
        architecture,
        flat: flat.clone(),
    };
    let steps: Vec<Tensor<2>> = inputs
        .iter()
        .map(|x| tensor(x.iter().copied(), [span.batch, INPUTS]))
        .collect();
    let outputs = composed.outputs(&steps, span, dropout.as_ref());
    let residual = outputs - tensor(targets.iter().copied(), [span.outputs(), 1]);
    let expected_cost = mean_cost(loss, residual, &weights);
    let expected = flat.grad(&expected_cost.backward()).unwrap().into_data();
    let expected: Vec<f64> = expected.iter::<f64>().collect();
    let expected_cost = expected_cost.into_data().iter::<f64>().next().unwrap();

    let mut batch = Batch::new(Network::new(architecture, INPUTS).unwrap(), loss);
    batch.begin(span);
    for (t, x) in inputs.iter().enumerate() {
        for (row, x) in x.chunks_exact(INPUTS).enumerate() {
            batch.network.input_mut(t, row).copy_from_slice(x);
        }
    }
    batch.targets.extend(targets.into_iter().zip(weights));
    batch.dropout = dropout;
    let unit = Weights::new(parameters);
    let (fused, _) = cost(unit.tensor(), &mut batch).unwrap();
    let fused_cost = fused.clone().into_data().iter::<f64>().next().unwrap();
    // As part of a longer expression, so that the slope from above is not 1.
    let gradients = GradientsParams::from_grads((fused * 2.0).backward(), &unit);
    let gradient = gradients.get::<1>(unit.name()).unwrap().into_data();
    let difference = gradient
        .iter::<f64>()
        .zip(&expected)
        .fold(0.0_f64, |m, (a, b)| m.max((a / 2.0 - b).abs()));
    assert_eq!(gradient.shape().num_elements(), expected.len());
    let largest = expected.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    assert!(largest > 1e-3, "a gradient to speak of");
    (
        difference / largest,
        (fused_cost - expected_cost).abs() / expected_cost,
    )
}

#[test]
fn fused_cost_and_gradient_equal_the_composed_ones() {
    let recurrent = |attention, memory| {
        Architecture::Recurrent(Recurrent {
            encoder: 12,
            attention,
            reencoder: 9,
            memory,
        })
    };
    let window = Memory::Window { timestep: 3 };
    let carried = Memory::Carried { attended: 4 };
    let last = Span {
        batch: 16,
        steps: 3,
        first: 2,
    };
    let all = Span {
        batch: 5,
        steps: 11,
        first: 0,
    };
    let perceptron = |hidden: &[usize]| Architecture::Perceptron {
        hidden: hidden.to_vec(),
        timestep: 3,
    };
    let huber = Loss::Huber { delta: 0.7 };
    for (architecture, span, dropped, loss) in [
        (recurrent(None, window), last, None, Loss::Mse),
        (recurrent(None, window), last, Some(0.3), huber),
        (recurrent(Some(10), window), last, None, Loss::Mse),
        (recurrent(Some(10), window), last, None, huber),
        (recurrent(Some(10), window), last, Some(0.5), Loss::Mse),
        (recurrent(None, carried), all, None, Loss::Mse),
        (recurrent(Some(10), carried), all, None, Loss::Mse),
        (recurrent(Some(10), carried), all, Some(0.2), huber),
        (perceptron(&[8, 6]), last, None, Loss::Mse),
        (perceptron(&[8, 6]), last, Some(0.5), huber),
        (perceptron(&[]), last, None, Loss::Mse),
    ] {
        let (gradient, cost) = worst(&architecture, span, dropped, loss);
        println!(
            "{architecture:?}, dropout {dropped:?}, {loss:?}: gradient {gradient:.1e}, cost {cost:.1e}"
        );
        assert!(
            gradient < 1e-6 && cost < 1e-6,
            "{architecture:?}, dropout {dropped:?}, {loss:?}: gradient {gradient:e}, cost {cost:e}"
        );
    }
}
