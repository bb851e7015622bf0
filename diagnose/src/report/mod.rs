//! The report as text and as a page.

pub mod layouts;
pub mod page;
pub(crate) mod trace;
pub mod words;
