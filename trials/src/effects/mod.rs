//! Effects that a sealed case can withhold, one file per effect: the draw of its shape, its change of a plant,
//! its description and, where nothing else needs it, the mechanism itself.
//!
//! Nothing here uses the terms of a diagnosis; the mechanisms are chosen to differ from those.

mod asymmetric_friction;
mod backlash;
mod base_tilt;
mod counterbalance;
mod encoder_offset;
mod external_contact;
mod friction_drift;
mod friction_parameters;
mod joint_coupling;
mod joint_elasticity;
mod link_parameters;
mod load_dependent_friction;
mod nonlinear_viscous_friction;
mod outside;
mod payload;
mod position_dependent_friction;
mod presliding_hysteresis;
mod pushes;
mod rotor_inertia;
mod saturation;
mod scene;
mod stribeck_friction;
mod time_delay;
mod torque_gain;
mod torque_offset;
mod torque_ripple;
mod withheld;
mod words;
mod worn_gear;

pub use asymmetric_friction::Asymmetry;
pub use load_dependent_friction::LoadFriction;
pub use nonlinear_viscous_friction::FluidFriction;
pub use presliding_hysteresis::Presliding;
pub use pushes::pushes_at_rest;
pub use scene::{Demand, Origin, Scene, Shape, Source};
pub use stribeck_friction::StartingFriction;
pub use torque_ripple::CoggingWaves;
pub use withheld::{Place, Withheld, joint_name};
pub use words::Words;

use rand::Rng;
use scene::Pick;
use std::ops::Range;

/// Function that draws an effect's random shape; none where the arm has no joint for the effect.
type Draw = fn(&Scene, &Pick, &mut dyn Rng) -> Option<Shape>;

/// The effects of the catalogue with their names in reports. Their order determines which cases a seed gives.
const CATALOGUE: &[(&str, Draw)] = &[
    ("link_parameters", link_parameters::draw),
    ("friction_parameters", friction_parameters::draw),
    ("payload", payload::draw),
    ("rotor_inertia", rotor_inertia::draw),
    ("base_tilt", base_tilt::draw),
    ("counterbalance", counterbalance::draw),
    ("asymmetric_friction", asymmetric_friction::draw),
    ("stribeck_friction", stribeck_friction::draw),
    (
        "nonlinear_viscous_friction",
        nonlinear_viscous_friction::draw,
    ),
    ("load_dependent_friction", load_dependent_friction::draw),
    (
        "position_dependent_friction",
        position_dependent_friction::draw,
    ),
    ("presliding_hysteresis", presliding_hysteresis::draw),
    ("friction_drift", friction_drift::draw),
    ("torque_ripple", torque_ripple::draw),
    ("joint_elasticity", joint_elasticity::draw),
    ("backlash", backlash::draw),
    ("joint_coupling", joint_coupling::draw),
    ("torque_gain", torque_gain::draw),
    ("torque_offset", torque_offset::draw),
    ("time_delay", time_delay::draw),
    ("saturation", saturation::draw),
    ("encoder_offset", encoder_offset::draw),
    ("external_contact", external_contact::draw),
];

/// Names of the effects that a case can withhold.
pub const EFFECTS: [&str; CATALOGUE.len()] = {
    let mut names = [""; CATALOGUE.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = CATALOGUE[i].0;
        i += 1;
    }
    names
};

impl Origin {
    /// Random shape by this function; none where the arm or its rests (s) have no place for it.
    pub fn draw(self, scene: &Scene, rests: &[Range<f64>], rng: &mut dyn Rng) -> Option<Shape> {
        match self {
            Self::Listed(index) => Effect::listed(index).draw(scene, rng),
            Self::Worn(index) => Effect::WORN[index].draw(scene, rng),
            Self::Outside => Effect::OUTSIDE.draw(scene, rng),
            Self::AtRest => pushes_at_rest(scene, rests, rng),
        }
    }
}

/// Something that can be drawn: an effect of the catalogue, or any one outside it.
#[derive(Clone, Copy)]
pub struct Effect {
    /// Name in the answers; `unknown` outside the catalogue.
    pub name: &'static str,
    origin: Origin,
    draw: Draw,
}

impl Effect {
    /// Effect outside the catalogue: a random mechanism that it does not list.
    pub const OUTSIDE: Self = Self {
        name: "unknown",
        origin: Origin::Outside,
        draw: outside::draw,
    };

    /// Gears as they wear: wind-up and play of other kinds than those of the catalogue's own mechanisms.
    pub const WORN: [Self; 2] = [
        Self {
            name: "joint_elasticity",
            origin: Origin::Worn(0),
            draw: worn_gear::wind_up,
        },
        Self {
            name: "backlash",
            origin: Origin::Worn(1),
            draw: worn_gear::play,
        },
    ];

    /// The effect at this place of [`EFFECTS`].
    pub fn listed(index: usize) -> Self {
        let (name, draw) = CATALOGUE[index];
        Self {
            name,
            origin: Origin::Listed(index),
            draw,
        }
    }

    /// Random shape of this effect; none where the arm has no joint for it.
    pub fn draw(&self, scene: &Scene, rng: &mut dyn Rng) -> Option<Shape> {
        let mut words = Words::new(&[], rng);
        let pick = Pick::draw(scene, &mut words);
        let shape = (self.draw)(scene, &pick, &mut words)?;
        Some(Shape {
            source: Some(Source {
                origin: self.origin,
                words: words.used,
            }),
            ..shape
        })
    }
}
