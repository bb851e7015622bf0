//! Patch: the simulator's model with the accepted causes written in. It is an MJCF or URDF as far as the format
//! holds them. Beside a URDF there is a drive file for rotor inertias, elements for MuJoCo and Gazebo, a layer
//! for USD, and a table of values for the remaining causes.

mod bodies;
mod mjcf;
mod patched;
mod sdf;
mod usd;
mod values;
mod written;

use crate::advice::code::{self, Code};
use crate::catalogue::info::Correction;
use crate::error::DiagnoseError;
use crate::outcome::Outcome;
use crate::schema::Cause;
use crate::schema::value::value;
use crate::simulator::NominalModel;
use nalgebra::Vector3;
use physics::robot::{Changed, Description, Edited, Urdf, to_urdf};
use std::path::{Path, PathBuf};

pub use code::beyond;
pub use patched::{Parts, parts, place};
use patched::{Patched, joint, number, place_of};
pub use values::Setting;

/// Patch: the files in which the accepted causes are written for a simulator.
pub struct Patch {
    /// The URDF: inertials, damping and friction as fitted with the causes in place, base and joint zeros turned.
    pub urdf: String,
    /// Drive file with the rotor inertias, where there is a new one; for `--drive`.
    pub drive: Option<String>,
    /// Elements or whole model for MuJoCo.
    pub mjcf: ForMujoco,
    /// Files for Gazebo and USD, where the model is a URDF: ending and text.
    pub others: Vec<(&'static str, String)>,
    /// Code for simulators, where they have no parameter for a cause.
    pub code: Option<Code>,
    /// Values of all causes, tab-separated.
    pub values: String,
    /// Numbers to be set, joint by joint.
    pub settings: Vec<Setting>,
    /// Changes in the description, from → to, a line each.
    pub changes: Vec<String>,
}

/// Part of a patch for MuJoCo.
pub enum ForMujoco {
    /// The user's own model with corrected numbers.
    Whole(Edited),
    /// Elements to be merged by name.
    Snippet(String),
}

impl Patch {
    /// The files for a model `out`: that file, and beside it files for what it cannot hold.
    ///
    /// # Errors
    /// Files of an MJCF that no longer fit together.
    pub fn files(&self, out: &Path) -> Result<Vec<(PathBuf, String)>, DiagnoseError> {
        let mut files = match &self.mjcf {
            ForMujoco::Whole(files) => files.files(out)?,
            ForMujoco::Snippet(text) => {
                let drive = self.drive.clone();
                let drive = drive.map(|text| (out.with_extension("drive.toml"), text));
                let snippet = (out.with_extension("mjcf.xml"), text.clone());
                let first = std::iter::once((out.to_owned(), self.urdf.clone()));
                let others = self.others.iter();
                let others =
                    others.map(|(ending, text)| (out.with_extension(ending), text.clone()));
                first.chain(drive).chain([snippet]).chain(others).collect()
            }
        };
        files.extend(self.code.iter().flat_map(|c| c.files(out)));
        files.push((out.with_extension("values.tsv"), self.values.clone()));
        Ok(files)
    }

    /// Removes files of an earlier patch to `out` that this one does not write, since they would be taken for a
    /// part of it. Returns their paths. A file that does not begin like this program's stays.
    pub fn remove_stale(&self, out: &Path) -> Vec<PathBuf> {
        let drive = out.with_extension("drive.toml");
        let mut stale = Vec::new();
        if self.code.is_none() {
            let generated = |path: &PathBuf| code::is_generated(path);
            stale.extend(code::names(out).into_iter().filter(generated));
        }
        if self.drive.is_none() && values::is_drive(&drive) {
            stale.push(drive);
        }
        stale.retain(|path| std::fs::remove_file(path).is_ok());
        stale
    }

