//! Training on a GPU against the kernels, by the tests that `compensator` runs on the CPU.

#[path = "../../compensator/tests/training/hysteresis.rs"]
mod hysteresis;
#[path = "../../compensator/tests/training/tensors.rs"]
mod tensors;

#[test]
#[ignore = "needs a GPU"]
fn on_a_gpu() {
    let gpu = gpu::gpu().unwrap();
    tensors::ends_where_the_kernels_end_on(&gpu);
    tensors::interrupted_and_resumed_as_if_it_never_was_on(&gpu);
}
