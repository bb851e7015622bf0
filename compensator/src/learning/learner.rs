//! A network under training: parameters, optimiser, schedule, and their records.

use burn::grad_clipping::{GradientClipping, GradientClippingConfig};
use burn::lr_scheduler::LrSchedulerRecord;
use burn::lr_scheduler::module_lr_scheduler::ModuleLrScheduler;
use burn::optim::{GradientsParams, ModuleOptimizer};
use burn::store::RecordError;
use burn::tensor::{Bytes, Device};

use super::adamw::{composed_optimizer, optimizer};
use super::batch::{Batch, Cost};
use super::composed::Means;
use super::operation::{NotFinite, cost};
use super::schedule::rates;
use super::weights::Weights;
use crate::config::Training;

/// Network under training: parameters, optimiser and schedule, which change from step to step.
pub(crate) struct Learner {
    /// Parameters of the network.
    weights: Weights,
    /// Largest norm of a gradient; longer ones are shortened to it.
    clip: f32,
    /// Operation of burn that shortens gradients.
    clipping: GradientClipping,
    /// Optimiser with its moments.
    optimizer: ModuleOptimizer,
    /// Schedule of the learning rate.
    rates: ModuleLrScheduler,
    /// Tensor operations that compute the cost; none where the kernels do.
    means: Option<Means>,
}

/// State of a learner as burn's records, for a checkpoint.
pub(crate) struct Records {
    /// Record of the parameters.
    pub(crate) weights: Bytes,
    /// Record of the optimiser.
    pub(crate) optimizer: Bytes,
    /// Record of the schedule.
    pub(crate) schedule: Bytes,
}

impl Learner {
    /// Learner for `steps` steps from the given weights, by the kernels or by composed operations.
    ///
    /// # Errors
    /// A rate out of range, or a device that burn cannot use.
    pub(crate) fn new(
        weights: Weights,
        training: &Training,
        steps: usize,
        means: Option<Means>,
    ) -> Result<Self, String> {
        let is_gpu = means.as_ref().is_some_and(|m| m.tensors.is_gpu);
        // burn reads its records onto the default device, and panics where that is not there.
        if let Ok(device) = std::env::var("BURN_DEVICE")
            && (is_gpu || !device.eq_ignore_ascii_case("flex"))
        {
            let place = if is_gpu { "the GPU" } else { "the CPU" };
            return Err(format!(
                "the environment asks burn for BURN_DEVICE={device}; training runs on {place}, unset it"
            ));
        }
        Ok(Self {
            weights: match &means {
                Some(means) => weights.moved(&means.tensors),
                None => weights,
            },
            clip: training.clip,
            clipping: GradientClippingConfig::Norm(training.clip).init(),
            optimizer: match means {
                Some(_) => composed_optimizer(training),
                None => optimizer(training),
            },
            rates: rates(training, steps)?,
            means,
        })
    }

    /// Parameters of the network.
    pub(crate) fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Takes one training step on a batch: forward and backward pass, clipping, AdamW.
    ///
    /// # Errors
    /// Cost or gradient that is not finite; no step was taken.
    pub(crate) fn step(&mut self, batch: &mut Batch) -> Result<Cost, NotFinite> {
        let (mut gradients, cost) = match &self.means {
            Some(means) => means.gradients(&self.weights, batch)?,
            None => {
                let (mean, cost) = cost(self.weights.tensor(), batch)?;
                let gradients = GradientsParams::from_grads(mean.backward(), &self.weights);
                (gradients, cost)
            }
        };
        // A shorter gradient comes out of burn's clipping as it went in, five passes over memory later.
        if cost.norm_squared.sqrt() > self.clip {
            let name = self.weights.name();
            if let Some(long) = gradients.remove::<1>(name) {
                gradients.register(name, self.clipping.clip_gradient(long));
            }
        }
        // The optimiser works in place on what nobody else holds.
        let weights = std::mem::replace(&mut self.weights, Weights::new(Vec::new()));
        self.weights = self.optimizer.step(self.rates.step(), weights, gradients);
        Ok(cost)
    }

    /// Advances the schedule over a batch without weighted samples.
    pub(crate) fn skip(&mut self) {
        self.rates.step();
    }

    /// State of the learner, on which all further steps depend.
    ///
    /// # Errors
    /// Record that burn could not write.
    pub(crate) fn records(&self) -> Result<Records, RecordError> {
        Ok(Records {
            weights: self.weights.record()?,
            optimizer: self.optimizer.into_bytes()?,
            schedule: self.rates.to_record().into_bytes()?,
        })
    }

