//! The two scalar types of the engine.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// f32 with the run-time's vectorisable activations, or f64 with the standard library's.
pub(crate) trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// Number 0.
    const ZERO: Self;
    /// Number 1.
    const ONE: Self;

    /// Number from single precision.
    fn from_f32(x: f32) -> Self;
    /// Exponential function.
    fn exp(self) -> Self;
    /// Logistic function 1/(1 + exp(−x)).
    fn sigmoid(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn from_f32(x: f32) -> Self {
        x
    }

    #[inline(always)]
    fn exp(self) -> Self {
        feedforward::network::exp(self)
    }

    #[inline(always)]
    fn sigmoid(self) -> Self {
        feedforward::network::sigmoid(self)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        feedforward::network::tanh(self)
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn from_f32(x: f32) -> Self {
        x.into()
    }

    #[inline(always)]
    fn exp(self) -> Self {
        self.exp()
    }

    #[inline(always)]
    fn sigmoid(self) -> Self {
        1.0 / (1.0 + (-self).exp())
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        self.tanh()
    }
}

/// Partial sums of a reduction: enough for two AVX-512 registers, and one fixed order on every machine.
const LANES: usize = 32;

/// aᵀb in a fixed order that vectorises.
#[inline(always)]
pub(crate) fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_body, a_rest) = a.as_chunks::<LANES>();
    let (b_body, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a_body.iter().zip(b_body) {
        for j in 0..LANES {
            lanes[j] += a[j] * b[j];
        }
    }
    let mut sum = T::ZERO;
    for (&a, &b) in a_rest.iter().zip(b_rest) {
        sum += a * b;
    }
    for lane in lanes {
        sum += lane;
    }
    sum
}

/// Scaled addition of vectors: y += α·x.
#[inline(always)]
pub(crate) fn add_scaled<T: Real>(y: &mut [T], alpha: T, x: &[T]) {
    for (y, &x) in y.iter_mut().zip(x) {
        *y += alpha * x;
    }
}

/// sum += Σ rows of a (rows × sum.len()) matrix.
pub(crate) fn add_rows<T: Real>(sum: &mut [T], rows: &[T]) {
    for row in rows.chunks_exact(sum.len()) {
        add_scaled(sum, T::ONE, row);
    }
}
