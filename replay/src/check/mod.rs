//! Check that commands and positions of a recording are those of one robot: on one clock, in one unit and in one order.

mod clock;
mod follows;
mod unusable;

use clock::clock;
use datasets::{Recording, Trajectory};
use follows::{FOLLOWED, Follows, RELATED, SLOWEST};
use ndarray::Array2;
use std::f64::consts::PI;
pub use unusable::Unusable;

/// Range of a joint's column: largest less smallest value.
pub(crate) fn range(table: &Array2<f64>, joint: usize) -> f64 {
    let column = table.column(joint);
    let (low, high) = column
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
            (a.min(*v), b.max(*v))
        });
    high - low
}

/// Largest range of commands, rad, during which dry friction may hold a joint still. A hobby servo's holds it through
/// three degrees.
const HELD: f64 = 0.1;

/// Refuses recordings whose replay is impossible or meaningless. `quantum` is the quantisation step of each joint's
/// positions, rad; 0 for none. `lags` says how late each joint follows by what is given of its drive, s.
///
/// # Errors
/// First fault found, with what to do about it.
pub(crate) fn check(
    recording: &Recording,
    command: &Array2<f64>,
    quantum: &[f64],
    lags: &[f64],
) -> Result<(), Unusable> {
    let source_name = || recording.source.clone();
    let n = recording.dof();
    let step = recording.median_step();
    if step > SLOWEST {
        return Err(Unusable::Apart {
            source_name: source_name(),
            step,
        });
    }
    let spans = |j: usize| (range(&recording.q, j), range(command, j));
    if (0..n).all(|j| spans(j).0 == 0.0) && (0..n).all(|j| spans(j).1 <= HELD) {
        return Err(Unusable::Still {
            source_name: source_name(),
        });
    }
    for j in 0..n {
        let (own, commanded) = spans(j);
        if own == 0.0 && commanded > HELD {
            return Err(Unusable::Stuck {
                source_name: source_name(),
                joint: j + 1,
                commanded,
            });
        }
    }
    let both: Vec<usize> = (0..n)
        .filter(|&j| spans(j).0 > 0.0 && spans(j).1 > 0.0)
        .collect();
    for &j in &both {
        if let Some(shift) = echo(recording, command, j, quantum[j]) {
            return Err(Unusable::Echo {
                source_name: source_name(),
                joint: j + 1,
                shift,
            });
        }
    }
    let own = |&j: &usize| Follows::of(recording, command, [j, j], SLOWEST + lags[j]);
    let known: Vec<Follows> = both.iter().map(own).collect();
    order(recording, command, &both, &known, lags)?;
    for (&j, follows) in both.iter().zip(&known) {
        unit_and_sign(recording, command, j, follows, SLOWEST + lags[j])?;
    }
    clock(recording, command, &both, lags)?;
    let each = known.iter().map(|f| f.drive[0]).collect();
    if let Some(correlation) = signal::quantile::median(each).filter(|c| *c < RELATED) {
        return Err(Unusable::Unrelated {
            source_name: source_name(),
            correlation,
        });
    }
    Ok(())
}

/// Largest number of samples by which copied positions may be shifted.
const SHIFTED: isize = 10;

/// Shift, in words, by which a joint's commands equal its own positions: the log then holds copies instead of goals.
/// None where they differ. Equality is to half a quantisation step, or single precision.
fn echo(recording: &Recording, command: &Array2<f64>, j: usize, quantum: f64) -> Option<String> {
    let (q, c) = (recording.q.column(j), command.column(j));
    let near = (0.5 * quantum).max(1e-6);
    let equal = |shift: isize| {
        recording.trajectories.iter().all(|t| {
            t.range.clone().all(|row| {
                let other = row.checked_add_signed(shift);
                let other = other.filter(|o| t.range.contains(o));
                other.is_none_or(|o| (c[row] - q[o]).abs() <= near)
            })
        })
    };
    let mut shifts: Vec<isize> = (-SHIFTED..=SHIFTED).collect();
    shifts.sort_by_key(|s| s.abs());
    let shift = shifts.into_iter().find(|&s| equal(s))?;
    Some(match shift {
        0 => ", sample by sample".to_owned(),
        s => format!(
            " {} sample(s) {}",
            s.abs(),
            if s > 0 { "later" } else { "earlier" }
        ),
    })
}

