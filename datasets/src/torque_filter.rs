//! Low-pass that a recorded torque went through before it was stored.

use serde::{Deserialize, Serialize};

/// Zero-phase Chebyshev type I low-pass that the recorded torque has been through.
///
/// A prediction is compared with such a torque only after it went through the same filter. The filter
/// belongs to the recording:
///
/// 1. a Parquet file written by this crate says so itself (`residyn.torque_filter`);
/// 2. otherwise [`ReadOptions::torque_filter`](crate::ReadOptions) declares it, from a drive file or for
///    the built-in robot whose published recordings are filtered (the KR300 benchmark);
/// 3. where nothing is declared, training recordings show it by an empty stop band
///    ([`stop_band`](crate::stop_band)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorqueFilter {
    /// Order of the filter (one pass; it runs forwards and backwards).
    pub order: usize,
    /// Edge of the pass band in Hz.
    pub cutoff_hz: f64,
    /// Ripple in the pass band in dB (one pass).
    pub ripple_db: f64,
    /// Whether the filter was recognised from the torque's spectrum, rather than declared.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub recognised: bool,
}

/// A filter that recordings up to a rate are declared to have been through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeclaredFilter {
    /// Low-pass that a torque is passed through.
    pub filter: TorqueFilter,
    /// Highest rate of recordings to which the declaration applies, Hz. Faster ones are taken as unfiltered.
    pub up_to_hz: f64,
}

impl TorqueFilter {
    /// Listing 1 of the KR300 benchmark paper: order 4, 2 Hz, 0.2 dB.
    pub const KR300: Self = Self {
        order: 4,
        cutoff_hz: 2.0,
        ripple_db: 0.2,
        recognised: false,
    };

    /// Declared for every recording, whatever its rate.
    pub fn always(self) -> DeclaredFilter {
        DeclaredFilter {
            filter: self,
            up_to_hz: f64::INFINITY,
        }
    }

    /// Declared for recordings that were decimated after the filter.
    ///
    /// Decimation keeps little more than the pass band: the benchmark has 10 Hz behind 2 Hz, a factor of 5.
    /// Up to a factor of 8 a recording is taken as filtered; a faster one would not have been worth storing
    /// and is taken as raw.
    pub fn decimated(self) -> DeclaredFilter {
        DeclaredFilter {
            filter: self,
            up_to_hz: 8.0 * self.cutoff_hz,
        }
    }

    /// Attenuation of both passes together at `frequency_hz`, dB; that of the analogue filter.
    pub fn attenuation_db(&self, frequency_hz: f64) -> f64 {
        let (x, n) = (frequency_hz / self.cutoff_hz, self.order as f64);
        let polynomial = if x <= 1.0 {
            (n * x.acos()).cos()
        } else {
            (n * x.acosh()).cosh()
        };
        20.0 * (1.0 + self.ripple() * polynomial.powi(2)).log10()
    }

    /// Frequency at which one pass halves the power, Hz.
    pub fn half_power_hz(&self) -> f64 {
        let n = self.order as f64;
        self.cutoff_hz * ((1.0 / self.ripple()).sqrt().max(1.0).acosh() / n).cosh()
    }

    /// ε² of the Chebyshev filter.
    fn ripple(&self) -> f64 {
        10.0_f64.powf(0.1 * self.ripple_db) - 1.0
    }
}
