//! Torque that changes slowly over the joint's own position: a spring, gas or hydraulic balancer of unknown make.

use serde::{Deserialize, Serialize};

/// Largest distance from the middle of the fitted range up to which a polynomial may change, in half ranges.
const BEYOND: f64 = 1.2;

/// Legendre polynomial of the joint's position over the range that was seen. Beyond 1.2 half ranges from the
/// middle it is held constant, as a polynomial is not valid where it was not fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polynomial {
    /// Degree of the polynomial.
    pub degree: usize,
    /// Middle of the range, rad (m for prismatic joints).
    pub middle: f64,
    /// Half the range, rad (m for prismatic joints).
    pub half: f64,
}

impl Polynomial {
    /// Column at position `q`, by Bonnet's recursion.
    pub fn at(&self, q: f64) -> f64 {
        let x = ((q - self.middle) / self.half).clamp(-BEYOND, BEYOND);
        let (mut last, mut p) = (1.0, x);
        if self.degree == 0 {
            return 1.0;
        }
        for n in 1..self.degree {
            let n = n as f64;
            (last, p) = (p, ((2.0 * n + 1.0) * x * p - n * last) / (n + 1.0));
        }
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_by_hand() {
        let at = |degree, q| {
            Polynomial {
                degree,
                middle: 1.0,
                half: 2.0,
            }
            .at(q)
        };
        // x = 0.5: P0 = 1, P1 = x, P2 = (3x² − 1)/2, P3 = (5x³ − 3x)/2, P4 = (35x⁴ − 30x² + 3)/8.
        let expected = [1.0, 0.5, -0.125, -0.4375, -0.2890625];
        for (degree, p) in expected.into_iter().enumerate() {
            assert!((at(degree, 2.0) - p).abs() < 1e-15, "{degree}");
        }
        assert_eq!(at(3, 1e3), at(3, 1.0 + 2.0 * BEYOND), "held");
    }
}
