//! Device of burn's own operations in place of the kernels.

use burn::tensor::{DType, Device, Tensor, TensorData};

/// Device on which burn's tensor operations run in place of the kernels of this crate.
#[derive(Debug, Clone)]
pub struct Tensors {
    /// Device of burn, with automatic differentiation.
    pub(super) device: Device,
    dtype: DType,
    /// Whether the device is a GPU.
    pub(super) is_gpu: bool,
}

impl Tensors {
    /// Tensor operations on the CPU: slower than the kernels, with equal results up to rounding.
    pub fn cpu() -> Self {
        Self::on(Device::flex(), DType::F32, false)
    }

    /// Tensor operations on a GPU device of burn. `BURN_DEVICE` must not be set.
    pub fn gpu(device: Device) -> Self {
        Self::on(device, DType::F32, true)
    }

    /// Tensor operations on a device, with numbers of type `dtype`.
    pub(super) fn on(device: Device, dtype: DType, is_gpu: bool) -> Self {
        Self {
            device: device.autodiff(),
            dtype,
            is_gpu,
        }
    }

    /// Tensor of this shape on the device.
    pub(super) fn tensor<const D: usize>(&self, values: &[f32], shape: [usize; D]) -> Tensor<D> {
        let data = TensorData::new(values.to_vec(), shape).convert_dtype(self.dtype);
        Tensor::from_data(data, (&self.device, self.dtype))
    }
}
