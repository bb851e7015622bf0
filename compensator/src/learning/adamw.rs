//! AdamW (Kingma & Ba 2015; Loshchilov & Hutter 2019) as an optimiser of burn in one pass over memory.
//!
//! burn's own AdamW goes over the parameters some fifteen times. That takes a tenth of a step of the published unit,
//! and more of a small one. This one does the same arithmetic in the same order, so that both give the same bits. It
//! keeps burn's state, so that each reads the other's records.

use burn::backend::flex::FlexTensor;
use burn::backend::tensor::FloatTensor;
use burn::backend::{Backend, Dispatch, Flex, backend_extension};
use burn::optim::{
    AdamWConfig, AdamWState, AdaptiveMomentumState, LearningRate, ModuleOptimizer, Optimizer,
};
use burn::tensor::{Device, Tensor};
use pulp::{Arch, Simd, WithSimd};

use super::operation::values;
use crate::config::Training;

/// Decay of the first moment (mean gradient) per step.
const BETA_1: f32 = 0.9;
/// Decay of the second moment (mean squared gradient) per step.
const BETA_2: f32 = 0.999;
/// Constant added to the root of the second moment, against division by zero.
const EPSILON: f32 = 1e-8;

/// AdamW of this crate for training on the CPU. Gradients must be clipped before.
pub(super) fn optimizer(training: &Training) -> ModuleOptimizer {
    ModuleOptimizer::from(AdamW {
        weight_decay: training.weight_decay,
    })
}

/// AdamW in burn's own operations, for training on any device.
pub(super) fn composed_optimizer(training: &Training) -> ModuleOptimizer {
    AdamWConfig::new()
        .with_beta_1(BETA_1)
        .with_beta_2(BETA_2)
        .with_epsilon(EPSILON)
        .with_weight_decay(training.weight_decay)
        .init()
}

/// AdamW optimiser in one pass over memory.
#[derive(Debug, Clone)]
struct AdamW {
    /// Decoupled weight decay per step, relative to the learning rate.
    weight_decay: f32,
}

/// Factors of one AdamW step, common to all parameters.
#[derive(Debug, Clone, Copy)]
struct Factors {
    /// Learning rate of the step.
    rate: f32,
    /// Factor on the parameters by weight decay: 1 − rate·decay.
    kept: f32,
    /// Corrections of both moments' bias: 1 − β₁ᵗ and 1 − β₂ᵗ.
    corrections: (f32, f32),
}

/// Backend of burn that has an AdamW step in one pass.
#[backend_extension(Flex)]
trait AdamStep: Backend {
    /// Parameters, first and second moment after one step.
    fn adam_step(
        parameters: FloatTensor<Self>,
        gradient: FloatTensor<Self>,
        first: FloatTensor<Self>,
        second: FloatTensor<Self>,
        factors: Factors,
    ) -> (FloatTensor<Self>, FloatTensor<Self>, FloatTensor<Self>);
}

impl AdamStep for Flex {
    fn adam_step(
        mut parameters: FlexTensor,
        gradient: FlexTensor,
        mut first: FlexTensor,
        mut second: FlexTensor,
        factors: Factors,
    ) -> (FlexTensor, FlexTensor, FlexTensor) {
        // In place: nobody else holds these tensors by now.
        Arch::new().dispatch(Step {
            parameters: parameters.storage_mut(),
            gradient: values(&gradient),
            first: first.storage_mut(),
            second: second.storage_mut(),
            factors,
        });
        (parameters, first, second)
    }
}

/// Arguments of one AdamW step, to be run with the processor's vector instructions.
struct Step<'a> {
    parameters: &'a mut [f32],
    gradient: &'a [f32],
    first: &'a mut [f32],
    second: &'a mut [f32],
    factors: Factors,
}

impl WithSimd for Step<'_> {
    type Output = ();

    /// θ ← θ·(1 − rate·decay) − rate·m̂/(√v̂ + ε).
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Factors {
            rate,
            kept,
            corrections,
        } = self.factors;
        let moments = self.first.iter_mut().zip(self.second);
        for ((p, &g), (m, v)) in self.parameters.iter_mut().zip(self.gradient).zip(moments) {
            *m = *m * BETA_1 + g * (1.0 - BETA_1);
            *v = *v * BETA_2 + g * g * (1.0 - BETA_2);
            let direction = *m / corrections.0 / ((*v / corrections.1).sqrt() + EPSILON);
            *p = *p * kept - direction * rate;
        }
    }
}

