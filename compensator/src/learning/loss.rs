//! Cost of residuals and its slope.

use crate::config::Loss;

impl Loss {
    /// Cost and slope of residual r.
    #[inline]
    pub(crate) fn cost(self, r: f32) -> (f32, f32) {
        match self {
            Loss::Huber { delta } if r.abs() > delta => {
                (delta * (r.abs() - 0.5 * delta), delta.copysign(r))
            }
            _ => (0.5 * r * r, r),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huber_joins_the_parabola_smoothly() {
        let huber = Loss::Huber { delta: 2.0 };
        assert_eq!(huber.cost(1.0), Loss::Mse.cost(1.0));
        assert_eq!(huber.cost(2.0), (2.0, 2.0));
        assert_eq!(huber.cost(-5.0), (8.0, -2.0));
    }
}
