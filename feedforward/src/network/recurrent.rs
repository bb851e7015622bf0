//! The published unit at run-time: one window, or one step of the carried state.

use pulp::{Arch, Simd, WithSimd};

use super::Weights;
use super::activation::{exp, gated, sigmoid, tanh};
use super::architecture::{Memory, Recurrent, Tensor};
use super::packed::{Packed, starts};

/// Values that are computed together.
const LANES: usize = 16;

/// Matrices with the same inputs side by side, row-major.
fn beside(parts: &[(&[f32], usize)]) -> Vec<f32> {
    let rows = parts[0].0.len() / parts[0].1;
    (0..rows)
        .flat_map(|k| {
            parts
                .iter()
                .flat_map(move |(part, width)| &part[k * width..(k + 1) * width])
        })
        .copied()
        .collect()
}

/// Encoder, attention and re-encoder with everything one step needs.
///
/// What acts on the same vector is one matrix. W_V V_t of equation 21 is Σ α_u W_V h_u: its products with the encoder
/// states, the keys and what the re-encoder takes of h_t are one product for all states of a window.
#[derive(Debug, Clone)]
pub(super) struct RecurrentNet {
    /// Input columns → gates of the encoder.
    input: Packed,
    /// Encoder state → gates of the encoder.
    recall: Packed,
    /// Encoder state → attention's key, its share in the re-encoder's gates, and its share as a context.
    project: Packed,
    /// Re-encoder state → attention's query, and its share in the re-encoder's gates.
    ask: Packed,
    /// Biases, where the sums of `input` and `project` start, for all their rows.
    input_start: Vec<f32>,
    project_start: Vec<f32>,
    /// Weights w_a of the attention; empty without one.
    score: Vec<f32>,
    output: Vec<f32>,
    output_bias: f32,
    memory: Memory,
    /// Encoder states of a window, or the last one.
    states: Vec<f32>,
    encoder_cell: Vec<f32>,
    reencoder_state: Vec<f32>,
    reencoder_cell: Vec<f32>,
    /// Sums of `input` and `recall`, one row for each sample of a window.
    gates: Vec<f32>,
    /// Sums of `project`, one row for each encoder state that attention sees.
    projected: Vec<f32>,
    /// Sums of `ask`.
    asked: Vec<f32>,
    /// Scores e_u of the states, then their weights α_u.
    weights: Vec<f32>,
    /// Number of steps since the reset of the carried state.
    steps: usize,
}

impl RecurrentNet {
    pub(super) fn new(
        shape: &Recurrent,
        tensors: &[Tensor],
        parameters: &[f32],
        slots: usize,
        form: Weights,
    ) -> Self {
        let of = |t: &Tensor| &parameters[t.range.clone()];
        let (h, s) = (shape.encoder, shape.reencoder);
        let columns = tensors[0].shape[0] - h;
        let (input, recall) = of(&tensors[0]).split_at(columns * 4 * h);
        let tail = &tensors[tensors.len() - 4..];
        let (taken, own) = of(&tail[0]).split_at(of(&tail[0]).len() - s * 4 * s);
        let (project, ask, bias, score) = match shape.attention {
            None => (taken.to_vec(), own.to_vec(), of(&tail[1]).to_vec(), vec![]),
            Some(a) => {
                let [query, key, bias, score] = [2, 3, 4, 5].map(|i| of(&tensors[i]));
                let (state, context) = taken.split_at(h * 4 * s);
                (
                    beside(&[(key, a), (state, 4 * s), (context, 4 * s)]),
                    beside(&[(query, a), (own, 4 * s)]),
                    [bias, of(&tail[1])].concat(),
                    score.to_vec(),
                )
            }
        };
        // Input columns have no bound, states lie within ±1.
        let unbounded = match form {
            Weights::Int8 => Weights::F32,
            form => form,
        };
        let input = Packed::new(input, columns, unbounded);
        let project = Packed::new(&project, h, form);
        let ask = Packed::new(&ask, s, form);
        let samples = match shape.memory {
            Memory::Window { timestep } => timestep,
            Memory::Carried { .. } => 1,
        };
        let input_start = starts(of(&tensors[1]), input.padded(), samples);
        let project_start = starts(&bias, project.padded(), samples);
        Self {
            recall: Packed::new(recall, h, form),
            score,
            output: of(&tail[2]).to_vec(),
            output_bias: parameters[tail[3].range.start],
            memory: shape.memory,
            states: vec![0.0; samples * h],
            encoder_cell: vec![0.0; h],
            reencoder_state: vec![0.0; s],
            reencoder_cell: vec![0.0; s],
            gates: input_start.clone(),
            projected: vec![0.0; slots * project.padded()],
            asked: vec![0.0; ask.padded()],
            weights: vec![0.0; slots],
            steps: 0,
            input,
            project,
            ask,
            input_start,
            project_start,
        }
    }

