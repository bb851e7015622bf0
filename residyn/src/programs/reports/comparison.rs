//! Two runs of one robot: errors joint by joint, and causes with their sizes.

use super::read::{Cause, Gap, Run, Size};
use model::spread::NINETY;

/// Two runs that cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum MismatchError {
    /// The reports are of different programs.
    #[error("{} is a report of {}, {} one of {}; two of one program can be compared", a.0, a.1, b.0, b.1)]
    Kind {
        /// File and program of the first run.
        a: (String, &'static str),
        /// File and program of the second run.
        b: (String, &'static str),
    },
    /// The runs are of different robots.
    #[error("{} is of the joints {}, {} of {}; two runs of one robot can be compared", a.0, a.1, b.0, b.1)]
    Joints {
        /// File and joints of the first run.
        a: (String, String),
        /// File and joints of the second run.
        b: (String, String),
    },
}

/// Two runs side by side.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// First and second run.
    pub runs: [Run; 2],
    /// Errors of the models that both runs have.
    pub gaps: Vec<[Gap; 2]>,
    /// Causes of either run, largest share first.
    pub causes: Vec<Pair>,
}

/// A cause in the first and in the second run; none where a run does not list it.
#[derive(Clone, Debug)]
pub struct Pair(pub [Option<Cause>; 2]);

/// A parameter of a cause in both runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizes {
    /// Name of the parameter.
    pub name: String,
    /// Joint that it belongs to, where it belongs to one.
    pub joint: Option<String>,
    /// Unit of the values.
    pub unit: String,
    /// Value and its standard deviation in either run.
    pub values: [Option<(f64, Option<f64>)>; 2],
}

/// What became of a parameter from the first run to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// One run alone states it.
    Alone,
    /// Its difference, of which a run states no deviation.
    Unsure(f64),
    /// Its difference and the deviation of that, within which zero lies (90 %).
    Within(f64, f64),
    /// Its difference and the deviation of that; zero lies outside (90 %).
    Clear(f64, f64),
}

impl Sizes {
    /// What became of the parameter.
    pub fn change(&self) -> Change {
        let [Some((a, a_std)), Some((b, b_std))] = self.values else {
            return Change::Alone;
        };
        match a_std.zip(b_std) {
            None => Change::Unsure(b - a),
            Some((s, t)) if (b - a).abs() > NINETY * s.hypot(t) => Change::Clear(b - a, s.hypot(t)),
            Some((s, t)) => Change::Within(b - a, s.hypot(t)),
        }
    }
}

impl Pair {
    /// The cause as one of the runs lists it.
    pub fn either(&self) -> &Cause {
        let [a, b] = &self.0;
        a.as_ref()
            .or(b.as_ref())
            .expect("a pair holds a cause of one run at least")
    }

    /// Its joints: those of the first run, then those that the second adds.
    pub fn joints(&self) -> Vec<&str> {
        let mut out: Vec<&str> = Vec::new();
        for joint in self.0.iter().flatten().flat_map(|c| &c.joints) {
            if !out.contains(&joint.as_str()) {
                out.push(joint);
            }
        }
        out
    }

    /// Its parameters in both runs, matched by name, joint and unit.
    pub fn sizes(&self) -> Vec<Sizes> {
        let mut out: Vec<Sizes> = Vec::new();
        for (run, cause) in self.0.iter().enumerate() {
            for size in cause.iter().flat_map(|c| &c.parameters) {
                let same = |s: &&mut Sizes| {
                    s.name == size.name && s.joint == size.joint && s.unit == size.unit
                };
                let value = Some((size.value, size.std));
                match out.iter_mut().find(same) {
                    Some(known) => known.values[run] = value,
                    None => out.push(Sizes::new(size, run, value)),
                }
            }
        }
        out
    }

    fn share(&self) -> f64 {
        let shares = self.0.iter().flatten().map(|c| c.share_of_gap);
        shares.fold(0.0, f64::max)
    }
}

impl Sizes {
    fn new(size: &Size, run: usize, value: Option<(f64, Option<f64>)>) -> Self {
        let mut values = [None, None];
        values[run] = value;
        Self {
            name: size.name.clone(),
            joint: size.joint.clone(),
            unit: size.unit.clone(),
            values,
        }
    }
}

