//! Units of joints that slide.

use crate::catalogue::effect::Effect;
use crate::schema::{Cause, Parameter, Place};
use physics::robot::Robot;

/// Units of joints that slide instead of turning. Inertial parameters are those of links.
pub(super) fn of_causes(mut causes: Vec<Cause>, robot: &Robot) -> Vec<Cause> {
    for cause in &mut causes {
        if matches!(cause.effect, Effect::LinkParameters | Effect::Payload) {
            continue;
        }
        of_parameters(&mut cause.parameters, robot);
    }
    causes
}

/// The same of numbers of joints.
pub(super) fn of_parameters(parameters: &mut [Parameter], robot: &Robot) {
    let slides = |name: &Option<String>| name.as_ref().is_some_and(|n| slides(robot, n));
    for p in parameters.iter_mut().filter(|p| slides(&p.joint)) {
        p.unit = linear(&p.unit).unwrap_or(&p.unit).to_owned();
    }
}

/// The same of regions.
pub(super) fn of_places(mut places: Vec<Place>, robot: &Robot) -> Vec<Place> {
    for place in places.iter_mut().filter(|p| slides(robot, &p.joint)) {
        place.unit = linear(place.unit).unwrap_or(place.unit);
    }
    places
}

fn slides(robot: &Robot, joint: &str) -> bool {
    let mut joints = robot.joints().iter();
    joints.any(|j| j.name == joint && !j.kind.is_rotation())
}

/// What an angular unit becomes where the joint slides.
fn linear(unit: &str) -> Option<&'static str> {
    Some(match unit {
        "N·m" => "N",
        "N·m·s/rad" => "N·s/m",
        "N·m·s/(rad·K)" => "N·s/(m·K)",
        "N·m/K" => "N/K",
        "N·m/rad" => "N/m",
        "kg·m²" => "kg",
        "rad" => "m",
        "rad/s" => "m/s",
        "rad/s²" => "m/s²",
        "1/rad" => "1/m",
        _ => return None,
    })
}