    /// Resets the network to zero states.
    pub(super) fn reset(&mut self) {
        self.states.fill(0.0);
        self.encoder_cell.fill(0.0);
        self.reencoder_state.fill(0.0);
        self.reencoder_cell.fill(0.0);
        self.steps = 0;
    }

    /// Output after the newest sample of `window` (normalised, oldest first; with carried state a single
    /// sample).
    pub(super) fn evaluate(&mut self, arch: Arch, window: &[f32]) -> f32 {
        self.gates.copy_from_slice(&self.input_start);
        self.input.add(arch, window, &mut self.gates);
        match self.memory {
            Memory::Window { timestep } => {
                self.reset();
                self.encode_window(arch, timestep);
                self.project(arch, 0);
                for t in 0..timestep {
                    self.reencode(arch, t, timestep, t == 0);
                }
            }
            Memory::Carried { attended } => {
                let slot = self.steps % attended;
                let first = self.steps == 0;
                self.steps += 1;
                self.encode(arch, first);
                self.project(arch, slot);
                self.reencode(arch, slot, self.steps.min(attended), first);
                // Keeps the count from overflowing while its remainder and "ring is full" stay true.
                if self.steps == 2 * attended {
                    self.steps = attended;
                }
            }
        }
        let s = self.output.iter().zip(&self.reencoder_state);
        self.output_bias + s.map(|(w, s)| w * s).sum::<f32>()
    }

    /// Encoder states of a window from zero state. The first step omits the products of its zero state.
    fn encode_window(&mut self, arch: Arch, timestep: usize) {
        let (n, width) = (self.encoder_cell.len(), self.input.padded());
        for t in 0..timestep {
            let (before, state) = self.states.split_at_mut(t * n);
            let gates = &mut self.gates[t * width..][..width];
            if t > 0 {
                self.recall.add(arch, &before[(t - 1) * n..], gates);
            }
            arch.dispatch(Activate {
                gates,
                cell: &mut self.encoder_cell,
                state: &mut state[..n],
            });
        }
    }

    /// Encoder step of the carried state.
    fn encode(&mut self, arch: Arch, first: bool) {
        if !first {
            self.recall.add(arch, &self.states, &mut self.gates);
        }
        arch.dispatch(Activate {
            gates: &self.gates,
            cell: &mut self.encoder_cell,
            state: &mut self.states,
        });
    }

    /// Products of the encoder states at hand, from slot `slot` on.
    fn project(&mut self, arch: Arch, slot: usize) {
        let start = slot * self.project.padded();
        let rows = &mut self.projected[start..][..self.project_start.len()];
        rows.copy_from_slice(&self.project_start);
        self.project.add(arch, &self.states, rows);
    }

    /// Re-encoder step on the encoder state of `slot` and the context of the first `filled` slots.
    fn reencode(&mut self, arch: Arch, slot: usize, filled: usize, first: bool) {
        self.asked.fill(0.0);
        if !first {
            self.ask.add(arch, &self.reencoder_state, &mut self.asked);
        }
        let width = self.project.padded();
        let (asked, gates) = self.asked.split_at_mut(self.score.len());
        arch.dispatch(Reencode {
            projected: &self.projected[..filled * width],
            width,
            slot,
            score: &self.score,
            asked,
            weights: &mut self.weights[..filled],
            gates: &mut gates[..4 * self.reencoder_cell.len()],
            cell: &mut self.reencoder_cell,
            state: &mut self.reencoder_state,
        });
    }
}

