//! Delay of the recorded torque, which is determined before all else. A lag of some milliseconds rounds and
//! shifts friction jumps, vibration and periodic lines, so that none has the shape in the catalogue.

use crate::catalogue::time_delay;
use crate::motion::channel::Channel;
use crate::search::find::Findings;
use physics::robot::Robot;

/// Largest number of searches after the first: the set of late joints hardly changes after one.
pub(super) const ROUNDS: usize = 2;

/// Whether both channels delay the same joints.
pub(super) fn alike(a: Option<&Channel>, b: Option<&Channel>) -> bool {
    let joints = |c: &Channel| -> Vec<bool> {
        let each = std::iter::once(&c.whole).chain(&c.own);
        each.map(Option::is_some).collect()
    };
    a.map(joints) == b.map(joints)
}

/// Torque channel from the accepted delays of a search; none without any.
pub(super) fn channel(found: &Findings, given: &Robot) -> Option<Channel> {
    let dof = given.dof();
    let mut channel = Channel {
        whole: None,
        own: vec![None; dof],
        given: given.clone(),
    };
    let beta = &found.tight.1;
    for cause in &found.accepted {
        let candidate = &found.candidates[cause.candidate];
        if !candidate.effect.info().late {
            continue;
        }
        let late = time_delay::said(candidate, beta[cause.variables.start]);
        if candidate.joints.len() == dof {
            channel.whole = Some(late);
        } else {
            channel.own[candidate.joints[0]] = Some(late);
        }
    }
    let known = channel.whole.is_some() || channel.own.iter().any(Option::is_some);
    known.then_some(channel)
}
