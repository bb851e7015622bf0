//! Recordings of real robots, where the shared data are there.

mod kr300;
mod motion;
mod raw;
mod real_gaps;
mod ur10e;
