//! Fit of mechanisms to the rows: the numbers of the generator's own draw, as coordinates of a cube of side 1, and sizes.

use super::marginal::{Marginal, Seen, log_volume};
use super::rows::Rows;
use super::unknown::Unknown;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use trials::cases::{Mechanism, Witness};

/// Greatest number of random words of a shape that is fitted. The shape of a longer draw, as the times of pushes, is told.
const MOST_WORDS: usize = 24;
/// Steps of derivatives: of a coordinate of the cube, and of the logarithm of a size.
const STEPS: [f64; 2] = [1e-4, 1e-3];
/// Share of a mechanism that came out, over that which was meant (`trials::cases::size`), and in all.
const OVER_MEANT: [f64; 2] = [0.55, 1.8];
const IN_ALL: [f64; 2] = [0.03, 0.6];
/// Bits of a word that choose among cases of a normal number; the others are its coordinate.
const CASES: u64 = 0xfff;

/// Rows of the first trajectories, in which mechanisms are fitted.
pub struct Window<'a> {
    witness: &'a Witness,
    rows: &'a Rows<'a>,
    marginal: Marginal<'a>,
    trajectories: usize,
    /// Rows of the log less the expected plant's.
    pub rest: Seen,
}

/// Mechanisms of some shapes and sizes with the torque that they make in a window.
pub struct Point {
    /// Mechanisms and their sizes.
    pub parts: Vec<(Mechanism, f64)>,
    /// Rows of their torque.
    pub torque: Seen,
    /// Squared length of what they leave of the rows.
    pub misfit: f64,
    /// Logarithm of the part of the prior's cube that the rows leave.
    pub volume: f64,
}

/// A coordinate: a random word of a mechanism, or the logarithm of its size.
#[derive(Clone, Copy)]
enum Coordinate {
    Word(usize, usize),
    Size(usize),
}

impl<'a> Window<'a> {
    /// The first `trajectories` of a log. None where a column is not finite.
    pub fn new(
        witness: &'a Witness,
        rows: &'a Rows<'a>,
        unknown: &'a Unknown,
        trajectories: usize,
    ) -> Option<Self> {
        let marginal = Marginal::new(&unknown.columns, rows.starts[trajectories], unknown.count)?;
        let rest = marginal.see(unknown.rest.clone());
        Some(Self {
            witness,
            rows,
            marginal,
            trajectories,
            rest,
        })
    }

    /// Rows of the torque of mechanisms; none where they make no possible robot.
    fn torque(&self, parts: &[(&Mechanism, f64)]) -> Option<Seen> {
        let added = self.witness.added(parts, self.trajectories).ok()?;
        let joints = added.into_iter().enumerate();
        let table = joints.map(|(j, column)| Some(self.rows.of_torque(j, &column?)));
        let seen = self.marginal.see(table.collect());
        seen.dot(&seen).is_finite().then_some(seen)
    }

