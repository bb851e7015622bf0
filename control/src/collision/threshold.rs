//! Thresholds for a wanted rate of false alarms, and alarms.

use super::residual::Signal;
use serde::Serialize;

/// Least time from which a threshold is chosen, s.
pub const SHORTEST: f64 = 20.0;

/// Length of a block, s: largest values of different blocks count as independent.
const BLOCK: f64 = 0.5;
/// Part of the blocks that makes the tail, and the most of them: a longer recording is extrapolated from farther out.
const TAIL: f64 = 0.1;
const MOST: usize = 100;
/// Time below its threshold after which a joint's next alarm is another one, s.
const APART: f64 = 0.5;

/// A joint beyond its threshold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alarm {
    /// Row of the signal.
    #[serde(skip)]
    pub row: usize,
    /// When it began, s.
    pub time: f64,
    /// Joint, from 0.
    pub joint: usize,
    /// Largest value while it lasted, N·m or N.
    pub value: f64,
}

/// Threshold of every joint for `per_hour` false alarms of all joints together, N·m or N.
///
/// Of the largest |value| in blocks of half a second, the excesses of the highest tenth (at most a hundred) over the next are taken as
/// exponential (peaks over threshold with shape zero), and the threshold is where a joint's share of the rate lies on that tail; but no
/// lower than what keeps the recording itself within the rate.
pub fn thresholds(signal: &Signal, per_hour: f64) -> Vec<f64> {
    let share = per_hour / signal.dof.max(1) as f64;
    let of = |joint: usize| {
        let mut tops = blocks(signal, joint);
        tops.sort_by(|a, b| b.total_cmp(a));
        let tail = ((TAIL * tops.len() as f64) as usize).clamp(1, MOST);
        let Some(&edge) = tops.get(tail).or(tops.last()) else {
            return 0.0;
        };
        let excess = tops[..tail].iter().map(|t| t - edge).sum::<f64>() / tail as f64;
        let an_hour = 3600.0 / BLOCK * tail as f64 / tops.len() as f64;
        let by_tail = edge + excess * (an_hour / share).ln().max(0.0);
        let allowed = (share * signal.seconds() / 3600.0) as usize;
        by_tail.max(tops.get(allowed).copied().unwrap_or(0.0))
    };
    (0..signal.dof).map(of).collect()
}

/// Largest |value| of each block.
fn blocks(signal: &Signal, joint: usize) -> Vec<f64> {
    let mut tops = Vec::new();
    for stretch in &signal.stretches {
        let mut top = 0.0f64;
        let mut from = signal.time[stretch.start];
        for row in stretch.clone() {
            if signal.time[row] - from >= BLOCK {
                tops.push(top);
                (top, from) = (0.0, signal.time[row]);
            }
            top = top.max(signal.at(row, joint).abs());
        }
        tops.push(top);
    }
    tops
}

/// Where joints exceed their thresholds, in order of time within each stretch.
pub fn alarms(signal: &Signal, thresholds: &[f64]) -> Vec<Alarm> {
    let mut all: Vec<Alarm> = Vec::new();
    for (joint, threshold) in thresholds.iter().enumerate() {
        for stretch in &signal.stretches {
            let mut last: Option<(usize, f64)> = None;
            for row in stretch.clone() {
                let value = signal.at(row, joint).abs();
                if value <= *threshold {
                    continue;
                }
                let time = signal.time[row];
                match last {
                    Some((index, until)) if time - until < APART => {
                        all[index].value = all[index].value.max(value);
                        last = Some((index, time));
                    }
                    _ => {
                        last = Some((all.len(), time));
                        all.push(Alarm {
                            row,
                            time,
                            joint,
                            value,
                        });
                    }
                }
            }
        }
    }
    all.sort_by_key(|a| (a.row, a.joint));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Blocks whose largest values are exponential with mean 2: of 40 hours' blocks the wanted rate is met within what chance allows.
    #[test]
    fn the_wanted_rate_is_met_on_new_data() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut made = |hours: usize| {
            let mut signal = Signal::new(1);
            for block in 0..hours * 7200 {
                let value = -2.0 * rng.random_range(f64::EPSILON..1.0f64).ln();
                for k in 0..5 {
                    let t = 0.5 * block as f64 + 0.1 * f64::from(k);
                    let value = if k == 2 { value } else { 0.0 };
                    signal.push(t, &[value], block + k as usize == 0);
                }
            }
            signal
        };
        let threshold = thresholds(&made(2), 1.0);
        // P(block > x) = exp(−x/2) = 1/7200.
        assert!(
            (threshold[0] - 2.0 * 7200f64.ln()).abs() < 2.5,
            "{threshold:?}"
        );
        let found = alarms(&made(40), &threshold).len();
        assert!((8..160).contains(&found), "{found} in 40 hours");
    }

    #[test]
    fn one_alarm_while_it_lasts() {
        let mut signal = Signal::new(2);
        for k in 0..4000 {
            let t = f64::from(k) * 1e-3;
            let push = if (1.0..1.3).contains(&t) || (2.5..2.6).contains(&t) {
                -5.0
            } else {
                0.1
            };
            signal.push(t, &[0.0, push], k == 0);
        }
        let found = alarms(&signal, &[1.0, 4.0]);
        let told: Vec<(f64, usize, f64)> =
            found.iter().map(|a| (a.time, a.joint, a.value)).collect();
        assert_eq!(told, [(1.0, 1, 5.0), (2.5, 1, 5.0)]);
        assert!((signal.seconds() - 3.999).abs() < 1e-9);
    }
}
