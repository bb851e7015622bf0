//! Whole diagnoses, each of which runs mostly on one thread: one program of tests runs two of them at a time.

mod attainable;
mod before_after;
mod blows;
mod few_or_many;
mod headline;
mod patched;
mod proof;
mod real_arms;
#[path = "../../../tests/src/shared.rs"]
mod shared;
mod shared_cases;

pub(crate) use shared::shared;
