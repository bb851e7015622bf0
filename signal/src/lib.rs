//! Sampled motion and the signal processing that recordings and models share:
//! zero-phase filters, splines, resampling, spectra and small linear systems.
//!
//! Everything is a plain function over `&[f64]`, one signal at a time; nothing here knows of
//! joints but [`Motion`].
//!
//! ```
//! // A zero-phase low-pass leaves a constant alone.
//! let sections = signal::sos::butterworth(4, 5.0, 100.0)?;
//! let y = signal::filter::filtfilt(&sections, &[2.0; 50]);
//! assert!(y.iter().all(|v| (v - 2.0).abs() < 1e-12));
//! # Ok::<(), signal::sos::DesignError>(())
//! ```
#![forbid(unsafe_code)]

#[cfg(feature = "statistics")]
pub mod bootstrap;
pub mod cholesky;
pub mod correlation;
#[cfg(feature = "statistics")]
pub mod delay;
pub mod differences;
pub mod filter;
pub mod harmonics;
pub mod loess;
pub mod motion;
#[cfg(feature = "statistics")]
pub mod proportion;
pub mod quantile;
pub mod resample;
pub mod smoother;
pub mod sos;
#[cfg(feature = "statistics")]
pub mod spectrum;
pub mod spline;
pub mod state_variable;

pub use motion::Motion;
