//! Sampled motion and the signal processing that recordings and models share:
//! zero-phase filters, splines, resampling and spectra.
#![forbid(unsafe_code)]

pub mod motion;

pub use motion::Motion;
