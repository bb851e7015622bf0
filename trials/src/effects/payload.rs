//! A body on the last link that the model does not have.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use nalgebra::{Matrix3, Vector3};
use physics::robot::{Inertia, RobotError};
use plant::build::Build;
use plant::random::unit_vector;
use rand::{Rng, RngExt};
use serde_json::json;

/// Body on the last link. Its size is the mass, kg. Centre of mass (last joint's frame) and radius of gyration are in
/// m.
#[derive(Debug)]
struct Payload {
    com: Vector3<f64>,
    gyration: f64,
}

pub(super) fn draw(scene: &Scene, _pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let tool = scene.arm.joints[scene.arm.dof() - 1].link.inertia.com();
    let scale = tool.norm().max(0.05);
    let aside = Vector3::new(1.0, 1.0, 0.0).component_mul(&unit_vector(rng)) * scale;
    let effect = Payload {
        com: aside + tool * rng.random_range(0.8..1.6),
        gyration: 0.4 * scale,
    };
    Some(Shape::anywhere(effect, 0.04..0.2, rng))
}

impl Withheld for Payload {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let about_com = Matrix3::identity() * (size * self.gyration * self.gyration);
        let body = Inertia::from_com(size, self.com, about_com);
        build.arm.attach(&body);
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({"mass": size, "com": self.com.as_slice(), "gyration": self.gyration});
        Description::of_arm("payload", values).same_as("link_parameters", true)
    }
}
