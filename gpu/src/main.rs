//! `train`, with a GPU for `--gpu`.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    train::command_line_with(std::env::args_os(), gpu::gpu)
}
