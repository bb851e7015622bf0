//! The ladder of errors: fits of what was found, and which causes stay on it.

pub(crate) mod listing;
pub(crate) mod out_of_fold;
pub(crate) mod rungs;
pub(crate) mod scores;
