//! What the torque of all joints is, if not that of the drives: without sign, without gravity, behind the gear, computed,
//! filtered.

use super::blocks::Estimate;
use super::description::{DECIDES, LEAST, MASSES, MOST};
use super::evidence::{Evidence, FEW};
use super::patient::{Patient, complaint};
use super::signal::is_dead;
use crate::preparation::torque_band;
use datasets::TorqueFilter;
use datasets::check::{Ailment, Complaint, Severity};
use signal::quantile::{median, quantile};

/// Largest part of its squared error that a torque without sign leaves when the model's sign is put before it.
const FOLDED: f64 = 0.5;
/// Least part of gravity in a joint's described torque, and over the deviation of the recorded one, from which gravity
/// must show.
const LOADED: (f64, f64) = (0.2, 0.25);
/// Ratio of the squared error with gravity to that without, from which gravity does not show: of every loaded joint,
/// and in the median.
const WEIGHTLESS: (f64, f64) = (0.4, 0.75);
/// Quantile over the joints, just below the median, and the part of friction in the torque below which it is not that
/// of a motor with its gear.
const FRICTIONLESS: (f64, f64) = (0.45, 0.1);
/// Deviation of friction's part of the torque, in the median of the joints, from which the part is unknown.
const UNSURE: f64 = 0.05;
/// Noise over the torque's deviation, in the median of the joints, that every sensor exceeds.
const NOISELESS: f64 = 2.5e-3;
/// Sharpness of the sharpest corner over the torque's deviation, of the joint with the sharpest one. Below it a torque
/// without noise was smoothed: friction turns round, encoders have counts.
const CORNER: f64 = 3e-3;

/// Complaint about a torque without sign: nowhere below zero, and explained with the model's sign before it.
pub(super) fn absolute(patient: &Patient) -> Option<Complaint> {
    let alive = || patient.fitted().filter(|(_, e, _)| !is_dead_number(e));
    let never = alive().all(|(_, e, _)| e.numbers.negative < FEW);
    let folded: Vec<usize> = alive()
        .filter(|(_, _, f)| f.folded < FOLDED)
        .map(|(j, ..)| j)
        .collect();
    let best = alive().map(|(_, _, f)| f.folded).fold(1.0, f64::min);
    (never && !folded.is_empty()).then(|| {
        complaint(
            Ailment::Absolute,
            Severity::Severe,
            patient.all(),
            [
                format!(
                    "no torque is ever below zero, and {} touch it and turn back: with the sign of the motion's own torque before \
                     them, a model leaves {:.0} % of the squared error that it leaves of them as they stand",
                    patient.names(&folded),
                    100.0 * best
                ),
                "the size of the torque, without its sign".to_owned(),
                "log the signed value, or name its column in the drive file (columns.tau = \"…\"); a sign that was not recorded cannot \
                 be brought back"
                    .to_owned(),
            ],
        )
    })
}

/// Whether a joint's torque keeps one value throughout. A folded torque is judged by that alone: a model hardly
/// explains it.
fn is_dead_number(evidence: &Evidence) -> bool {
    evidence.numbers.spread == 0.0
}

/// Complaint about a torque from which gravity's is taken off: on every joint that carries weight a model without
/// gravity does as well.
pub(super) fn weightless(patient: &Patient) -> Option<Complaint> {
    let loaded: Vec<(usize, f64)> = patient
        .fitted()
        .filter(|(_, e, _)| !is_dead(e))
        .filter(|(_, e, f)| {
            f.loaded > LOADED.0 && f.loaded * f.described > LOADED.1 * e.numbers.spread
        })
        .map(|(j, _, f)| (j, f.gravity))
        .collect();
    let least = loaded.iter().map(|l| l.1).fold(f64::INFINITY, f64::min);
    let middle = median(loaded.iter().map(|l| l.1).collect())?;
    (least > WEIGHTLESS.0 && middle > WEIGHTLESS.1).then(|| {
        let joints: Vec<usize> = loaded.iter().map(|l| l.0).collect();
        complaint(
            Ailment::GravityRemoved,
            Severity::Severe,
            joints.clone(),
            [
                format!(
                    "gravity, which should make most of the torque of {}, does not show: a model with it leaves {middle:.2} times the \
                     squared error of one without",
                    patient.names(&joints)
                ),
                "a torque from which the controller's own gravity torque is taken off, as some makers log it by default".to_owned(),
                "add --gravity 0,0,0 to the command: the model is then one of this channel, and a controller that compensates gravity \
                 itself takes it as it is; or name the column of the whole torque in the drive file (columns.tau = \"…\")"
                    .to_owned(),
            ],
        )
    })
}