    /// Learner with these settings in the recorded state.
    ///
    /// # Errors
    /// Records of another learner. burn drops state that does not fit without an error. The restored state is therefore
    /// written again and compared.
    pub(crate) fn restore(self, records: Records) -> Result<Self, String> {
        let is_gpu = self.means.as_ref().is_some_and(|m| m.tensors.is_gpu);
        // A program with support for a GPU has it as burn's default device.
        if !is_gpu && Device::default() != Device::flex() {
            return Err(
                "this build reads it onto a GPU; set BURN_DEVICE=flex to go on on the CPU".into(),
            );
        }
        let other = |what: &str| format!("its {what} is not one of this training");
        let text = |e: RecordError| e.to_string();
        let restored = Self {
            weights: self.weights.restore(records.weights.clone())?,
            clip: self.clip,
            clipping: self.clipping,
            optimizer: self
                .optimizer
                .from_bytes(records.optimizer.clone())
                .map_err(text)?,
            rates: self.rates.load_record(
                LrSchedulerRecord::from_bytes(records.schedule.clone()).map_err(text)?,
            ),
            means: self.means,
        };
        let written = restored.records().map_err(text)?;
        match () {
            () if written.weights[..] != records.weights[..] => Err(other("parameters")),
            () if written.optimizer[..] != records.optimizer[..] => Err(other("optimiser")),
            () if written.schedule[..] != records.schedule[..] => Err(other("schedule")),
            () => Ok(restored),
        }
    }
}

#[cfg(test)]
mod tests {
    use feedforward::network::Architecture;

    use super::*;
    use crate::engine::{Network, Span};

    /// y = w·x + b on two inputs, away from its target.
    fn batch(size: f32) -> Batch {
        let architecture = Architecture::Perceptron {
            hidden: vec![],
            timestep: 1,
        };
        let network = Network::new(&architecture, 2).unwrap();
        let mut batch = Batch::new(network, crate::config::Loss::Mse);
        batch.begin(Span {
            batch: 2,
            steps: 1,
            first: 0,
        });
        for row in 0..2 {
            batch
                .network
                .input_mut(0, row)
                .copy_from_slice(&[size, 1.0]);
        }
        batch.targets.extend([(0.5, 1.0), (-0.25, 2.0)]);
        batch
    }

    fn learner(size: usize) -> Learner {
        Learner::new(
            Weights::new(vec![0.1; size]),
            &Training::default(),
            10,
            None,
        )
        .unwrap()
    }

    #[test]
    fn a_step_on_what_is_not_finite_changes_nothing() {
        let mut learner = learner(3);
        assert_eq!(learner.step(&mut batch(f32::NAN)), Err(NotFinite::Loss));
        // Finite cost in double precision, but a gradient whose square is not: burn would clip it to zero.
        assert_eq!(learner.step(&mut batch(1e15)), Err(NotFinite::Gradient));
        assert_eq!(learner.weights().values(), [0.1; 3]);
        let cost = learner.step(&mut batch(1.0)).unwrap();
        // r = 0.3 − 0.5 and 0.3 + 0.25: (0.02 + 2·0.15125) with weights 1 and 2.
        assert!(
            (cost.sum - 0.3225).abs() < 1e-6 && cost.weight == 3.0,
            "{cost:?}"
        );
        assert!(learner.weights().values().iter().all(|w| *w != 0.1));
    }

    /// Long gradients are shortened, short ones are what they were: both as burn's own optimiser does it.
    #[test]
    fn clipped_as_by_burns_own_optimiser() {
        for size in [0.01, 30.0] {
            let mut ours = learner(3);
            ours.step(&mut batch(size)).unwrap();
            let settings = Training::default();
            let mut own = optimizer(&settings)
                .with_grad_clipping(GradientClippingConfig::Norm(settings.clip).init());
            let weights = Weights::new(vec![0.1; 3]);
            let (mean, cost) = cost(weights.tensor(), &mut batch(size)).unwrap();
            assert_eq!(cost.norm_squared > 1.0, size > 1.0, "{cost:?}");
            let gradients = GradientsParams::from_grads(mean.backward(), &weights);
            let rate = rates(&settings, 10).unwrap().step();
            let weights = own.step(rate, weights, gradients);
            assert_eq!(ours.weights().values(), weights.values());
            // Adam's step hides the gradient's length, its moments do not.
            let theirs = own.into_bytes().unwrap();
            assert_eq!(ours.records().unwrap().optimizer[..], theirs[..]);
        }
    }

    #[test]
    fn restored_goes_on_with_the_same_bits() {
        let mut straight = learner(3);
        let mut broken = learner(3);
        for _ in 0..4 {
            straight.step(&mut batch(1.0)).unwrap();
            broken.step(&mut batch(1.0)).unwrap();
        }
        let mut broken = learner(3).restore(broken.records().unwrap()).unwrap();
        for _ in 0..4 {
            straight.step(&mut batch(1.5)).unwrap();
            broken.step(&mut batch(1.5)).unwrap();
        }
        assert_eq!(straight.weights().values(), broken.weights().values());
    }

    #[test]
    fn records_of_another_shape_or_of_nothing_are_refused() {
        let mut small = learner(3);
        small.step(&mut batch(1.0)).unwrap();
        let records = || small.records().unwrap();
        let refused = |learner: Learner, records| learner.restore(records).err().unwrap();
        let message = refused(learner(4), records());
        assert!(message.contains("shape"), "{message}");
        let mut mixed = records();
        mixed.optimizer = mixed.weights.clone();
        assert!(!refused(learner(3), mixed).is_empty());
        let mut mixed = records();
        mixed.schedule = mixed.optimizer.clone();
        assert!(!refused(learner(3), mixed).is_empty());
        let mut cut = records();
        cut.weights = Bytes::from_bytes_vec(cut.weights[..cut.weights.len() - 1].to_vec());
        assert!(!refused(learner(3), cut).is_empty());
    }
}