    /// Corrections that the model's format could hold but that could not be written; one line each.
    pub fn left_out(&self) -> Vec<String> {
        match &self.mjcf {
            ForMujoco::Whole(files) => files.left_out().to_vec(),
            ForMujoco::Snippet(_) => Vec::new(),
        }
    }
}

/// Writes the accepted causes into the model; `description` is the one that it was read from. For an MJCF there
/// is a separate URDF, too.
///
/// # Errors
/// The fitted parameters make no robot, or `description` is not that of the model.
pub fn patch(
    model: &NominalModel,
    outcome: &Outcome,
    description: &Description,
) -> Result<Patch, DiagnoseError> {
    let causes = &outcome.diagnosis.causes;
    let Parts {
        whole: robot,
        unloaded,
        load,
    } = parts(model, &outcome.findings, &outcome.frames.scale, causes)?;
    let of = |part| {
        let corrected = move |c: &&Cause| c.effect.info().correction == Some(part);
        causes.iter().filter(corrected)
    };
    let mut zeros = vec![0.0; robot.dof()];
    for cause in of(Correction::Zero) {
        if let Some(j) = joint(model, cause) {
            zeros[j] += number(cause, "zero");
        }
    }
    let tilt = of(Correction::Tilt).fold(Vector3::zeros(), |sum, c| {
        sum + Vector3::new(number(c, "tilt_x"), number(c, "tilt_y"), 0.0)
    });
    let patched = Patched {
        robot,
        unloaded,
        load,
        tilt,
        causes,
    };
    let settings = values::settings(&model.robot, &patched.robot);
    let rotors = of(Correction::Rotor).next().is_some();
    let mut others = Vec::new();
    let changed = Changed {
        robot: &patched.unloaded,
        zeros: &zeros,
        tilt: patched.tilt,
        load: patched.load,
    };
    // A base that is tilted is the same as gravity that is.
    let tilted = patched.robot.clone().with_gravity(patched.gravity());
    let (urdf, mjcf) = match description {
        Description::Urdf(urdf) => {
            others.push(("sdf", sdf::document(&patched)));
            others.push(("usda", usd::layer(&patched)));
            let snippet = mjcf::snippet(&patched, &zeros);
            let text = urdf.with(&changed)?;
            let read = urdf.reread(&text)?.with_gravity(model.robot.gravity());
            written::compare("the patched URDF", &tilted, &zeros, &read, false)?;
            (text, ForMujoco::Snippet(snippet))
        }
        Description::Mjcf(own) => {
            let robot = patched.unloaded.clone().with_gravity(patched.gravity());
            let files = own.with(&Changed {
                robot: &robot,
                tilt: Vector3::zeros(),
                ..changed.clone()
            })?;
            // What has no place in the model is said instead.
            if files.left_out().is_empty() {
                written::compare(
                    "the patched MJCF",
                    &tilted,
                    &zeros,
                    &own.reread(&files)?,
                    true,
                )?;
            }
            let urdf = Urdf::new(to_urdf(&model.robot), &[])?;
            (urdf.with(&changed)?, ForMujoco::Whole(files))
        }
    };
    let whole = matches!(mjcf, ForMujoco::Whole(_));
    Ok(Patch {
        urdf,
        drive: rotors.then(|| values::drive(&patched.robot)),
        mjcf,
        others,
        code: code::code(model, outcome, |c| place_of(c, whole).is_some()),
        values: values::table(&patched, &settings, whole),
        settings,
        changes: written::changes(&model.robot, &patched),
    })
}

/// One line on the content of the patch. `mjcf`: whether the model is an MJCF, which also holds rotor inertias;
/// `changes`: whether any number of it changes.
pub fn summary(causes: &[Cause], mjcf: bool, changes: bool) -> String {
    let format = if mjcf { "MJCF" } else { "URDF" };
    let inside = |c: &&Cause| place_of(c, mjcf) == Some(format);
    let (inside, outside): (Vec<&Cause>, Vec<&Cause>) = causes.iter().partition(inside);
    let list = |c: &[&Cause], none: &str| {
        let one = |c: &&Cause| {
            c.parameters
                .first()
                .map_or(c.effect.name().to_owned(), |p| {
                    format!("{} ({})", c.effect.name(), value(p))
                })
        };
        if c.is_empty() {
            none.to_owned()
        } else {
            c.iter().map(one).collect::<Vec<_>>().join(", ")
        }
    };
    let (code, beside): (Vec<&Cause>, Vec<&Cause>) =
        outside.into_iter().partition(|c| code::holds(c));
    let none = if changes {
        "no cause, but the numbers that were fitted beside the causes"
    } else {
        "nothing"
    };
    format!(
        "in the {format}: {}; in generated code: {}; beside it: {}",
        list(&inside, none),
        list(&code, "nothing"),
        list(&beside, "nothing")
    )
}
