//! Machines without a description by links.

mod carried;
mod end_to_end;
