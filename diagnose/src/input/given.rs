//! Model and recordings as the command line names them.

use crate::error::DiagnoseError;
use crate::simulator::NominalModel;
use datasets::{Part, ReadOptions, Recording, Trajectory, read};
use model::directory::{ModelFile, Source};
use model::evaluation::read_options;
use model::preparation::setup::{Setup, SetupError};
use model::preparation::units::refuse_degrees;
use ndarray::{Array2, Axis, concatenate};
use physics::robot::Description;
use std::path::{Path, PathBuf};

/// A simulator's model with what reading its robot's recordings needs.
pub struct Given {
    /// The model.
    pub model: NominalModel,
    /// Its description, as the user has it where there is one.
    pub description: Description,
    /// The recordings that are fitted, file by file, once they are read.
    pub sources: Vec<Source>,
    reading: Reading,
}

/// Where it stands how recordings are read.
enum Reading {
    /// The robot with its drive file, and what its recordings show.
    Robot(Box<Setup>),
    /// A model directory: for the recordings that are fitted, and for the one that is scored.
    Directory(Box<[ReadOptions; 2]>),
}

impl Given {
    /// A built-in robot by name or a URDF or MJCF by path, with its drive file; `joints` chooses from an MJCF that holds
    /// more than one chain.
    ///
    /// # Errors
    /// No such robot, or a description or drive file that cannot be used.
    pub fn robot(
        name: &str,
        joints: &[String],
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
    ) -> Result<Self, DiagnoseError> {
        let setup = Setup::with_joints(name, joints, drive, gravity)?;
        Ok(Self {
            model: NominalModel::new(setup.robot.clone()),
            description: setup.description.clone(),
            sources: Vec::new(),
            reading: Reading::Robot(Box::new(setup)),
        })
    }

    /// The physics of a model directory.
    ///
    /// # Errors
    /// A directory that holds no model of this program, or a drive file that cannot be used.
    pub fn model(directory: &Path, drive: Option<&Path>) -> Result<Self, DiagnoseError> {
        let file = ModelFile::load(directory)?;
        let options = [
            read_options(&file, drive, Part::Train, true)?,
            read_options(&file, drive, Part::Test, true)?,
        ];
        Ok(Self {
            model: NominalModel::identified(&file)?,
            description: Description::Urdf(file.physics.urdf),
            sources: Vec::new(),
            reading: Reading::Directory(Box::new(options)),
        })
    }

    /// Reads and joins the recordings that are fitted; a low-pass that their torque shows then holds for the one
    /// that is scored as well.
    ///
    /// # Errors
    /// A file cannot be used.
    pub fn data(&mut self, paths: &[PathBuf]) -> Result<Recording, DiagnoseError> {
        let mut all = match &mut self.reading {
            Reading::Robot(setup) => setup.read_training(paths)?,
            Reading::Directory(options) => paths
                .iter()
                .map(|p| of_model(&self.model, p, &options[0]))
                .collect::<Result<_, _>>()?,
        };
        self.sources = all.iter().map(Source::of).collect();
        // One is not copied: it may fill half the memory.
        Ok(if all.len() == 1 {
            all.remove(0)
        } else {
            joined(&all)
        })
    }

    /// Reads the recording that is scored.
    ///
    /// # Errors
    /// The file cannot be used.
    pub fn heldout(&self, path: &Path) -> Result<Recording, DiagnoseError> {
        match &self.reading {
            Reading::Robot(setup) => Ok(setup.read_one(path, Part::Test, true)?),
            Reading::Directory(options) => of_model(&self.model, path, &options[1]),
        }
    }
}

/// Reads a recording of a model directory's robot.
fn of_model(
    model: &NominalModel,
    path: &Path,
    options: &ReadOptions,
) -> Result<Recording, DiagnoseError> {
    let recording = read(path, options)?;
    refuse_degrees(&model.robot, &recording).map_err(SetupError::from)?;
    Ok(recording)
}

/// One recording of all trajectories. Optional tables that one of them lacks are left out.
fn joined(all: &[Recording]) -> Recording {
    let mut out = all[0].clone();
    for next in &all[1..] {
        let start = out.len();
        out.trajectories
            .extend(next.trajectories.iter().map(|t| Trajectory {
                label: t.label.clone(),
                range: start + t.range.start..start + t.range.end,
            }));
        out.time.extend_from_slice(&next.time);
        let both = |a: &Array2<f64>, b: &Array2<f64>| {
            concatenate(Axis(0), &[a.view(), b.view()])
                .expect("recordings of one robot have the same joints")
        };
        let some =
            |a: &Option<Array2<f64>>, b: &Option<Array2<f64>>| Some(both(a.as_ref()?, b.as_ref()?));
        out.q = both(&out.q, &next.q);
        out.tau = some(&out.tau, &next.tau);
        out.qd = some(&out.qd, &next.qd);
        out.qdd = some(&out.qdd, &next.qdd);
        out.ql = some(&out.ql, &next.ql);
        out.q_ref = some(&out.q_ref, &next.q_ref);
        out.qd_ref = some(&out.qd_ref, &next.qd_ref);
        out.temp = some(&out.temp, &next.temp);
        out.source = format!("{}, {}", out.source, next.source);
    }
    out
}
