//! Thresholds for a wanted rate of false alarms, and alarms.

use super::regime::Regime;
use super::residual::Signal;
use serde::Serialize;

/// Least time from which a threshold is chosen, s.
pub const SHORTEST: f64 = 20.0;

/// Length of a block, s: largest values of different blocks count as independent.
const BLOCK: f64 = 0.5;
/// Part of the blocks that makes the tail, and the most of them: a longer recording is extrapolated from farther out.
const TAIL: f64 = 0.1;
const MOST: usize = 100;
/// Largest k of a tail: what a model is wrong by has an end, but a hundred excesses tell k to a tenth only.
const BOUNDED: f64 = 0.25;
/// Least time of blocks that make a tail, s.
const ENOUGH: f64 = 10.0;
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

/// Thresholds of one joint, N·m or N.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Thresholds {
    /// In motion.
    pub moving: f64,
    /// Where it turned round.
    pub reversing: f64,
    /// Where it stands or has just left a standstill.
    pub standing: f64,
}

impl Thresholds {
    /// In one regime.
    pub fn of(&self, regime: Regime) -> f64 {
        match regime {
            Regime::Moving => self.moving,
            Regime::Reversing => self.reversing,
            Regime::Standing => self.standing,
        }
    }
}

/// Thresholds of every joint for `per_hour` false alarms of all joints together, each joint and each of its regimes with the same
/// share of it.
///
/// Of the largest |value| in blocks of half a second, the excesses of the highest tenth (at most a hundred) over the next make a tail
/// of generalised Pareto shape, and the threshold is where the share of the rate lies on it; but no lower than what keeps
/// the recording itself within the rate. A regime that was seen for less than ten seconds has no tail of its own: there the joint's
/// highest threshold or value counts.
pub fn thresholds(signal: &Signal, per_hour: f64) -> Vec<Thresholds> {
    let share = per_hour / (signal.dof.max(1) * Regime::ALL.len()) as f64;
    let hours = signal.seconds() / 3600.0;
    let of = |joint: usize| {
        let tops = Regime::ALL.map(|regime| blocks(signal, joint, regime));
        let own = tops.each_ref().map(|tops| {
            let enough = tops.len() as f64 * BLOCK >= ENOUGH;
            enough.then(|| threshold(tops, hours, share))
        });
        let highest = tops.iter().flatten().chain(own.iter().flatten());
        let highest = highest.fold(0.0f64, |a, b| a.max(*b));
        let [moving, reversing, standing] = own.map(|own| own.unwrap_or(highest));
        Thresholds {
            moving,
            reversing,
            standing,
        }
    };
    (0..signal.dof).map(of).collect()
}

/// Where `share` an hour of the largest values of blocks, highest first, lies beyond.
fn threshold(tops: &[f64], hours: f64, share: f64) -> f64 {
    let tail = ((TAIL * tops.len() as f64) as usize).clamp(1, MOST);
    let Some(&edge) = tops.get(tail).or(tops.last()) else {
        return 0.0;
    };
    let excesses: Vec<f64> = tops[..tail].iter().map(|t| t - edge).collect();
    let beyond = (share * hours / tail as f64).min(1.0);
    let allowed = (share * hours) as usize;
    let seen = tops.get(allowed).copied().unwrap_or(0.0);
    (edge + pareto(&excesses, beyond)).max(seen)
}

/// What a part `beyond` of the excesses, highest first, exceeds: generalised Pareto with cumulative probability
/// 1 − (1 − k x/α)^(1/k), by probability-weighted moments (Hosking and Wallis 1987, section 4; k is minus the shape ξ of
/// others). k is held from 0, the exponential tail, to [`BOUNDED`].
fn pareto(excesses: &[f64], beyond: f64) -> f64 {
    let n = excesses.len() as f64;
    let mean = excesses.iter().sum::<f64>() / n;
    // E[x (1 − F)]: the highest comes first, and its 1 − F is the smallest.
    let ranked = excesses.iter().enumerate();
    let weighted = ranked.map(|(i, x)| x * (i as f64 + 0.35) / n).sum::<f64>() / n;
    let k = mean / (mean - 2.0 * weighted) - 2.0;
    // Less its asymptotic standard error (their section 4): chance is not to shorten a tail.
    let spread = (1.0 + k) * (2.0 + k).powi(2) * (1.0 + k + 2.0 * k * k);
    let error = (spread / ((1.0 + 2.0 * k) * (3.0 + 2.0 * k) * n)).sqrt();
    let k = if error.is_finite() {
        (k - error).clamp(0.0, BOUNDED)
    } else {
        0.0
    };
    let scale = mean * (1.0 + k);
    if k > 1e-9 {
        scale * (1.0 - beyond.powf(k)) / k
    } else {
        -scale * beyond.ln()
    }
}

