//! The report as text and as a page.

pub mod page;
pub mod words;
