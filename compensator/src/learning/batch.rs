//! Batch of one step, and the kernels' computation of cost and gradient from the parameters.

use crate::config::Loss;
use crate::engine::{Dropout, Network, Span, dot};

/// Batch of one training step: inputs in the network's buffers, and targets.
#[derive(Debug)]
pub(crate) struct Batch {
    /// Network with its inputs and the forward pass's intermediate results.
    pub(crate) network: Network<f32>,
    /// Factors of dropout, drawn for this batch; none without.
    pub(crate) dropout: Option<Dropout<f32>>,
    /// Normalised target and weight of every output, in the network's order.
    pub(crate) targets: Vec<(f32, f32)>,
    /// Loss of one residual in the cost.
    loss: Loss,
    /// Number of rows and steps.
    span: Span,
    /// Outputs of the last forward pass; after the gradient's computation, their gradients.
    outputs: Vec<f32>,
}

/// Cost of a batch, and the size of its gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cost {
    /// Sum of the samples' costs times their weights.
    pub(crate) sum: f64,
    /// Sum of the samples' weights.
    pub(crate) weight: f64,
    /// Squared norm of the gradient, in single precision as burn's clipping takes it.
    pub(crate) norm_squared: f32,
}

impl Batch {
    /// Batch without samples.
    pub(crate) fn new(network: Network<f32>, loss: Loss) -> Self {
        Self {
            network,
            dropout: None,
            targets: Vec::new(),
            loss,
            span: Span::default(),
            outputs: Vec::new(),
        }
    }

    /// Starts a batch of this size; inputs and targets are to be written next.
    pub(crate) fn begin(&mut self, span: Span) {
        self.network.begin(span);
        self.span = span;
        self.targets.clear();
        self.outputs.resize(span.outputs(), 0.0);
    }

    /// Number of rows and steps of the batch.
    pub(super) fn span(&self) -> Span {
        self.span
    }

    /// Loss of one residual in the cost.
    pub(super) fn loss(&self) -> Loss {
        self.loss
    }

    /// Sum of the samples' weights.
    pub(crate) fn weight(&self) -> f64 {
        self.targets.iter().map(|&(_, w)| f64::from(w)).sum()
    }

    /// Outputs of a forward pass without dropout, and the targets with their weights.
    pub(crate) fn outputs(&mut self, parameters: &[f32]) -> (&[f32], &[(f32, f32)]) {
        self.network.forward(parameters, None, &mut self.outputs);
        (&self.outputs, &self.targets)
    }

    /// Weighted mean cost and its gradient, written to `gradient`; the weights must not all be zero.
    pub(super) fn gradient(&mut self, parameters: &[f32], gradient: &mut [f32]) -> Cost {
        let dropout = self.dropout.as_ref();
        self.network.forward(parameters, dropout, &mut self.outputs);
        let (mut sum, mut weight) = (0.0, 0.0);
        for (y, &(target, w)) in self.outputs.iter_mut().zip(&self.targets) {
            let (cost, slope) = self.loss.cost(*y - target);
            sum += f64::from(w) * f64::from(cost);
            weight += f64::from(w);
            // From here on the outputs are the slopes.
            *y = w * slope;
        }
        let share = (1.0 / weight) as f32;
        self.outputs.iter_mut().for_each(|s| *s *= share);
        gradient.fill(0.0);
        self.network
            .backward(parameters, dropout, &self.outputs, gradient);
        Cost {
            sum,
            weight,
            norm_squared: dot(gradient, gradient),
        }
    }
}