    /// Part of its joint's torque that a mechanism makes; none where it makes no possible robot.
    fn share(&self, mechanism: &Mechanism, size: f64) -> Option<f64> {
        let added = self
            .witness
            .added(&[(mechanism, size)], self.trajectories)
            .ok()?;
        let rms = added.iter().map(|column| match column {
            Some(x) => (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt(),
            None => 0.0,
        });
        let rms: Vec<f64> = rms.collect();
        let largest = || (0..rms.len()).max_by(|&a, &b| rms[a].total_cmp(&rms[b]));
        let at = mechanism.joint.or_else(largest)?;
        let share = rms[at] / self.witness.log.rms[at];
        share.is_finite().then_some(share)
    }

    /// The size nearest to `size` at which the generator would keep the mechanism; none without one.
    pub fn kept(&self, mechanism: &Mechanism, mut size: f64) -> Option<f64> {
        let [least, most] = mechanism.shares;
        let low = (least * OVER_MEANT[0]).max(IN_ALL[0]);
        let high = (most * OVER_MEANT[1]).min(IN_ALL[1]);
        for _ in 0..4 {
            size = size.min(mechanism.sizes()[1]);
            let share = self.share(mechanism, size)?;
            if share < 1e-9 {
                return None;
            }
            let meant = share.clamp(low, high);
            if (meant / share - 1.0).abs() < 0.02 {
                return Some(size);
            }
            size *= (meant / share).clamp(1e-3, 1e3);
        }
        None
    }

    /// A mechanism at the size that fits best, as far as its torque is proportional to it; none where the generator would not
    /// keep it.
    pub fn sized(&self, mechanism: Mechanism, from: &Seen) -> Option<Point> {
        let size = self.kept(&mechanism, mechanism.sizes()[0].min(mechanism.sizes()[1]))?;
        let seen = self.torque(&[(&mechanism, size)])?;
        let factor = from.dot(&seen) / seen.dot(&seen);
        let size = self.kept(&mechanism, size * factor.clamp(1e-3, 1e3))?;
        self.at(vec![(mechanism, size)])
    }

    /// Mechanisms of given sizes.
    pub fn at(&self, parts: Vec<(Mechanism, f64)>) -> Option<Point> {
        let refs: Vec<(&Mechanism, f64)> = parts.iter().map(|(m, s)| (m, *s)).collect();
        let torque = self.torque(&refs)?;
        let left = self.rest.plus(-1.0, &torque);
        Some(Point {
            misfit: left.dot(&left),
            torque,
            volume: 0.0,
            parts,
        })
    }

    /// The point after up to `steps` steps of Levenberg and Marquardt, with its volume.
    pub fn refined(&self, mut point: Point, steps: usize) -> Point {
        let mut damping = 1e-2;
        let coordinates = self.coordinates(&point);
        for step in 0..=steps {
            let Some(slopes) = self.slopes(&point, &coordinates) else {
                return point;
            };
            let count = coordinates.len();
            let information = DMatrix::from_fn(count, count, |i, k| slopes[i].dot(&slopes[k]));
            point.volume = log_volume(self.in_cube(&point, &coordinates, &information));
            if step == steps {
                break;
            }
            let left = self.rest.plus(-1.0, &point.torque);
            let pull = DVector::from_fn(count, |i, _| slopes[i].dot(&left));
            let mut better = None;
            for _ in 0..4 {
                let mut damped = information.clone();
                for i in 0..count {
                    // Half the cube is as far as any coordinate goes.
                    damped[(i, i)] += damping * information[(i, i)] + 4.0;
                }
                let Some(factor) = damped.cholesky() else {
                    return point;
                };
                let moved = self.moved(&point, &coordinates, &factor.solve(&pull));
                better = moved.filter(|p| p.misfit < point.misfit);
                if better.is_some() {
                    damping *= 0.2;
                    break;
                }
                damping *= 8.0;
            }
            let Some(better) = better else { break };
            let gained = point.misfit - better.misfit;
            let volume = point.volume;
            point = Point { volume, ..better };
            if gained < 0.1 {
                break;
            }
        }
        point
    }

    /// Information in the coordinates of the prior's cube: a size's logarithm is uniform over that of the shares.
    fn in_cube(
        &self,
        point: &Point,
        coordinates: &[Coordinate],
        information: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let width = |c: &Coordinate| match c {
            Coordinate::Word(..) => 1.0,
            Coordinate::Size(m) => {
                let [least, most] = point.parts[*m].0.shares;
                (most / least).ln()
            }
        };
        let widths: Vec<f64> = coordinates.iter().map(width).collect();
        DMatrix::from_fn(widths.len(), widths.len(), |i, k| {
            information[(i, k)] * widths[i] * widths[k]
        })
    }

    /// Coordinates on which the shapes depend, and sizes.
    fn coordinates(&self, point: &Point) -> Vec<Coordinate> {
        let mut all = Vec::new();
        for (m, (mechanism, _)) in point.parts.iter().enumerate() {
            all.extend(
                self.active(mechanism)
                    .into_iter()
                    .map(|w| Coordinate::Word(m, w)),
            );
            all.push(Coordinate::Size(m));
        }
        all
    }

    /// Random words on which a mechanism's shape depends smoothly; none where its shape is told.
    pub fn active(&self, mechanism: &Mechanism) -> Vec<usize> {
        let words = mechanism.words.len();
        if words > MOST_WORDS {
            return Vec::new();
        }
        let differs = |&w: &usize| {
            let other = self.shifted(mechanism, w, step_of(mechanism.words[w]));
            other.is_some_and(|o| o.joint == mechanism.joint && !o.is_like(mechanism))
        };
        (0..words - 1).filter(differs).collect()
    }

    /// A mechanism with one of its words moved by a part of the cube's side.
    fn shifted(&self, mechanism: &Mechanism, word: usize, by: f64) -> Option<Mechanism> {
        let mut words = mechanism.words.clone();
        words[word] = moved(words[word], by);
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        self.witness.mechanism(mechanism.origin, &words, &mut rng)
    }

    fn slopes(&self, point: &Point, coordinates: &[Coordinate]) -> Option<Vec<Seen>> {
        let slope = |c: &Coordinate| {
            let mut parts: Vec<(&Mechanism, f64)> =
                point.parts.iter().map(|(m, s)| (m, *s)).collect();
            let other;
            let step = match *c {
                Coordinate::Word(m, w) => {
                    let step = step_of(parts[m].0.words[w]);
                    other = self.shifted(parts[m].0, w, step)?;
                    parts[m].0 = &other;
                    step
                }
                Coordinate::Size(m) => {
                    parts[m].1 *= STEPS[1].exp();
                    STEPS[1]
                }
            };
            let torque = self.torque(&parts)?;
            let change = torque.plus(-1.0, &point.torque);
            Some(change.plus(1.0 / step - 1.0, &change))
        };
        coordinates.iter().map(slope).collect()
    }

    /// The point a step away, its sizes kept; none where a discrete choice would change.
    fn moved(
        &self,
        point: &Point,
        coordinates: &[Coordinate],
        step: &DVector<f64>,
    ) -> Option<Point> {
        let mut words: Vec<Vec<u64>> = point.parts.iter().map(|(m, _)| m.words.clone()).collect();
        let mut sizes: Vec<f64> = point.parts.iter().map(|(_, s)| *s).collect();
        for (c, by) in coordinates.iter().zip(step.iter()) {
            match *c {
                Coordinate::Word(m, w) => words[m][w] = moved(words[m][w], by.clamp(-0.5, 0.5)),
                Coordinate::Size(m) => sizes[m] *= by.clamp(-1.0, 1.0).exp(),
            }
        }
        let mut parts = Vec::new();
        for ((old, words), size) in point.parts.iter().zip(words).zip(sizes) {
            let mut rng = ChaCha8Rng::seed_from_u64(0);
            let new = self.witness.mechanism(old.0.origin, &words, &mut rng)?;
            if new.joint != old.0.joint || new.words.len() != words.len() {
                return None;
            }
            let size = self.kept(&new, size)?;
            parts.push((new, size));
        }
        self.at(parts)
    }
}

/// Step of a word's derivative, towards the middle of the cube.
fn step_of(word: u64) -> f64 {
    if word < 1 << 63 { STEPS[0] } else { -STEPS[0] }
}

/// A word moved by a part of the cube's side, within the cube; what chooses among cases stays.
fn moved(word: u64, by: f64) -> u64 {
    let side = 2f64.powi(64);
    let to = (word as f64 + by * side).clamp(0.0, side * (1.0 - 1e-9)) as u64;
    (to & !CASES) | (word & CASES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_moves_within_its_cube() {
        let quarter = (1u64 << 62) | 7;
        assert_eq!(moved(quarter, 0.25), (1 << 63) | 7);
        assert_eq!(moved(quarter, -1.0), 7);
        assert!(moved(quarter, 2.0) > u64::MAX - (1 << 36));
        assert_eq!(moved(quarter, 2.0) & CASES, 7);
        assert!(step_of(quarter) > 0.0 && step_of(u64::MAX) < 0.0);
    }
}
