//! The models of `fixtures/mjcf`, and what MuJoCo computes of them.

use physics::robot::{Description, Mjcf, Robot, RobotError};
use serde::Deserialize;
use std::path::{Path, PathBuf};

#[derive(Deserialize)]
pub struct Fixture {
    pub cases: Vec<Case>,
}

#[derive(Deserialize)]
pub struct Case {
    pub file: String,
    pub chosen: Vec<String>,
    pub joints: Vec<String>,
    pub states: Vec<State>,
}

#[derive(Deserialize)]
pub struct State {
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    pub tau: Vec<f64>,
    pub mass: Vec<f64>,
}

pub fn fixture() -> Fixture {
    serde_json::from_str(include_str!("../../fixtures/mjcf.json")).expect("the fixture is valid")
}

pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/mjcf")
}

pub fn model(file: &str, joints: &[String]) -> (Mjcf, Robot) {
    match Description::load(&folder().join(file), joints) {
        Ok((Description::Mjcf(mjcf), robot)) => (mjcf, robot),
        Ok(_) => panic!("{file} is an MJCF"),
        Err(e) => panic!("{e}"),
    }
}

/// Largest departure, relative to the largest value.
pub fn departure(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let scale = theirs.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    let pairs = ours.iter().zip(theirs);
    pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs() / scale))
}

/// A hinge with everything that a test wants to add.
pub fn pendulum(compiler: &str, body: &str, after: &str) -> String {
    format!(
        "<mujoco><compiler angle=\"radian\"/>{compiler}<worldbody><body name=\"link\">\
         <inertial pos=\"0.1 0 0\" mass=\"1\" diaginertia=\"0.01 0.01 0.01\"/>\
         <joint name=\"hinge\" axis=\"0 1 0\"/>{body}</body></worldbody>{after}</mujoco>"
    )
}

pub fn read(text: &str) -> Result<Robot, RobotError> {
    Mjcf::from_text(text, &[])?.robot()
}
