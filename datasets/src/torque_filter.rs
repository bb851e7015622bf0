//! Low-pass that a recorded torque went through before it was stored.

use serde::{Deserialize, Serialize};

/// Zero-phase Chebyshev type I low-pass that the recorded torque has been through.
///
/// A prediction is compared with such a torque only after it went through the same filter. The
/// filter belongs to the recording, so it is found when the recording is read:
///
/// 1. a Parquet file written by this crate says so itself (`residyn.torque_filter`);
/// 2. otherwise [`ReadOptions::torque_filter`](crate::ReadOptions), set for a robot whose
///    published recordings are filtered (the KR300 benchmark) or by a drive file, applies if the
///    recording is slow enough to have been decimated after the filter: see
///    [`TorqueFilter::applies_at`]. A raw 250 Hz recording of the same robot is left alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorqueFilter {
    /// Order of the filter (one pass; it runs forwards and backwards).
    pub order: usize,
    /// Edge of the pass band in Hz.
    pub cutoff_hz: f64,
    /// Ripple in the pass band in dB (one pass).
    pub ripple_db: f64,
}

impl TorqueFilter {
    /// Listing 1 of the KR300 benchmark paper: order 4, 2 Hz, 0.2 dB.
    pub const KR300: Self = Self {
        order: 4,
        cutoff_hz: 2.0,
        ripple_db: 0.2,
    };

    /// Whether a recording sampled at `rate_hz` can have been decimated after this filter.
    ///
    /// Decimation keeps little more than the pass band: the benchmark has 10 Hz behind 2 Hz, a
    /// factor of 5. Up to a factor of 8 the recording is taken as filtered; a faster one would
    /// not have been worth storing and is taken as raw.
    pub fn applies_at(&self, rate_hz: f64) -> bool {
        rate_hz <= 8.0 * self.cutoff_hz
    }
}
