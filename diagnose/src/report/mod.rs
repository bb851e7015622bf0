//! The report in words and as a page.

pub mod page;
pub mod words;
