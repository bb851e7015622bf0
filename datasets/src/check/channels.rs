//! Position, velocity and torque of one joint.

use super::finding::{CheckOptions, Finding, JointFigures, Kind, Severity};
use super::velocity::VelocityChannel;
use crate::Recording;
use crate::metrics::MOVING;
use signal::Motion;
use signal::quantile::median;

/// Range of positions within which a joint counts as never moving, rad or m.
pub const STILL: f64 = 1e-3;

/// Whether a joint moves at all in a recording.
pub fn moves(recording: &Recording, joint: usize) -> bool {
    let q = recording.q.column(joint);
    let low = q.iter().copied().fold(f64::INFINITY, f64::min);
    q.iter().any(|v| v - low >= STILL)
}

/// Top speed below which friction cannot be resolved, in rad/s or m/s.
const SLOW: f64 = 0.05;
/// Number of cycles below which a recording is too short.
const CYCLES: f64 = 3.0;
/// Range below which position-dependent torque cannot be seen, in rad or m, and as a part of the
/// range between the limits.
const SMALL_RANGE: f64 = 0.2;
const SMALL_PART: f64 = 0.05;
/// Delay of a recorded velocity that is worth a note, s. The whole 95 % interval must lie beyond plus or minus this.
const LATE: f64 = 2e-3;
/// Deviation of a recorded velocity's gain from 1 that is worth a warning.
const VELOCITY_GAIN: f64 = 0.05;
/// Width of the top of |τ| in which a plateau is looked for, as a part of the largest value.
const TOP: f64 = 0.01;
/// Factor by which the top must hold more samples than bands of the same width below it, to be a plateau.
const CROWDED: f64 = 4.0;
/// Least part of all samples that a plateau holds.
const PLATEAU_SHARE: f64 = 0.002;
/// Least number of separate stretches in which the torque reaches a plateau: one smooth peak is flat at its top, too.
const PLATEAU_VISITS: usize = 3;
/// Longest time for which a torque may keep exactly one value while the joint moves (`MOVING`), s. Beyond it the check
/// warns.
const FROZEN_S: f64 = 0.5;

/// One joint of a recording with its smooth motion.
pub(super) struct Channel<'a> {
    pub recording: &'a Recording,
    pub motion: &'a Motion,
    pub velocity: Option<VelocityChannel>,
    pub joint: usize,
    pub name: String,
    pub slides: bool,
}

