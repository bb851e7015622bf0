//! What a fit frees, and how far from its given value.

use crate::arm::{Arm, STEP};
use crate::catalogue::{Mechanism, Sizes};
use crate::fit::Free;
use crate::given::Given;
use crate::parameter::{Kind, Parameter};
use crate::tracks::Replayed;
use std::collections::BTreeMap;

/// A parameter as the decision sees it: several entries may be the same physical number with different reasons to differ.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The parameter that may differ.
    pub parameter: Parameter,
    /// Deviation of its coordinate for this reason.
    pub deviation: f64,
}

/// Relative uncertainty of what any simulator's values mean: the description's masses, to which all torques are scaled, are
/// known to some per cent, and so is what an integrator makes of a gain.
pub const RELATIVE: f64 = 0.03;

/// Part of Coulomb friction by which two simulators' laws of friction at standstill differ (a soft constraint creeps).
pub(super) const STANDSTILL: f64 = 0.1;

/// Parameters that are free under every hypothesis, with their deviations.
pub(super) fn always(given: &Given, sizes: &Sizes) -> Vec<Entry> {
    let mut out = Vec::new();
    let mut add = |kind: Kind, joint: usize, deviation: f64| {
        if deviation > 0.0 && deviation.is_finite() {
            out.push(Entry {
                parameter: Parameter::new(kind, joint),
                deviation,
            });
        }
    };
    for (j, joint) in given.arm.joints.iter().enumerate() {
        add(Kind::Gain, j, RELATIVE);
        add(Kind::LinkScale, j, RELATIVE);
        if given.arm.shared[j] == 0.0 {
            add(Kind::ServoDamping, j, RELATIVE * given.arm.servos[j].kd);
        }
        let viscous = given.arm.get(Parameter::new(Kind::Damping, j));
        add(Kind::Damping, j, RELATIVE * viscous);
        add(Kind::Coulomb, j, RELATIVE * joint.coulomb);
        add(Kind::Stribeck, j, STANDSTILL * joint.coulomb);
        add(Kind::Armature, j, RELATIVE * joint.armature);
    }
    // Two integrators place a force within a step of their own.
    add(Kind::CommonDelay, 0, STEP);
    for &(parameter, t) in given.tolerances.iter().filter(|(_, t)| *t > 0.0) {
        let log = parameter.kind.scale() == crate::parameter::Scale::Log;
        let value = given.arm.get(parameter);
        add(
            parameter.kind,
            parameter.joint,
            if log { t } else { t * value.abs() },
        );
    }
    for &(parameter, deviation) in given.earlier.iter().flat_map(|e| &e.open) {
        add(parameter.kind, parameter.joint, deviation);
    }
    for &parameter in &given.free {
        add(
            parameter.kind,
            parameter.joint,
            3.0 * spread(parameter, sizes),
        );
    }
    out
}

/// Size of a parameter of which only its nature is known.
pub(super) fn spread(parameter: Parameter, sizes: &Sizes) -> f64 {
    let (torque, j) = (sizes.torque[parameter.joint], parameter.joint);
    match parameter.kind {
        Kind::Gain | Kind::DriveLimit | Kind::Limit => 1.0,
        Kind::ServoDamping | Kind::Damping => torque / sizes.speed[j],
        Kind::Delay | Kind::CommonDelay | Kind::Lag => (2.0 * sizes.period).max(0.02),
        Kind::Armature => sizes.inertia[j],
        Kind::GravityCompensation => 0.5,
        Kind::Integral => torque,
        _ => torque,
    }
}

/// Free parameters of a fit: those of the set and those free under every one, each with the sum of its variances.
pub fn free(given: &Given, mechanisms: &[Mechanism], set: &[usize], always: &[Entry]) -> Vec<Free> {
    let mut variance: BTreeMap<Parameter, f64> = BTreeMap::new();
    let listed = set.iter().flat_map(|&m| &mechanisms[m].parameters);
    for entry in listed {
        *variance.entry(entry.parameter).or_default() += entry.deviation.powi(2);
    }
    for entry in always {
        *variance.entry(entry.parameter).or_default() += entry.deviation.powi(2);
    }
    variance
        .into_iter()
        .map(|(parameter, v)| {
            let mut own = Free {
                parameter,
                prior: None,
            };
            own.prior = Some((own.coordinate(given.arm.get(parameter)), v.sqrt()));
            own
        })
        .collect()
}

/// Free parameters that a tolerance or a missing value leaves open.
pub fn tolerated(given: &Given, replayed: &Replayed) -> Vec<Entry> {
    always(given, &Sizes::of(given, replayed))
}

/// The given arm with the fitted values of what is free.
pub fn pinned(given: &Given, fitted: &Arm, free: &[Free]) -> Arm {
    let mut arm = given.arm.clone();
    let values: Vec<(Parameter, f64)> = free
        .iter()
        .map(|f| (f.parameter, fitted.get(f.parameter)))
        .collect();
    // What was simulated once can be put together again.
    if arm.set(&values).is_err() {
        return fitted.clone();
    }
    arm
}
