//! Parameters of a network, and the network itself, unrolled over the window.

use feedforward::network::{Architecture, Recurrent, Tensor};

use super::graph::Graph;

/// Parameters of one network of a unit, by tensor.
pub(super) struct Member<'a> {
    /// Layout of the parameters.
    tensors: Vec<Tensor>,
    /// All parameters as one flat vector.
    parameters: &'a [f32],
}

impl<'a> Member<'a> {
    pub(super) fn new(architecture: &Architecture, inputs: usize, parameters: &'a [f32]) -> Self {
        Self {
            tensors: architecture.tensors(inputs).unwrap_or_default(),
            parameters,
        }
    }

    /// Number of tensors.
    pub(super) fn len(&self) -> usize {
        self.tensors.len()
    }

    /// Columns of tensor `i`.
    pub(super) fn columns(&self, i: usize) -> usize {
        self.tensors[i].shape[1]
    }

    /// Values of tensor `i`, row-major.
    pub(super) fn values(&self, i: usize) -> &'a [f32] {
        &self.parameters[self.tensors[i].range.clone()]
    }

    /// Adds tensors `i` and `i` + 1, an LSTM layer of `width` units, as the operator has it: W and R with a row for each gate
    /// in the order input, output, forget, cell, and biases of both.
    pub(super) fn layer(&self, g: &mut Graph, i: usize, width: usize) -> [String; 3] {
        let (weight, bias) = (self.values(i), self.values(i + 1));
        let inputs = self.tensors[i].shape[0] - width;
        let rows = [0, 3, 1, 2].map(|gate| gate * width..(gate + 1) * width);
        let rows = rows.into_iter().flatten();
        let transposed = |from: std::ops::Range<usize>| -> Vec<f32> {
            let row = |row: usize| from.clone().map(move |k| weight[k * 4 * width + row]);
            rows.clone().flat_map(row).collect()
        };
        let w = transposed(0..inputs);
        let r = transposed(inputs..inputs + width);
        let mut b: Vec<f32> = rows.map(|row| bias[row]).collect();
        b.resize(8 * width, 0.0);
        [
            g.constant(&[1, 4 * width, inputs], w),
            g.constant(&[1, 4 * width, width], r),
            g.constant(&[1, 8 * width], b),
        ]
    }

    /// Adds tensor `i` as a constant; returns its name.
    pub(super) fn constant(&self, g: &mut Graph, i: usize) -> String {
        g.constant(&self.tensors[i].shape, self.values(i).to_vec())
    }

    /// Adds tensor `i`, which has one row, as a column vector; returns its name.
    pub(super) fn column(&self, g: &mut Graph, i: usize) -> String {
        let [rows, columns] = self.tensors[i].shape;
        g.constant(&[columns, rows], self.values(i).to_vec())
    }
}

/// Normalised output (batch × 1) of one member for the held samples, oldest first.
pub(super) fn output(
    g: &mut Graph,
    architecture: &Architecture,
    inputs: usize,
    parameters: &[f32],
    samples: &[String],
) -> String {
    let member = Member::new(architecture, inputs, parameters);
    match architecture {
        Architecture::Recurrent(shape) => recurrent(g, shape, &member, samples),
        Architecture::Perceptron { hidden, .. } => {
            let parts: Vec<&str> = samples.iter().map(String::as_str).collect();
            let mut x = g.concatenate(&parts);
            for i in 0..=hidden.len() {
                let (w, b) = (member.constant(g, 2 * i), member.constant(g, 2 * i + 1));
                x = g.op("Gemm", &[&x, &w, &b]);
                if i < hidden.len() {
                    x = g.op("Tanh", &[&x]);
                }
            }
            x
        }
    }
}

/// State of an LSTM layer; none before the first step, when the state is zero.
type State = Option<(String, String)>;

