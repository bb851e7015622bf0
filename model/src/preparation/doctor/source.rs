//! Sources of the torque of all joints other than the drives: without sign, without gravity, behind the gear, computed,
//! or filtered.

use super::blocks::Estimate;
use super::description::{DECIDES, LEAST, MASSES, MOST, placeholder};
use super::evidence::{Evidence, FEW};
use super::patient::{Patient, complaint};
use super::signal::is_dead;
use crate::preparation::torque_band;
use datasets::TorqueFilter;
use datasets::check::{Ailment, Complaint, Severity};
use signal::quantile::{median, quantile};

/// Largest ratio [`Fitted::folded`](super::evidence::Fitted::folded) of a torque without sign.
const FOLDED: f64 = 0.5;
/// Least gravity, as a part of the described torque's deviation and of the recorded one's, from which gravity must
/// show.
const LOADED: (f64, f64) = (0.2, 0.25);
/// Least ratios of the squared error with gravity to that without, for gravity not to show: on every loaded joint, and
/// in the median.
const WEIGHTLESS: (f64, f64) = (0.4, 0.75);
/// Quantile over the joints, just below the median, of friction's part of the torque. The second number is the part
/// below which the torque is not that of a motor with its gear.
const FRICTIONLESS: (f64, f64) = (0.45, 0.1);
/// Standard deviation of friction's part of the torque, median over the joints, from which that part counts as unknown.
const UNSURE: f64 = 0.05;
/// Noise of a torque over its standard deviation, median over the joints, that every sensor exceeds.
const NOISELESS: f64 = 2.5e-3;
/// Log-odds against a torque of weight alone before a recording is seen: at most one recording in twenty has it.
const RARE: f64 = 3.0;
/// Sharpness of the sharpest corner of all joints, over the torque's standard deviation. Below it, a torque was
/// smoothed: friction at reversals and encoder steps make sharper ones.
const CORNER: f64 = 3e-3;

/// Complaint about a torque without sign: it is nowhere below zero, and a model explains it better with its own sign
/// put before it.
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

/// Whether a joint's torque has one value throughout. No other sign of a missing signal is used for a torque without
/// sign, which a model hardly explains.
fn is_dead_number(evidence: &Evidence) -> bool {
    evidence.numbers.spread == 0.0
}

/// Complaint about a torque from which that of gravity was subtracted. On every joint that carries weight, a model
/// without gravity explains it as well.
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

/// Complaint about a torque that holds the arm's weight but does not move it: gravity shows, and inertia does not. Masses
/// that are placeholders say nothing of either.
pub(super) fn of_weight_alone(patient: &Patient) -> Option<Complaint> {
    if placeholder(patient.robot).is_some() {
        return None;
    }
    let shown: Vec<Estimate> = patient
        .fitted()
        .filter(|(_, e, _)| !is_dead(e))
        .filter_map(|(_, _, f)| f.inertia)
        .collect();
    let odds: f64 = shown.iter().map(weight_alone).sum();
    let middle = median(shown.iter().map(|e| e.value).collect())?;
    let doubt = median(shown.iter().map(|e| e.std).collect())?;
    (odds >= DECIDES + RARE).then(|| {
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

/// Log-odds that a joint's torque contains no inertia rather than the described inertia, which is wrong by as much as
/// masses usually are. `shown` is the recorded part of the inertia.
fn weight_alone(shown: &Estimate) -> f64 {
    /// Range of a normal variate, ± standard deviations, over which likelihoods are summed.
    const RANGE: f64 = 6.0;
    /// Step of that sum, standard deviations.
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

/// Complaint about a torque without the friction of motor and gear: on most joints friction certainly takes little
/// energy.
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

/// Complaint about a commanded or computed torque, whose part of noise is `noise`.
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

/// Complaint about a filtered torque, with the filter where it was recognised.
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
        assert!(odds(0.0, 0.01) >= DECIDES + RARE && odds(-0.05, 0.02) >= DECIDES + RARE);
        assert!(odds(1.0, 0.05) < -DECIDES && odds(0.5, 0.1) < -DECIDES);
        // One joint that hardly shows it.
        assert!(odds(-0.5, 0.4) < DECIDES + RARE);
        assert!(odds(0.0, 2.0).abs() < 1.0 && odds(1.0, 2.0).abs() < 1.0);
    }
}
