//! Comparison of models on one recording, with published results on it.

mod board;
mod bootstrap;
mod contest;
mod entry;
mod error;
mod inference;
mod page;

pub use board::{Given, Leaderboard};
pub use bootstrap::{Intervals, Judged, Stretches, judge};
pub use contest::{Contest, hold};
pub use entry::{Entry, Publication, Training};
pub use error::LeaderboardError;
pub use page::{page, summary, table};
