//! Faults of the signal of single joints: no signal, coarse steps, or a limit.

use super::evidence::{Evidence, Limit};
use super::patient::{Patient, complaint, short};
use datasets::check::{Ailment, Complaint, Severity};

/// Explained part of a torque's variance below which the channel counts as without signal.
const EXPLAINED: f64 = 0.25;
/// Least part of the time in motion, and least time in s, with one constant value for a channel to count as without
/// signal.
const FROZEN: (f64, f64) = (0.15, 2.0);
/// Least part of the time in motion instead of `FROZEN`'s where the torque has coarse steps.
const FROZEN_COARSE: f64 = 0.6;
/// Least part of the time in motion instead of `FROZEN`'s where the torque has a flat top.
const FROZEN_CUT: f64 = 0.25;
/// Step, as a part of the torque's standard deviation, from which steps count as coarse. Such steps add 3 % to the
/// error of any model, as their deviation is 1/√12 of a step.
const COARSE: f64 = 0.1;
/// Least part of the rows in which a model of the smaller torques exceeds the level of the largest ones, for a torque
/// cut off.
const BEYOND: f64 = 0.02;
/// Least ratio of the rows at the level to those in an equal band below it, for a torque cut off.
const CROWD: f64 = 1.1;
/// Least part of the rows instead of `BEYOND` where the top of |τ| is flat.
const BEYOND_FLAT: f64 = 0.008;
/// Least part of the samples on a flat top for a torque cut off without other signs. The second number is the upper
/// bound of the largest torque over its standard deviation: a held weight stays near its top by itself.
const FLAT: (f64, f64) = (0.025, 2.5);
/// Part of the rows at the level, from which on a flat top counts as made by the motion: the model puts them there as
/// well.
const MADE: f64 = 0.5;

/// Whether a joint's torque carries no signal: it is constant for long, or the model explains little of it.
pub(super) fn is_dead(evidence: &Evidence) -> bool {
    let (part, seconds) = evidence.numbers.frozen;
    let numbers = &evidence.numbers;
    let coarse = numbers.step.is_some_and(|s| s > COARSE * numbers.spread);
    let least = match (coarse, numbers.flat > 0.0) {
        (true, _) => FROZEN_COARSE,
        (false, true) => FROZEN_CUT,
        (false, false) => FROZEN.0,
    };
    let still = part >= least && seconds >= FROZEN.1;
    let noise = evidence
        .fitted
        .as_ref()
        .is_some_and(|f| f.explained < EXPLAINED);
    evidence.numbers.spread == 0.0 || still || noise
}

/// Complaint about joints without a signal.
pub(super) fn dead(patient: &Patient) -> Option<Complaint> {
    let joints: Vec<usize> = (0..patient.joints.len())
        .filter(|&j| is_dead(&patient.joints[j]))
        .collect();
    let each = joints.iter().map(|&j| {
        let evidence = &patient.joints[j];
        let (part, seconds) = evidence.numbers.frozen;
        let name = patient.names(&[j]);
        if evidence.numbers.spread == 0.0 {
            format!("{name} has one value in every sample")
        } else if part >= FROZEN.0 {
            format!(
                "{name} keeps one value for {seconds:.1} s of motion ({:.0} % of it)",
                100.0 * part
            )
        } else {
            format!("{name} has nothing to do with its motion")
        }
    });
    let seen = each.collect::<Vec<_>>().join("; ");
    let lines = joints
        .iter()
        .map(|j| format!("columns.tau{} = \"…\"", j + 1))
        .collect::<Vec<_>>();
    (!joints.is_empty()).then(|| {
        complaint(
            Ailment::Dead,
            Severity::Severe,
            joints,
            [
                seen,
                "the channel carries no torque: a sensor that is off, a topic that stopped, or a column of something else"
                    .to_owned(),
                format!(
                    "record it again, or name the column that holds the torque in the drive file ({})",
                    lines.join(", ")
                ),
            ],
        )
    })
}

/// Complaint about joints whose torque comes in coarse steps.
pub(super) fn quantised(patient: &Patient) -> Option<Complaint> {
    let found: Vec<(usize, f64, f64)> = (0..patient.joints.len())
        .filter_map(|j| {
            let numbers = &patient.joints[j].numbers;
            let step = numbers.step?;
            (step > COARSE * numbers.spread).then_some((j, step, step / numbers.spread))
        })
        .filter(|(j, ..)| !is_dead(&patient.joints[*j]))
        .collect();
    let each = found.iter().map(|&(j, step, part)| {
        format!(
            "{} in steps of {}, {:.0} % of its deviation",
            patient.names(&[j]),
            short(step),
            100.0 * part
        )
    });
    let seen = each.collect::<Vec<_>>().join("; ");
    let most = found.iter().map(|f| f.2).fold(0.0, f64::max);
    (!found.is_empty()).then(|| {
        complaint(
            Ailment::Quantised,
            Severity::Warning,
            found.iter().map(|f| f.0).collect(),
            [
                seen,
                format!(
                    "no model can be better than an NRMSE of about {:.2} there; parameters average over the steps, what is small and \
                     local (ripple, play, reversals) drowns",
                    most / 12.0_f64.sqrt()
                ),
                "log more digits, or move with more torque; no line of a drive file brings them back".to_owned(),
            ],
        )
    })
}

/// Whether a joint's torque is cut off at a limit.
pub(super) fn is_cut(evidence: &Evidence) -> bool {
    let Some(fitted) = &evidence.fitted else {
        return false;
    };
    let limit = &fitted.limit;
    // Coarse steps have a flat top of their own.
    let fine = |step: f64| step < COARSE * evidence.numbers.spread;
    let flat = if evidence.numbers.step.is_none_or(fine) {
        evidence.numbers.flat
    } else {
        0.0
    };
    let beyond = if flat > 0.0 { BEYOND_FLAT } else { BEYOND };
    (limit.beyond >= beyond && limit.visits > 1 && limit.crowd >= CROWD)
        || (flat >= FLAT.0
            && evidence.numbers.largest < FLAT.1 * evidence.numbers.spread
            && limit.made < MADE)
}

/// Complaint about joints whose torque is cut off at a limit.
pub(super) fn saturated(patient: &Patient) -> Option<Complaint> {
    let found: Vec<(usize, &Limit)> = patient
        .fitted()
        .filter(|(_, e, _)| !is_dead(e) && is_cut(e))
        .map(|(j, _, f)| (j, &f.limit))
        .collect();
    let each = found.iter().map(|(j, limit)| {
        format!(
            "{} stays at {}, where {:.1} % of its samples lie and a model of its smaller torques goes beyond in {:.1} % of the time",
            patient.names(&[*j]),
            short(limit.level),
            100.0 * limit.share,
            100.0 * limit.beyond
        )
    });
    let seen = each.collect::<Vec<_>>().join("; ");
    (!found.is_empty()).then(|| {
        complaint(
            Ailment::Saturated,
            Severity::Warning,
            found.iter().map(|f| f.0).collect(),
            [
                seen,
                "the record is cut, or the drive gives no more: torque at these samples is not what the motion took".to_owned(),
                "move less fast or with less load, or raise the limit of the record; no line of a drive file brings it back"
                    .to_owned(),
            ],
        )
    })
}
