//! The libraries together: what one says against what another says.

mod causes_as_a_model;
mod cross_fit;
mod damaged_models;
mod effects;
mod known_parameters;
