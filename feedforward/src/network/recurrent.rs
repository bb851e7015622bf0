//! The published unit at run-time: one window, or one step of the carried state.

use pulp::{Arch, Simd, WithSimd};

use super::activation::{exp, sigmoid, tanh};
use super::architecture::{Memory, Recurrent, Tensor};
use super::packed::Packed;

/// LSTM layer: packed weights on [x; h], state, and the gate buffer.
#[derive(Debug, Clone)]
struct Lstm {
    weights: Packed,
    /// Input of a step [x; h]: the caller writes x, the step writes h.
    joined: Vec<f32>,
    input: usize,
    cell: Vec<f32>,
    gates: Vec<f32>,
}

impl Lstm {
    fn new(weight: &Tensor, bias: &Tensor, parameters: &[f32]) -> Self {
        let hidden = weight.shape[1] / 4;
        let input = weight.shape[0] - hidden;
        let weights = Packed::new(
            &parameters[weight.range.clone()],
            &parameters[bias.range.clone()],
            weight.shape[0],
        );
        let gates = vec![0.0; weights.padded()];
        Self {
            weights,
            joined: vec![0.0; input + hidden],
            input,
            cell: vec![0.0; hidden],
            gates,
        }
    }

    fn hidden(&self) -> &[f32] {
        &self.joined[self.input..]
    }

    fn reset(&mut self) {
        self.joined[self.input..].fill(0.0);
        self.cell.fill(0.0);
    }

    /// One step (equations 14–18). `first`: whether the state is zero, so that its products are omitted.
    fn step(&mut self, arch: Arch, first: bool) {
        let used = if first { self.input } else { self.joined.len() };
        self.weights
            .apply(arch, &self.joined[..used], &mut self.gates);
        let n = self.cell.len();
        let (i, rest) = self.gates.split_at(n);
        let (f, rest) = rest.split_at(n);
        let (g, rest) = rest.split_at(n);
        let gates = [i, f, g, &rest[..n]];
        arch.dispatch(Activate {
            gates,
            cell: &mut self.cell,
            hidden: &mut self.joined[self.input..],
        });
    }
}

/// c ← f∘c + i∘g, h = o∘tanh c, from gate sums in the order i, f, g, o.
struct Activate<'a> {
    gates: [&'a [f32]; 4],
    cell: &'a mut [f32],
    hidden: &'a mut [f32],
}

impl WithSimd for Activate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        activate(self.gates, self.cell, self.hidden);
    }
}

#[inline(always)]
fn activate([i, f, g, o]: [&[f32]; 4], cell: &mut [f32], hidden: &mut [f32]) {
    let n = cell.len();
    let (i, f, g, o, hidden) = (&i[..n], &f[..n], &g[..n], &o[..n], &mut hidden[..n]);
    for k in 0..n {
        let c = sigmoid(f[k]) * cell[k] + sigmoid(i[k]) * tanh(g[k]);
        cell[k] = c;
        hidden[k] = sigmoid(o[k]) * tanh(c);
    }
}

/// Additive attention over a ring of encoder states (equations 22–24).
#[derive(Debug, Clone)]
struct Attention {
    key: Packed,
    query: Packed,
    score: Vec<f32>,
    /// Attention keys W_h h_u + b_a of each slot, padded to whole tiles.
    keys: Vec<f32>,
    /// Product W_s s of the attention's query.
    asked: Vec<f32>,
    /// Scores e_u of the states, then their weights α_u.
    weights: Vec<f32>,
}

/// Sum of tanh(key + asked)·score with eight partial sums, so that it vectorises.
#[inline(always)]
fn scored(key: &[f32], asked: &[f32], score: &[f32]) -> f32 {
    let mut sum = [0.0; 8];
    let (k8, k_rest) = key.as_chunks::<8>();
    let (a8, a_rest) = asked.as_chunks::<8>();
    let (s8, s_rest) = score.as_chunks::<8>();
    for ((k, a), s) in k8.iter().zip(a8).zip(s8) {
        for j in 0..8 {
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

impl Attention {
    fn new(tensors: &[Tensor], parameters: &[f32], slots: usize) -> Self {
        let [query, key, bias, score] = [0, 1, 2, 3].map(|i| &parameters[tensors[i].range.clone()]);
        let key = Packed::new(key, bias, tensors[1].shape[0]);
        let query = Packed::new(query, &[], tensors[0].shape[0]);
        let width = key.padded();
        Self {
            keys: vec![0.0; slots * width],
            asked: vec![0.0; width],
            weights: vec![0.0; slots],
            score: score.to_vec(),
            key,
            query,
        }
    }

    /// Writes V = Σ α_u h_u over the first `filled` slots for re-encoder state `s`.
    fn context(
        &mut self,
        arch: Arch,
        s: &[f32],
        states: &[f32],
        filled: usize,
        first: bool,
        out: &mut [f32],
    ) {
        let width = self.asked.len();
        let n = self.score.len();
        let used = if first { 0 } else { s.len() };
        self.query.apply(arch, &s[..used], &mut self.asked);
        arch.dispatch(Attend {
            keys: self.keys.chunks_exact(width),
            asked: &self.asked[..n],
            score: &self.score,
            weights: &mut self.weights[..filled],
            states,
            out,
        });
    }
}

/// Equations 22–24 once W_s s and the keys are there.
struct Attend<'a> {
    keys: std::slice::ChunksExact<'a, f32>,
    asked: &'a [f32],
    score: &'a [f32],
    weights: &'a mut [f32],
    states: &'a [f32],
    out: &'a mut [f32],
}

impl WithSimd for Attend<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            keys,
            asked,
            score,
            weights,
            states,
            out,
        } = self;
        let mut top = f32::NEG_INFINITY;
        for (e, key) in weights.iter_mut().zip(keys) {
            *e = scored(&key[..score.len()], asked, score);
            top = top.max(*e);
        }
        let mut total = 0.0;
        for e in weights.iter_mut() {
            *e = exp(*e - top);
            total += *e;
        }
        out.fill(0.0);
        for (e, h) in weights.iter().zip(states.chunks_exact(out.len())) {
            let alpha = e / total;
            for (v, &h) in out.iter_mut().zip(h) {
                *v += alpha * h;
            }
        }
    }
}

