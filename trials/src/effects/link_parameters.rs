//! A link whose mass, centre of mass and inertia are not those of the model.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use nalgebra::Vector3;
use physics::robot::RobotError;
use plant::arm::altered;
use plant::build::Build;
use plant::random::unit_vector;
use rand::{Rng, RngExt};
use serde_json::json;

/// Wrong inertial parameters of a link. The size is a factor on the relative errors of mass and inertia and on the
/// shift of the centre of mass, m.
#[derive(Debug)]
struct LinkError {
    link: usize,
    mass: f64,
    shift: Vector3<f64>,
    inertia: f64,
}

/// Random errors of any link but the first, whose mass most arms cannot feel.
pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let n = scene.arm.dof();
    let link = rng.random_range(n.min(2) - 1..n);
    let size = scene.arm.joints[link].link.inertia.com().norm().max(0.05);
    let effect = LinkError {
        link,
        mass: pick.sign,
        shift: unit_vector(rng) * (size * rng.random_range(0.1..0.4)),
        inertia: rng.random_range(-0.6..0.6),
    };
    Some(Shape::anywhere(effect, 0.06..0.25, rng))
}

impl Withheld for LinkError {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let link = build.axes[self.link];
        let body = &mut build.arm.joints[link].link.inertia;
        let (mass, inertia) = (1.0 + size * self.mass, 1.0 + size * self.inertia);
        *body = altered(body, mass, self.shift * size, inertia);
        Ok(())
    }

    fn describe(&self, size: f64, dof: usize) -> Description {
        let values = json!({
            "link": self.link + 1,
            "mass_factor": 1.0 + size * self.mass,
            "com_shift": (self.shift * size).as_slice(),
            "inertia_factor": 1.0 + size * self.inertia,
        });
        let last = self.link == dof - 1;
        Description::of_arm("link_parameters", values).same_as("payload", last)
    }

    fn largest(&self) -> f64 {
        0.5
    }
}
