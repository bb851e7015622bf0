//! Examination of a recorded torque, before physics is fitted to it: unit, sign, source and faults of the torque
//! channel.
//!
//! For every joint, it looks at the numbers themselves (`number`), and at a fit of a rigid body with friction to that
//! joint alone (`evidence`). Such a fit needs neither the described inertials nor the unit. Described inertials are
//! used for scale, sign and unit only.
//!
//! The examination goes through questions in an order; an answer ends those that it makes meaningless. First come
//! whether there is a signal (`signal`), and whether it has a sign and contains gravity (`source`). Then come its unit
//! (`unit`) and its sign (`sign`). Columns (`columns`) or the description (`description`) may be wrong instead. Last
//! come inertia, friction, noise, filters, limits and coarse steps (`source`, `signal`).

mod blocks;
mod columns;
mod description;
mod evidence;
mod number;
mod patient;
mod shared;
mod sign;
mod signal;
mod source;
mod unit;

use datasets::Recording;
use datasets::channel::ChannelEstimate;
use datasets::check::{Ailment, Complaint};
use datasets::prepare::Prepared;
use patient::Patient;
use physics::robot::{Masses, Robot};

/// Complaints about the torque of a recording of `robot`, worst first. The list is empty where the torque is that of
/// the drives in N·m (N) on the link, and where none is recorded. `prepared` and `channel` come from the same
/// recording.
pub fn examine(
    robot: &Robot,
    recording: &Recording,
    prepared: &Prepared,
    channel: &ChannelEstimate,
) -> Vec<Complaint> {
    if recording.dof() != robot.dof() {
        return Vec::new();
    }
    let Some(joints) = evidence::gather(robot, recording, prepared, channel) else {
        return Vec::new();
    };
    let patient = Patient {
        robot,
        recording,
        joints: &joints,
    };
    if let Some(absolute) = source::absolute(&patient) {
        return [Some(absolute), signal::quantised(&patient)]
            .into_iter()
            .flatten()
            .collect();
    }
    let mut found: Vec<Complaint> = signal::dead(&patient).into_iter().collect();
    let noiseless = source::noiseless(&patient);
    let smeared = noiseless
        .as_ref()
        .is_some_and(|c| c.ailment == Ailment::Filtered);
    match source::weightless(&patient) {
        // Without gravity a described torque is no measure of scale or sign, and neither is one of no masses.
        Some(weightless) => found.push(weightless),
        None if robot.masses() != Masses::Described => {}
        None => found.extend(
            [unit::of_all(&patient, smeared), sign::turned(&patient)]
                .into_iter()
                .flatten(),
        ),
    }
    // Before the channel is blamed: the columns, then the description.
    if let Some(other) = columns::otherwise(&patient, prepared, channel) {
        found.retain(|c| !columns::could_be(c.ailment));
        found.push(other);
        found.extend(signal::quantised(&patient));
        return found;
    }
    let mut judged = Vec::with_capacity(found.len());
    for complaint in found {
        judged.extend(description::weighed(complaint, &patient, prepared, channel));
    }
    let mut found = judged;
    match source::of_weight_alone(&patient) {
        Some(held) => {
            found = description::doubted(found, &patient);
            found.push(held);
        }
        None => {
            found.extend(source::behind_the_gear(&patient));
            found.extend(noiseless);
        }
    }
    found.extend(signal::saturated(&patient));
    found.extend(signal::quantised(&patient));
    merged(&mut found);
    found.sort_by_key(|c| std::cmp::Reverse(c.severity));
    found
}

/// Replaces the two lines `torque_scale` of a wrong sign and a wrong scale by one with the product of both.
fn merged(found: &mut [Complaint]) {
    let scales = |c: &Complaint| -> Option<Vec<f64>> {
        let inside = c.drive.as_ref()?.strip_prefix("torque_scale = [")?;
        let each = inside.strip_suffix(']')?.split(", ");
        each.map(|v| v.parse().ok()).collect()
    };
    let Some(sign) = found.iter().position(|c| c.ailment == Ailment::Sign) else {
        return;
    };
    let other = (0..found.len()).find(|&i| i != sign && scales(&found[i]).is_some());
    let Some((other, both)) =
        other.and_then(|o| Some((o, scales(&found[o])?.into_iter().zip(scales(&found[sign])?))))
    else {
        return;
    };
    let product: Vec<f64> = both.map(|(a, b)| a * b).collect();
    let line = Some(patient::list("torque_scale", &product));
    found[other].drive.clone_from(&line);
    found[sign].drive = line;
}
