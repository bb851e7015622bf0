//! The room that a periodic motion has: limits of every joint, rest at its ends, home, the tool's region.

use super::error::ExcitationError;
use super::limits::{MotionLimits, Rest};
use super::series::Series;
use super::tool::ToolRoom;
use ndarray::Array2;
use std::f64::consts::{PI, TAU};

/// Bounds of a motion: limits, and conditions beside them.
#[derive(Debug, Clone)]
pub struct Bounds<'a> {
    /// Limits of the motion, one per joint.
    pub limits: Vec<MotionLimits>,
    /// Highest derivative that is zero at both ends.
    pub rest: Rest,
    /// Pose at which the motion starts and ends; none where any pose will do.
    pub home: Option<Vec<f64>>,
    /// Region of the tool; none where it may be anywhere.
    pub tool: Option<ToolRoom<'a>>,
}

impl<'a> Bounds<'a> {
    /// Bounds by these limits alone. A motion begins and ends with velocity and acceleration zero, in any pose.
    pub fn of(limits: Vec<MotionLimits>) -> Self {
        Self {
            limits,
            rest: Rest::Acceleration,
            home: None,
            tool: None,
        }
    }

    /// Pose towards which a motion is shrunk where the tool leaves its region: home, or a pose with the tool well inside.
    ///
    /// # Errors
    /// No limits; limits or a home that cannot hold; a tool that is outside wherever the joints are.
    pub fn anchor(&self, seed: u64) -> Result<Vec<f64>, ExcitationError> {
        if self.limits.is_empty() {
            return Err(ExcitationError::Empty("the number of joints"));
        }
        for (joint, limit) in self.limits.iter().enumerate() {
            limit.check(joint)?;
        }
        if let Some(home) = &self.home {
            for (joint, (&q, limit)) in home.iter().zip(&self.limits).enumerate() {
                let (lower, upper) = (limit.lower, limit.upper);
                if !(q >= lower && q <= upper) {
                    return Err(ExcitationError::HomeOutside {
                        joint,
                        home: q,
                        lower,
                        upper,
                    });
                }
            }
        }
        match (&self.home, &self.tool) {
            (Some(home), Some(tool)) => match tool.clearance(home) {
                c if c > 0.0 => Ok(home.clone()),
                c => Err(ExcitationError::ToolOutsideAtHome { outside: -c }),
            },
            (Some(home), None) => Ok(home.clone()),
            (None, Some(tool)) => tool.pose(&self.limits, seed),
            (None, None) => Ok(self.limits.iter().map(MotionLimits::middle).collect()),
        }
    }
}

/// Number of points of the grid over one period, per period of the highest harmonic.
const DENSITY: usize = 24;

/// The room of periodic motions of one period with given harmonics.
#[derive(Debug, Clone)]
pub struct Room<'a> {
    pub(super) bounds: Bounds<'a>,
    /// Period of the motions, s.
    pub(super) period: f64,
    /// Multiples of the base frequency.
    pub(super) harmonics: Vec<usize>,
    /// Pose towards which a motion is shrunk, rad or m.
    pub(super) anchor: Vec<f64>,
    /// sin and cos of each harmonic over the grid, shape (points, harmonics).
    table: [Array2<f64>; 2],
    /// Directions that rest forbids the sines and the cosines, orthonormal.
    forbidden: [Vec<Vec<f64>>; 2],
    /// Largest value of a trigonometric polynomial over its largest on the grid, at most.
    inflation: f64,
}

/// Bounds of one joint's motion about its offset.
struct Swing {
    low: f64,
    high: f64,
    derivatives: [f64; 3],
}

impl<'a> Room<'a> {
    /// Room for motions of `period` seconds with the given multiples of its frequency.
    ///
    /// # Errors
    /// Limits, home or region that leave no motion; fewer harmonics than rest takes.
    pub fn new(
        bounds: Bounds<'a>,
        period: f64,
        harmonics: &[usize],
        seed: u64,
    ) -> Result<Self, ExcitationError> {
        if harmonics.is_empty() || harmonics.contains(&0) {
            return Err(ExcitationError::Empty("the number of harmonics"));
        }
        if !(period.is_finite() && period > 0.0) {
            return Err(ExcitationError::Empty("the period"));
        }
        let needed = bounds.rest.least_harmonics();
        if harmonics.len() < needed {
            return Err(ExcitationError::FewHarmonics {
                harmonics: harmonics.len(),
                needed,
            });
        }
        let anchor = bounds.anchor(seed)?;
        for (joint, limit) in bounds.limits.iter().enumerate() {
            limit.reachable(joint, period)?;
        }
        let highest = harmonics.iter().copied().max().unwrap_or(1);
        let points = DENSITY * highest;
        let of = |f: fn(f64) -> f64| {
            Array2::from_shape_fn((points, harmonics.len()), |(k, i)| {
                f(TAU * ((k * harmonics[i]) % points) as f64 / points as f64)
            })
        };
        let power = |p: i32| -> Vec<f64> {
            let each = harmonics.iter().map(|&h| h as f64 / highest as f64);
            each.map(|h| h.powi(p)).collect()
        };
        // q̇(0) = Σ ω μ, q̈(0) = −Σ ω² ν, jerk(0) = −Σ ω³ μ.
        let mut sines = vec![power(1)];
        let mut cosines = Vec::new();
        if bounds.rest >= Rest::Acceleration {
            cosines.push(power(2));
        }
        if bounds.rest >= Rest::Jerk {
            sines.push(power(3));
        }
        Ok(Self {
            table: [of(f64::sin), of(f64::cos)],
            forbidden: [orthonormal(sines), orthonormal(cosines)],
            // Ehlich and Zeller (Mathematische Zeitschrift 86, 1964): degree n, m equal steps, m > 2n.
            inflation: 1.0 / (PI * highest as f64 / points as f64).cos(),
            bounds,
            period,
            harmonics: harmonics.to_vec(),
            anchor,
        })
    }

