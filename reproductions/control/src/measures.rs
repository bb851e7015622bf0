//! How well a motion was followed.

use crate::track::Trace;
use serde::Serialize;

/// When a robot counts as settled, as the softMC manual defines it: once the profile is completed, ISSETTLED is set when the
/// position error has been at most PESETTLE for TIMESETTLE.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settle {
    /// PESETTLE of every joint, rad or m.
    pub pesettle: Vec<f64>,
    /// TIMESETTLE, s.
    pub timesettle: f64,
}

/// Errors of one joint during the motion, rad or m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub peak: f64,
    /// From the lowest to the highest.
    pub peak_to_peak: f64,
}

/// Measures of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tracking {
    /// Joint by joint.
    pub joints: Vec<Errors>,
    /// Distance of the tool from where it was to be, m; none where no tool is known.
    pub tool: Option<Errors>,
    /// Time from the end of the profile to ISSETTLED, s; none where it was not set while the robot was watched, or no rule given.
    pub settling: Option<f64>,
}

impl Errors {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut squares, mut count, mut low, mut high) =
            (0.0, 0usize, f64::INFINITY, f64::NEG_INFINITY);
        for value in values {
            squares += value * value;
            count += 1;
            low = low.min(value);
            high = high.max(value);
        }
        Self {
            rms: (squares / count.max(1) as f64).sqrt(),
            peak: low.abs().max(high.abs()),
            peak_to_peak: high - low,
        }
    }
}

impl Tracking {
    /// Errors from `trace.from` to the end of the motion, settling from there.
    pub fn of(trace: &Trace, settle: Option<&Settle>) -> Self {
        let first = trace.time.partition_point(|&t| t < trace.from);
        let moving = first..trace.time.partition_point(|&t| t <= trace.duration);
        let n = trace.dof;
        let joint = |j: usize| Errors::of(moving.clone().map(|k| trace.error[k * n + j]));
        let tool = (!trace.tool.is_empty())
            .then(|| Errors::of(trace.tool[moving.clone()].iter().copied()));
        Self {
            joints: (0..n).map(joint).collect(),
            tool,
            settling: settle.and_then(|rule| settling(trace, rule)),
        }
    }

    /// Root mean square over joints of a robot whose joints are all of one kind.
    pub fn rms(&self) -> f64 {
        let squares = self.joints.iter().map(|e| e.rms * e.rms).sum::<f64>();
        (squares / self.joints.len() as f64).sqrt()
    }
}

/// Time from the end of the profile to ISSETTLED, s.
fn settling(trace: &Trace, rule: &Settle) -> Option<f64> {
    let n = trace.dof;
    let within = |k: usize| {
        let errors = &trace.error[k * n..][..n];
        errors
            .iter()
            .zip(&rule.pesettle)
            .all(|(e, limit)| e.abs() <= *limit)
    };
    let mut since: Option<f64> = None;
    let first = trace.time.partition_point(|&t| t < trace.duration);
    for k in first..trace.time.len() {
        if !within(k) {
            since = None;
            continue;
        }
        let entered = *since.get_or_insert(trace.time[k]);
        // Half a nanosecond for the clock's rounding.
        if trace.time[k] - entered >= rule.timesettle - 5e-10 {
            return Some(trace.time[k] - trace.duration);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within PESETTLE from 0.10 to 0.12 s after the end, which is too short, and from 0.15 s on.
    #[test]
    fn settled_only_after_its_time() {
        let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * 1e-3).collect();
        let error = time.iter().map(|&t| {
            let after = t - 0.5;
            let inside = (0.0995..0.1205).contains(&after) || after >= 0.1495;
            if inside { 0.001 } else { -0.02 }
        });
        let trace = Trace {
            dof: 1,
            from: 0.0,
            duration: 0.5,
            error: error.collect(),
            time,
            tool: Vec::new(),
        };
        let rule = |timesettle| Settle {
            pesettle: vec![0.001],
            timesettle,
        };
        let found = |timesettle| Tracking::of(&trace, Some(&rule(timesettle))).settling;
        assert!((found(0.05).unwrap() - 0.2).abs() < 1e-9);
        assert!((found(0.01).unwrap() - 0.11).abs() < 1e-9);
        assert_eq!(found(0.6), None);
        let errors = Tracking::of(&trace, None).joints[0];
        assert!((errors.rms - 0.02).abs() < 1e-12);
        assert_eq!((errors.peak, errors.peak_to_peak), (0.02, 0.0));
    }
}
