//! A GPU for the training of networks.
#![forbid(unsafe_code)]

use burn::tensor::Device;
use burn::tensor::wgpu::wgpu;
use compensator::Error;
use compensator::training::Tensors;

/// The GPU that `wgpu` prefers (Vulkan, Metal or DirectX 12). `BURN_DEVICE` must not be set.
///
/// # Errors
/// [`Error::Gpu`]: there is none that can be used; a renderer in software is none.
pub fn gpu() -> Result<Tensors, Error> {
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
    Ok(Tensors::gpu(device))
}