/// Encoder, attention and re-encoder with everything one step needs.
#[derive(Debug, Clone)]
pub(super) struct RecurrentNet {
    encoder: Lstm,
    attention: Option<Attention>,
    reencoder: Lstm,
    output: Vec<f32>,
    output_bias: f32,
    memory: Memory,
    /// Encoder states that attention chooses from, one per slot.
    states: Vec<f32>,
    /// Number of steps since the reset of the carried state.
    steps: usize,
}

impl RecurrentNet {
    pub(super) fn new(
        shape: &Recurrent,
        tensors: &[Tensor],
        parameters: &[f32],
        slots: usize,
    ) -> Self {
        let attention = shape
            .attention
            .map(|_| Attention::new(&tensors[2..6], parameters, slots));
        let tail = &tensors[tensors.len() - 4..];
        Self {
            encoder: Lstm::new(&tensors[0], &tensors[1], parameters),
            attention,
            reencoder: Lstm::new(&tail[0], &tail[1], parameters),
            output: parameters[tail[2].range.clone()].to_vec(),
            output_bias: parameters[tail[3].range.start],
            memory: shape.memory,
            states: vec![0.0; slots * shape.encoder],
            steps: 0,
        }
    }

    /// Resets the network to zero states.
    pub(super) fn reset(&mut self) {
        self.encoder.reset();
        self.reencoder.reset();
        self.steps = 0;
    }

    /// Output after the newest sample of `window` (normalised, oldest first; with carried state a single
    /// sample).
    pub(super) fn evaluate(&mut self, arch: Arch, window: &[f32]) -> f32 {
        match self.memory {
            Memory::Window { timestep } => {
                self.reset();
                for (t, x) in window.chunks_exact(self.encoder.input).enumerate() {
                    self.encode(arch, x, t, t == 0);
                }
                for t in 0..timestep {
                    self.reencode(arch, t, timestep, t == 0);
                }
            }
            Memory::Carried { attended } => {
                let slot = self.steps % attended;
                let first = self.steps == 0;
                self.steps += 1;
                self.encode(arch, window, slot, first);
                self.reencode(arch, slot, self.steps.min(attended), first);
                // Keeps the count from overflowing while its remainder and "ring is full" stay true.
                if self.steps == 2 * attended {
                    self.steps = attended;
                }
            }
        }
        let s = self.reencoder.hidden();
        self.output_bias + self.output.iter().zip(s).map(|(w, s)| w * s).sum::<f32>()
    }

    /// Encoder step on sample `x`; its state goes to `slot`.
    fn encode(&mut self, arch: Arch, x: &[f32], slot: usize, first: bool) {
        self.encoder.joined[..x.len()].copy_from_slice(x);
        self.encoder.step(arch, first);
        let h = self.encoder.hidden();
        self.states[slot * h.len()..][..h.len()].copy_from_slice(h);
        if let Some(attention) = &mut self.attention {
            let width = attention.key.padded();
            attention
                .key
                .apply(arch, h, &mut attention.keys[slot * width..][..width]);
        }
    }

    /// Re-encoder step on [h of `slot`; V over the first `filled` slots].
    fn reencode(&mut self, arch: Arch, slot: usize, filled: usize, first: bool) {
        let n = self.encoder.cell.len();
        let (input, s) = self.reencoder.joined.split_at_mut(self.reencoder.input);
        input[..n].copy_from_slice(&self.states[slot * n..][..n]);
        if let Some(attention) = &mut self.attention {
            attention.context(arch, s, &self.states, filled, first, &mut input[n..]);
        }
        self.reencoder.step(arch, first);
    }
}
