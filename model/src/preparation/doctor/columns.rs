//! Columns that belong to another joint, or that count in the opposite direction.
//!
//! Rigid body and friction are fitted to each joint alone, whatever the described inertials and the unit of its torque.
//! With the right reading of the columns the torque is explained. With another one it is not, as gravity and coupling
//! depend on the positions.

use super::blocks::{Blocks, Estimate};
use super::patient::{Patient, complaint};
use super::unit::CLEAR;
use crate::preparation::channel::systems::{Reading, Systems};
use datasets::channel::ChannelEstimate;
use datasets::check::{Ailment, Complaint, Severity};
use datasets::prepare::Prepared;
use rayon::prelude::*;
use signal::delay::{Search, rows_at};

/// Number of rows on which a reading is finally judged.
const ROWS: usize = 4000;
/// Number of rows on which the many readings are compared first.
const FIRST: usize = 2000;
/// Least part of a torque's variance that any model leaves unexplained: none is right to less than three hundredths of
/// the torque's deviation.
const LEAST: f64 = 1e-3;
/// Least gain of another reading, Σ ln of the joints' squared errors: as if the errors of three joints were halved.
const GAIN: f64 = 3.0 * std::f64::consts::LN_2;

/// Whether a wrong reading of the columns can look like this fault.
pub(super) fn could_be(ailment: Ailment) -> bool {
    use Ailment::{Current, Dead, GravityRemoved, Motor, PerMille, Percent, Scale, Sign};
    matches!(
        ailment,
        Current | Dead | GravityRemoved | Motor | PerMille | Percent | Scale | Sign
    )
}

/// Complaint about the columns, where another reading of them explains the torque far better; none otherwise.
pub(super) fn otherwise(
    patient: &Patient,
    prepared: &Prepared,
    channel: &ChannelEstimate,
) -> Option<Complaint> {
    let n = patient.joints.len();
    let delay = channel.delay.value.unwrap_or(0.0);
    let judge = |reading: &Reading, rows| judged(patient, prepared, reading, delay, rows);
    let plain = Reading::plain(n);
    let first = judge(&plain, FIRST)?;
    // Shortcut: so little is unexplained that no reading could gain enough.
    if first.sum() - n as f64 * LEAST.ln() < GAIN {
        return None;
    }
    let (mut best, mut left) = (plain.clone(), first.sum());
    // One exchange or turn at a time, as long as each is worth it.
    for _ in 0..n {
        let others = neighbours(&best);
        let scored: Vec<(f64, &Reading)> = others
            .par_iter()
            .filter_map(|reading| Some((judge(reading, FIRST)?.sum(), reading)))
            .collect();
        let least = scored.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        if left - least.0 < GAIN {
            break;
        }
        (left, best) = (least.0, least.1.clone());
    }
    if best == plain {
        return None;
    }
    let gain = judge(&plain, ROWS)?.over(&judge(&best, ROWS)?);
    (gain.value >= GAIN.max(CLEAR * gain.std)).then(|| said(patient, &best, gain.value))
}

/// Readings that differ from `from` by the exchange of two columns, or by one opposite direction.
fn neighbours(from: &Reading) -> Vec<Reading> {
    let n = from.order.len();
    let mut all = Vec::new();
    for i in 0..n {
        let mut turned = from.clone();
        turned.turned[i] = !turned.turned[i];
        all.push(turned);
        for k in i + 1..n {
            let mut other = from.clone();
            other.order.swap(i, k);
            all.push(other);
        }
    }
    all
}

/// Unexplained part of each joint's torque variance under one reading, by joint and stretch of time. Each stretch is
/// predicted by a model fitted to the others.
struct Left(Vec<Vec<f64>>);

impl Left {
    /// Sum over the joints of the logarithm of the unexplained part, which counts as at most 1.
    fn sum(&self) -> f64 {
        self.without(None)
    }

