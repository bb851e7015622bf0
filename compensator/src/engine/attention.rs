//! Additive attention over encoder states (equations 22–24), batched.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::matmul::{View, ViewMut, multiply, multiply_add};
use super::real::{Real, add_rows, add_scaled, dot};

/// Parameters of the attention, or their gradients.
pub(crate) struct Weights<V> {
    /// Weights W_s of the query, (re-encoder × width).
    pub(crate) query: V,
    /// Weights W_h of the encoder states, (encoder × width).
    pub(crate) key: V,
    /// Bias b_a within the tanh.
    pub(crate) bias: V,
    /// Score weights w_a, (width).
    pub(crate) score: V,
}

/// Intermediate results of the attention's forward pass, kept for the backward pass.
#[derive(Debug)]
pub(crate) struct Attention<T> {
    /// Width of queries and keys.
    width: usize,
    /// Width of the encoder states.
    encoder: usize,
    /// Number of rows of the batch.
    batch: usize,
    /// Longest range of states that one step attends to.
    reach: usize,
    /// Keys W_h h_u + b_a of each state, batch × width, and later their gradient.
    keys: Vec<T>,
    /// Gradient of the keys, in their layout.
    key_gradient: Vec<T>,
    /// Query W_s s_{t−1} of each row in the present step, batch × width. In the backward pass, its gradient.
    asked: Vec<T>,
    /// Activation tanh(W_s s + W_h h_u + b_a) for each step, row and attended state; each has `width` values.
    bent: Vec<T>,
    /// Attention weight α_u for each step, row and attended state.
    alpha: Vec<T>,
}

impl<T: Real> Attention<T> {
    /// Attention without values, for encoder states of width `encoder`.
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

    /// Starts a forward pass: sets the sizes and computes the keys of all `states` (steps blocks of batch × encoder).
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

    /// Computes the query W_s s_{t−1} of step t; `None` while the state is zero.
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

    /// Writes the context vector V_t of every row to `out[row·stride..]`, after [`Self::ask`].
    pub(crate) fn context(
        &mut self,
        arch: Arch,
        t: usize,
        attended: Range<usize>,
        states: &[T],
        score: &[T],
        (out, stride): (&mut [T], usize),
    ) {
        let (width, batch, reach) = (self.width, self.batch, self.reach);
        arch.dispatch(Context {
            sizes: Sizes {
                width,
                encoder: self.encoder,
                batch,
                reach,
            },
            attended,
            keys: &self.keys,
            asked: &self.asked,
            score,
            states,
            bent: &mut self.bent[t * batch * reach * width..],
            alpha: &mut self.alpha[t * batch * reach..],
            out,
            stride,
        });
    }

    /// Starts the backward pass over `steps` steps: sets the gradient of the keys to zero.
    pub(crate) fn begin_back(&mut self, steps: usize) {
        self.key_gradient.clear();
        self.key_gradient
            .resize(steps * self.batch * self.width, T::ZERO);
    }

    /// Backward pass through the context vector V_t, with ∂L/∂V_t as `context[row·stride..]`. It adds to the gradients
    /// of the states and of w_a. It keeps those of the keys and of the query for [`Self::end_back`] and
    /// [`Self::ask_back`].
    pub(crate) fn context_back(
        &mut self,
        arch: Arch,
        t: usize,
        attended: Range<usize>,
        (context, stride): (&[T], usize),
        (states, state_gradient): (&[T], &mut [T]),
        (score, score_gradient): (&[T], &mut [T]),
    ) {
        let (width, batch, reach) = (self.width, self.batch, self.reach);
        arch.dispatch(ContextBack {
            sizes: Sizes {
                width,
                encoder: self.encoder,
                batch,
                reach,
            },
            attended,
            context,
            stride,
            states,
            state_gradient,
            score,
            score_gradient,
            bent: &self.bent[t * batch * reach * width..],
            alpha: &self.alpha[t * batch * reach..],
            keys: &mut self.key_gradient,
            asked: &mut self.asked,
        });
    }

    /// Adds the gradient of W_s s_{t−1} to ∂L/∂s_{t−1} (batch × re-encoder) and ∂L/∂W_s.
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

