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
        match cause.driver.clone() {
            Some(driver) => of_coupling(&mut cause.parameters, &driver, robot),
            None => of_parameters(&mut cause.parameters, robot),
        }
    }
    causes
}

/// Units of what one joint's motion does to another.
fn of_coupling(parameters: &mut [Parameter], driver: &str, robot: &Robot) {
    for p in parameters {
        let driven = p.joint.as_ref().is_some_and(|j| slides(robot, j));
        let unit = mixed(&p.unit, driven, slides(robot, driver));
        p.unit = unit.unwrap_or(&p.unit).to_owned();
    }
}

/// What an angular unit becomes where the driven joint slides, or the driving one.
fn mixed(unit: &str, driven: bool, driver: bool) -> Option<&'static str> {
    Some(match (unit, driven, driver) {
        (_, false, false) => return None,
        (_, true, true) => return linear(unit),
        ("N·m", true, false) => "N",
        ("N·m·s/rad", true, false) => "N·s/rad",
        ("N·m·s/rad", false, true) => "N·s",
        ("N·m/rad", true, false) => "N/rad",
        ("N·m/rad", false, true) => "N",
        ("kg·m²", ..) => "kg·m",
        _ => return None,
    })
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
        "N·m·s" => "N·s",
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

#[cfg(test)]
mod tests {
    use super::mixed;

    #[test]
    fn a_coupling_is_per_motion_of_its_driver() {
        assert_eq!(mixed("N·m·s/rad", true, false), Some("N·s/rad"));
        assert_eq!(mixed("N·m·s/rad", false, true), Some("N·s"));
        assert_eq!(mixed("kg·m²", false, true), Some("kg·m"));
        assert_eq!(mixed("kg·m²", true, true), Some("kg"));
        assert_eq!(mixed("N·m", false, true), None);
        assert_eq!(mixed("N·m/rad", false, false), None);
    }
}