/// Refuses commands in other joints' columns. That is a ring of joints in which each command belongs to the next
/// joint's positions rather than its own. It is less than half as far from them, or only they follow it.
///
/// Bad drives alone make no ring: of two joints, each would have to follow the other's command better.
fn order(
    recording: &Recording,
    command: &Array2<f64>,
    joints: &[usize],
    own: &[Follows],
    lags: &[f64],
) -> Result<(), Unusable> {
    let apart = |a: usize, b: usize| {
        let pairs = command.column(a).into_iter().zip(recording.q.column(b));
        pairs.map(|(c, q)| (c - q).powi(2)).sum::<f64>().sqrt()
    };
    let best = |of: &dyn Fn(usize) -> f64| {
        let all = joints.iter().map(|&b| (of(b), b));
        all.min_by(|x, y| x.0.total_cmp(&y.0))
    };
    let whose = |a: usize, own: &Follows| {
        let (least, nearest) = best(&|b| apart(a, b))?;
        if least < 0.5 * apart(a, a) {
            return Some(nearest);
        }
        if own.drive[0] > RELATED {
            return None;
        }
        let follows = |b: usize| Follows::of(recording, command, [a, b], SLOWEST + lags[b]);
        let (less, followed) = best(&|b| -follows(b).drive[0])?;
        (-less > FOLLOWED).then_some(followed)
    };
    let whose: Vec<(usize, Option<usize>)> = joints
        .iter()
        .zip(own)
        .map(|(&a, own)| (a, whose(a, own)))
        .collect();
    let next = |a: usize| whose.iter().find(|(j, _)| *j == a).and_then(|(_, b)| *b);
    let in_ring = |a: &usize| {
        let ring = std::iter::successors(next(*a), |&b| next(b));
        ring.take(joints.len()).any(|b| b == *a)
    };
    let found: Vec<String> = joints
        .iter()
        .copied()
        .filter(in_ring)
        .filter_map(|a| Some(format!("command {} is joint {}'s", a + 1, next(a)? + 1)))
        .collect();
    if found.is_empty() {
        return Ok(());
    }
    Err(Unusable::Order {
        source_name: recording.source.clone(),
        found: found.join(", "),
    })
}

/// Ratios of the commands' range to the positions' range that a wrong unit makes, with their meaning.
const UNITS: [(f64, &str); 3] = [
    (180.0 / PI, "degrees beside radians"),
    (PI / 180.0, "a conversion from degrees applied twice"),
    (1000.0, "millimetres beside metres"),
];

/// Refuses commands of joint `j` with the opposite sign, or in another unit. `slowest` is the longest delay that its drive may have, s.
fn unit_and_sign(
    recording: &Recording,
    command: &Array2<f64>,
    j: usize,
    follows: &Follows,
    slowest: f64,
) -> Result<(), Unusable> {
    let source_name = recording.source.clone();
    let ratio = deviation(command, j) / deviation(&recording.q, j);
    // Tolerance of a factor 2: the range of a drive that follows is within half and twice the command's.
    let is = |unit: f64| (0.5..2.0).contains(&(ratio / unit));
    // A joint at its torque limit hardly moves, and any way. One of the other sign moves as far, and in every trajectory.
    let follows_in = |t: &Trajectory| {
        Follows::over(recording, command, [j, j], &t.range, slowest).drive[0] > RELATED
    };
    let against = follows.drive[1] < -FOLLOWED && follows.drive[0] < RELATED && is(1.0);
    if against && !recording.trajectories.iter().any(follows_in) {
        return Err(Unusable::Sign {
            source_name,
            joint: j + 1,
        });
    }
    let unit = UNITS.iter().find(|(u, _)| is(*u));
    match unit.filter(|_| follows.best.1 > FOLLOWED) {
        Some((_, meaning)) => Err(Unusable::Unit {
            source_name,
            joint: j + 1,
            ratio,
            meaning: if percent(command) {
                "per cent of each motor's range beside radians"
            } else {
                meaning
            },
        }),
        None => Ok(()),
    }
}

/// Whether the largest magnitude in the table is 99 to 100, so that values are per cent.
fn percent(table: &Array2<f64>) -> bool {
    let most = table.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    (99.0..=100.0).contains(&most)
}

/// Standard deviation of a joint's column.
fn deviation(table: &Array2<f64>, j: usize) -> f64 {
    let column = table.column(j);
    let mean = column.mean().unwrap_or(0.0);
    (column.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / column.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint that moves `by` times its command in each of two trajectories of ten seconds.
    fn refused(by: [f64; 2]) -> Option<Unusable> {
        let rows = 1000;
        let command = |row: usize| (0.02 * row as f64).sin() + 0.3 * (0.071 * row as f64).sin();
        let at = |row: usize| [by[0], by[1]][row / rows] * command(row);
        let table =
            |of: &dyn Fn(usize) -> f64| Array2::from_shape_fn((2 * rows, 1), |(i, _)| of(i));
        let time = (0..2 * rows).map(|i| 0.01 * i as f64).collect();
        let mut recording = Recording::new("a joint", time, table(&at), None);
        recording.trajectories = [0..rows, rows..2 * rows]
            .map(|range| Trajectory {
                label: String::new(),
                range,
            })
            .to_vec();
        let command = table(&command);
        let follows = Follows::of(&recording, &command, [0, 0], SLOWEST);
        unit_and_sign(&recording, &command, 0, &follows, SLOWEST).err()
    }

    #[test]
    fn times_in_milliseconds_are_refused() {
        let motion = Array2::from_shape_fn((100, 1), |(i, _)| (0.1 * i as f64).sin());
        let time = (0..100).map(|i| 20.0 * i as f64).collect();
        let recording = Recording::new("a log", time, motion.clone(), None);
        let fault = check(&recording, &motion, &[0.0], &[0.0]);
        assert!(matches!(fault, Err(Unusable::Apart { step, .. }) if step == 20.0));
    }

    #[test]
    fn a_turned_sign_moves_as_far_in_every_trajectory() {
        let turned = |by| matches!(refused(by), Some(Unusable::Sign { .. }));
        assert!(turned([-1.0, -0.9]));
        // A joint that its torque limit holds, in one trajectory or in both.
        assert!(!turned([0.9, -0.02]) && !turned([-0.02, -0.02]));
        assert!(refused([1.0, 0.9]).is_none());
    }
}
