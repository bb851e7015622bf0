//! Units composed of burn's plain tensor operations, in double precision, as reference of the fused operation.

use burn::optim::GradientsParams;
use burn::tensor::{DType, Device};
use feedforward::network::{Architecture, Memory, Recurrent};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::batch::Batch;
use super::composed::Composed;
use super::operation::cost;
use super::tensors::Tensors;
use super::weights::Weights;
use crate::config::Loss;
use crate::engine::{Dropout, Network, Span};

const INPUTS: usize = 4;

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

    let mut batch = Batch::new(Network::new(architecture, INPUTS).unwrap(), loss);
    batch.begin(span);
    for (t, x) in inputs.iter().enumerate() {
        for (row, x) in x.chunks_exact(INPUTS).enumerate() {
            batch.network.input_mut(t, row).copy_from_slice(x);
        }
    }
    batch.targets.extend(targets.into_iter().zip(weights));
    batch.dropout = dropout;

    let double = Tensors::on(Device::flex(), DType::F64, false);
    let flat = double
        .tensor(&parameters, [parameters.len()])
        .require_grad();
    let composed = Composed::new(architecture, INPUTS, flat.clone(), &double);
    let expected_cost = composed.cost(&mut batch);
    let expected = flat.grad(&expected_cost.backward()).unwrap().into_data();
    let expected: Vec<f64> = expected.iter::<f64>().collect();
    let expected_cost = expected_cost.into_data().iter::<f64>().next().unwrap();

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
