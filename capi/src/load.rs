//! From files or memory to a handle; versions.

use crate::code::{Code, Fault, remember};
use crate::handle::{Model, guarded};
use crate::slices::usable;
use feedforward::{Feedforward, Guard, LoadError};
use std::ffi::{CStr, c_char};
use std::path::Path;

/// Version of this interface: the header and the library that runs must have the same.
pub const RESIDYN_ABI: u32 = 1;

/// Version of the interface of the library that runs.
#[unsafe(no_mangle)]
pub extern "C" fn residyn_abi() -> u32 {
    RESIDYN_ABI
}

/// Version of the library that runs, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn residyn_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => panic!("a version has no zero inside"),
        };
    VERSION.as_ptr()
}

/// Loads a model directory for a loop of `period` seconds (0: the period of training) into `model`. Call it as residyn_load, which
/// hands the header's RESIDYN_ABI on.
///
/// # Safety
/// `directory` is null or a text that ends in zero; `model` is null or points to a handle's place.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_load_for(
    abi: u32,
    directory: *const c_char,
    period: f64,
    model: *mut *mut Model,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        load(abi, model, || {
            usable(directory)?;
            let Ok(directory) = CStr::from_ptr(directory).to_str() else {
                return Err(Fault(Code::ResidynValue, "the directory is not UTF-8"));
            };
            told(Feedforward::load(Path::new(directory), asked(period)))
        })
    }
}

/// Loads a model from the contents of its model.json and of its compensator.safetensors (null and 0: the physics alone), as
/// residyn_load does. Call it as residyn_load_memory.
///
/// # Safety
/// Pointers are null or point to as many bytes as their lengths say; `model` is null or points to a handle's place.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_load_memory_for(
    abi: u32,
    json: *const u8,
    json_length: usize,
    network: *const u8,
    network_length: usize,
    period: f64,
    model: *mut *mut Model,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        load(abi, model, || {
            usable(json)?;
            let json = std::slice::from_raw_parts(json, json_length);
            let network = if network.is_null() {
                None
            } else {
                Some(std::slice::from_raw_parts(network, network_length))
            };
            told(Feedforward::from_bytes(json, network, asked(period)))
        })
    }
}

/// Zero is the period of training; all else is judged where the model is put together.
fn asked(period: f64) -> Option<f64> {
    (period != 0.0).then_some(period)
}

/// Tells why a model cannot be loaded.
fn told(loaded: Result<Feedforward, LoadError>) -> Result<Feedforward, Fault> {
    loaded.map_err(|error| {
        remember(&error.to_string());
        Fault(Code::ResidynLoad, "")
    })
}

/// # Safety
/// `model` is null or points to a handle's place.
unsafe fn load(
    abi: u32,
    model: *mut *mut Model,
    read: impl FnOnce() -> Result<Feedforward, Fault>,
) -> Code {
    guarded(|| {
        usable(model)?;
        if abi != RESIDYN_ABI {
            return Err(Fault(
                Code::ResidynVersion,
                "residyn.h belongs to another libresidyn than the one that runs; compile with the header installed beside it",
            ));
        }
        let handle = Box::new(Model::new(Guard::new(read()?)));
        // SAFETY: not null, aligned, and by the caller's promise a handle's place.
        unsafe { model.write(Box::into_raw(handle)) };
        Ok(())
    })
}
