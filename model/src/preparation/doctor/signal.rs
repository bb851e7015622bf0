//! What is wrong with the signal of single joints: none, steps, a limit.

use super::evidence::{Evidence, Limit};
use super::patient::{Patient, complaint, short};
use datasets::check::{Ailment, Complaint, Severity};

/// Part of a torque's variance below which a model's explanation means that the channel has no signal.
const EXPLAINED: f64 = 0.25;
/// Part of the time in motion, and seconds, over which one constant value means that a channel has no signal …
const FROZEN: (f64, f64) = (0.15, 2.0);
/// … but over these parts where the torque comes in coarse steps (this one) or stands at a limit (the next).
const FROZEN_COARSE: f64 = 0.6;
const FROZEN_CUT: f64 = 0.25;
/// Size of the steps, as a part of the torque's deviation, from which they are coarse. They add 3 % to the error of any
/// model, as their deviation is 1/√12 of a step.
const COARSE: f64 = 0.1;
/// A torque is cut where the model goes beyond its largest values more than once, in this part of the rows, and more of
/// them lie at the limit than a little below it …
const BEYOND: f64 = 0.02;
const CROWD: f64 = 1.1;
/// … or in this part where the top of |τ| is flat …
const BEYOND_FLAT: f64 = 0.008;
/// … or where so large a part of the samples lies on a flat top that no motion makes it, on a joint whose largest torque
/// is at most so many deviations: where it is a weight that is held, the motion itself stays near the top; nor where the model of the
/// smaller torques brings most of those samples there itself, within two of its deviations.
const FLAT: (f64, f64) = (0.025, 2.5);
const MADE: f64 = 0.5;

/// Whether a joint's torque carries any signal throughout.
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

/// Joints whose torque comes in coarse steps.
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

/// Whether a joint's torque stops at a limit.
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

/// Joints whose torque stops at a limit.
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
