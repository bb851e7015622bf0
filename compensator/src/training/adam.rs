//! Adam with decoupled weight decay (Kingma & Ba 2015; Loshchilov & Hutter 2019).

use pulp::{Arch, Simd, WithSimd};

const BETA1: f32 = 0.9;
const BETA2: f32 = 0.999;
const EPSILON: f32 = 1e-8;

/// Moments of the gradient and number of steps.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Adam {
    pub(super) first: Vec<f32>,
    pub(super) second: Vec<f32>,
    pub(super) steps: u64,
}

impl Adam {
    pub(super) fn new(parameters: usize) -> Self {
        Self {
            first: vec![0.0; parameters],
            second: vec![0.0; parameters],
            steps: 0,
        }
    }

    /// θ ← θ − rate·(m̂/(√v̂ + ε) + decay·θ), with the gradient scaled by `scale` (clipping).
    pub(super) fn step(
        &mut self,
        arch: Arch,
        parameters: &mut [f32],
        gradient: &[f32],
        scale: f32,
        rate: f32,
        decay: f32,
    ) {
        self.steps += 1;
        let steps = i32::try_from(self.steps).unwrap_or(i32::MAX);
        let correction1 = 1.0 / (1.0 - f64::from(BETA1).powi(steps)) as f32;
        let correction2 = 1.0 / (1.0 - f64::from(BETA2).powi(steps)) as f32;
        let moments = (&mut self.first[..], &mut self.second[..]);
        let corrections = (correction1, correction2);
        arch.dispatch(Step {
            parameters,
            gradient,
            moments,
            corrections,
            scale,
            rate,
            decay,
        });
    }
}

struct Step<'a> {
    parameters: &'a mut [f32],
    gradient: &'a [f32],
    moments: (&'a mut [f32], &'a mut [f32]),
    corrections: (f32, f32),
    scale: f32,
    rate: f32,
    decay: f32,
}

impl WithSimd for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            parameters,
            gradient,
            moments: (first, second),
            corrections,
            scale,
            rate,
            decay,
        } = self;
        for (((p, &g), m), v) in parameters.iter_mut().zip(gradient).zip(first).zip(second) {
            let g = g * scale;
            *m = BETA1 * *m + (1.0 - BETA1) * g;
            *v = BETA2 * *v + (1.0 - BETA2) * g * g;
            let direction = *m * corrections.0 / ((*v * corrections.1).sqrt() + EPSILON);
            *p -= rate * (direction + decay * *p);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First step by hand: m̂ = g and v̂ = g², so every parameter moves by rate·sign(g).
    #[test]
    fn first_step_moves_by_the_rate() {
        let mut p = [1.0, 1.0];
        Adam::new(2).step(Arch::new(), &mut p, &[0.5, -20.0], 0.1, 0.01, 0.0);
        assert!(
            (p[0] - 0.99).abs() < 1e-6 && (p[1] - 1.01).abs() < 1e-6,
            "{p:?}"
        );
    }

    #[test]
    fn decay_pulls_towards_zero_without_a_gradient() {
        let mut p = [2.0];
        Adam::new(1).step(Arch::new(), &mut p, &[0.0], 1.0, 0.1, 0.5);
        assert!((p[0] - 1.9).abs() < 1e-6);
    }
}
