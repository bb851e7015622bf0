//! Graph of a compensator for one sample at a time: what its networks remember goes in and comes out.
//!
//! The layout is that of an LSTM in Newton's neural drives: sample (1 × batch × columns), hidden state `h` and cell state `c`
//! (1 × batch × [`hidden_size`](super::hidden_size)) in, torque (batch × joints) and both states after the sample out. Zeros are
//! the start of a motion. Operators are those that Warp-NN can differentiate, too: it neither gathers nor
//! concatenates, and multiplies values of one shape alone.

use feedforward::network::{Architecture, Compensator, Memory, Recurrent, Unit};

use super::graph::{CELL, Graph, HIDDEN, NEXT_CELL, NEXT_HIDDEN, OUTPUT, Port, SAMPLE};
use super::network::{Member, zeros};
use super::state::{Place, State, earlier, hidden_size};
use super::{bounded, hold, scale};
use crate::Error;

/// Added to the score of a state that lies before the start of a motion: its weight is exactly zero.
const NEVER: f32 = -1e9;

/// Serialised ONNX model of a whole compensator for one sample at a time, units with carried state included.
///
/// `metadata` is the model's property of that name.
///
/// # Errors
/// [`Error::Unit`] for a unit that contradicts itself.
pub fn export_steps(compensator: &Compensator, metadata: &str) -> Result<Vec<u8>, Error> {
    let (joints, columns) = (compensator.joints.len(), compensator.inputs.len());
    let mut g = Graph::default();
    let mut state = State::new(compensator);
    let mut torques = Vec::new();
    for unit in &compensator.units {
        unit.check(joints, columns).map_err(Error::Unit)?;
        if unit.enabled {
            let own = g.pick(SAMPLE, columns, &unit.columns);
            let torque = torque(&mut g, &mut state, unit, &own);
            torques.push(g.place(&torque, 1, unit.joint, joints));
        }
    }
    if torques.is_empty() {
        torques.push(zeros(&mut g, SAMPLE, columns, joints));
    }
    let torque = g.sum(torques);
    g.squeeze(&torque, OUTPUT);
    state.finish(&mut g);
    let tensor = |name, width| Port {
        name,
        shape: vec![Some(1), None, Some(width)],
    };
    let size = hidden_size(compensator);
    let inputs = [
        tensor(SAMPLE, columns),
        tensor(HIDDEN, size),
        tensor(CELL, size),
    ];
    let outputs = [
        Port {
            name: OUTPUT,
            shape: vec![None, Some(joints)],
        },
        tensor(NEXT_HIDDEN, size),
        tensor(NEXT_CELL, size),
    ];
    Ok(g.encode("compensator", &inputs, &outputs, metadata))
}

/// Torque (1 × batch × 1) of a unit for the newest sample of its columns.
fn torque(g: &mut Graph, state: &mut State, unit: &Unit, sample: &str) -> String {
    let scaled = scale(g, unit, sample);
    let held = hold(g, unit, &scaled);
    let (d, architecture) = (unit.columns.len(), &unit.architecture);
    let samples = window(g, state, &held, d, architecture.timestep());
    let mut outputs = Vec::new();
    for parameters in &unit.members {
        let member = Member::new(architecture, d, parameters);
        outputs.push(match architecture {
            Architecture::Perceptron { hidden, .. } => {
                perceptron(g, &member, hidden.len(), d, &samples)
            }
            Architecture::Recurrent(shape) => match shape.memory {
                Memory::Window { .. } => windowed(g, shape, &member, &samples),
                Memory::Carried { .. } => carried(g, state, shape, &member, &held),
            },
        });
    }
    bounded(g, unit, outputs, &scaled)
}

