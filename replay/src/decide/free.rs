//! Free parameters of a fit, and the prior deviation of each from its given value.

use crate::arm::{Arm, STEP};
use crate::catalogue::{Mechanism, Sizes};
use crate::fit::Free;
use crate::given::Given;
use crate::parameter::{Kind, Parameter};
use crate::tracks::Replayed;
use std::collections::BTreeMap;

/// Reason for a parameter to differ from its given value. Several entries may name one parameter; their variances add
/// up.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Parameter that may differ.
    pub parameter: Parameter,
    /// Prior standard deviation of the parameter's coordinate for this reason.
    pub deviation: f64,
}

/// Relative uncertainty of any simulator's values. Masses of a description, to which all torques are scaled, are known
/// to some per cent. Another integrator changes the effect of a gain by as much.
pub const RELATIVE: f64 = 0.03;

/// Prior deviation of friction at standstill, as a part of Coulomb friction. Simulators differ by so much there, because
/// a soft constraint creeps.
pub const STANDSTILL: f64 = 0.1;

/// Parameters that are free under every set of hypotheses, with their prior deviations. They are small model errors,
/// given tolerances, what earlier recordings leave uncertain, and unknown values.
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
        let limited = given.arm.get(Parameter::new(given.limit(), j)).is_finite();
        if limited && !given.is_unlimited(j) {
            add(given.limit(), j, RELATIVE);
        }
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
    // Common delay of up to a step: integrators differ in when within a step a force acts.
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

/// Typical size of a parameter whose value is not known, as a deviation of its coordinate.
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

/// Free parameters of a fit: those that the hypotheses `set` free and those free under every set. Each has the given
/// value as prior mean, and the sum of its entries' variances.
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

/// Parameters that are free under every set of hypotheses (see `always`), with sizes taken from the recorded motion.
pub fn tolerated(given: &Given, replayed: &Replayed) -> Vec<Entry> {
    always(given, &Sizes::of(given, replayed))
}

/// Given arm in which only the free parameters have their fitted values.
pub fn pinned(given: &Given, fitted: &Arm, free: &[Free]) -> Arm {
    let mut arm = given.arm.clone();
    let values: Vec<(Parameter, f64)> = free
        .iter()
        .map(|f| (f.parameter, fitted.get(f.parameter)))
        .collect();
    // Fallback that is not expected: values that were simulated before make a valid robot.
    if arm.set(&values).is_err() {
        return fitted.clone();
    }
    arm
}
