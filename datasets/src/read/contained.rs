//! Decoders of others, kept from taking the program down.

use crate::{Problem, ReadError};
use std::cell::Cell;
use std::panic::{UnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Once;

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder and turns a panic in it into damage of the file.
///
/// Decoders assert properties that a damaged file may lack (in Parquet a dictionary page before the pages that
/// use it, in MATLAB files a length that can be rounded up).
pub(super) fn contained<T>(
    format: &'static str,
    file: &Path,
    decode: impl FnOnce() -> Result<T, ReadError> + UnwindSafe,
) -> Result<T, ReadError> {
    quietly(|| catch_unwind(decode)).unwrap_or_else(|_| {
        let detail = "its decoder gave up".to_owned();
        Err(Problem::Damaged { format, detail }.in_file(file))
    })
}

/// Runs `work` without printing the message of a panic of this thread. Other threads and the hook that the
/// program has set are left alone.
fn quietly<T>(work: impl FnOnce() -> T) -> T {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !QUIET.get() {
                previous(info);
            }
        }));
    });
    let before = QUIET.replace(true);
    let result = work();
    QUIET.set(before);
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_damage() {
        let file = Path::new("run.mat");
        let error = contained::<()>("MATLAB", file, || panic!("attempt to add with overflow"));
        assert!(error.unwrap_err().to_string().contains("run.mat"));
        assert_eq!(contained("MATLAB", file, || Ok(1)).unwrap(), 1);
    }
}
