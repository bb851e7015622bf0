//! The search for causes: from the catalogue to those that explain.

pub(crate) mod dictionary;
pub(crate) mod find;
pub(crate) mod ground;
pub(crate) mod objective;
mod on_time;
pub(crate) mod select;
mod short;
pub(crate) mod simplest;
pub(crate) mod tables;
mod worth;