/// Complaint about a torque that holds an arm's weight and does not move it: gravity shows, and inertia does not.
pub(super) fn of_weight_alone(patient: &Patient) -> Option<Complaint> {
    let shown: Vec<Estimate> = patient
        .fitted()
        .filter(|(_, e, _)| !is_dead(e))
        .filter_map(|(_, _, f)| f.inertia)
        .collect();
    let odds: f64 = shown.iter().map(weight_alone).sum();
    let middle = median(shown.iter().map(|e| e.value).collect())?;
    let doubt = median(shown.iter().map(|e| e.std).collect())?;
    (odds > DECIDES).then(|| {
        complaint(
            Ailment::Commanded,
            Severity::Severe,
            patient.all(),
            [
                format!(
                    "the arm's weight shows, and of the torque that its inertia takes {:.0} ± {:.0} % do, in the median of the joints",
                    100.0 * middle.max(0.0),
                    100.0 * doubt
                ),
                "a command that holds the weight of an arm that something else moves, or a torque computed for one at rest".to_owned(),
                "name the column of the measured current or torque in the drive file (columns.tau = \"…\"); masses fitted to this one \
                 are the controller's"
                    .to_owned(),
            ],
        )
    })
}

/// Log-odds that a joint's torque has no inertia in it over that it has that of the description, which is off by as much as masses
/// are. Described torques are right to a part of their deviation at best.
fn weight_alone(shown: &Estimate) -> f64 {
    /// Deviations of a normal variate, and the step, over which likelihoods are summed.
    const RANGE: f64 = 6.0;
    const STEP: f64 = 0.05;
    let std = shown.std.hypot(LEAST.sqrt());
    let likely = |expected: f64| (-0.5 * ((shown.value - expected) / std).powi(2)).exp();
    let steps = (-(RANGE / STEP) as i32..=(RANGE / STEP) as i32).map(|k| STEP * f64::from(k));
    let (sum, weights) = steps.fold((0.0, 0.0), |(sum, weights), x| {
        let weight = (-0.5 * x * x).exp();
        (
            sum + weight * likely((x * MASSES.ln()).exp()),
            weights + weight,
        )
    });
    let moved = (sum / weights).max(f64::MIN_POSITIVE);
    (likely(0.0).max(f64::MIN_POSITIVE) / moved)
        .ln()
        .clamp(-MOST, MOST)
}

/// Complaint about a torque without the friction of motor and gear: on most joints it takes little energy for certain.
pub(super) fn behind_the_gear(patient: &Patient) -> Option<Complaint> {
    let alive = || patient.fitted().filter(|(_, e, _)| !is_dead(e));
    let parts = alive().map(|(_, _, f)| f.friction.value).collect();
    let middle = quantile(parts, FRICTIONLESS.0)?;
    let doubt = median(alive().map(|(_, _, f)| f.friction.std).collect())?;
    (middle.abs() < FRICTIONLESS.1 && middle > -doubt && doubt < UNSURE).then(|| {
        complaint(
            Ailment::JointSensor,
            Severity::Note,
            patient.all(),
            [
                format!(
                    "friction makes {:.1} ± {:.1} % of the torque in the median of the joints",
                    100.0 * middle.max(0.0),
                    100.0 * doubt
                ),
                "a torque sensor behind the gear, or a torque computed for there: it sees no friction of motor and gear".to_owned(),
                "right for the model of the links and for a controller of joint torque; a feed-forward of motor current needs the \
                 friction as well, which the motors' currents show (columns.tau, units.torque = \"current\")"
                    .to_owned(),
            ],
        )
    })
}

