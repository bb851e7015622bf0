//! Bad input to `train`, `eval` and `replay`: exit status 2, one line that names the place, nothing written.

mod arguments;
mod models;
mod recordings;
mod refused;
mod replay;