impl Channel<'_> {
    /// Units of the joint's position and of its torque.
    fn units(&self) -> [&'static str; 2] {
        if self.slides {
            ["m", "N"]
        } else {
            ["rad", "N·m"]
        }
    }

    fn q(&self) -> impl Iterator<Item = f64> + '_ {
        self.recording.q.column(self.joint).into_iter().copied()
    }

    fn qd(&self, row: usize) -> f64 {
        self.motion.qd[(row, self.joint)]
    }

    fn tau(&self) -> Option<Vec<f64>> {
        Some(self.recording.tau.as_ref()?.column(self.joint).to_vec())
    }

    fn rows(&self) -> std::ops::Range<usize> {
        0..self.recording.len()
    }

    pub fn figures(&self) -> JointFigures {
        let range = self
            .q()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| {
                [low.min(q), high.max(q)]
            });
        let moving = self.rows().filter(|&r| self.qd(r).abs() > MOVING).count();
        let tau = self.tau();
        JointFigures {
            name: self.name.clone(),
            range,
            top_speed: self.rows().map(|r| self.qd(r).abs()).fold(0.0, f64::max),
            cycles: 0.5 * self.reversals() as f64,
            share_moving: moving as f64 / self.recording.len() as f64,
            torque_rms: tau
                .as_ref()
                .map(|t| (t.iter().map(|v| v * v).sum::<f64>() / t.len() as f64).sqrt()),
            torque_max: tau
                .as_ref()
                .map(|t| t.iter().fold(0.0, |m, v| v.abs().max(m))),
            velocity_delay: self.velocity.map(|v| v.late),
        }
    }

    /// Changes of direction between speeds beyond the threshold, within trajectories.
    fn reversals(&self) -> usize {
        let mut count = 0;
        for t in &self.recording.trajectories {
            let mut direction = 0.0;
            for v in t
                .range
                .clone()
                .map(|r| self.qd(r))
                .filter(|v| v.abs() > MOVING)
            {
                if direction * v < 0.0 {
                    count += 1;
                }
                direction = v.signum();
            }
        }
        count
    }

    fn finding(&self, kind: Kind, severity: Severity, value: f64, message: String) -> Finding {
        let message = format!("{}: {message}", self.name);
        Finding {
            kind,
            severity,
            joint: Some(self.joint),
            row: None,
            value,
            parameters: Vec::new(),
            message,
        }
    }

    pub fn findings(&self, figures: &JointFigures, options: &CheckOptions) -> Vec<Finding> {
        let mut found = self.motion_findings(figures, options);
        found.extend(self.velocity_finding());
        found.extend(self.corrupt_row());
        if let Some(tau) = self.tau() {
            found.extend(self.torque_findings(&tau));
        }
        found
    }

    fn motion_findings(&self, figures: &JointFigures, options: &CheckOptions) -> Vec<Finding> {
        let mut found = Vec::new();
        let [way, _] = self.units();
        let [low, high] = figures.range;
        let span = high - low;
        if span < STILL {
            found.push(self.finding(
                Kind::NeverMoves,
                Severity::Severe,
                span,
                "never moves; nothing about it can be identified".to_owned(),
            ));
            return found;
        }
        if figures.top_speed < SLOW {
            let text = format!(
                "moves at {:.3} {way}/s at most; viscous and Coulomb friction look alike below {SLOW}",
                figures.top_speed
            );
            found.push(self.finding(Kind::TooSlow, Severity::Warning, figures.top_speed, text));
        }
        if figures.cycles < CYCLES {
            let text = format!("makes {:.1} cycles; record at least three", figures.cycles);
            found.push(self.finding(Kind::TooShort, Severity::Warning, figures.cycles, text));
        }
        let limits = options.position_limits.get(self.joint).copied();
        let between = limits
            .map(|[a, b]| b - a)
            .filter(|w| w.is_finite() && *w > 0.0);
        let needed = between.map_or(SMALL_RANGE, |w| SMALL_RANGE.min(SMALL_PART * w));
        if span < needed {
            let text = format!("covers {span:.3} {way}; gravity and position effects need more");
            found.push(self.finding(Kind::RegionTooSmall, Severity::Warning, span, text));
        }
        if let (Some([a, b]), Some(width)) = (limits, between) {
            let outside = (a - low).max(high - b).max(0.0);
            if outside > 0.1 * width {
                let (part, other) = match self.slides {
                    true => (1e-3, "it looks like mm"),
                    false => (1_f64.to_radians(), "it looks like degrees"),
                };
                let hint = if part * low >= a && part * high <= b {
                    other
                } else {
                    "check unit and joint zero"
                };
                let text = format!("is {outside:.2} {way} outside its limits; {hint}");
                found.push(self.finding(Kind::PositionScale, Severity::Severe, outside, text));
            }
        }
        found
    }

    /// Finding on the recorded velocity, where it differs from dq/dt.
    fn velocity_finding(&self) -> Option<Finding> {
        let VelocityChannel { gain, late } = self.velocity?;
        if gain.abs() < VELOCITY_GAIN {
            let text = "the recorded velocity has nothing to do with dq/dt: a column of zeros, or of something else; it is left aside"
                .to_owned();
            return Some(self.finding(Kind::VelocityMismatch, Severity::Warning, gain, text));
        }
        if (gain - 1.0).abs() > VELOCITY_GAIN {
            let text = format!("the recorded velocity is {gain:.3} times dq/dt; check its unit");
            return Some(self.finding(Kind::VelocityMismatch, Severity::Warning, gain, text));
        }
        let (value, [low, high]) = (late.value?, late.interval?);
        late.lies_outside([-LATE, LATE]).then(|| {
            let text = format!(
                "the recorded velocity is {:.1} ms ({:.1} to {:.1}) late",
                1e3 * value,
                1e3 * low,
                1e3 * high
            );
            self.finding(Kind::VelocityMismatch, Severity::Note, value, text)
        })
    }

    /// A position that jumps away for one sample and comes back.
    fn corrupt_row(&self) -> Option<Finding> {
        let q = self.recording.q.column(self.joint);
        let off = |r: usize| (q[r] - 0.5 * (q[r - 1] + q[r + 1])).abs();
        let rows = || {
            self.recording
                .trajectories
                .iter()
                .flat_map(|t| t.range.start + 1..t.range.end - 1)
        };
        let row = rows().max_by(|&a, &b| off(a).total_cmp(&off(b)))?;
        // A corrupt row stands out in its neighbours, too.
        let others = rows().filter(|r| r.abs_diff(row) > 1);
        let mut sizes: Vec<f64> = others.map(off).collect();
        if sizes.is_empty() {
            return None;
        }
        let at = sizes.len() * 99 / 100;
        let usual = *sizes.select_nth_unstable_by(at, f64::total_cmp).1;
        let size = off(row);
        let [way, _] = self.units();
        (size > 30.0 * usual && size > 0.01).then(|| Finding {
            row: Some(row + 1),
            ..self.finding(
                Kind::CorruptRow,
                Severity::Severe,
                size,
                format!("the position jumps by {size:.3} {way} for one sample; remove the row"),
            )
        })
    }

    fn torque_findings(&self, tau: &[f64]) -> Vec<Finding> {
        let mut found = Vec::new();
        if tau.iter().all(|v| *v == tau[0]) {
            let text = format!(
                "the torque is {} in every sample; the channel is dead",
                tau[0]
            );
            found.push(self.finding(Kind::DeadChannel, Severity::Severe, tau[0], text));
            return found;
        }
        found.extend(self.frozen(tau));
        if let Some((level, share)) = plateau(tau) {
            let [_, unit] = self.units();
            let text = format!(
                "the torque is cut at ±{level:.1} {unit} in {:.1} % of the samples; move it less fast",
                100.0 * share
            );
            found.push(self.finding(Kind::TorquePlateau, Severity::Warning, level, text));
        }
        found
    }

    /// The longest stretch in which the torque keeps one value while the joint moves.
    fn frozen(&self, tau: &[f64]) -> Option<Finding> {
        let time = &self.recording.time;
        let (mut longest, mut at) = (0.0, 0);
        for t in &self.recording.trajectories {
            let mut start = t.range.start;
            for row in t.range.clone() {
                if tau[row] != tau[start] || self.qd(row).abs() <= MOVING {
                    start = row;
                }
                if time[row] - time[start] > longest {
                    (longest, at) = (time[row] - time[start], start);
                }
            }
        }
        (longest > FROZEN_S).then(|| Finding {
            row: Some(at + 1),
            ..self.finding(
                Kind::DeadChannel,
                Severity::Warning,
                longest,
                format!("the torque keeps one value for {longest:.1} s while the joint moves"),
            )
        })
    }
}

