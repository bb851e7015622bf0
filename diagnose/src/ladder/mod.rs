//! The ladder of errors: refits with the accepted causes, and the causes that are listed.

pub(crate) mod listing;
pub(crate) mod out_of_fold;
pub(crate) mod rungs;
pub(crate) mod scores;
