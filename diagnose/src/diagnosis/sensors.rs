//! Findings of sensors beside the motors' encoders that no cause names, and sensors that are not used.

use super::units;
use crate::catalogue::gear::{Gear, Link};
use crate::input::frames::Frames;
use crate::measure::quantities::measured;
use crate::motion::sensed::Sensed;
use crate::schema::Cause;
use crate::schema::value::value;
use physics::robot::Robot;

/// Sentences on each sensor that is not used, and on each gear that visibly gives way without being among the causes.
pub(super) fn beside(
    frames: &Frames,
    links: &[Link],
    causes: &[Cause],
    robot: &Robot,
) -> Vec<String> {
    let names = robot.joint_names();
    let mut out = Vec::new();
    for (what, frame) in [("data", &frames.data), ("heldout", &frames.heldout)] {
        let refused = frame.sensed().map_or(&[][..], Sensed::refused).iter();
        out.extend(refused.map(|(j, why)| format!("{what}: {}: {why}", names[*j])));
    }
    out.extend(no_causes(links, causes, robot));
    out
}

fn no_causes(links: &[Link], causes: &[Cause], robot: &Robot) -> Vec<String> {
    let named = |joint: &String| {
        let mut causes = causes.iter();
        causes.any(|c| c.effect.info().gear && c.joints.contains(joint))
    };
    let names = robot.joint_names();
    let joints = names.iter().zip(links);
    let gives = joints.filter_map(|(joint, link)| match link {
        Link::Gives(gear) if !named(joint) => Some((joint, gear)),
        _ => None,
    });
    let line = |(joint, gear): (&String, &Gear)| {
        let (effect, sizes) = gear.told();
        let mut sizes = measured(&sizes, Some(joint));
        units::of_parameters(&mut sizes, robot);
        let sizes: Vec<String> = sizes.iter().map(value).collect();
        format!(
            "{joint}: the link's encoder shows {} ({}); no cause, for what it changes of the torque cannot be told from the rest",
            effect.name(),
            sizes.join(", ")
        )
    };
    gives.map(line).collect()
}
