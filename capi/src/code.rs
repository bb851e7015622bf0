//! What a call returns, and the words for it.

use std::cell::UnsafeCell;
use std::ffi::c_char;

/// What became of a call.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(clippy::enum_variant_names)] // Names of C have no room of their own.
pub enum Code {
    /// Done.
    ResidynOk = 0,
    /// A pointer is null, not aligned, or two that must not overlap do.
    ResidynPointer = 1,
    /// Another number of values than the model has joints, or no such joint.
    ResidynLength = 2,
    /// A value is not finite.
    ResidynNotFinite = 3,
    /// A value that is no setting: a negative limit, a text that is not UTF-8.
    ResidynValue = 4,
    /// The model cannot be read: missing, damaged, of another version, not for this period, or with another network than
    /// model.json has the checksum of. model.json itself has none: an altered value there is not noticed.
    ResidynLoad = 5,
    /// The header belongs to another library than the one that runs.
    ResidynVersion = 6,
    /// Another thread is in a call on the same handle.
    ResidynBusy = 7,
    /// A bug of the library. Its handle can only be freed.
    ResidynPanic = 8,
}

/// A code with words.
pub(crate) struct Fault(pub Code, pub &'static str);

/// Longest message with its end, bytes.
const LONGEST: usize = 512;

thread_local! {
    /// In place, so that a message allocates nothing.
    static MESSAGE: UnsafeCell<[u8; LONGEST]> = const { UnsafeCell::new([0; LONGEST]) };
}

/// Keeps the words of the calling thread's last error.
pub(crate) fn remember(message: &str) {
    let mut end = message.len().min(LONGEST - 1);
    while !message.is_char_boundary(end) {
        end -= 1;
    }
    MESSAGE.with(|kept| {
        // SAFETY: the cell is this thread's, nothing in here calls back, and C reads it only between calls.
        let kept = unsafe { &mut *kept.get() };
        kept[..end].copy_from_slice(&message.as_bytes()[..end]);
        kept[end] = 0;
    });
}

/// Words for the last call of this thread that returned another code than RESIDYN_OK; empty before the first. The text stays until
/// the next such call of the thread.
#[unsafe(no_mangle)]
pub extern "C" fn residyn_last_error() -> *const c_char {
    MESSAGE.with(|kept| kept.get().cast_const().cast())
}
