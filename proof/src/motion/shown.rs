//! What the recorded motion shows of a robot's values, by the simulator that made it: differences of its own roll-outs.

use super::MotionError;
use super::effects::Withheld;
use super::real::{Moved, Real};
use nalgebra::{DMatrix, DVector};
use plant::arm::scaled;
use plant::reference::Session;
use serde::{Deserialize, Serialize};

/// Deviation of a stated value relative to it, where nothing is withheld: no description is known better.
const STATED: f64 = 0.03;

/// Magnitude of a posterior correlation beyond which two values cannot be told apart.
const INSEPARABLE: f64 = 0.95;

/// Change by which a value is varied, relative to it.
const CHANGE: f64 = 1e-3;

/// Change by which a delay is varied, s: whole steps of the simulator, which delays commands by such.
const LATER: f64 = 1e-3;

/// Change by which the zero of an encoder is varied, rad.
const TURNED: f64 = 1e-4;

/// Value of the real robot, and how well the motion shows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shown {
    /// Name of the parameter in the report.
    pub name: String,
    /// Name of the joint; none for a parameter of the whole arm.
    pub joint: Option<String>,
    /// True value, in the parameter's unit.
    pub value: f64,
    /// Standard deviation with which it is known before the motion: wide where it is withheld.
    pub prior: f64,
    /// Standard deviation with which the motion leaves it, all listed values being fitted together.
    pub deviation: f64,
}

impl Shown {
    /// Value as it is known before the motion.
    fn before(name: &str, joint: Option<&String>, value: f64, prior: f64) -> Self {
        Self {
            name: name.to_owned(),
            joint: joint.cloned(),
            value,
            prior,
            deviation: prior,
        }
    }

    /// Whether the motion halves what was not known of it before.
    pub fn is_halved(&self) -> bool {
        self.deviation <= 0.5 * self.prior
    }
}

/// What a motion shows of the values of drives, friction, rotors, delays, zeros and masses. All else of the robot counts as known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Information {
    /// Each value that is not known exactly.
    pub values: Vec<Shown>,
    /// Pairs of them, by index, that cannot be told apart: magnitude of their posterior correlation above 0.95.
    pub inseparable: Vec<[usize; 2]>,
}

impl Information {
    /// Index of a value.
    pub fn index(&self, name: &str, joint: Option<&str>) -> Option<usize> {
        let mut all = self.values.iter();
        all.position(|v| v.name == name && v.joint.as_deref() == joint)
    }

    /// Whether two values, by index, cannot be told apart, or one of them is hardly shown at all.
    pub fn is_inseparable(&self, a: usize, b: usize) -> bool {
        let pair = [a.min(b), a.max(b)];
        let faint = |i: usize| !self.values[i].is_halved();
        self.inseparable.contains(&pair) || faint(a) || faint(b)
    }

    /// Information of white noise with the deviation `sigma` (rad) on every sample, from the change of the motion by each value.
    /// `changes` has a column for each of `values`, divided by the change of the value. None where it has no inverse.
    fn of(mut values: Vec<Shown>, changes: &[DVector<f64>], sigma: f64) -> Option<Self> {
        let p = values.len();
        let mut precision = DMatrix::from_fn(p, p, |i, k| {
            // In units of the prior deviations, in which the matrix is well scaled.
            let scale = values[i].prior * values[k].prior / (sigma * sigma);
            changes[i].dot(&changes[k]) * scale
        });
        for i in 0..p {
            precision[(i, i)] += 1.0;
        }
        let covariance = precision.cholesky()?.inverse();
        for (i, value) in values.iter_mut().enumerate() {
            value.deviation = value.prior * covariance[(i, i)].sqrt();
        }
        let correlation = |i: usize, k: usize| {
            covariance[(i, k)] / (covariance[(i, i)] * covariance[(k, k)]).sqrt()
        };
        let pairs = (0..p).flat_map(|i| (i + 1..p).map(move |k| [i, k]));
        let inseparable = pairs.filter(|[i, k]| correlation(*i, *k).abs() > INSEPARABLE);
        Some(Self {
            inseparable: inseparable.collect(),
            values,
        })
    }
}

/// Value that is varied: what is known of it, and the robots with a larger and a smaller value.
struct Varied {
    shown: Shown,
    /// Difference of the value between the two robots, in its unit.
    span: f64,
    /// Robot with the larger value.
    more: Real,
    /// Robot with the smaller value; none where it is the true one, because the value can hardly be less.
    less: Option<Real>,
}

/// What the motions of `real` along `sessions`, which are `moved`, show of its values, where `withheld` is not known. None where a
/// robot with a value varied does not follow its commands.
///
/// # Errors
/// Bodies that make no robot.
pub fn information(
    real: &Real,
    sessions: &[Session],
    moved: &[Moved],
    withheld: &[Withheld],
    known: Known,
) -> Result<Option<Information>, MotionError> {
    let mut values = Vec::new();
    let mut changes = Vec::new();
    for varied in varied(real, withheld, known) {
        let mut column = Vec::new();
        for (session, base) in sessions.iter().zip(moved) {
            let Some(more) = varied.more.run(session, known.period)? else {
                return Ok(None);
            };
            let less = match &varied.less {
                None => None,
                Some(real) => match real.run(session, known.period)? {
                    None => return Ok(None),
                    less => less,
                },
            };
            let less = less.as_ref().unwrap_or(base);
            let pairs = more.q.iter().zip(&less.q);
            column.extend(pairs.map(|(a, b)| (a - b) / varied.span));
        }
        values.push(varied.shown);
        changes.push(DVector::from_vec(column));
    }
    Ok(Information::of(values, &changes, known.sigma))
}