/// Level (median of the flat part, N·m) and share of samples of a flat top in |τ|, where there is one.
///
/// Without a limit the largest values are rare; with one they crowd below it. The top of the range
/// is compared with the band below it.
pub fn plateau(tau: &[f64]) -> Option<(f64, f64)> {
    let largest = tau.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let count = |from: f64, to: f64| {
        tau.iter()
            .filter(|v| (from * largest..to * largest).contains(&v.abs()))
            .count() as f64
    };
    let top = count(1.0 - TOP, 2.0);
    // Five bands of the same width below, averaged.
    let below = count(1.0 - 7.0 * TOP, 1.0 - 2.0 * TOP) / 5.0;
    let share = top / tau.len() as f64;
    let at_top = |v: &f64| v.abs() >= (1.0 - TOP) * largest;
    let entries = tau.windows(2).filter(|w| !at_top(&w[0]) && at_top(&w[1]));
    let visits = entries.count() + usize::from(tau.first().is_some_and(at_top));
    let crowded = top > CROWDED * below.max(1.0) && share > PLATEAU_SHARE;
    if !crowded || visits < PLATEAU_VISITS {
        return None;
    }
    let flat = tau.iter().filter(|v| at_top(v)).map(|v| v.abs());
    Some((median(flat.collect())?, share))
}
