//! Activations in f32 that the compiler can vectorise: no table, no branch, no library call.
//!
//! Training and inference share them, so a trained unit sees the same curve at run-time.

/// eˣ for f32, relative error below 2·10⁻⁷; the argument is held within ±87, so the result is finite.
///
/// x = n·ln 2 + r with |r| ≤ ½ ln 2, a degree-5 remainder polynomial for eʳ (Cephes `expf`), then 2ⁿ
/// by the exponent bits.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // Adding 1.5·2²³ rounds to the nearest integer and leaves it in the low mantissa bits.
    const ROUND: f32 = 12_582_912.0;
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let x = x.clamp(-87.0, 87.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = x - n * LN2_HIGH - n * LN2_LOW;
    let p = 1.987_569_1e-4;
    let p = p * r + 1.398_199_9e-3;
    let p = p * r + 8.333_452e-3;
    let p = p * r + 4.166_579_6e-2;
    let p = p * r + 1.666_666_5e-1;
    let p = p * r + 0.5;
    let e = p * r * r + r + 1.0;
    let exponent = shifted
        .to_bits()
        .wrapping_sub(ROUND.to_bits())
        .wrapping_add(127)
        << 23;
    e * f32::from_bits(exponent)
}

/// Logistic function 1/(1 + e⁻ˣ), absolute error below 2·10⁻⁷. (Equation 19 of Wang et al. is
/// printed with e⁺ˣ, which falls instead of rising; a rising function is meant.)
#[inline(always)]
pub fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + exp(-x))
}

/// Hyperbolic tangent (equation 20), absolute error below 3·10⁻⁷.
#[inline(always)]
pub fn tanh(x: f32) -> f32 {
    1.0 - 2.0 / (1.0 + exp(2.0 * x))
}

/// sigmoid(gate)·tanh(x) with one division, absolute error below 4·10⁻⁷: (e²ˣ − 1)/((1 + e⁻ᵍ)(1 + e²ˣ)). Beyond ±15, where
/// the tangent is ±1 to 10⁻¹², x counts as that, so that the denominator overflows only where the value is below 10⁻²⁴.
#[inline(always)]
pub(super) fn gated(gate: f32, x: f32) -> f32 {
    let (g, t) = (exp(-gate), exp(2.0 * x.clamp(-15.0, 15.0)));
    (t - 1.0) / ((1.0 + g) * (1.0 + t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_to_double_precision_over_the_whole_range() {
        for i in -200_000..=200_000 {
            let x = i as f32 * 5e-4;
            let d = f64::from(x);
            let held = d.clamp(-87.0, 87.0);
            assert!(
                (f64::from(exp(x)) / held.exp() - 1.0).abs() < 2e-7,
                "exp({x})"
            );
            assert!(
                (f64::from(sigmoid(x)) - 1.0 / (1.0 + (-d).exp())).abs() < 2e-7,
                "sigmoid({x})"
            );
            assert!((f64::from(tanh(x)) - d.tanh()).abs() < 3e-7, "tanh({x})");
        }
    }

    #[test]
    fn a_gated_tangent_is_the_product() {
        for i in -400..=400 {
            for j in -400..=400 {
                let (gate, x) = (i as f32 * 0.25, j as f32 * 0.25);
                let d = f64::from(x).tanh() / (1.0 + f64::from(-gate).exp());
                assert!((f64::from(gated(gate, x)) - d).abs() < 4e-7, "{gate}, {x}");
            }
        }
    }

    #[test]
    fn saturates_without_overflow() {
        assert_eq!(sigmoid(f32::MAX), 1.0);
        assert!(sigmoid(f32::MIN) < 1e-37);
        assert_eq!(tanh(f32::MAX), 1.0);
        assert_eq!(tanh(f32::MIN), -1.0);
    }
}