/// Complaint about a torque without any sensor's noise. It is commanded or computed where it has corners, filtered
/// where it is smooth.
pub(super) fn noiseless(patient: &Patient) -> Option<Complaint> {
    let recording = patient.recording;
    if let Some(declared) = recording.torque_filter {
        return declared
            .recognised
            .then(|| of_filter(patient, Some(declared)));
    }
    let alive = || patient.joints.iter().filter(|e| !is_dead(e));
    if alive().any(|e| e.numbers.step.is_some()) {
        return None;
    }
    let noise = median(
        alive()
            .map(|e| e.numbers.noise / e.numbers.spread)
            .collect(),
    )?;
    let corners = alive().map(|e| e.numbers.corner / e.numbers.spread);
    let smooth = corners.fold(0.0, f64::max) < CORNER;
    let one = std::slice::from_ref(recording);
    match (smooth, noise < NOISELESS) {
        (true, _) => Some(of_filter(
            patient,
            torque_band::recognise(patient.robot, one),
        )),
        (false, true) => Some(of_command(patient, noise)),
        (false, false) => None,
    }
}

fn of_command(patient: &Patient, noise: f64) -> Complaint {
    complaint(
        Ailment::Commanded,
        Severity::Warning,
        patient.all(),
        [
            format!(
                "{noise:.1e} of the torque's deviation is noise in the median of the joints, and it comes in no steps"
            ),
            "a commanded or computed torque, not a measured one: what the drive does of it (its lag, its limits, its offset) is not in \
             it, and neither is what the controller does not know"
                .to_owned(),
            "name the column of the measured current or torque in the drive file (columns.tau = \"…\")".to_owned(),
        ],
    )
}

fn of_filter(patient: &Patient, filter: Option<TorqueFilter>) -> Complaint {
    let seen = match &filter {
        Some(f) => format!(
            "the torque's spectrum is empty above {:.1} Hz, and a model explains it better through that filter",
            f.half_power_hz()
        ),
        None => "the torque has neither noise nor corners: not even where a joint turns round"
            .to_owned(),
    };
    let advice = match &filter {
        Some(_) => {
            "declare it, so that every model is compared behind the same filter; it is found and used for this command already"
        }
        None => {
            "log it unfiltered if you can; if you know the filter, declare it (torque_filter.order, .cutoff_hz, .ripple_db)"
        }
    };
    Complaint {
        drive: filter.map(|f| {
            format!(
                "torque_filter.order = {}\ntorque_filter.cutoff_hz = {:.3}\ntorque_filter.ripple_db = {}",
                f.order, f.cutoff_hz, f.ripple_db
            )
        }),
        ..complaint(
            Ailment::Filtered,
            Severity::Note,
            patient.all(),
            [
                seen,
                "a low-pass forwards and backwards before it was stored: friction is smeared over its reversals".to_owned(),
                advice.to_owned(),
            ],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing of the inertia, all or part of it, and a motion that is too slow to show any.
    #[test]
    fn weight_without_inertia_is_a_command() {
        let odds = |value: f64, std: f64| weight_alone(&Estimate { value, std });
        assert!(odds(0.0, 0.01) > DECIDES && odds(-0.05, 0.02) > DECIDES);
        assert!(odds(1.0, 0.05) < -DECIDES && odds(0.5, 0.1) < -DECIDES);
        assert!(odds(0.0, 2.0).abs() < 1.0 && odds(1.0, 2.0).abs() < 1.0);
    }
}
