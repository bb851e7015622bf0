//! The report as text and as a page.

pub mod page;
pub(crate) mod trace;
pub mod words;
