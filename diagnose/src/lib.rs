//! Where the gap between a simulator's torque and a real robot's lies, which unmodelled effects cause
//! it, and how far it shrinks.
#![forbid(unsafe_code)]

pub mod analysis;
pub mod budget;
pub mod candidates;
pub mod cholesky;
mod confounders;
pub mod contact;
pub mod diagnosis;
pub mod dictionary;
pub mod effect;
pub mod error;
pub mod experiment;
pub mod explain;
pub mod files;
pub mod fit;
pub mod floor;
pub mod folds;
pub mod forward;
pub mod frame;
pub mod gram;
pub mod impacts;
pub mod ladder;
pub mod learned;
pub mod listing;
pub mod locate;
pub mod model;
pub mod moved;
pub mod objective;
pub mod order;
pub mod out_of_fold;
pub mod page;
pub mod patch;
pub mod prove;
pub mod quantities;
pub mod recordings;
pub mod report;
pub mod reversal;
pub mod rungs;
pub mod scene;
pub mod select;
mod shift;
pub mod standing;
pub mod unknown;
mod verdict;
pub mod words;
