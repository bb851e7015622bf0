//! Printing to a person who may stop reading.

use std::fmt::Arguments;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Whether standard output was closed by its reader.
static CLOSED: AtomicBool = AtomicBool::new(false);
/// Whether standard output is kept for a file.
static KEPT: AtomicBool = AtomicBool::new(false);

/// Whether nothing but errors and files is printed.
static SILENT: AtomicBool = AtomicBool::new(false);

/// Prints nothing but errors, warnings and files called `-` from here on.
pub fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// Reserves standard output for a file called `-`: messages to a person go to standard error from here on.
pub(crate) fn keep_standard_output() {
    KEPT.store(true, Ordering::Relaxed);
}

/// Writes the text of `say!` and `say_text!` to standard output.
///
/// A closed pipe (`… | head`) is the end of the output and no failure: later text is dropped, and the program
/// goes on to write its files. Any other failure (a full disk) is reported once on standard error.
pub fn out(text: Arguments) {
    if SILENT.load(Ordering::Relaxed) {
        return;
    }
    if KEPT.load(Ordering::Relaxed) {
        return err(text);
    }
    written(|stream| stream.write_fmt(text));
}

/// Writes a file called `-` to standard output.
pub(crate) fn kept(contents: &[u8]) {
    written(|stream| stream.write_all(contents));
}

fn written(write: impl FnOnce(&mut std::io::StdoutLock) -> std::io::Result<()>) {
    if CLOSED.load(Ordering::Relaxed) {
        return;
    }
    let mut stream = std::io::stdout().lock();
    if let Err(error) = write(&mut stream).and_then(|()| stream.flush()) {
        CLOSED.store(true, Ordering::Relaxed);
        if error.kind() != ErrorKind::BrokenPipe {
            err(format_args!(
                "error: cannot write standard output: {error}\n"
            ));
        }
    }
}

/// Writes to standard error; a failure to do so is ignored.
pub fn err(text: Arguments) {
    let _ = std::io::stderr().lock().write_fmt(text);
}

/// Time after which a person wants to know what a program is at, s.
const SHORT: f64 = 2.0;

/// Says which stage of a longer work begins, where no terminal shows a bar: a line on standard error with the time since `begun`.
/// What is done or refused at once says no stage.
pub fn stage(begun: Instant, stage: &str) {
    let passed = begun.elapsed().as_secs_f64();
    let shown = !SILENT.load(Ordering::Relaxed) && !std::io::stderr().is_terminal();
    if passed >= SHORT && shown {
        err(format_args!("{passed:6.1} s  {stage}\n"));
    }
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