/// The last `timestep` samples, oldest first, the newest of which is given. Before the start of a motion its first sample repeats.
fn window(
    g: &mut Graph,
    state: &mut State,
    newest: &str,
    columns: usize,
    timestep: usize,
) -> Vec<String> {
    if timestep == 1 {
        return vec![newest.to_owned()];
    }
    // One, once a sample has been seen.
    let flag = state.take(1);
    let begun = state.repeated(g, flag, columns);
    let (fresh, _) = rest(g, &begun);
    let first = g.op("Mul", &[newest, &fresh]);
    let places: Vec<Place> = (1..timestep).map(|_| state.take(columns)).collect();
    let mut samples: Vec<String> = places
        .iter()
        .map(|&place| {
            let stored = state.hidden(g, place);
            let stored = g.op("Mul", &[&stored, &begun]);
            g.op("Add", &[&stored, &first])
        })
        .collect();
    samples.push(newest.to_owned());
    for (&place, next) in places.iter().zip(&samples[1..]) {
        state.keep_hidden(g, next, place);
    }
    let begun = state.hidden(g, flag);
    let (_, one) = rest(g, &begun);
    state.keep_hidden(g, &one, flag);
    samples
}

/// 1 − x, and their sum, which is one in the shape of x.
fn rest(g: &mut Graph, x: &str) -> (String, String) {
    let one = g.constant(&[1], vec![1.0]);
    let rest = g.op("Sub", &[&one, x]);
    let whole = g.op("Add", &[x, &rest]);
    (rest, whole)
}

/// Output (1 × batch × 1) of a perceptron over samples of `columns` each: its first matrix in parts, one for each sample.
fn perceptron(
    g: &mut Graph,
    member: &Member,
    hidden: usize,
    columns: usize,
    samples: &[String],
) -> String {
    let width = member.columns(0);
    let parts = samples.iter().zip(member.values(0).chunks(columns * width));
    let parts = parts
        .map(|(x, rows)| {
            let weight = g.constant(&[columns, width], rows.to_vec());
            g.op("MatMul", &[x, &weight])
        })
        .collect();
    let mut sum = g.sum(parts);
    for layer in 0..=hidden {
        if layer > 0 {
            let bent = g.op("Tanh", &[&sum]);
            let weight = member.constant(g, 2 * layer);
            sum = g.op("MatMul", &[&bent, &weight]);
        }
        let bias = member.constant(g, 2 * layer + 1);
        sum = g.op("Add", &[&sum, &bias]);
    }
    sum
}

/// Layers of a recurrent network as ONNX has them.
struct Layers {
    encoder: [String; 3],
    reencoder: [String; 3],
    /// Query, key, its bias, and score as a column; none without attention.
    attention: Option<[String; 4]>,
    /// Number of tensors before those of the re-encoder.
    tail: usize,
}

impl Layers {
    fn new(g: &mut Graph, shape: &Recurrent, member: &Member) -> Self {
        let tail = member.len() - 4;
        Self {
            encoder: member.layer(g, 0, shape.encoder),
            reencoder: member.layer(g, tail, shape.reencoder),
            attention: shape.attention.map(|_| {
                let [query, key, bias] = [2, 3, 4].map(|i| member.constant(g, i));
                [query, key, bias, member.column(g, 5)]
            }),
            tail,
        }
    }

    /// Key W_h h + b_a of an encoder state; empty without attention.
    fn key(&self, g: &mut Graph, state: &str) -> String {
        let Some([_, key, bias, _]) = &self.attention else {
            return String::new();
        };
        let product = g.op("MatMul", &[state, key]);
        g.op("Add", &[&product, bias])
    }

    /// Step of the re-encoder on the newest encoder state, with the context of `seen`: states, keys, and what is added to their
    /// scores.
    fn reencode(
        &self,
        g: &mut Graph,
        shape: &Recurrent,
        newest: &str,
        seen: &[(String, String, Option<String>)],
        before: Option<&(String, String)>,
    ) -> (String, String) {
        let (n, width) = (shape.encoder, shape.reencoder);
        let Some([query, _, _, score]) = &self.attention else {
            return g.lstm(newest, &self.reencoder, width, before);
        };
        let asked = before.map(|(s, _)| g.op("MatMul", &[s, query]));
        let mut rows = Vec::new();
        for (slot, (_, key, mask)) in seen.iter().enumerate() {
            let sum = match &asked {
                None => key.clone(),
                Some(asked) => g.op("Add", &[key, asked]),
            };
            let bent = g.op("Tanh", &[&sum]);
            let mut e = g.op("MatMul", &[&bent, score]);
            if let Some(mask) = mask {
                e = g.op("Add", &[&e, mask]);
            }
            rows.push(g.place(&e, 1, slot, seen.len()));
        }
        let scores = g.sum(rows);
        let weights = g.softmax(&scores);
        let mut shares = Vec::new();
        for (slot, (state, ..)) in seen.iter().enumerate() {
            let weight = g.pick(&weights, seen.len(), &vec![slot; n]);
            shares.push(g.op("Mul", &[state, &weight]));
        }
        let context = g.sum(shares);
        let newest = g.place(newest, n, 0, 2 * n);
        let context = g.place(&context, n, n, 2 * n);
        let merged = g.op("Add", &[&newest, &context]);
        g.lstm(&merged, &self.reencoder, width, before)
    }

