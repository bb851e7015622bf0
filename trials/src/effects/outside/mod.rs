//! Mechanisms outside the catalogue, for which a diagnosis has to answer `unknown_effect`.

mod cable_tug;
mod cross_drag;
mod dropouts;
mod flexible_mount;
mod floor_hum;
mod place;
mod sloshing_tank;
mod wandering;
mod worn_sector;

use super::scene::{Pick, Scene, Shape};
use rand::{Rng, RngExt};

/// Draws a shape on the first of two joints, or on both.
type Draw = fn(&Scene, [usize; 2], &mut dyn Rng) -> Shape;

/// All mechanisms, equally likely.
const MECHANISMS: [Draw; 8] = [
    cross_drag::draw,
    cable_tug::draw,
    flexible_mount::draw,
    dropouts::draw,
    floor_hum::draw,
    sloshing_tank::draw,
    wandering::draw,
    worn_sector::draw,
];

/// Random mechanism among those outside the catalogue, with a random shape.
pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let n = scene.arm.dof();
    let other = (pick.any + rng.random_range(1..n)) % n;
    let draw = MECHANISMS[rng.random_range(0..MECHANISMS.len())];
    Some(draw(scene, [pick.any, other], rng))
}
