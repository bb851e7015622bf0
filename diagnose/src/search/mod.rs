//! Search for causes: from the candidates of the catalogue to those that explain the recording.

mod acceptance;
mod carried_body;
pub(crate) mod dictionary;
pub(crate) mod find;
pub(crate) mod kept;
pub(crate) mod model_comparison;
pub(crate) mod objective;
mod on_time;
pub(crate) mod products;
pub(crate) mod select;
pub(crate) mod session;
mod short_recordings;
#[cfg(test)]
mod tests;