    /// Same sum without one stretch.
    fn without(&self, stretch: Option<usize>) -> f64 {
        let of = |parts: &Vec<f64>| {
            let own = parts
                .iter()
                .enumerate()
                .filter(|(b, _)| Some(*b) != stretch);
            let (sum, count) = own.fold((0.0, 0.0), |(s, n), (_, p)| (s + p, n + 1.0));
            let all = sum * parts.len() as f64 / f64::max(count, 1.0);
            (all.min(1.0) + LEAST).ln()
        };
        self.0.iter().map(of).sum()
    }

    /// Difference of [`Self::sum`] between this reading and the other, with its standard deviation by the jackknife
    /// over stretches.
    fn over(&self, other: &Self) -> Estimate {
        let count = self.0.first().map_or(0, Vec::len);
        let each = (0..count).map(|b| self.without(Some(b)) - other.without(Some(b)));
        Estimate::of_jackknife(self.sum() - other.sum(), &each.collect::<Vec<_>>())
    }
}

/// Unexplained parts under a reading, on about `rows` rows; none where the joints cannot be fitted.
fn judged(
    patient: &Patient,
    prepared: &Prepared,
    reading: &Reading,
    delay: f64,
    rows: usize,
) -> Option<Left> {
    let systems = Systems::read(patient.robot, patient.recording, prepared, reading, rows)?;
    let mut all = Vec::new();
    for (j, joint) in systems.joints.iter().enumerate() {
        let Some(joint) = joint else { continue };
        let system = systems.system(joint, j);
        let width = system.columns.len();
        let offset = width - joint.friction.len();
        let (values, target) = rows_at(&system, delay, &Search::default())?;
        let blocks = Blocks::new(&values, &target, width);
        let spread = blocks.left(&[offset]).max(f64::MIN_POSITIVE);
        let left = blocks.left_out(&(0..width).collect::<Vec<_>>());
        all.push(left.into_iter().map(|l| l / spread).collect());
    }
    Some(Left(all))
}

/// Complaint about the columns, with the lines that would correct them.
fn said(patient: &Patient, reading: &Reading, gain: f64) -> Complaint {
    let n = patient.joints.len();
    let exchanged: Vec<usize> = (0..n).filter(|&j| reading.order[j] != j).collect();
    let turned: Vec<usize> = (0..n).filter(|&j| reading.turned[j]).collect();
    let mut parts = Vec::new();
    let mut lines = Vec::new();
    if !exchanged.is_empty() {
        let numbers: Vec<String> = exchanged.iter().map(|j| (j + 1).to_string()).collect();
        parts.push(match exchanged[..] {
            [_, _] => format!("columns {} look exchanged", numbers.join(" and ")),
            _ => format!(
                "columns {} look like those of other joints",
                numbers.join(", ")
            ),
        });
        for &j in &exchanged {
            for group in ["q", "tau"] {
                lines.push(format!(
                    "columns.{group}{} = \"{group}{}\"",
                    j + 1,
                    reading.order[j] + 1
                ));
            }
        }
    }
    if !turned.is_empty() {
        parts.push(format!(
            "positions of {} look turned round: they count against the description's axis",
            patient.names(&turned)
        ));
        let signs: Vec<f64> = reading
            .turned
            .iter()
            .map(|t| if *t { -1.0 } else { 1.0 })
            .collect();
        lines.push(super::patient::list("direction", &signs));
    }
    let ailment = if exchanged.is_empty() {
        Ailment::Turned
    } else {
        Ailment::Columns
    };
    let mut joints = [exchanged, turned].concat();
    joints.sort_unstable();
    joints.dedup();
    Complaint {
        drive: Some(lines.join("\n")),
        ..complaint(
            ailment,
            Severity::Severe,
            joints,
            [
                format!(
                    "read so, rigid body and friction leave {:.2} times the squared error that they leave of the columns as they stand, in \
                     the mean of the joints",
                    (-gain / n as f64).exp()
                ),
                parts.join("; "),
                "compare names and order of the columns, and each joint's positive direction, with the description before you take these \
                 lines (direction turns position and torque; a torque that was right before needs torque_scale = -1 there)"
                    .to_owned(),
            ],
        )
    }
}
