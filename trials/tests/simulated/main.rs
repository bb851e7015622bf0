//! Simulated recordings: what they hold, and that a seed says all of it.

mod cases;
mod raw;