    /// Number of joints of the motion.
    pub fn dof(&self) -> usize {
        self.bounds.limits.len()
    }

    /// Limits of the motion, one per joint.
    pub fn limits(&self) -> &[MotionLimits] {
        &self.bounds.limits
    }

    /// A motion of this room's period and harmonics, standing at the anchor.
    pub(super) fn still(&self) -> Series {
        let shape = (self.dof(), self.harmonics.len());
        let base = TAU / self.period;
        Series {
            duration: self.period,
            ramp: 0.0,
            offset: self.anchor.clone(),
            pulsation: Array2::from_shape_fn(shape, |(_, i)| base * self.harmonics[i] as f64),
            sine: Array2::zeros(shape),
            cosine: Array2::zeros(shape),
        }
    }

    /// Brings a motion into the room: rest at its ends, home, and every joint shrunk until it keeps its limits at all
    /// times, not on a grid alone.
    pub fn keep(&self, series: &mut Series) {
        for (j, limit) in self.bounds.limits.iter().enumerate() {
            for (table, forbidden) in [&mut series.sine, &mut series.cosine]
                .into_iter()
                .zip(&self.forbidden)
            {
                let mut row = table.row_mut(j);
                for direction in forbidden {
                    let along: f64 = row.iter().zip(direction).map(|(a, b)| a * b).sum();
                    row.iter_mut()
                        .zip(direction)
                        .for_each(|(a, b)| *a -= along * b);
                }
            }
            let swing = self.swing(series, j);
            let mut factor = 1.0f64;
            let mut at_most = |room: f64, used: f64| {
                if used > 0.0 {
                    factor = factor.min((room / used).max(0.0));
                }
            };
            let rates = [limit.velocity, limit.acceleration, limit.jerk];
            for (room, used) in rates.into_iter().zip(swing.derivatives) {
                at_most(room, used);
            }
            let first: f64 = series.cosine.row(j).sum();
            let home = self.bounds.home.as_ref().map(|h| h[j]);
            match home {
                Some(home) => {
                    at_most(limit.upper - home, swing.high - first);
                    at_most(home - limit.lower, first - swing.low);
                }
                None => at_most(limit.upper - limit.lower, swing.high - swing.low),
            }
            series.sine.row_mut(j).mapv_inplace(|x| x * factor);
            series.cosine.row_mut(j).mapv_inplace(|x| x * factor);
            series.offset[j] = match home {
                Some(home) => home - factor * first,
                None => {
                    let low = limit.lower - factor * swing.low;
                    let high = limit.upper - factor * swing.high;
                    // Equal but for rounding where the motion fills the range.
                    series.offset[j].max(low).min(high.max(low))
                }
            };
        }
        if let Some(tool) = &self.bounds.tool {
            tool.keep(series, &self.anchor);
        }
    }

    /// Bounds of a joint's motion about its offset and of its derivatives.
    fn swing(&self, series: &Series, joint: usize) -> Swing {
        let [sin, cos] = &self.table;
        let (mu, nu) = (series.sine.row(joint), series.cosine.row(joint));
        let w = series.pulsation.row(joint);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut derivatives = [0.0f64; 3];
        for k in 0..sin.nrows() {
            let (mut q, mut d) = (0.0, [0.0; 3]);
            for i in 0..w.len() {
                let (s, c) = (sin[(k, i)], cos[(k, i)]);
                let value = mu[i] * s + nu[i] * c;
                let slope = w[i] * (mu[i] * c - nu[i] * s);
                q += value;
                d[0] += slope;
                d[1] += w[i] * w[i] * value;
                d[2] += w[i] * w[i] * slope;
            }
            low = low.min(q);
            high = high.max(q);
            for (most, d) in derivatives.iter_mut().zip(d) {
                *most = most.max(d.abs());
            }
        }
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) * self.inflation);
        // The middle is a constant, so the motion about it is a polynomial of the same degree.
        Swing {
            low: middle - half,
            high: middle + half,
            derivatives: derivatives.map(|d| d * self.inflation),
        }
    }
}

/// Orthonormal basis of the span of some vectors.
fn orthonormal(vectors: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut v in vectors {
        // Twice, for rounding.
        for _ in 0..2 {
            for b in &basis {
                let along: f64 = v.iter().zip(b).map(|(x, y)| x * y).sum();
                v.iter_mut().zip(b).for_each(|(x, y)| *x -= along * y);
            }
        }
        let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm > 1e-12 {
            v.iter_mut().for_each(|x| *x /= norm);
            basis.push(v);
        }
    }
    basis
}
