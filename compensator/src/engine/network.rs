//! One interface over the architectures.

use feedforward::network::Architecture;

use super::perceptron::Perceptron;
use super::real::Real;
use super::recurrent::Recurrent;
use super::span::{Dropout, Span};

/// Network of any architecture, with its forward and backward pass.
#[derive(Debug)]
pub(crate) enum Network<T> {
    Recurrent(Box<Recurrent<T>>),
    Perceptron(Perceptron<T>),
}

impl<T: Real> Network<T> {
    /// Network without values in its layers; `None` where a width is zero or overflows.
    pub(crate) fn new(architecture: &Architecture, inputs: usize) -> Option<Self> {
        let tensors = architecture.tensors(inputs)?;
        Some(match architecture {
            Architecture::Recurrent(shape) => {
                Self::Recurrent(Box::new(Recurrent::new(shape, inputs, tensors)))
            }
            Architecture::Perceptron { .. } => Self::Perceptron(Perceptron::new(inputs, tensors)),
        })
    }

    /// Starts a pass of this size.
    pub(crate) fn begin(&mut self, span: Span) {
        match self {
            Self::Recurrent(net) => net.begin(span),
            Self::Perceptron(net) => net.begin(span),
        }
    }

    /// Input of step t of one row, to be written between `begin` and `forward`.
    pub(crate) fn input_mut(&mut self, t: usize, row: usize) -> &mut [T] {
        match self {
            Self::Recurrent(net) => net.input_mut(t, row),
            Self::Perceptron(net) => net.input_mut(t, row),
        }
    }

    /// Forward pass: writes one normalised output for each output step and row to `outputs`.
    pub(crate) fn forward(
        &mut self,
        parameters: &[T],
        dropout: Option<&Dropout<T>>,
        outputs: &mut [T],
    ) {
        match self {
            Self::Recurrent(net) => net.forward(parameters, dropout, outputs),
            Self::Perceptron(net) => net.forward(parameters, dropout, outputs),
        }
    }

    /// Backward pass: adds the gradient of Σ outputs·`output_gradient` with respect to the parameters to `gradient`.
    pub(crate) fn backward(
        &mut self,
        parameters: &[T],
        dropout: Option<&Dropout<T>>,
        output_gradient: &[T],
        gradient: &mut [T],
    ) {
        match self {
            Self::Recurrent(net) => net.backward(parameters, dropout, output_gradient, gradient),
            Self::Perceptron(net) => net.backward(parameters, dropout, output_gradient, gradient),
        }
    }
}
