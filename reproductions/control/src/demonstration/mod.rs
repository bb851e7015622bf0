//! The robots of `eval --closed-loop`.

mod arm;
mod experiment;
mod machines;
mod page;
mod tables;
mod trial;

pub use self::arm::{Withheld, limits, machine, of_directory};
pub use self::machines::standard;
pub use experiment::{Compared, Demonstration, Experiment, Outcome};
pub use page::page;
pub use tables::{compared, errors};
