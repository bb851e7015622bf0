//! Sign of a torque against that of the motion.

use super::evidence::Evidence;
use super::patient::{Patient, complaint, list, short};
use super::signal::is_dead;
use super::unit::{CLEAR, scale};
use datasets::check::{Ailment, Complaint, Severity};

/// Least power of friction, as [`Fitted::friction`](super::evidence::Fitted::friction), for its sign to count.
const FRICTION: f64 = 0.05;

/// Complaint about joints whose torque has the wrong sign for their motion.
pub(super) fn turned(patient: &Patient) -> Option<Complaint> {
    let turned: Vec<usize> = (0..patient.joints.len())
        .filter(|&j| !is_dead(&patient.joints[j]) && is_turned(&patient.joints[j]))
        .collect();
    let each = turned.iter().map(|&j| {
        let evidence = &patient.joints[j];
        let friction = evidence.fitted.as_ref().map_or(0.0, |f| f.friction.value);
        match scale(evidence) {
            Some((value, _)) if value < 0.0 => format!(
                "{} is {} times the described torque, and its friction gives energy instead of taking it ({:.0} % of the torque)",
                patient.names(&[j]),
                short(value),
                100.0 * friction
            ),
            _ => format!(
                "the friction of {} gives energy instead of taking it ({:.0} % of the torque)",
                patient.names(&[j]),
                100.0 * friction
            ),
        }
    });
    let seen = each.collect::<Vec<_>>().join("; ");
    let factors: Vec<f64> = patient
        .all()
        .iter()
        .map(|j| if turned.contains(j) { -1.0 } else { 1.0 })
        .collect();
    (!turned.is_empty()).then(|| Complaint {
        drive: Some(list("torque_scale", &factors)),
        ..complaint(
            Ailment::Sign,
            Severity::Severe,
            turned,
            [
                seen,
                "torque and motion are counted in opposite directions".to_owned(),
                "if the position is counted backwards as well, which gravity then contradicts, turn both by direction instead"
                    .to_owned(),
            ],
        )
    })
}

/// Whether a joint's torque has the wrong sign. Friction decides where it certainly takes or gives energy; otherwise
/// the described torque does.
fn is_turned(evidence: &Evidence) -> bool {
    let Some(fitted) = &evidence.fitted else {
        return false;
    };
    let (friction, described) = (fitted.friction, fitted.scale);
    if friction.value - CLEAR * friction.std > FRICTION {
        return false;
    }
    let gives = friction.value + CLEAR * friction.std < -FRICTION;
    let forwards = described.value - CLEAR * described.std > 0.0;
    let backwards = described.value + CLEAR * described.std < 0.0;
    let turned = scale(evidence).is_some_and(|(_, [_, high])| high < 0.0);
    (gives && !forwards) || (backwards && (turned || gives))
}