impl Optimizer for AdamW {
    type State<const D: usize> = AdamWState<D>;

    fn step<const D: usize>(
        &self,
        rate: LearningRate,
        parameters: Tensor<D>,
        gradient: Tensor<D>,
        state: Option<AdamWState<D>>,
    ) -> (Tensor<D>, Option<AdamWState<D>>) {
        let AdaptiveMomentumState {
            time,
            moment_1,
            moment_2,
            ..
        } = match state {
            Some(state) => state.momentum,
            None => AdaptiveMomentumState::new(
                0,
                Tensor::zeros_like(&parameters),
                Tensor::zeros_like(&parameters),
            ),
        };
        let time = time + 1;
        let power = i32::try_from(time).unwrap_or(i32::MAX);
        let factors = Factors {
            rate: rate as f32,
            kept: (1.0 - rate * f64::from(self.weight_decay)) as f32,
            corrections: (1.0 - BETA_1.powi(power), 1.0 - BETA_2.powi(power)),
        };
        let (parameters, first, second) = <Dispatch as AdamStep>::adam_step(
            parameters.into_dispatch(),
            gradient.into_dispatch(),
            moment_1.into_dispatch(),
            moment_2.into_dispatch(),
            factors,
        );
        let momentum = AdaptiveMomentumState::new(
            time,
            Tensor::from_dispatch(first),
            Tensor::from_dispatch(second),
        );
        (
            Tensor::from_dispatch(parameters),
            Some(AdamWState::new(momentum)),
        )
    }

    fn to_device<const D: usize>(mut state: AdamWState<D>, device: &Device) -> AdamWState<D> {
        state.momentum = state.momentum.to_device(device);
        state
    }
}

#[cfg(test)]
mod tests {
    use burn::optim::GradientsParams;
    use burn::tensor::TensorData;

    use super::*;
    use crate::learning::weights::Weights;

    const SIZE: usize = 1000;

    fn training() -> Training {
        Training {
            weight_decay: 0.3,
            ..Training::default()
        }
    }

    fn start() -> Weights {
        Weights::new((0..SIZE).map(|i| (i as f32 * 0.7).sin()).collect())
    }

    /// Step k, with gradients of very different lengths.
    fn step(optimizer: &mut ModuleOptimizer, weights: Weights, k: usize) -> Weights {
        let size = if k.is_multiple_of(2) { 1.0 } else { 1e-3 };
        let gradient = (0..SIZE).map(|i| size * (i as f32 * 0.3 + k as f32).cos());
        let gradient = TensorData::new(gradient.collect(), [SIZE]);
        let tensor = Tensor::<1>::from_data(gradient, &Device::flex());
        let mut gradients = GradientsParams::new();
        gradients.register(weights.name(), tensor);
        optimizer.step(0.01 / (k as f64 + 1.0), weights, gradients)
    }

    #[test]
    fn same_bits_as_burns_own() {
        let (mut fused, mut own) = (optimizer(&training()), composed_optimizer(&training()));
        let (mut a, mut b) = (start(), start());
        for k in 0..50 {
            a = step(&mut fused, a, k);
            b = step(&mut own, b, k);
            assert_eq!(a.values(), b.values(), "step {k}");
        }
        assert_ne!(a.values(), start().values());
        assert_eq!(
            fused.into_bytes().unwrap().to_vec(),
            own.into_bytes().unwrap().to_vec(),
            "both write the same record"
        );
    }

    /// First step by hand: m̂ = g and v̂ = g², so every parameter moves by rate·sign(g) and, with decay, by
    /// rate·decay·θ towards zero.
    #[test]
    fn first_step_by_hand() {
        let before = start().values();
        let after = step(&mut optimizer(&training()), start(), 0).values();
        for i in [1, 7, 500] {
            let sign = (i as f32 * 0.3).cos().signum();
            let expected = before[i] * (1.0 - 0.01 * 0.3) - 0.01 * sign;
            assert!((after[i] - expected).abs() < 1e-6, "{i}: {}", after[i]);
        }
    }
}
