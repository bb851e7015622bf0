//! Parameters of a network as a burn module.

use burn::module::{Module, Param, ParamId};
use burn::store::{ModuleRecord, RecordError};
use burn::tensor::{Bytes, DType, Device, Tensor, TensorData};
use feedforward::network::Architecture;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::tensors::Tensors;

/// Name of the parameter vector in burn's records. A fixed one makes records equal byte for byte; burn draws a random
/// one.
const NAME: u64 = 1;

/// Parameters of a network as one flat vector, laid out by [`Architecture::tensors`].
#[derive(Module, Debug)]
pub(crate) struct Weights {
    flat: Param<Tensor<1>>,
}

impl Weights {
    /// Parameters to be trained by the kernels.
    pub(crate) fn new(values: Vec<f32>) -> Self {
        // Never the default device: that prefers a GPU where one is compiled in.
        Self::on(&Device::flex().autodiff(), values)
    }

    /// Parameters on a device, with automatic differentiation.
    fn on(device: &Device, values: Vec<f32>) -> Self {
        let size = [values.len()];
        let tensor = Tensor::from_data(TensorData::new(values, size), device);
        Self {
            flat: Param::initialized(ParamId::from(NAME), tensor.require_grad()),
        }
    }

    /// Random initial parameters, uniform in ±1/√(inputs of the layer). Forget biases of LSTM layers start at 1, so
    /// that gradients reach far back. The output starts at `level`.
    ///
    /// They are drawn from `rng`, so that one seed gives the same parameters whatever else is trained. burn's own
    /// initialisers share one generator in the whole process.
    pub(crate) fn initial(
        architecture: &Architecture,
        inputs: usize,
        level: f32,
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let mut values = Vec::new();
        let tensors = architecture.tensors(inputs).unwrap_or_default();
        let last = tensors.len().saturating_sub(1);
        for (i, t) in tensors.iter().enumerate() {
            let lstm = t.name.starts_with("encoder") || t.name.starts_with("reencoder");
            let fan = if lstm {
                t.shape[1] / 4
            } else {
                t.shape[0].max(if t.name == "attention.score" {
                    t.shape[1]
                } else {
                    1
                })
            };
            let bound = 1.0 / (fan as f32).sqrt();
            let bias = t.name.ends_with("bias");
            values.extend((0..t.range.len()).map(|k| match () {
                () if i == last => level,
                () if bias && lstm && k / fan == 1 => 1.0,
                () if bias => 0.0,
                () => rng.random_range(-bound..bound),
            }));
        }
        Self::new(values)
    }

    /// Parameters moved to the device of the tensors.
    pub(crate) fn moved(&self, tensors: &Tensors) -> Self {
        Self::on(&tensors.device, self.values())
    }

    /// Parameters as a tensor, with automatic differentiation where the device has it.
    pub(super) fn tensor(&self) -> Tensor<1> {
        self.flat.val()
    }

    /// Name of the parameter in the gradients and in the optimiser.
    pub(super) fn name(&self) -> ParamId {
        self.flat.id
    }

    /// Number of parameters of the network.
    pub(crate) fn len(&self) -> usize {
        self.num_params()
    }

    /// Copy of the parameters.
    pub(crate) fn values(&self) -> Vec<f32> {
        let data = self.tensor().inner().into_data();
        data.iter::<f32>().collect()
    }

    /// Record of the parameters, in burn's format.
    ///
    /// # Errors
    /// Record that burn could not write.
    pub(crate) fn record(&self) -> Result<Bytes, RecordError> {
        self.clone().into_record().into_bytes()
    }

    /// Recorded parameters in place of these.
    ///
    /// # Errors
    /// Bytes that are no record, or one of another shape, type or parameter.
    pub(crate) fn restore(self, record: Bytes) -> Result<Self, String> {
        let size = self.len();
        let restored = ModuleRecord::from_bytes(record)
            .and_then(|record| self.try_load_record(record))
            .map_err(|e| e.to_string())?;
        if restored.flat.id != ParamId::from(NAME)
            || restored.len() != size
            || restored.tensor().dtype() != DType::F32
        {
            return Err("its parameters are not those of this network".into());
        }
        Ok(restored)
    }
}
