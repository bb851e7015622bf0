//! Any bytes as a `compensator.safetensors`: an error or a network, never a panic.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run compensator`.
#![no_main]

use feedforward::network::Compensator;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = Compensator::from_bytes(bytes);
});
