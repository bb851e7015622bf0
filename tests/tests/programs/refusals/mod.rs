//! Bad input to `train` and `eval`: exit status 2, one line that names the place, nothing written.

mod arguments;
mod models;
mod recordings;
mod refused;
