//! Model and recordings as the command line names them.

use crate::error::DiagnoseError;
use crate::model::NominalModel;
use datasets::{Part, ReadOptions, Recording, Trajectory, read};
use model::directory::ModelFile;
use model::evaluation::read_options;
use model::setup::Setup;
use ndarray::{Array2, Axis, concatenate};
use physics::robot::to_urdf;
use std::path::{Path, PathBuf};

/// A simulator's model with what reading its robot's recordings needs.
pub struct Given {
    /// The model.
    pub model: NominalModel,
    /// Its URDF, as the user has it where there is one.
    pub urdf: String,
    /// For the recordings that are fitted, and for the one that is scored.
    options: [ReadOptions; 2],
}

impl Given {
    /// A built-in robot by name or a URDF by path, with its drive file.
    ///
    /// # Errors
    /// No such robot, or a description or drive file that cannot be used.
    pub fn robot(
        name: &str,
        drive: Option<&Path>,
        gravity: Option<[f64; 3]>,
    ) -> Result<Self, DiagnoseError> {
        let setup = Setup::new(name, drive, gravity)?;
        let options = [
            setup.read_options(Part::Train, true)?,
            setup.read_options(Part::Test, true)?,
        ];
        let urdf = std::fs::read_to_string(name).unwrap_or_else(|_| to_urdf(&setup.robot));
        Ok(Self {
            model: NominalModel::new(setup.robot),
            urdf,
            options,
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
            urdf: file.physics.urdf,
            options,
        })
    }

    /// Reads and joins the recordings that are fitted.
    ///
    /// # Errors
    /// A file cannot be used.
    pub fn data(&self, paths: &[PathBuf]) -> Result<Recording, DiagnoseError> {
        let all: Result<Vec<Recording>, _> =
            paths.iter().map(|p| read(p, &self.options[0])).collect();
        let mut all = all?;
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
        Ok(read(path, &self.options[1])?)
    }
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
