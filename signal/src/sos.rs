//! Digital low-passes as cascades of second-order sections.
//!
//! Analogue prototypes are mapped with the pre-warped bilinear transform, as in
//! Oppenheim & Schafer, *Discrete-Time Signal Processing*, ch. 7, and `scipy.signal`.

/// One second-order section
/// H(z) = (b₀ + b₁z⁻¹ + b₂z⁻²) / (1 + a₁z⁻¹ + a₂z⁻²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Numerator coefficients b₀, b₁, b₂.
    pub b: [f64; 3],
    /// Denominator coefficients a₁, a₂ (a₀ = 1).
    pub a: [f64; 2],
}

/// A filter that cannot be designed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Order zero, or so high that it is a mistake.
    #[error("filter order {0} is not in 1..=16")]
    Order(usize),
    /// The cut-off is not inside the band.
    #[error("cut-off {cutoff_hz} Hz is not between 0 and half the rate of {rate_hz} Hz")]
    Cutoff {
        /// Cut-off that was asked for, Hz.
        cutoff_hz: f64,
        /// Sampling rate of the signal, Hz.
        rate_hz: f64,
    },
    /// Ripple or quality that is not positive.
    #[error("{0} is not positive")]
    NotPositive(f64),
}

impl Section {
    /// Gain of the section at frequency zero.
    pub fn dc_gain(&self) -> f64 {
        self.b.iter().sum::<f64>() / (1.0 + self.a[0] + self.a[1])
    }

    /// Second-order low-pass with quality Q (1/√2 is Butterworth, 1/2 is critically damped),
    /// gain 1 at frequency zero.
    ///
    /// # Errors
    /// A cut-off outside (0, rate/2) or a quality that is not positive.
    pub fn lowpass(cutoff_hz: f64, rate_hz: f64, quality: f64) -> Result<Self, DesignError> {
        if !(quality > 0.0 && quality.is_finite()) {
            return Err(DesignError::NotPositive(quality));
        }
        let w = warp(cutoff_hz, rate_hz)?;
        Ok(Self::from_analogue_pair(w / quality, w * w))
    }

    /// Bilinear image of 1/(s² + c₁s + c₀) with s in units of 2·rate, scaled to gain 1.
    fn from_analogue_pair(c1: f64, c0: f64) -> Self {
        let a0 = 1.0 + c1 + c0;
        let a = [2.0 * (c0 - 1.0) / a0, (1.0 - c1 + c0) / a0];
        let gain = c0 / a0;
        Self {
            b: [gain, 2.0 * gain, gain],
            a,
        }
    }

    /// Bilinear image of 1/(s + c₀), scaled to gain 1.
    fn from_analogue_real(c0: f64) -> Self {
        let gain = c0 / (1.0 + c0);
        Self {
            b: [gain, gain, 0.0],
            a: [(c0 - 1.0) / (1.0 + c0), 0.0],
        }
    }
}

/// Pre-warped angular frequency in units of 2·rate.
fn warp(cutoff_hz: f64, rate_hz: f64) -> Result<f64, DesignError> {
    if !(cutoff_hz > 0.0 && cutoff_hz < 0.5 * rate_hz && rate_hz.is_finite()) {
        return Err(DesignError::Cutoff { cutoff_hz, rate_hz });
    }
    Ok((std::f64::consts::PI * cutoff_hz / rate_hz).tan())
}

/// Sections from the analogue poles −σ_k ± iω_k, k = 0 … ⌈n/2⌉, given by angle.
fn from_poles(order: usize, warped: f64, real: f64, imaginary: f64) -> Vec<Section> {
    let mut sections = Vec::with_capacity(order.div_ceil(2));
    if !order.is_multiple_of(2) {
        sections.push(Section::from_analogue_real(real * warped));
    }
    for k in 0..order / 2 {
        // Angle from the imaginary axis; highest quality first would ring most in the cascade,
        // so the sections run from well damped to lightly damped.
        let angle =
            std::f64::consts::PI * (2 * (order / 2 - 1 - k) + 1) as f64 / (2 * order) as f64;
        let sigma = real * angle.sin() * warped;
        let omega = imaginary * angle.cos() * warped;
        sections.push(Section::from_analogue_pair(
            2.0 * sigma,
            sigma * sigma + omega * omega,
        ));
    }
    sections
}

/// Butterworth low-pass of any order, −3 dB at the cut-off, gain 1 at frequency zero.
///
/// # Errors
/// An order outside 1..=16 or a cut-off outside (0, rate/2).
pub fn butterworth(
    order: usize,
    cutoff_hz: f64,
    rate_hz: f64,
) -> Result<Vec<Section>, DesignError> {
    if !(1..=16).contains(&order) {
        return Err(DesignError::Order(order));
    }
    Ok(from_poles(order, warp(cutoff_hz, rate_hz)?, 1.0, 1.0))
}

/// Chebyshev type I low-pass: `ripple_db` of ripple up to the cut-off; for even orders the gain at
/// frequency zero is at the bottom of the ripple, as in SciPy and MATLAB.
///
/// # Errors
/// An order outside 1..=16, a cut-off outside (0, rate/2), a ripple that is not positive.
pub fn chebyshev1(
    order: usize,
    ripple_db: f64,
    cutoff_hz: f64,
    rate_hz: f64,
) -> Result<Vec<Section>, DesignError> {
    if !(1..=16).contains(&order) {
        return Err(DesignError::Order(order));
    }
    if !(ripple_db > 0.0 && ripple_db.is_finite()) {
        return Err(DesignError::NotPositive(ripple_db));
    }
    let warped = warp(cutoff_hz, rate_hz)?;
    let epsilon = (10.0_f64.powf(0.1 * ripple_db) - 1.0).sqrt();
    let mu = (1.0 / epsilon).asinh() / order as f64;
    let mut sections = from_poles(order, warped, mu.sinh(), mu.cosh());
    if order.is_multiple_of(2) {
        let gain = 1.0 / (1.0 + epsilon * epsilon).sqrt();
        if let Some(first) = sections.first_mut() {
            first.b.iter_mut().for_each(|b| *b *= gain);
        }
    }
    Ok(sections)
}