/// Output (batch × 1) of a recurrent network, unrolled over the samples of the window.
fn recurrent(g: &mut Graph, shape: &Recurrent, member: &Member, samples: &[String]) -> String {
    let tail = member.tensors.len() - 4;
    let encoder = (member.constant(g, 0), member.constant(g, 1));
    let reencoder = (member.constant(g, tail), member.constant(g, tail + 1));
    let mut state = None;
    let mut states = Vec::new();
    for x in samples {
        let zero = zeros(
            g,
            x,
            member.tensors[0].shape[0] - shape.encoder,
            shape.encoder,
        );
        let next = lstm(g, x, &zero, state, &encoder);
        states.push(next.0.clone());
        state = Some(next);
    }
    let attention = shape.attention.map(|_| {
        let query = member.constant(g, 2);
        let (key, bias, score) = (
            member.constant(g, 3),
            member.constant(g, 4),
            member.column(g, 5),
        );
        let keys: Vec<String> = states
            .iter()
            .map(|h| g.op("Gemm", &[h, &key, &bias]))
            .collect();
        (query, keys, score)
    });
    let mut state: State = None;
    for h in &states {
        let zero = zeros(g, h, shape.encoder, shape.reencoder);
        let mut merged = h.clone();
        if let Some((query, keys, score)) = &attention {
            let s = state.as_ref().map_or(&zero, |(s, _)| s);
            let asked = g.op("MatMul", &[s, query]);
            let scores: Vec<String> = keys
                .iter()
                .map(|key| {
                    let sum = g.op("Add", &[key, &asked]);
                    let bent = g.op("Tanh", &[&sum]);
                    g.op("MatMul", &[&bent, score])
                })
                .collect();
            let context = weighted(g, &scores, &states);
            merged = g.concatenate(&[h, &context]);
        }
        state = Some(lstm(g, &merged, &zero, state, &reencoder));
    }
    let (weight, bias) = (member.constant(g, tail + 2), member.constant(g, tail + 3));
    let s = state.map_or_else(String::new, |(s, _)| s);
    g.op("Gemm", &[&s, &weight, &bias])
}

/// Zeros of (batch × columns), made from x (batch × width).
pub(super) fn zeros(g: &mut Graph, x: &str, width: usize, columns: usize) -> String {
    let nothing = g.constant(&[width, columns], vec![0.0; width * columns]);
    g.op("MatMul", &[x, &nothing])
}

/// Step of an LSTM layer (equations 14–18): names of hidden and cell state after it.
fn lstm(
    g: &mut Graph,
    x: &str,
    zero: &str,
    state: State,
    (weight, bias): &(String, String),
) -> (String, String) {
    let before = state.unwrap_or_else(|| (zero.to_owned(), zero.to_owned()));
    let joined = g.concatenate(&[x, &before.0]);
    let gates = g.op("Gemm", &[&joined, weight, bias]);
    let gates = g.split(&gates, 4);
    let [i, f, o] = [0, 1, 3].map(|k| g.op("Sigmoid", &[&gates[k]]));
    let cell = g.op("Tanh", &[&gates[2]]);
    let kept = g.op("Mul", &[&f, &before.1]);
    let added = g.op("Mul", &[&i, &cell]);
    let c = g.op("Add", &[&kept, &added]);
    let bent = g.op("Tanh", &[&c]);
    (g.op("Mul", &[&o, &bent]), c)
}

/// Weighted sum Σ softmax(scores)·states.
fn weighted(g: &mut Graph, scores: &[String], states: &[String]) -> String {
    let parts: Vec<&str> = scores.iter().map(String::as_str).collect();
    let all = g.concatenate(&parts);
    let alpha = g.softmax(&all);
    let alpha = g.split(&alpha, scores.len());
    let mut sum: Option<String> = None;
    for (a, h) in alpha.iter().zip(states) {
        let part = g.op("Mul", &[h, a]);
        sum = Some(match sum {
            None => part,
            Some(before) => g.op("Add", &[&before, &part]),
        });
    }
    sum.unwrap_or_default()
}
