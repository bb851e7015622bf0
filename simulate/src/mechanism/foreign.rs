//! Mechanisms that no catalogue of effects lists: a diagnosis has to say that it does not know them.

use super::{Instant, Mechanism, soft_sign};
use std::f64::consts::TAU;

/// Air drag between two joints: each is braked in proportion to its own speed times the other's.
#[derive(Debug, Clone)]
pub struct CrossDrag {
    /// Plant joints.
    pub joints: [usize; 2],
    /// Torque on each at 1 rad/s of both, N·m.
    pub size: [f64; 2],
}

impl Mechanism for CrossDrag {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let [a, b] = self.joints;
        force[a] -= self.size[0] * now.v[b].abs() * now.v[a];
        force[b] -= self.size[1] * now.v[a].abs() * now.v[b];
    }
}

/// A cable over two joints that is slack in part of the region and pulls on both in the rest.
#[derive(Debug, Clone)]
pub struct CableTug {
    /// Plant joints.
    pub joints: [usize; 2],
    /// Positions at which the cable is straight.
    pub centre: [f64; 2],
    /// Lever of the second joint over the first's.
    pub ratio: f64,
    /// Relative length from which it pulls.
    pub slack: f64,
    /// N·m per squared relative length.
    pub size: f64,
}

impl Mechanism for CableTug {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let [a, b] = self.joints;
        let (sa, ca) = (now.q[a] - self.centre[0]).sin_cos();
        let (sb, cb) = (now.q[b] - self.centre[1]).sin_cos();
        let stretch = (sa + self.ratio * sb + sa * sb - self.slack).max(0.0);
        let tension = self.size * stretch * stretch;
        force[a] -= tension * ca * (1.0 + sb);
        force[b] -= tension * cb * (self.ratio + sa);
    }
}

/// Spring and damper of one joint towards zero.
#[derive(Debug, Clone)]
pub struct SpringDamper {
    /// Plant joint.
    pub joint: usize,
    /// N·m/rad.
    pub stiffness: f64,
    /// N·m·s/rad.
    pub damping: f64,
}

impl Mechanism for SpringDamper {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        force[self.joint] -= self.stiffness * now.q[self.joint];
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, _now: &Instant, v: f64) -> f64 {
        self.damping * v
    }
}

/// A drive that loses part of its torque at random for fractions of a second.
#[derive(Debug, Clone)]
pub struct Dropouts {
    /// Plant joint.
    pub joint: usize,
    /// Lost share of the torque.
    pub depth: f64,
    /// Start and end of each loss, s, in order.
    pub times: Vec<(f64, f64)>,
}

impl Mechanism for Dropouts {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let next = self.times.partition_point(|t| t.0 <= now.t);
        if next > 0 && now.t < self.times[next - 1].1 {
            force[self.joint] -= self.depth * now.load[self.joint];
        }
    }
}

/// Vibration of fixed frequency that comes and goes, from a machine on the same floor.
#[derive(Debug, Clone)]
pub struct FloorHum {
    /// Plant joint.
    pub joint: usize,
    /// N·m.
    pub size: f64,
    /// Hz.
    pub frequency: f64,
    /// Period of its coming and going, s.
    pub swell: f64,
}

impl Mechanism for FloorHum {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let swell = 1.0 + 0.5 * (TAU * now.t / self.swell).sin();
        force[self.joint] += self.size * swell * (TAU * self.frequency * now.t).sin();
    }
}

/// Liquid that sloshes in a tank on a link: a mass on a weak spring, shaken by the joint's acceleration.
#[derive(Debug, Clone)]
pub struct SloshingTank {
    /// Plant joint.
    pub joint: usize,
    /// Inertia of the liquid about the joint, kg·m².
    pub inertia: f64,
    /// Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Angle of the liquid against the tank, rad, and its rate.
    pub angle: f64,
    /// rad/s.
    pub rate: f64,
}

impl Mechanism for SloshingTank {
    fn push(&mut self, _now: &Instant, force: &mut [f64]) {
        let w = TAU * self.frequency;
        force[self.joint] +=
            self.inertia * (w * w * self.angle + 2.0 * self.damping * w * self.rate);
    }

    fn advance(&mut self, now: &Instant, _v: &[f64]) {
        let w = TAU * self.frequency;
        let spring = w * w * self.angle + 2.0 * self.damping * w * self.rate;
        self.rate += now.dt * (-now.a[self.joint] - spring);
        self.angle += now.dt * self.rate;
    }
}

/// A torque that wanders at random.
#[derive(Debug, Clone)]
pub struct WanderingOffset {
    /// Plant joint.
    pub joint: usize,
    /// N·m.
    pub size: f64,
    /// First knot, s, and distance of knots, s.
    pub start: f64,
    /// s.
    pub step: f64,
    /// Values at the knots, of unit deviation.
    pub knots: Vec<f64>,
}

impl Mechanism for WanderingOffset {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let x = ((now.t - self.start) / self.step).max(0.0);
        let k = (x as usize).min(self.knots.len().saturating_sub(2));
        if let [a, b, ..] = self.knots[k..] {
            let u = (x - k as f64).min(1.0);
            force[self.joint] +=
                self.size * (a + (b - a) * 0.5 * (1.0 - (std::f64::consts::PI * u).cos()));
        }
    }
}

/// A worn or dirty sector of a joint: friction within part of its range.
#[derive(Debug, Clone)]
pub struct WornSector {
    /// Plant joint.
    pub joint: usize,
    /// N·m.
    pub size: f64,
    /// Middle of the sector, rad.
    pub centre: f64,
    /// Half of its width, rad.
    pub half: f64,
    /// Softening of the sign, rad/s.
    pub v_eps: f64,
}

impl Mechanism for WornSector {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let x = (now.q[self.joint] - self.centre) / self.half;
        self.size * (-x.powi(4)).exp() * soft_sign(v, self.v_eps)
    }
}
