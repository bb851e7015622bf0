//! Model and recordings as named on the command line.

use super::before;
use crate::error::DiagnoseError;
use crate::simulator::NominalModel;
use datasets::{Part, ReadOptions, Recording, read};
use model::directory::{ModelFile, Source};
use model::evaluation::read_options;
use model::preparation::setup::{Setup, SetupError};
use model::preparation::units::refuse_degrees;
use physics::robot::{Description, Urdf};
use std::path::{Path, PathBuf};

/// A simulator's model with the options for reading its robot's recordings.
pub struct Given {
    /// Model to which the gap is measured, as given.
    pub model: NominalModel,
    /// Description of its robot: the user's own file where there is one.
    pub description: Description,
    /// The recordings that are fitted, file by file, once they are read.
    pub sources: Vec<Source>,
    reading: Reading,
}

/// Source of the options for reading recordings.
enum Reading {
    /// The robot with its drive file, and the findings from its recordings.
    Robot(Box<Setup>),
    /// A model directory: options for the fitted recordings, and for the scored one.
    Directory(Box<[ReadOptions; 2]>),
}

impl Given {
    /// A built-in robot by name or a URDF or MJCF by path, with its drive file; `joints` chooses where it holds more than one
    /// chain, and else the columns of `recordings` do.
    ///
    /// # Errors
    /// No such robot, or a description or drive file that cannot be used.
    pub fn robot(
        name: &str,
        joints: &[String],
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
        recordings: &[PathBuf],
    ) -> Result<Self, DiagnoseError> {
        let setup = Setup::for_recordings(name, joints, drive, gravity, recordings)?;
        Ok(Self {
            model: NominalModel::new(setup.robot.clone()),
            description: setup.description.clone(),
            sources: Vec::new(),
            reading: Reading::Robot(Box::new(setup)),
        })
    }

    /// The model of a robot identified from its earlier recordings, and these, joined. The description gives
    /// lengths and axes only.
    ///
    /// # Errors
    /// As [`Self::robot`], or earlier recordings that cannot be used.
    pub fn before(
        name: &str,
        joints: &[String],
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
        rate_hz: Option<f64>,
        recordings: &[PathBuf],
        cutoff_hz: Option<f64>,
    ) -> Result<(Self, Recording), DiagnoseError> {
        let mut setup = Setup::for_recordings(name, joints, drive, gravity, recordings)?;
        setup.rate_hz = rate_hz;
        let read = setup.read_training(recordings)?;
        let given = Self {
            model: before::model(&setup.robot, &read, cutoff_hz)?,
            description: setup.description.clone(),
            sources: Vec::new(),
            reading: Reading::Robot(Box::new(setup)),
        };
        let read = Recording::joined(&read).expect("the command line demands one");
        Ok((given, read))
    }

    /// The input with the sampling rate, Hz, of recordings that have no time column.
    #[must_use]
    pub fn at_rate(mut self, rate_hz: Option<f64>) -> Self {
        match &mut self.reading {
            Reading::Robot(setup) => setup.rate_hz = rate_hz,
            Reading::Directory(options) => options.iter_mut().for_each(|o| o.rate_hz = rate_hz),
        }
        self
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
            description: Description::Urdf(Urdf::new(file.physics.urdf, &[])?),
            sources: Vec::new(),
            reading: Reading::Directory(Box::new(options)),
        })
    }

    /// Reads and joins the fitted recordings. A low-pass that their torque shows is then assumed for the scored one as well.
    ///
    /// # Errors
    /// A file cannot be used, or the torque of two of them has been through different low-passes.
    pub fn data(&mut self, paths: &[PathBuf]) -> Result<Recording, DiagnoseError> {
        let mut all = match &mut self.reading {
            Reading::Robot(setup) => setup.read_training(paths)?,
            Reading::Directory(options) => paths
                .iter()
                .map(|p| of_model(&self.model, p, &options[0]))
                .collect::<Result<_, _>>()?,
        };
        self.sources = all.iter().map(Source::of).collect();
        let filter = |r: &Recording| r.torque_filter;
        if let Some(other) = all.iter().find(|r| filter(r) != filter(&all[0])) {
            return Err(DiagnoseError::Filters {
                one: all[0].source.clone(),
                other: other.source.clone(),
            });
        }
        // One is not copied: it may fill half the memory.
        Ok(if all.len() == 1 {
            all.remove(0)
        } else {
            Recording::joined(&all).expect("the command line demands one")
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
