//! What searches of one recording have in common, whatever its rows weigh and whatever is picked from the torque.

use crate::catalogue::choice::Choice;
use crate::catalogue::effect::Effect;
use crate::catalogue::gear::{Link, links};
use crate::catalogue::{Candidate, catalogue};
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::search::dictionary::Dictionary;
use crate::search::tables::Tables;
use ndarray::Array2;
use physics::robot::Robot;

/// The catalogue on one recording, its torque as late as a scene has it.
pub struct Session {
    /// The model with the first fit's parameters: what derived columns are built on.
    pub present: Robot,
    /// What each joint's link encoder says of its gear.
    pub links: Vec<Link>,
    /// Everything that is looked for without having seen the torque.
    pub candidates: Vec<Candidate>,
    /// Its columns.
    pub tables: Tables,
}

impl Session {
    /// On a scene with its derivatives. `weight` on the fitted rows, shape (rows, joints). Where the description has no
    /// masses, a body more or another scale of torque is as good as any, and neither is looked for.
    pub fn new(
        scene: &Scene,
        frame: &Frame,
        weight: &Array2<f64>,
        effects: Choice,
        masses: bool,
    ) -> Self {
        let links = links(scene, frame, weight);
        let mut candidates = catalogue(scene, &links);
        effects.retain(&mut candidates);
        let scales = |c: &Candidate| matches!(c.effect, Effect::Payload | Effect::TorqueGain);
        candidates.retain(|c| masses || !scales(c));
        let dictionary = Dictionary::new(scene.dof(), &candidates);
        Self {
            present: scene.robot.clone(),
            links,
            tables: Tables::new(&dictionary, scene, frame),
            candidates,
        }
    }
}
