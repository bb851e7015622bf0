//! Cost of a batch as one differentiable operation of burn.
//!
//! The gradient is computed along with the cost and kept as the operation's state. The backward pass returns
//! that state times the slope of the function of the cost, 1 where the cost is the root.

use burn::backend::autodiff::checkpoint::base::Checkpointer;
use burn::backend::autodiff::checkpoint::strategy::CheckpointStrategy;
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{Backward, Ops, OpsKind};
use burn::backend::flex::FlexTensor;
use burn::backend::ops::FloatTensorOps;
use burn::backend::tensor::FloatTensor;
use burn::backend::{Autodiff, Backend, Dispatch, Flex, backend_extension};
use burn::tensor::{Tensor, TensorData};

use super::batch::{Batch, Cost};

/// Quantity of a training step that is not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NotFinite {
    /// Cost of the batch, which is NaN or infinite.
    Loss,
    /// Gradient of the cost, or its norm, which is NaN or infinite.
    Gradient,
}

/// Backend of burn on which this crate's kernels run.
pub(super) trait UnitKernels: Backend {
    /// Mean cost (shape 1), its gradient (shape of the parameters) and the cost's sums.
    fn cost_and_gradient(
        parameters: FloatTensor<Self>,
        batch: &mut Batch,
    ) -> (FloatTensor<Self>, FloatTensor<Self>, Cost);

    /// Gradient times the slope (shape 1) of the later operations: the chain rule.
    fn chain(gradient: FloatTensor<Self>, slope: FloatTensor<Self>) -> FloatTensor<Self> {
        Self::float_mul(gradient, slope)
    }
}

/// Backend of burn with the cost of a batch as one operation, with or without automatic differentiation.
#[backend_extension(Flex, Autodiff)]
pub(super) trait UnitCost: Backend {
    /// Mean cost (shape 1) of a batch, and its sums.
    fn unit_cost(parameters: FloatTensor<Self>, batch: &mut Batch) -> (FloatTensor<Self>, Cost);
}

/// Values of a tensor of single precision, in one piece.
pub(super) fn values(tensor: &FlexTensor) -> &[f32] {
    // Every tensor here was made from a Vec<f32>.
    tensor
        .as_slice()
        .expect("single precision and in one piece")
}

impl UnitKernels for Flex {
    fn cost_and_gradient(
        parameters: FlexTensor,
        batch: &mut Batch,
    ) -> (FlexTensor, FlexTensor, Cost) {
        let parameters = values(&parameters);
        let mut gradient = vec![0.0; parameters.len()];
        let cost = batch.gradient(parameters, &mut gradient);
        let shape = [gradient.len()];
        let mean = (cost.sum / cost.weight) as f32;
        (
            FlexTensor::from_data(TensorData::new(vec![mean], [1])),
            FlexTensor::from_data(TensorData::new(gradient, shape)),
            cost,
        )
    }

    fn chain(gradient: FlexTensor, slope: FlexTensor) -> FlexTensor {
        match slope.as_slice::<f32>() {
            Some(&[1.0]) => gradient,
            _ => Self::float_mul(gradient, slope),
        }
    }
}

impl UnitCost for Flex {
    fn unit_cost(parameters: FlexTensor, batch: &mut Batch) -> (FlexTensor, Cost) {
        let (mean, _, cost) = Self::cost_and_gradient(parameters, batch);
        (mean, cost)
    }
}

/// Backward pass of the cost. Its state is the gradient, which the forward pass has computed.
#[derive(Debug)]
struct Slope;

impl<B: UnitKernels> Backward<B, 1> for Slope {
    type State = FloatTensor<B>;

    fn backward(self, ops: Ops<Self::State, 1>, gradients: &mut Gradients, _: &mut Checkpointer) {
        let slope = gradients.consume::<B>(&ops.node);
        let [parent] = ops.parents;
        if let Some(parent) = parent {
            gradients.register::<B>(parent.id, B::chain(ops.state, slope));
        }
    }
}

impl<B: UnitKernels + UnitCost, C: CheckpointStrategy> UnitCost for Autodiff<B, C> {
    fn unit_cost(parameters: FloatTensor<Self>, batch: &mut Batch) -> (FloatTensor<Self>, Cost) {
        let (parameters, node) = parameters.into_parts();
        match Slope.prepare::<C>([node]).compute_bound().stateful() {
            OpsKind::Tracked(prepared) => {
                let (mean, gradient, cost) = B::cost_and_gradient(parameters, batch);
                (prepared.finish(gradient, mean), cost)
            }
            OpsKind::UnTracked(prepared) => {
                let (mean, cost) = B::unit_cost(parameters, batch);
                (prepared.finish(mean), cost)
            }
        }
    }
}

/// Mean cost of a batch, differentiable in the parameters, with the sums behind it.
///
/// # Errors
/// Cost or gradient left the finite numbers: burn's clipping would make a gradient that overflows zero.
pub(super) fn cost(
    parameters: Tensor<1>,
    batch: &mut Batch,
) -> Result<(Tensor<1>, Cost), NotFinite> {
    let (mean, cost) = <Dispatch as UnitCost>::unit_cost(parameters.into_dispatch(), batch);
    match () {
        () if !cost.sum.is_finite() => Err(NotFinite::Loss),
        () if !cost.norm_squared.is_finite() => Err(NotFinite::Gradient),
        () => Ok((Tensor::from_dispatch(mean), cost)),
    }
}
