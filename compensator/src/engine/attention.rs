//! Additive attention over encoder states (equations 22–24), batched.

use std::ops::Range;

use pulp::Arch;

use super::matmul::{View, ViewMut, multiply, multiply_add};
use super::real::{Real, add_rows, add_scaled, dot};

/// Parameters, or their gradients.
pub(crate) struct Weights<V> {
    /// W_s, (re-encoder × width).
    pub(crate) query: V,
    /// W_h, (encoder × width).
    pub(crate) key: V,
    /// b_a.
    pub(crate) bias: V,
    /// w_a.
    pub(crate) score: V,
}

/// What the forward pass leaves for the backward pass.
#[derive(Debug)]
pub(crate) struct Attention<T> {
    width: usize,
    encoder: usize,
    batch: usize,
    /// Longest range of states that one step attends to.
    reach: usize,
    /// Per state, batch × width: W_h h_u + b_a, and later its gradient.
    keys: Vec<T>,
    key_gradient: Vec<T>,
    /// batch × width: W_s s_{t−1}, and later its gradient.
    asked: Vec<T>,
    /// Per step, row and attended state: tanh(W_s s + W_h h_u + b_a), (width).
    bent: Vec<T>,
    /// Per step, row and attended state: α_u.
    alpha: Vec<T>,
}

impl<T: Real> Attention<T> {
    pub(crate) fn new(encoder: usize, width: usize) -> Self {
        let empty = Vec::new;
        Self {
            width,
            encoder,
            batch: 0,
            reach: 0,
            keys: empty(),
            key_gradient: empty(),
            asked: empty(),
            bent: empty(),
            alpha: empty(),
        }
    }

    /// Makes room and computes the keys of all `states` (steps blocks of batch × encoder).
    pub(crate) fn begin(
        &mut self,
        batch: usize,
        steps: usize,
        reach: usize,
        states: &[T],
        weights: &Weights<&[T]>,
    ) {
        let width = self.width;
        self.batch = batch;
        self.reach = reach;
        self.keys.resize(steps * batch * width, T::ZERO);
        self.asked.resize(batch * width, T::ZERO);
        self.bent.resize(steps * batch * reach * width, T::ZERO);
        self.alpha.resize(steps * batch * reach, T::ZERO);
        let keys = &mut self.keys[..steps * batch * width];
        for row in keys.chunks_exact_mut(width) {
            row.copy_from_slice(weights.bias);
        }
        multiply_add(
            ViewMut::new(keys, steps * batch, width, width),
            View::new(states, steps * batch, self.encoder, self.encoder),
            View::new(weights.key, self.encoder, width, width),
        );
    }

    /// Computes W_s s_{t−1}; `None` while the state is zero.
    pub(crate) fn ask(&mut self, state: Option<View<T>>, weights: &Weights<&[T]>) {
        let (width, batch) = (self.width, self.batch);
        let asked = &mut self.asked[..batch * width];
        match state {
            Some(s) => {
                let query = View::new(weights.query, weights.query.len() / width, width, width);
                multiply(ViewMut::new(asked, batch, width, width), s, query);
            }
            None => asked.fill(T::ZERO),
        }
    }

    /// Writes V_t of every row to `out[row·stride..]`, after [`Self::ask`].
    pub(crate) fn context(
        &mut self,
        arch: Arch,
        t: usize,
        attended: Range<usize>,
        states: &[T],
        score: &[T],
        (out, stride): (&mut [T], usize),
    ) {
        let (width, encoder, batch, reach) = (self.width, self.encoder, self.batch, self.reach);
        let (keys, asked) = (&self.keys[..], &self.asked[..]);
        let bent = &mut self.bent[t * batch * reach * width..];
        let alpha = &mut self.alpha[t * batch * reach..];
        arch.dispatch(
            #[inline(always)]
            || {
                for row in 0..batch {
                    let alpha = &mut alpha[row * reach..][..attended.len()];
                    let asked = &asked[row * width..][..width];
                    for (k, u) in attended.clone().enumerate() {
                        let key = &keys[(u * batch + row) * width..][..width];
                        let bent = &mut bent[(row * reach + k) * width..][..width];
                        for j in 0..width {
                            bent[j] = (key[j] + asked[j]).tanh();
                        }
                        alpha[k] = dot(bent, score);
                    }
                    softmax(alpha);
                    let context = &mut out[row * stride..][..encoder];
                    context.fill(T::ZERO);
                    for (&a, u) in alpha.iter().zip(attended.clone()) {
                        add_scaled(
                            context,
                            a,
                            &states[(u * batch + row) * encoder..][..encoder],
                        );
                    }
                }
            },
        );
    }