/// What is known of a case beside its motion.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// Relative deviation of the stated gains.
    pub tolerance: f64,
    /// Time between two commands, s.
    pub period: f64,
    /// Standard deviation of a recorded position: noise and quantisation, rad (m).
    pub sigma: f64,
}

/// Values that are not known exactly, each with the robots in which it is a little larger and smaller.
fn varied(real: &Real, withheld: &[Withheld], known: Known) -> Vec<Varied> {
    let mut out = Vec::new();
    let of = |name: &str, joint: Option<&String>| {
        let mut all = withheld.iter().flat_map(|w| &w.parameters);
        all.any(|p| p.name == name && p.joint.as_ref() == joint)
    };
    let gain = known.tolerance.hypot(STATED);
    let late = (2.0 * known.period).max(0.02);
    for (j, own) in real.arm.joints.iter().enumerate() {
        let joint = &own.name;
        let mut add = |name: &str, value: f64, stated: f64, put: &dyn Fn(&mut Real, f64)| {
            let prior = if of(name, Some(joint)) {
                value.abs()
            } else {
                stated * value.abs()
            };
            if prior <= 0.0 {
                return;
            }
            let change = CHANGE * value.abs();
            let [more, less] = [change, -change].map(|d| {
                let mut real = real.clone();
                put(&mut real, d);
                real
            });
            out.push(Varied {
                shown: Shown::before(name, Some(joint), value, prior),
                span: 2.0 * change,
                more,
                less: Some(less),
            });
        };
        add("kp", real.kp[j], gain, &|r, d| r.kp[j] += d);
        if real.rates {
            add("kd", real.kd[j], gain, &|r, d| r.kd[j] += d);
            add("viscous", own.damping, STATED, &|r, d| {
                r.arm.joints[j].damping += d
            });
        } else {
            // Without commanded velocities the motion shows the sum of both.
            let sum = own.damping + real.kd[j];
            add("viscous", sum, gain, &|r, d| r.kd[j] += d);
        }
        add("coulomb", own.friction, STATED, &|r, d| {
            r.arm.joints[j].friction += d
        });
        add("inertia", real.armature[j], STATED, &|r, d| {
            r.armature[j] += d
        });
        let factor = withheld.iter().flat_map(|w| &w.parameters);
        let mut factor =
            factor.filter(|p| p.name == "mass_factor" && p.joint.as_ref() == Some(joint));
        let factor = factor.next().map_or(1.0, |p| p.value);
        add("mass_factor", factor, STATED, &|r, d| {
            let own = &mut r.arm.joints[j].link.inertia;
            *own = scaled(own, 1.0 + d / factor);
        });
        let mut shift =
            |name: &str, value: f64, prior: f64, span: f64, more: Real, less: Option<Real>| {
                if !of(name, Some(joint)) {
                    return;
                }
                out.push(Varied {
                    shown: Shown::before(name, Some(joint), value, prior),
                    span,
                    more,
                    less,
                });
            };
        let [more, less] = [TURNED, -TURNED].map(|d| {
            let mut real = real.clone();
            real.zero[j] -= d;
            real
        });
        shift("zero", -real.zero[j], 0.05, 2.0 * TURNED, more, Some(less));
        let mut later = real.clone();
        later.late[j] += LATER;
        shift("delay", real.late[j], late, LATER, later, None);
    }
    let mut later = real.clone();
    later.late.iter_mut().for_each(|l| *l += LATER);
    let prior = if of("delay", None) { late } else { LATER };
    let earliest = real.late.iter().copied().fold(f64::INFINITY, f64::min);
    out.push(Varied {
        shown: Shown::before("delay", None, earliest, prior),
        span: LATER,
        more: later,
        less: None,
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(name: &str) -> Shown {
        Shown::before(name, None, 1.0, 1.0)
    }

    #[test]
    fn values_that_change_the_motion_alike_cannot_be_told_apart() {
        let wave = |w: f64| DVector::from_fn(100, |k, _| (w * k as f64).sin());
        let values = ["a", "b", "c", "d", "e"].map(value).to_vec();
        let changes = [wave(0.3), wave(0.3), wave(1.1), 1e-6 * wave(2.0), wave(1.7)];
        let shows = Information::of(values, &changes, 0.1).expect("an inverse");
        assert_eq!(shows.inseparable, vec![[0, 1]]);
        assert!(shows.is_inseparable(1, 0) && !shows.is_inseparable(2, 4));
        // The squares of a hundred samples of a sine add up to fifty.
        let own = shows.values[2].deviation;
        assert!((own - 0.1 / 50f64.sqrt()).abs() < 0.1 * own, "{own}");
        assert!(!shows.values[3].is_halved() && shows.is_inseparable(2, 3));
        assert_eq!(shows.index("c", None), Some(2));
    }
}
