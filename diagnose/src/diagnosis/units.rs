//! Units of sliding joints.

use crate::catalogue::Parameter;
use crate::schema::{Cause, Place};
use physics::robot::Robot;

/// Converts units of causes for joints that slide instead of turning. Inertial parameters keep the units of links.
pub(super) fn of_causes(mut causes: Vec<Cause>, robot: &Robot) -> Vec<Cause> {
    for cause in &mut causes {
        if cause.effect.info().body {
            continue;
        }
        match cause.driver.clone() {
            Some(driver) => of_coupling(&mut cause.parameters, &driver, robot),
            None => of_parameters(&mut cause.parameters, robot),
        }
    }
    causes
}

/// Converts units of a coupling by the kinds of its driven and driving joint.
fn of_coupling(parameters: &mut [Parameter], driver: &str, robot: &Robot) {
    for p in parameters {
        let driven = p.joint.as_ref().is_some_and(|j| slides(robot, j));
        p.unit = p.unit.of_coupling(driven, slides(robot, driver));
    }
}

/// Converts units of parameters that belong to sliding joints.
pub(super) fn of_parameters(parameters: &mut [Parameter], robot: &Robot) {
    let slides = |name: &Option<String>| name.as_ref().is_some_and(|n| slides(robot, n));
    for p in parameters.iter_mut().filter(|p| slides(&p.joint)) {
        p.unit = p.unit.linear();
    }
}

/// Converts units of regions on sliding joints.
pub(super) fn of_places(mut places: Vec<Place>, robot: &Robot) -> Vec<Place> {
    for place in places.iter_mut().filter(|p| slides(robot, &p.joint)) {
        place.unit = place.unit.linear();
    }
    places
}

fn slides(robot: &Robot, joint: &str) -> bool {
    let mut joints = robot.joints().iter();
    joints.any(|j| j.name == joint && !j.kind.is_rotation())
}