/// c ← f∘c + i∘g, h = o∘tanh c, from gate sums in the order i, f, g, o (equations 14–18).
struct Activate<'a> {
    gates: &'a [f32],
    cell: &'a mut [f32],
    state: &'a mut [f32],
}

impl WithSimd for Activate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        activate(self.gates, self.cell, self.state);
    }
}

#[inline(always)]
fn activate(gates: &[f32], cell: &mut [f32], state: &mut [f32]) {
    let n = cell.len();
    let gates = [0, 1, 2, 3].map(|k| &gates[k * n..][..n]);
    let whole = n - n % LANES;
    let (cells, rest) = cell.split_at_mut(whole);
    let (states, state_rest) = state[..n].split_at_mut(whole);
    blocks::<LANES>(gates.map(|g| &g[..whole]), cells, states);
    blocks::<1>(gates.map(|g| &g[whole..]), rest, state_rest);
}

/// [`activate`] in blocks of `N`: left to itself, the compiler makes blocks so long that small layers are what remains.
#[inline(always)]
fn blocks<const N: usize>(gates: [&[f32]; 4], cell: &mut [f32], state: &mut [f32]) {
    let [i, f, g, o] = gates.map(|gate| gate.as_chunks::<N>().0);
    let cells = cell.as_chunks_mut::<N>().0.iter_mut();
    let blocks = cells.zip(state.as_chunks_mut::<N>().0);
    for (b, (cell, state)) in blocks.enumerate() {
        for k in 0..N {
            let c = sigmoid(f[b][k]) * cell[k] + gated(i[b][k], g[b][k]);
            cell[k] = c;
            state[k] = gated(o[b][k], c);
        }
    }
}

/// Equations 21–24 once the products of encoder and re-encoder states are there.
struct Reencode<'a> {
    /// Per slot: key W_h h_u + b_a, share of h_u in the gates with their bias, share of h_u as a context.
    projected: &'a [f32],
    /// Length of a row of `projected`.
    width: usize,
    slot: usize,
    score: &'a [f32],
    /// Query W_s s of the attention.
    asked: &'a [f32],
    weights: &'a mut [f32],
    /// Share of s in the gates.
    gates: &'a mut [f32],
    cell: &'a mut [f32],
    state: &'a mut [f32],
}

impl WithSimd for Reencode<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (a, n) = (self.score.len(), self.gates.len());
        let own = &self.projected[self.slot * self.width + a..][..n];
        for (gate, h) in self.gates.iter_mut().zip(own) {
            *gate += h;
        }
        if a > 0 {
            let rows = || self.projected.chunks_exact(self.width);
            let mut top = f32::NEG_INFINITY;
            for (e, row) in self.weights.iter_mut().zip(rows()) {
                *e = scored(&row[..a], self.asked, self.score);
                top = top.max(*e);
            }
            let mut total = 0.0;
            for e in self.weights.iter_mut() {
                *e = exp(*e - top);
                total += *e;
            }
            for (e, row) in self.weights.iter().zip(rows()) {
                let alpha = e / total;
                for (gate, h) in self.gates.iter_mut().zip(&row[a + n..]) {
                    *gate += alpha * h;
                }
            }
        }
        activate(self.gates, self.cell, self.state);
    }
}

/// Sum of tanh(key + asked)·score with [`LANES`] partial sums, so that it vectorises.
#[inline(always)]
fn scored(key: &[f32], asked: &[f32], score: &[f32]) -> f32 {
    let mut sum = [0.0; LANES];
    let (keys, k_rest) = key.as_chunks::<LANES>();
    let (asks, a_rest) = asked.as_chunks::<LANES>();
    let (scores, s_rest) = score.as_chunks::<LANES>();
    for ((k, a), s) in keys.iter().zip(asks).zip(scores) {
        for j in 0..LANES {
            sum[j] += tanh(k[j] + a[j]) * s[j];
        }
    }
    let mut total = 0.0;
    for j in 0..k_rest.len() {
        total += tanh(k_rest[j] + a_rest[j]) * s_rest[j];
    }
    for s in sum {
        total += s;
    }
    total
}