    /// Adds the gradient of the keys to ∂L/∂h_u of all states, ∂L/∂W_h and ∂L/∂b_a.
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

/// Sizes of one step of the attention.
#[derive(Clone, Copy)]
struct Sizes {
    width: usize,
    encoder: usize,
    batch: usize,
    reach: usize,
}

/// Arguments of [`Attention::context`], to be run with the processor's vector instructions.
struct Context<'a, T> {
    sizes: Sizes,
    attended: Range<usize>,
    keys: &'a [T],
    asked: &'a [T],
    score: &'a [T],
    states: &'a [T],
    bent: &'a mut [T],
    alpha: &'a mut [T],
    out: &'a mut [T],
    stride: usize,
}

impl<T: Real> WithSimd for Context<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Sizes {
            width,
            encoder,
            batch,
            reach,
        } = self.sizes;
        for row in 0..batch {
            let alpha = &mut self.alpha[row * reach..][..self.attended.len()];
            let asked = &self.asked[row * width..][..width];
            for (k, u) in self.attended.clone().enumerate() {
                let bent = &mut self.bent[(row * reach + k) * width..][..width];
                bend(
                    &self.keys[(u * batch + row) * width..][..width],
                    asked,
                    bent,
                );
                alpha[k] = dot(bent, self.score);
            }
            softmax(alpha);
            let context = &mut self.out[row * self.stride..][..encoder];
            context.fill(T::ZERO);
            for (k, u) in self.attended.clone().enumerate() {
                add_scaled(
                    context,
                    alpha[k],
                    &self.states[(u * batch + row) * encoder..][..encoder],
                );
            }
        }
    }
}

/// Writes the activation tanh(key + asked), element by element, to `bent`.
#[inline(always)]
fn bend<T: Real>(key: &[T], asked: &[T], bent: &mut [T]) {
    for j in 0..bent.len() {
        bent[j] = (key[j] + asked[j]).tanh();
    }
}

/// Arguments of [`Attention::context_back`], to be run with the processor's vector instructions.
struct ContextBack<'a, T> {
    sizes: Sizes,
    attended: Range<usize>,
    context: &'a [T],
    stride: usize,
    states: &'a [T],
    state_gradient: &'a mut [T],
    score: &'a [T],
    score_gradient: &'a mut [T],
    bent: &'a [T],
    alpha: &'a [T],
    keys: &'a mut [T],
    asked: &'a mut [T],
}

impl<T: Real> WithSimd for ContextBack<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Sizes {
            width,
            encoder,
            batch,
            reach,
        } = self.sizes;
        for row in 0..batch {
            let context = &self.context[row * self.stride..][..encoder];
            let asked = &mut self.asked[row * width..][..width];
            asked.fill(T::ZERO);
            let alpha = &self.alpha[row * reach..][..self.attended.len()];
            // What the softmax subtracts: Σ_u α_u ∂L/∂α_u.
            let mut mean = T::ZERO;
            for (k, u) in self.attended.clone().enumerate() {
                mean += alpha[k]
                    * dot(
                        context,
                        &self.states[(u * batch + row) * encoder..][..encoder],
                    );
            }
            for (k, u) in self.attended.clone().enumerate() {
                let place = (u * batch + row) * encoder;
                let e = alpha[k] * (dot(context, &self.states[place..][..encoder]) - mean);
                add_scaled(
                    &mut self.state_gradient[place..][..encoder],
                    alpha[k],
                    context,
                );
                let bent = &self.bent[(row * reach + k) * width..][..width];
                add_scaled(self.score_gradient, e, bent);
                unbend(
                    e,
                    self.score,
                    bent,
                    &mut self.keys[(u * batch + row) * width..][..width],
                    asked,
                );
            }
        }
    }
}

/// Adds the gradient before the tanh, e·w_a∘(1 − bent²), to the gradients of the key and of the query.
#[inline(always)]
fn unbend<T: Real>(e: T, score: &[T], bent: &[T], key: &mut [T], asked: &mut [T]) {
    for j in 0..key.len() {
        let d = e * score[j] * (T::ONE - bent[j] * bent[j]);
        key[j] += d;
        asked[j] += d;
    }
}

/// Softmax exp(e_u)/Σ exp(e_i), shifted by the largest exponent against overflow.
#[inline(always)]
fn softmax<T: Real>(e: &mut [T]) {
    let mut top = e[0];
    for &x in e.iter() {
        top = if x > top { x } else { top };
    }
    let mut sum = T::ZERO;
    for x in e.iter_mut() {
        *x = (*x - top).exp();
        sum += *x;
    }
    for x in e.iter_mut() {
        *x = *x / sum;
    }
}
