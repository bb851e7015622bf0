//! One member network on scaled samples.

use candle_core::{Result, Tensor};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Architecture {
    Recurrent {
        encoder: usize,
        attention: Option<usize>,
        reencoder: usize,
        memory: Memory,
    },
    Perceptron {
        hidden: Vec<usize>,
        timestep: usize,
    },
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum Memory {
    Window { timestep: usize },
    Carried { attended: usize },
}

/// Weights of one member by name.
pub(crate) struct Network<'a> {
    pub tensor: &'a dyn Fn(&str) -> Result<&'a Tensor>,
}

impl Network<'_> {
    /// Scaled output after every row of `x` (samples, columns), a trajectory from its start; shape
    /// (samples).
    pub fn evaluate(&self, architecture: &Architecture, x: &Tensor) -> Result<Tensor> {
        match architecture {
            Architecture::Perceptron { hidden, timestep } => {
                let mut y = Tensor::cat(&window(x, *timestep)?, 1)?;
                for k in 0..=hidden.len() {
                    y = self.dense(&y, &format!("layer{k}"))?;
                    if k < hidden.len() {
                        y = y.tanh()?;
                    }
                }
                y.squeeze(1)
            }
            Architecture::Recurrent {
                encoder,
                attention,
                reencoder,
                memory,
            } => {
                let attended = attention.is_some();
                match memory {
                    Memory::Window { timestep } => {
                        let steps = window(x, *timestep)?;
                        let mut state = State::zero(x, x.dim(0)?, *encoder)?;
                        let mut states = Vec::new();
                        for step in &steps {
                            state = self.lstm("encoder", step, &state)?;
                            states.push(state.h.clone());
                        }
                        let mut s = State::zero(x, x.dim(0)?, *reencoder)?;
                        for h in &states {
                            s = self.reencode(attended, h, &states, &s)?;
                        }
                        self.dense(&s.h, "output")?.squeeze(1)
                    }
                    Memory::Carried { attended: last } => {
                        let mut state = State::zero(x, 1, *encoder)?;
                        let mut s = State::zero(x, 1, *reencoder)?;
                        let (mut states, mut outputs) = (Vec::new(), Vec::new());
                        for row in 0..x.dim(0)? {
                            state = self.lstm("encoder", &x.narrow(0, row, 1)?, &state)?;
                            states.push(state.h.clone());
                            let seen = &states[states.len().saturating_sub(*last)..];
                            s = self.reencode(attended, &state.h, seen, &s)?;
                            outputs.push(self.dense(&s.h, "output")?);
                        }
                        Tensor::cat(&outputs, 0)?.squeeze(1)
                    }
                }
            }
        }
    }

    fn dense(&self, x: &Tensor, layer: &str) -> Result<Tensor> {
        let weight = (self.tensor)(&format!("{layer}.weight"))?;
        let bias = (self.tensor)(&format!("{layer}.bias"))?;
        x.matmul(weight)?.broadcast_add(bias)
    }

    /// Gates in the order input, forget, cell, output, on [x; h].
    fn lstm(&self, layer: &str, x: &Tensor, state: &State) -> Result<State> {
        let gates = self
            .dense(&Tensor::cat(&[x, &state.h], 1)?, layer)?
            .chunk(4, 1)?;
        let kept = (sigmoid(&gates[1])? * &state.c)?;
        let c = (kept + (sigmoid(&gates[0])? * gates[2].tanh()?)?)?;
        let h = (sigmoid(&gates[3])? * c.tanh()?)?;
        Ok(State { h, c })
    }

    /// Re-encoder step on [h; V], V the attended mean of `states` as s before this step asks for it.
    fn reencode(&self, attended: bool, h: &Tensor, states: &[Tensor], s: &State) -> Result<State> {
        if !attended {
            return self.lstm("reencoder", h, s);
        }
        let asked = s.h.matmul((self.tensor)("attention.query")?)?;
        let (key, bias) = (
            (self.tensor)("attention.key")?,
            (self.tensor)("attention.bias")?,
        );
        let score = (self.tensor)("attention.score")?;
        let mut scores = Vec::new();
        for state in states {
            let sum = (&asked + state.matmul(key)?)?.broadcast_add(bias)?;
            scores.push(sum.tanh()?.broadcast_mul(score)?.sum_keepdim(1)?);
        }
        let e = Tensor::cat(&scores, 1)?;
        let e = e.broadcast_sub(&e.max_keepdim(1)?)?.exp()?;
        let alpha = e.broadcast_div(&e.sum_keepdim(1)?)?;
        let mut context = states[0].zeros_like()?;
        for (u, state) in states.iter().enumerate() {
            context = (context + state.broadcast_mul(&alpha.narrow(1, u, 1)?)?)?;
        }
        self.lstm("reencoder", &Tensor::cat(&[h, &context], 1)?, s)
    }
}

struct State {
    h: Tensor,
    c: Tensor,
}

impl State {
    /// Zero states in the type and on the device of `like`.
    fn zero(like: &Tensor, rows: usize, width: usize) -> Result<Self> {
        let zero = Tensor::zeros((rows, width), like.dtype(), like.device())?;
        Ok(Self {
            h: zero.clone(),
            c: zero,
        })
    }
}

fn sigmoid(x: &Tensor) -> Result<Tensor> {
    (x.neg()?.exp()? + 1.0)?.recip()
}

/// The window of every row, oldest sample first: one tensor (samples, columns) for each step. Before the
/// start the first sample repeats.
fn window(x: &Tensor, timestep: usize) -> Result<Vec<Tensor>> {
    let rows = x.dim(0)?;
    (0..timestep)
        .map(|t| {
            let places: Vec<u32> = (0..rows)
                .map(|row| (row + t + 1).saturating_sub(timestep) as u32)
                .collect();
            x.index_select(&Tensor::new(places, x.device())?, 0)
        })
        .collect()
}
