//! The robot that is written.

use crate::advice::code;
use crate::catalogue::effect::Effect;
use crate::schema::Cause;
use crate::search::find::Findings;
use crate::simulator::{NominalModel, possible};
use nalgebra::{Rotation3, Vector3};
use physics::robot::{Robot, RobotError};

/// What is written of a robot.
pub(super) struct Patched<'a> {
    /// Possible inertials, friction, rotor inertia, joint zeros.
    pub(super) robot: Robot,
    /// Rotation vector by which the base is tilted, rad.
    pub(super) tilt: Vector3<f64>,
    pub(super) causes: &'a [Cause],
}

/// The model with every fitted change of parameters that it has a place for, payload and rotor inertia included, as a robot
/// whose links are possible bodies.
///
/// # Errors
/// The fitted parameters make no robot.
pub fn robot(
    model: &NominalModel,
    found: &Findings,
    causes: &[Cause],
) -> Result<Robot, RobotError> {
    let change: Vec<f64> = found.changes(|_| true).iter().map(|c| c.0).collect();
    let mut inertia = model.robot.rotor_inertia();
    for cause in causes.iter().filter(|c| c.effect == Effect::RotorInertia) {
        if let Some(j) = joint(model, cause) {
            inertia[j] += number(cause, "inertia");
        }
    }
    possible::robot(model.sizes(), &model.moved(&change)?)?.with_rotor_inertia(&inertia)
}

/// Where a patch writes an effect; none for the table of values alone. `mjcf` says whether the model is one: what a URDF
/// needs a drive file for stands in it.
pub fn place(effect: Effect, mjcf: bool) -> Option<&'static str> {
    if effect.info().coded {
        return Some("generated code");
    }
    match (effect.info().place, mjcf) {
        (place, false) => place,
        (Some("URDF"), true) => Some("MJCF"),
        (_, true) => (effect == Effect::RotorInertia).then_some("MJCF"),
    }
}

/// The same of a cause: what is coded as an effect may go with something that no simulator has.
pub(super) fn place_of(cause: &Cause, mjcf: bool) -> Option<&'static str> {
    let coded = cause.effect.info().coded;
    place(cause.effect, mjcf).filter(|_| !coded || code::holds(cause))
}

/// A parameter of a cause; zero where it has none of this name.
pub(super) fn number(cause: &Cause, name: &str) -> f64 {
    let found = cause.parameters.iter().find(|p| p.name == name);
    found.map_or(0.0, |p| p.value)
}

/// Index of a cause's first joint.
pub(super) fn joint(model: &NominalModel, cause: &Cause) -> Option<usize> {
    let own = cause.joints.first()?;
    model.robot.joints().iter().position(|j| j.name == *own)
}

impl Patched<'_> {
    /// Gravity as the tilted base sees it, m/s².
    pub(super) fn gravity(&self) -> Vector3<f64> {
        Rotation3::new(-self.tilt) * self.robot.gravity()
    }
}
