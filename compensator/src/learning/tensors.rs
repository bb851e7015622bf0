//! Where burn's own operations train, in place of the kernels.

#[cfg(feature = "gpu")]
use burn::tensor::wgpu::wgpu;
use burn::tensor::{DType, Device, Tensor, TensorData};

use crate::Error;

/// Where burn's tensor operations run in place of the kernels of this crate.
#[derive(Debug, Clone)]
pub struct Tensors {
    /// With its graph.
    pub(super) device: Device,
    dtype: DType,
    pub(super) is_gpu: bool,
}

impl Tensors {
    /// On the CPU: slower than the kernels, and the same to rounding.
    pub fn cpu() -> Self {
        Self::on(Device::flex(), DType::F32, false)
    }

    /// On the GPU that `wgpu` prefers (Vulkan, Metal or DirectX 12). `BURN_DEVICE` must not be set.
    ///
    /// # Errors
    /// [`Error::Gpu`]: the feature `gpu` is not compiled in, or there is no GPU that can be used; a renderer in software is none.
    #[cfg(feature = "gpu")]
    pub fn gpu() -> Result<Self, Error> {
        let (device, setup) = Device::wgpu_options()
            .init_with_setup()
            .map_err(|e| Error::Gpu(format!("no GPU can be used: {e}")))?;
        let adapter = setup.adapter.get_info();
        // It would train, far more slowly than the kernels on the same CPU.
        if adapter.device_type == wgpu::DeviceType::Cpu {
            let name = adapter.name;
            return Err(Error::Gpu(format!(
                "no GPU can be used: {name} is software on the CPU"
            )));
        }
        Ok(Self::on(device, DType::F32, true))
    }

    /// On a GPU; this build has no support for them.
    ///
    /// # Errors
    /// [`Error::Gpu`], always: the feature `gpu` is not compiled in.
    #[cfg(not(feature = "gpu"))]
    pub fn gpu() -> Result<Self, Error> {
        Err(Error::Gpu("this program was built without `gpu`".into()))
    }

    pub(super) fn on(device: Device, dtype: DType, is_gpu: bool) -> Self {
        Self {
            device: device.autodiff(),
            dtype,
            is_gpu,
        }
    }

    pub(super) fn tensor<const D: usize>(&self, values: &[f32], shape: [usize; D]) -> Tensor<D> {
        let data = TensorData::new(values.to_vec(), shape).convert_dtype(self.dtype);
        Tensor::from_data(data, (&self.device, self.dtype))
    }
}
