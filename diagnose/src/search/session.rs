//! State that all searches of one recording share, whatever their row weights and the columns they pick from the torque.

use crate::catalogue::choice::Choice;
use crate::catalogue::gear::{Link, links};
use crate::catalogue::{Candidate, catalogue, told_from_links};
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::search::dictionary::Dictionary;
use crate::search::kept::Kept;
use crate::simulator::NominalModel;
use ndarray::Array2;
use physics::robot::Robot;

/// Candidates of the catalogue on one recording, which all its searches share.
pub struct Session {
    /// Robot with the parameters of the first fit, with which columns that depend on a model are computed.
    pub present: Robot,
    /// Compliance of each joint's gear as its link encoder shows it: unknown, stiff, or compliant with its flanks.
    pub links: Vec<Link>,
    /// Candidates that do not depend on the recorded torque.
    pub candidates: Vec<Candidate>,
    /// Values of these candidates' columns and of the base, with which every dictionary of a search begins.
    pub kept: Kept,
}

impl Session {
    /// Session of a scene. `weight` of the fitted rows, shape (rows, joints). Effects that no recording
    /// separates from links which `model` does not know are left out.
    pub fn new(
        scene: &Scene,
        frame: &Frame,
        weight: &Array2<f64>,
        effects: Choice,
        model: &NominalModel,
    ) -> Self {
        let links = links(scene, frame, weight);
        let mut candidates = catalogue(scene, &links);
        effects.retain(&mut candidates);
        let tool = model.is_identified() || model.robot.doubtful_links().last() != Some(&true);
        candidates.retain(|c| told_from_links(c.effect, model.has_masses(), tool));
        Self {
            present: scene.robot.clone(),
            links,
            kept: Kept::new(Dictionary::new(scene.dof(), &candidates).len()),
            candidates,
        }
    }
}
