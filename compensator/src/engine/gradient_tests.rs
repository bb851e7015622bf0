//! Outputs and gradients in f64 against PyTorch and against finite differences.

use feedforward::network::{Architecture, Memory, Recurrent};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;

use super::network::Network;
use super::span::{Dropout, Span};

const INPUTS: usize = 3;

fn recurrent(attention: Option<usize>, memory: Memory) -> Architecture {
    Architecture::Recurrent(Recurrent {
        encoder: 5,
        attention,
        reencoder: 4,
        memory,
    })
}

/// Largest difference between the analytic and the central-difference gradient of Σ c·y, relative to the
/// largest gradient.
fn worst(architecture: &Architecture, span: Span, dropped: Option<f32>) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let count = architecture.parameter_count(INPUTS).unwrap();
    let mut parameters: Vec<f64> = (0..count).map(|_| rng.random_range(-0.8..0.8)).collect();
    let inputs: Vec<f64> = (0..span.steps * span.batch * INPUTS)
        .map(|_| rng.random_range(-1.0..1.0))
        .collect();
    let c: Vec<f64> = (0..span.outputs())
        .map(|_| rng.random_range(-1.0..1.0))
        .collect();
    let mut dropout = Dropout::default();
    dropout.draw(architecture, span, dropped.unwrap_or(0.0), &mut rng);
    let dropout = dropped.map(|_| &dropout);
    let mut net = Network::<f64>::new(architecture, INPUTS).unwrap();
    let mut outputs = vec![0.0; span.outputs()];
    let mut loss = |net: &mut Network<f64>, parameters: &[f64]| -> f64 {
        net.begin(span);
        for t in 0..span.steps {
            for row in 0..span.batch {
                net.input_mut(t, row)
                    .copy_from_slice(&inputs[(t * span.batch + row) * INPUTS..][..INPUTS]);
            }
        }
        net.forward(parameters, dropout, &mut outputs);
        outputs.iter().zip(&c).map(|(y, c)| y * c).sum()
    };
    let mut gradient = vec![0.0; count];
    // A larger pass first: stale buffers must not leak into the one that counts.
    loss(&mut net, &parameters);
    net.backward(&parameters, dropout, &c, &mut gradient);
    gradient.fill(0.0);
    loss(&mut net, &parameters);
    net.backward(&parameters, dropout, &c, &mut gradient);
    let step = 1e-6;
    let mut difference: f64 = 0.0;
    for k in 0..count {
        let kept = parameters[k];
        parameters[k] = kept + step;
        let above = loss(&mut net, &parameters);
        parameters[k] = kept - step;
        let below = loss(&mut net, &parameters);
        parameters[k] = kept;
        difference = difference.max(((above - below) / (2.0 * step) - gradient[k]).abs());
    }
    difference / gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()))
}

#[test]
fn gradients_equal_finite_differences() {
    let window = Memory::Window { timestep: 4 };
    let last = Span {
        batch: 3,
        steps: 4,
        first: 3,
    };
    let carried = Memory::Carried { attended: 3 };
    let all = Span {
        batch: 2,
        steps: 6,
        first: 1,
    };
    let perceptron = Architecture::Perceptron {
        hidden: vec![6, 5],
        timestep: 4,
    };
    let linear = Architecture::Perceptron {
        hidden: vec![],
        timestep: 4,
    };
    for (architecture, span, dropout) in [
        (recurrent(None, window), last, None),
        (recurrent(Some(6), window), last, None),
        (recurrent(Some(6), window), last, Some(0.5)),
        (recurrent(Some(6), carried), all, None),
        (recurrent(Some(6), carried), all, Some(0.3)),
        (perceptron.clone(), last, None),
        (perceptron, last, Some(0.5)),
        (linear, last, None),
    ] {
        let worst = worst(&architecture, span, dropout);
        assert!(
            worst < 1e-8,
            "{architecture:?} dropout {dropout:?}: {worst:e}"
        );
    }
}

#[derive(Deserialize)]
struct Fixture {
    batch: usize,
    steps: usize,
    encoder: usize,
    reencoder: usize,
    input_columns: usize,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    name: String,
    attention: Option<usize>,
    attended: Option<usize>,
    inputs: Vec<f64>,
    parameters: Vec<f64>,
    outputs: Vec<f64>,
    slopes: Vec<f64>,
    gradient: Vec<f64>,
}

/// `fixtures/torch_reference.py` made the numbers.
#[test]
fn outputs_and_gradients_equal_pytorch() {
    let fixture: Fixture =
        serde_json::from_str(include_str!("../../fixtures/torch_reference.json")).unwrap();
    let Fixture {
        batch,
        steps,
        encoder,
        reencoder,
        input_columns,
        cases,
    } = fixture;
    assert_eq!(cases.len(), 3);
    for case in cases {
        let memory = match case.attended {
            None => Memory::Window { timestep: steps },
            Some(attended) => Memory::Carried { attended },
        };
        let first = if case.attended.is_none() {
            steps - 1
        } else {
            0
        };
        let architecture = Architecture::Recurrent(Recurrent {
            encoder,
            attention: case.attention,
            reencoder,
            memory,
        });
        let span = Span {
            batch,
            steps,
            first,
        };
        let mut net = Network::<f64>::new(&architecture, input_columns).unwrap();
        net.begin(span);
        for (k, x) in case.inputs.chunks_exact(input_columns).enumerate() {
            net.input_mut(k / batch, k % batch).copy_from_slice(x);
        }
        let mut outputs = vec![0.0; span.outputs()];
        net.forward(&case.parameters, None, &mut outputs);
        let mut gradient = vec![0.0; case.parameters.len()];
        net.backward(&case.parameters, None, &case.slopes, &mut gradient);
        let worst = |a: &[f64], b: &[f64]| {
            assert_eq!(a.len(), b.len());
            a.iter()
                .zip(b)
                .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
        };
        let (y, g) = (
            worst(&outputs, &case.outputs),
            worst(&gradient, &case.gradient),
        );
        assert!(
            y < 1e-12 && g < 1e-12,
            "{}: outputs {y:e}, gradients {g:e}",
            case.name
        );
    }
}
