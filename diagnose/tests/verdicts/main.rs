//! What a diagnosis comes to on recordings that say little, or whose held-out part is special.

mod arm;
mod contact;
mod heldout;
mod little;
mod names;
