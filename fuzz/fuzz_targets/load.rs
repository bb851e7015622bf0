//! Any bytes as the files of a model directory: a code, or a handle whose torque is finite or refused; never a panic.
//!
//! First byte 0: the others are a `model.json`. 1: they are a `compensator.safetensors` of a right `model.json`. 2: the same, with
//! its own checksum made right, so that what lies behind it is reached.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run load`; `FUZZ_SEEDS=FOLDER` writes valid inputs there first.
#![no_main]

mod robot;

use libfuzzer_sys::fuzz_target;
use residyn_c::*;
use safetensors::SafeTensors;
use sha2::{Digest, Sha256};
use std::ptr::{null, null_mut};

fuzz_target!(init: seeds(), |bytes: &[u8]| {
    match bytes.split_first() {
        Some((0, json)) => load(json, None),
        Some((1, network)) => load(&robot::model(Some(network)), Some(network)),
        Some((2, network)) => {
            if let Some(network) = sealed(network) {
                load(&robot::model(Some(&network)), Some(&network));
            }
        }
        _ => {}
    }
});

/// The file with the checksum of its content, as `docs/compensator-format.md` describes it; none for what is no such file.
fn sealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let (_, metadata) = SafeTensors::read_metadata(bytes).ok()?;
    let file = SafeTensors::deserialize(bytes).ok()?;
    let envelope = metadata.metadata().as_ref()?.get("residyn")?;
    let mut envelope: serde_json::Value = serde_json::from_str(envelope).ok()?;
    let mut hash = Sha256::new();
    hash.update(envelope["header"].as_str()?);
    let mut tensors = file.tensors();
    tensors.sort_by(|a, b| a.0.cmp(&b.0));
    for (name, tensor) in &tensors {
        hash.update([0]);
        hash.update(name);
        for size in tensor.shape() {
            hash.update([0]);
            hash.update(size.to_string());
        }
        hash.update([0]);
        hash.update(tensor.data());
    }
    let hexadecimal = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
    *envelope.get_mut("sha256")? = serde_json::Value::String(hexadecimal);
    let metadata = Some(
        [("residyn".to_owned(), envelope.to_string())]
            .into_iter()
            .collect(),
    );
    safetensors::serialize(tensors, metadata).ok()
}

/// Valid inputs of each kind.
fn seeds() {
    let Some(folder) = std::env::var_os("FUZZ_SEEDS") else {
        return;
    };
    let network = robot::network();
    for (kind, content) in [robot::model(None), network.clone(), network]
        .iter()
        .enumerate()
    {
        let seed = [&[kind as u8], &content[..]].concat();
        std::fs::write(std::path::Path::new(&folder).join(format!("{kind}")), seed)
            .expect("a folder that can be written");
    }
}

fn load(json: &[u8], network: Option<&[u8]>) {
    let mut model = null_mut();
    let (pointer, length) = network.map_or((null(), 0), |n| (n.as_ptr(), n.len()));
    // SAFETY: pointers to values that live during the call.
    let code = unsafe {
        residyn_load_memory_for(
            RESIDYN_ABI,
            json.as_ptr(),
            json.len(),
            pointer,
            length,
            0.0,
            &mut model,
        )
    };
    assert_ne!(code, Code::ResidynPanic);
    if code != Code::ResidynOk {
        return;
    }
    let mut n = 0;
    // SAFETY: a handle that was just made, and arrays as long as it says.
    unsafe {
        assert_eq!(residyn_joints(model, &mut n), Code::ResidynOk);
        let (q, mut tau) = (vec![0.3; n], vec![0.0; n]);
        for _ in 0..4 {
            let mut status = 0;
            let (q, tau) = (q.as_ptr(), tau.as_mut_ptr());
            let code = residyn_torque(model, q, q, q, tau, n, &mut status);
            assert_ne!(code, Code::ResidynPanic);
        }
        assert_eq!(residyn_free(model), Code::ResidynOk);
    }
}
