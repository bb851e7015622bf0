//! Printing to a person who may stop reading.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether standard output was closed by its reader.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Writes to standard output what `say!` and `say_text!` give.
///
/// A closed pipe (`… | head`) is the end of the output and no failure: what comes later is dropped, and the
/// program goes on to write its files. Any other failure (a full disk) is said once on standard error.
pub fn out(text: Arguments) {
    if CLOSED.load(Ordering::Relaxed) {
        return;
    }
    let mut stream = std::io::stdout().lock();
    if let Err(error) = stream.write_fmt(text).and_then(|()| stream.flush()) {
        CLOSED.store(true, Ordering::Relaxed);
        if error.kind() != ErrorKind::BrokenPipe {
            err(format_args!(
                "error: cannot write standard output: {error}\n"
            ));
        }
    }
}

/// Writes to standard error; where nobody listens there is nobody to tell.
pub fn err(text: Arguments) {
    let _ = std::io::stderr().lock().write_fmt(text);
}

/// Prints a line to standard output, as `println!` does; a closed pipe is its end, not a panic.
#[macro_export]
macro_rules! say {
    () => { $crate::say::out(format_args!("\n")) };
    ($($text:tt)*) => { $crate::say::out(format_args!("{}\n", format_args!($($text)*))) };
}

/// Prints text that carries its own line breaks (a table) to standard output.
#[macro_export]
macro_rules! say_text {
    ($text:expr $(,)?) => {
        $crate::say::out(format_args!("{}", $text))
    };
}

/// Prints a line to standard error.
#[macro_export]
macro_rules! warn {
    ($($text:tt)*) => { $crate::say::err(format_args!("{}\n", format_args!($($text)*))) };
}