/// Compares two runs of one program on one robot.
///
/// # Errors
/// The runs are of different programs or robots.
pub fn compare(a: Run, b: Run) -> Result<Comparison, MismatchError> {
    let file = |run: &Run| run.path.display().to_string();
    if a.kind != b.kind {
        return Err(MismatchError::Kind {
            a: (file(&a), a.kind.program()),
            b: (file(&b), b.kind.program()),
        });
    }
    if a.joints != b.joints {
        return Err(MismatchError::Joints {
            a: (file(&a), a.joints.join(", ")),
            b: (file(&b), b.joints.join(", ")),
        });
    }
    let both = a.gaps.iter().filter_map(|gap| {
        let other = b.gaps.iter().find(|g| g.name == gap.name)?;
        Some([gap.clone(), other.clone()])
    });
    Ok(Comparison {
        gaps: both.collect(),
        causes: paired(&a.causes, &b.causes),
        runs: [a, b],
    })
}

/// Causes of both runs: those of one effect that share most joints are one cause.
fn paired(a: &[Cause], b: &[Cause]) -> Vec<Pair> {
    let shared = |a: &Cause, b: &Cause| {
        let same = a.effect == b.effect && a.driver == b.driver;
        let joints = a.joints.iter().filter(|j| b.joints.contains(j)).count();
        if same { joints } else { 0 }
    };
    let mut rest: Vec<Cause> = b.to_vec();
    let mut out: Vec<Pair> = Vec::new();
    for cause in a {
        let best = (0..rest.len())
            .filter(|&k| shared(cause, &rest[k]) > 0)
            .max_by_key(|&k| (shared(cause, &rest[k]), std::cmp::Reverse(k)));
        out.push(Pair([Some(cause.clone()), best.map(|k| rest.remove(k))]));
    }
    out.extend(rest.into_iter().map(|cause| Pair([None, Some(cause)])));
    out.sort_by(|a, b| b.share().total_cmp(&a.share()));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cause(effect: &str, joints: &[&str], value: f64, std: Option<f64>) -> Cause {
        Cause {
            effect: effect.to_owned(),
            joints: joints.iter().map(|j| (*j).to_owned()).collect(),
            driver: None,
            share_of_gap: 0.5,
            gap_closed: 0.9,
            gap_closed_interval: Some([0.8, 0.95]),
            confirmed: true,
            parameters: vec![Size {
                name: "mass".to_owned(),
                joint: None,
                value,
                std,
                unit: "kg".to_owned(),
            }],
        }
    }

    #[test]
    fn causes_are_paired_by_the_joints_that_they_share() {
        let a = [
            cause("backlash", &["j1"], 1.0, None),
            cause("backlash", &["j2"], 1.0, None),
        ];
        let b = [
            cause("backlash", &["j2"], 2.0, None),
            cause("payload", &["j1"], 1.0, None),
        ];
        let pairs = paired(&a, &b);
        let has: Vec<[bool; 2]> = pairs
            .iter()
            .map(|p| [p.0[0].is_some(), p.0[1].is_some()])
            .collect();
        assert_eq!(has, [[true, false], [true, true], [false, true]]);
        assert_eq!(pairs[1].joints(), ["j2"]);
    }

    #[test]
    fn a_change_is_clear_beyond_the_interval_of_both() {
        let change = |a: Option<f64>, b: Option<f64>, by: f64| {
            let pair = Pair([
                Some(cause("payload", &["j1"], 1.0, a)),
                Some(cause("payload", &["j1"], 1.0 + by, b)),
            ]);
            pair.sizes()[0].change()
        };
        // The deviation of the difference is 0.05.
        assert!(matches!(
            change(Some(0.03), Some(0.04), 0.09),
            Change::Clear(..)
        ));
        assert!(matches!(
            change(Some(0.03), Some(0.04), 0.08),
            Change::Within(..)
        ));
        assert!(matches!(change(None, Some(0.04), 5.0), Change::Unsure(_)));
        let alone = Pair([Some(cause("payload", &["j1"], 1.0, None)), None]);
        assert_eq!(alone.sizes()[0].change(), Change::Alone);
    }
}