    /// Starts the backward pass.
    pub(crate) fn begin_back(&mut self, steps: usize) {
        self.key_gradient.clear();
        self.key_gradient
            .resize(steps * self.batch * self.width, T::ZERO);
    }

    /// Backward through V_t, ∂L/∂V_t being `context[row·stride..]`: adds to the gradients of the states and of
    /// w_a, and keeps those of the keys and of W_s s_{t−1} for the two methods below.
    pub(crate) fn context_back(
        &mut self,
        arch: Arch,
        t: usize,
        attended: Range<usize>,
        (context, stride): (&[T], usize),
        (states, state_gradient): (&[T], &mut [T]),
        (score, score_gradient): (&[T], &mut [T]),
    ) {
        let (width, encoder, batch, reach) = (self.width, self.encoder, self.batch, self.reach);
        let (keys, asked) = (&mut self.key_gradient[..], &mut self.asked[..]);
        let bent = &self.bent[t * batch * reach * width..];
        let alpha = &self.alpha[t * batch * reach..];
        arch.dispatch(
            #[inline(always)]
            || {
                for row in 0..batch {
                    let context = &context[row * stride..][..encoder];
                    let asked = &mut asked[row * width..][..width];
                    asked.fill(T::ZERO);
                    let alpha = &alpha[row * reach..][..attended.len()];
                    // Σ_u α_u ∂L/∂α_u, which the softmax subtracts, is Vᵀ ∂L/∂V.
                    let mut mean = T::ZERO;
                    for (&a, u) in alpha.iter().zip(attended.clone()) {
                        mean += a * dot(context, &states[(u * batch + row) * encoder..][..encoder]);
                    }
                    for (k, u) in attended.clone().enumerate() {
                        let place = (u * batch + row) * encoder;
                        let e = alpha[k] * (dot(context, &states[place..][..encoder]) - mean);
                        add_scaled(&mut state_gradient[place..][..encoder], alpha[k], context);
                        let bent = &bent[(row * reach + k) * width..][..width];
                        add_scaled(score_gradient, e, bent);
                        let key = &mut keys[(u * batch + row) * width..][..width];
                        for j in 0..width {
                            let d = e * score[j] * (T::ONE - bent[j] * bent[j]);
                            key[j] += d;
                            asked[j] += d;
                        }
                    }
                }
            },
        );
    }

    /// Adds what W_s s_{t−1} received to ∂L/∂s_{t−1} (batch × re-encoder) and ∂L/∂W_s.
    pub(crate) fn ask_back(
        &self,
        state: View<T>,
        query: &[T],
        state_gradient: &mut [T],
        query_gradient: &mut [T],
    ) {
        let (width, batch) = (self.width, self.batch);
        let n = query.len() / width;
        let asked = View::new(&self.asked, batch, width, width);
        multiply_add(
            ViewMut::new(state_gradient, batch, n, n),
            asked,
            View::new(query, n, width, width).t(),
        );
        multiply_add(
            ViewMut::new(query_gradient, n, width, width),
            state.t(),
            asked,
        );
    }

    /// Adds what the keys received to ∂L/∂h_u of all states, ∂L/∂W_h and ∂L/∂b_a.
    pub(crate) fn end_back(
        &self,
        states: (&[T], &mut [T]),
        key: &[T],
        key_gradient: &mut [T],
        bias_gradient: &mut [T],
    ) {
        let (width, n) = (self.width, self.encoder);
        let rows = states.0.len() / n;
        let keys = View::new(&self.key_gradient, rows, width, width);
        multiply_add(
            ViewMut::new(states.1, rows, n, n),
            keys,
            View::new(key, n, width, width).t(),
        );
        multiply_add(
            ViewMut::new(key_gradient, n, width, width),
            View::new(states.0, rows, n, n).t(),
            keys,
        );
        add_rows(bias_gradient, &self.key_gradient[..rows * width]);
    }
}

/// exp(e_u)/Σ exp(e_i), shifted by the largest exponent against overflow.
#[inline(always)]
fn softmax<T: Real>(e: &mut [T]) {
    let top = e.iter().fold(e[0], |m, &x| if x > m { x } else { m });
    let mut sum = T::ZERO;
    for x in e.iter_mut() {
        *x = (*x - top).exp();
        sum += *x;
    }
    for x in e.iter_mut() {
        *x = *x / sum;
    }
}
