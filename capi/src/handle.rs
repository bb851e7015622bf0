//! The opaque handle: a guarded model that one thread at a time may use.

use crate::code::{Code, Fault, remember};
use crate::slices::usable;
use feedforward::Guard;
use std::cell::UnsafeCell;
use std::ffi::{CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, Ordering};

const FREE: u32 = 0;
const BUSY: u32 = 1;
const BROKEN: u32 = 2;

/// A loaded model with its memory. One thread at a time may use it; residyn_clone makes one for another thread.
pub struct Model {
    /// Whether a call is in progress, or a panic has left the model as it may be.
    state: AtomicU32,
    inner: UnsafeCell<Inner>,
    names: Vec<CString>,
    period: f64,
    compensated: bool,
}

/// What a call may change.
pub(crate) struct Inner {
    pub guard: Guard,
    pub scratch: Vec<f64>,
}

impl Model {
    pub(crate) fn new(guard: Guard) -> Self {
        let model = guard.model();
        let name = |name: &String| CString::new(name.replace('\0', "")).unwrap_or_default();
        Self {
            state: AtomicU32::new(FREE),
            names: model.joint_names().iter().map(name).collect(),
            period: model.period(),
            compensated: model.is_compensated(),
            inner: UnsafeCell::new(Inner {
                scratch: vec![0.0; model.dof()],
                guard,
            }),
        }
    }

    pub(crate) fn joints(&self) -> usize {
        self.names.len()
    }
}

/// Runs a step that may fail or panic, and tells the thread's last error.
pub(crate) fn guarded(step: impl FnOnce() -> Result<(), Fault>) -> Code {
    match catch_unwind(AssertUnwindSafe(step)) {
        Ok(Ok(())) => Code::ResidynOk,
        Ok(Err(Fault(code, words))) => {
            // A step that has told more itself leaves no words here.
            if !words.is_empty() {
                remember(words);
            }
            code
        }
        Err(_) => {
            remember("a bug of libresidyn: a call panicked; the handle can only be freed");
            Code::ResidynPanic
        }
    }
}

/// Runs a step on what a handle holds, alone.
///
/// # Safety
/// `model` is null or a handle that was not freed.
pub(crate) unsafe fn with(
    model: *const Model,
    step: impl FnOnce(&Model, &mut Inner) -> Result<(), Fault>,
) -> Code {
    // SAFETY: passed on.
    let entered = unsafe { enter(model) };
    let model = match entered {
        Ok(model) => model,
        Err(fault) => return guarded(|| Err(fault)),
    };
    // SAFETY: the state was free and is busy now, so nobody else is here.
    let inner = unsafe { &mut *model.inner.get() };
    let code = guarded(|| step(model, inner));
    let broken = code == Code::ResidynPanic;
    model
        .state
        .store(if broken { BROKEN } else { FREE }, Ordering::Release);
    code
}

/// Takes a handle for the calling thread.
///
/// # Safety
/// As [`with`].
unsafe fn enter<'a>(model: *const Model) -> Result<&'a Model, Fault> {
    usable(model)?;
    // SAFETY: not null, aligned, and by the caller's promise a handle; what changes in it is in cells.
    let model = unsafe { &*model };
    match model
        .state
        .compare_exchange(FREE, BUSY, Ordering::Acquire, Ordering::Relaxed)
    {
        Ok(_) => Ok(model),
        Err(BUSY) => Err(Fault(
            Code::ResidynBusy,
            "another thread is in a call on the same handle; give each its own by residyn_clone",
        )),
        Err(_) => Err(Fault(
            Code::ResidynPanic,
            "an earlier call on the handle panicked; it can only be freed",
        )),
    }
}

/// Looks at what of a handle never changes.
///
/// # Safety
/// As [`with`].
unsafe fn look<T>(
    model: *const Model,
    out: *mut T,
    step: impl FnOnce(&Model) -> Result<T, Fault>,
) -> Code {
    guarded(|| {
        usable(model)?;
        usable(out)?;
        // SAFETY: not null, aligned, and by the caller's promise a handle.
        let value = step(unsafe { &*model })?;
        // SAFETY: not null, aligned, and by the caller's promise one value.
        unsafe { out.write(value) };
        Ok(())
    })
}

/// Another handle with the same model in the same state, for another thread.
///
/// # Safety
/// `model` is null or a handle that was not freed; `copy` is null or points to a handle's place.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_clone(model: *const Model, copy: *mut *mut Model) -> Code {
    // SAFETY: passed on.
    unsafe {
        with(model, |_, inner| {
            usable(copy)?;
            let twin = Box::into_raw(Box::new(Model::new(inner.guard.clone())));
            copy.write(twin);
            Ok(())
        })
    }
}

/// Frees a handle; null is allowed. A handle in use by another thread is not freed.
///
/// # Safety
/// `model` is null or a handle that was not freed; it is none afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_free(model: *mut Model) -> Code {
    if model.is_null() {
        return Code::ResidynOk;
    }
    // SAFETY: passed on.
    if let Err(fault @ Fault(Code::ResidynBusy | Code::ResidynPointer, _)) = unsafe { enter(model) }
    {
        return guarded(|| Err(fault));
    }
    guarded(|| {
        // SAFETY: it came from `Box::into_raw`, and nobody is in a call on it.
        drop(unsafe { Box::from_raw(model) });
        Ok(())
    })
}

/// Number of joints.
///
/// # Safety
/// `model` is null or a handle that was not freed; `joints` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_joints(model: *const Model, joints: *mut usize) -> Code {
    // SAFETY: passed on.
    unsafe { look(model, joints, |model| Ok(model.joints())) }
}

/// Name of a joint (0: at the base), as the robot's description has it. The text lives as long as the handle.
///
/// # Safety
/// `model` is null or a handle that was not freed; `name` is null or points to one pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_joint_name(
    model: *const Model,
    joint: usize,
    name: *mut *const c_char,
) -> Code {
    // SAFETY: passed on.
    unsafe {
        look(model, name, |model| match model.names.get(joint) {
            Some(name) => Ok(name.as_ptr()),
            None => Err(Fault(Code::ResidynLength, "the model has no such joint")),
        })
    }
}

/// Control period, s.
///
/// # Safety
/// `model` is null or a handle that was not freed; `period` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_period(model: *const Model, period: *mut f64) -> Code {
    // SAFETY: passed on.
    unsafe { look(model, period, |model| Ok(model.period)) }
}

/// Whether the model has a compensator: 1, or 0 where it is physics alone.
///
/// # Safety
/// `model` is null or a handle that was not freed; `answer` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn residyn_is_compensated(model: *const Model, answer: *mut c_int) -> Code {
    // SAFETY: passed on.
    unsafe { look(model, answer, |model| Ok(c_int::from(model.compensated))) }
}