    /// Output (1 × batch × 1) for the last state of the re-encoder.
    fn output(&self, g: &mut Graph, member: &Member, state: &str) -> String {
        let weight = member.constant(g, self.tail + 2);
        let bias = member.constant(g, self.tail + 3);
        let product = g.op("MatMul", &[state, &weight]);
        g.op("Add", &[&product, &bias])
    }
}

/// Output of a recurrent network over a window, from zero states.
fn windowed(g: &mut Graph, shape: &Recurrent, member: &Member, samples: &[String]) -> String {
    let layers = Layers::new(g, shape, member);
    let mut encoder: Option<(String, String)> = None;
    let mut seen = Vec::new();
    for x in samples {
        let next = g.lstm(x, &layers.encoder, shape.encoder, encoder.as_ref());
        let key = layers.key(g, &next.0);
        seen.push((next.0.clone(), key, None));
        encoder = Some(next);
    }
    let mut reencoder: Option<(String, String)> = None;
    for (newest, ..) in &seen {
        let next = layers.reencode(g, shape, newest, &seen, reencoder.as_ref());
        reencoder = Some(next);
    }
    let (last, _) = reencoder.unwrap_or_default();
    layers.output(g, member, &last)
}

/// Output of a recurrent network that carries its state from sample to sample.
fn carried(
    g: &mut Graph,
    state: &mut State,
    shape: &Recurrent,
    member: &Member,
    sample: &str,
) -> String {
    let layers = Layers::new(g, shape, member);
    let before = earlier(shape);
    let own = state.take(shape.encoder);
    let older: Vec<Place> = (1..before).map(|_| state.take(shape.encoder)).collect();
    let flags: Vec<Place> = (0..before).map(|_| state.take(1)).collect();
    let second = state.take(shape.reencoder);
    let encoder = (state.hidden(g, own), state.cell(g, own));
    let reencoder = (state.hidden(g, second), state.cell(g, second));
    // Earlier states that attention sees, newest first, each with one where there is such a state and zero before the start.
    let mut past: Vec<(String, String)> = Vec::new();
    for (i, &flag) in flags.iter().enumerate() {
        let value = match i.checked_sub(1) {
            None => encoder.0.clone(),
            Some(i) => state.hidden(g, older[i]),
        };
        past.push((value, state.hidden(g, flag)));
    }
    let next = g.lstm(sample, &layers.encoder, shape.encoder, Some(&encoder));
    let newest = next.0.clone();
    let key = layers.key(g, &newest);
    let mut seen = vec![(newest.clone(), key, None)];
    let never = g.constant(&[1], vec![NEVER]);
    let always = g.constant(&[1], vec![-NEVER]);
    for (value, flag) in &past {
        let key = layers.key(g, value);
        let mask = g.op("Mul", &[flag, &always]);
        let mask = g.op("Add", &[&mask, &never]);
        seen.push((value.clone(), key, Some(mask)));
    }
    let last = layers.reencode(g, shape, &newest, &seen, Some(&reencoder));
    state.keep_hidden(g, &newest, own);
    state.keep_cell(g, &next.1, own);
    for (&place, (value, _)) in older.iter().zip(&past) {
        state.keep_hidden(g, value, place);
    }
    if let (Some(&first), Some((_, flag))) = (flags.first(), past.first()) {
        let (_, one) = rest(g, flag);
        state.keep_hidden(g, &one, first);
    }
    for (&place, (_, flag)) in flags.iter().skip(1).zip(&past) {
        state.keep_hidden(g, flag, place);
    }
    state.keep_hidden(g, &last.0, second);
    state.keep_cell(g, &last.1, second);
    layers.output(g, member, &last.0)
}
