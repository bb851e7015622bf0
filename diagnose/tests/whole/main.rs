//! Whole diagnoses, each of which runs mostly on one thread: one program of tests runs two of them at a time.

mod before_after;
mod few_or_many;
mod patched;
mod proof;
mod real_arms;
mod shared_cases;
