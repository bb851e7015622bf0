//! Counterbalances: a strut between two pins, one on the link and one on the part before it.

use super::{Instant, Mechanism};

/// The triangle of pins: the joint at the origin, one pin at distance `lever` on the link, one at distance
/// `base` on the part before, `angle` between them at q = 0.
#[derive(Debug, Clone, Copy)]
pub struct Pins {
    /// Distance of the link's pin from the joint, m.
    pub lever: f64,
    /// Distance of the pin on the part before from the joint, m.
    pub base: f64,
    /// Angle between both pins at q = 0, rad.
    pub angle: f64,
}

impl Pins {
    /// Length of the strut and its derivative with respect to q.
    fn length(&self, q: f64) -> (f64, f64) {
        let (s, c) = (q + self.angle).sin_cos();
        let l = (self.lever.powi(2) + self.base.powi(2) - 2.0 * self.lever * self.base * c).sqrt();
        (l, self.lever * self.base * s / l)
    }
}

/// Gas strut: filled to `force` at its middle length, polytropic with exponent 1.2; the gas volume equals `volume`
/// metres of stroke there.
#[derive(Debug, Clone)]
pub struct GasStrut {
    /// Index of the plant's joint on which the mechanism acts.
    pub joint: usize,
    /// Positions of the strut's pins.
    pub pins: Pins,
    /// Force that pushes the pins apart at the middle length, N.
    pub force: f64,
    /// Gas volume over piston area at the middle length, m.
    pub volume: f64,
}

impl Mechanism for GasStrut {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let (l, slope) = self.pins.length(now.q[self.joint]);
        let middle = self.pins.lever.hypot(self.pins.base);
        let volume = (1.0 + (l - middle) / self.volume).max(0.2);
        force[self.joint] += self.force * volume.powf(-1.2) * slope;
    }
}

/// Coil spring that pulls the pins together.
#[derive(Debug, Clone)]
pub struct CoilSpring {
    /// Index of the plant's joint on which the mechanism acts.
    pub joint: usize,
    /// Positions of the spring's pins.
    pub pins: Pins,
    /// Stiffness of the spring, N/m.
    pub stiffness: f64,
    /// Free length of the spring over the shortest distance of the pins.
    pub free: f64,
}

impl Mechanism for CoilSpring {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let (l, slope) = self.pins.length(now.q[self.joint]);
        let free = self.free * (self.pins.base - self.pins.lever).abs();
        force[self.joint] -= self.stiffness * (l - free).max(0.0) * slope;
    }
}
