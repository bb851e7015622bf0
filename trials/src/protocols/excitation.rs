//! The motion of a day: excitations one after another, each a trajectory.

use super::runs::Plan;
use plant::arm::Arm;
use plant::reference::{Multisine, Pace, Segment, Session};
use plant::run::Clock;
use rand_chacha::ChaCha8Rng;

/// Number of excitations of a day.
pub(super) const RUNS: usize = 4;
/// Length of each and time between two of them, s.
const LENGTH: f64 = 25.0;
const GAP: f64 = 2.0;

/// The excitation of this number of a day that begins at `start`, s, at 200 Hz.
pub(super) fn excitation(arm: &Arm, index: usize, start: f64, rng: &mut ChaCha8Rng) -> Plan {
    let series = Multisine::draw(arm, &Pace::lively(), LENGTH, rng);
    Plan {
        session: Session::new(vec![(Segment::Multisine(series), LENGTH)], GAP, arm.dof()),
        offset: start + index as f64 * (LENGTH + GAP),
        labels: vec![format!("{}", index + 1)],
        clock: Clock {
            step: 5e-4,
            control: 2,
            sample: 10,
        },
        part: 0,
    }
}