/// Largest |value| of each block in which the joint was in a regime, highest first.
fn blocks(signal: &Signal, joint: usize, regime: Regime) -> Vec<f64> {
    let mut tops = Vec::new();
    for stretch in &signal.stretches {
        let mut top: Option<f64> = None;
        let mut from = signal.time[stretch.start];
        for row in stretch.clone() {
            if signal.time[row] - from >= BLOCK {
                tops.extend(top.take());
                from = signal.time[row];
            }
            if signal.regime(row, joint) == regime {
                let value = signal.at(row, joint).abs();
                top = Some(top.map_or(value, |t| t.max(value)));
            }
        }
        tops.extend(top);
    }
    tops.sort_by(|a, b| b.total_cmp(a));
    tops
}

/// Where joints exceed their thresholds, in order of time within each stretch.
pub fn alarms(signal: &Signal, thresholds: &[Thresholds]) -> Vec<Alarm> {
    let mut all: Vec<Alarm> = Vec::new();
    for (joint, threshold) in thresholds.iter().enumerate() {
        for stretch in &signal.stretches {
            let mut last: Option<(usize, f64)> = None;
            for row in stretch.clone() {
                let value = signal.at(row, joint).abs();
                if value <= threshold.of(signal.regime(row, joint)) {
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

    fn alike(threshold: f64) -> Thresholds {
        Thresholds {
            moving: threshold,
            reversing: threshold,
            standing: threshold,
        }
    }

    /// Excesses of known tails: k = 1/4 has its end at 4 α, k = 0 has none, and k = −1/2 counts as 0. A standard error less of k is a
    /// little more of threshold.
    #[test]
    fn tails_of_known_shape() {
        let of = |k: f64| -> Vec<f64> {
            let at = |i: usize| {
                let beyond: f64 = (i as f64 + 0.5) / 2000.0;
                if k == 0.0 {
                    -beyond.ln()
                } else {
                    (1.0 - beyond.powf(k)) / k
                }
            };
            (0..2000).map(at).collect()
        };
        let bounded = pareto(&of(0.25), 1e-4);
        assert!((3.6..3.9).contains(&bounded), "{bounded}");
        assert!((pareto(&of(0.0), 1e-4) - 1e4f64.ln()).abs() < 0.3);
        let mean = 2.0;
        assert!((pareto(&of(-0.5), 1e-4) / (mean * 1e4f64.ln()) - 1.0).abs() < 0.05);
        assert_eq!(pareto(&[0.0; 5], 1e-4), 0.0);
    }

    /// A joint whose friction errs at reversals has a high threshold there and there alone; a regime that was hardly seen takes the
    /// joint's highest.
    #[test]
    fn each_regime_has_its_own() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mut signal = Signal::new(1);
        for k in 0..60_000 {
            let t = f64::from(k) * 0.01;
            let regime = match k % 200 {
                _ if k < 100 => Regime::Standing,
                0..50 => Regime::Reversing,
                _ => Regime::Moving,
            };
            let size = if regime == Regime::Reversing {
                5.0
            } else {
                1.0
            };
            let value = size * rng.random_range(-1.0..1.0);
            signal.push(t, &[value], &[regime], k == 0);
        }
        let Thresholds {
            moving,
            reversing,
            standing,
        } = thresholds(&signal, 1.0)[0];
        assert!((1.0..1.2).contains(&moving), "{moving}");
        assert!((5.0..6.0).contains(&reversing), "{reversing}");
        assert_eq!(standing, reversing);
        let found = alarms(
            &signal,
            &[Thresholds {
                moving: 0.5,
                reversing: 9.0,
                standing: 9.0,
            }],
        );
        assert!(
            found
                .iter()
                .all(|a| signal.regime(a.row, 0) == Regime::Moving)
        );
    }

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
                    signal.push(t, &[value], &[Regime::Moving], block + k as usize == 0);
                }
            }
            signal
        };
        let threshold = thresholds(&made(2), 1.0);
        // A third of an alarm an hour in each regime: P(block > x) = exp(−x/2) = 1/21600.
        assert!(
            (threshold[0].moving - 2.0 * 21_600f64.ln()).abs() < 2.5,
            "{threshold:?}"
        );
        let found = alarms(&made(40), &threshold).len();
        assert!((3..60).contains(&found), "{found} in 40 hours");
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
            signal.push(t, &[0.0, push], &[Regime::Moving; 2], k == 0);
        }
        let found = alarms(&signal, &[alike(1.0), alike(4.0)]);
        let told: Vec<(f64, usize, f64)> =
            found.iter().map(|a| (a.time, a.joint, a.value)).collect();
        assert_eq!(told, [(1.0, 1, 5.0), (2.5, 1, 5.0)]);
        assert!((signal.seconds() - 3.999).abs() < 1e-9);
    }
}
