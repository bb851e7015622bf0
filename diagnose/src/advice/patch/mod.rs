//! The simulator's model with the accepted causes written in: a URDF as far as that has a place for them, a drive file
//! for rotor inertias, a snippet for MuJoCo, and a table of values for everything else.

mod mjcf;
mod patched;
mod urdf;
mod values;

use crate::catalogue::effect::Effect;
use crate::error::DiagnoseError;
use crate::outcome::Outcome;
use crate::schema::Cause;
use crate::schema::value::value;
use crate::simulator::NominalModel;
use nalgebra::Vector3;
use std::path::{Path, PathBuf};

pub use patched::robot;
use patched::{Patched, joint, number};
pub use values::Setting;

/// Files of a patch.
pub struct Patch {
    /// The URDF: inertials, damping and friction as fitted with the causes in place, base and joint zeros turned.
    pub urdf: String,
    /// Drive file with the rotor inertias, where there is a new one; for `--drive`.
    pub drive: Option<String>,
    /// MJCF snippet.
    pub mjcf: String,
    /// Values of all causes, tab-separated.
    pub values: String,
    /// What every joint is to be set to.
    pub settings: Vec<Setting>,
}

impl Patch {
    /// The files by their paths: the URDF at `path`, the others beside it with endings of their own.
    pub fn files(self, path: &Path) -> Vec<(PathBuf, String)> {
        let mut files = vec![(path.to_owned(), self.urdf)];
        let drive = self.drive.map(|text| (path.with_extension("drive.toml"), text));
        files.extend(drive);
        files.push((path.with_extension("mjcf.xml"), self.mjcf));
        files.push((path.with_extension("values.tsv"), self.values));
        files
    }
}

/// Writes the accepted causes into the model; `urdf` is its description.
///
/// # Errors
/// The fitted parameters make no robot, or `urdf` is not that of the model.
pub fn patch(model: &NominalModel, outcome: &Outcome, urdf: &str) -> Result<Patch, DiagnoseError> {
    let causes = &outcome.diagnosis.causes;
    let robot = robot(model, &outcome.findings, causes)?;
    let of = |effect: Effect| causes.iter().filter(move |c| c.effect == effect);
    let mut zeros = vec![0.0; robot.dof()];
    for cause in of(Effect::EncoderOffset) {
        if let Some(j) = joint(model, cause) {
            zeros[j] += number(cause, "zero");
        }
    }
    let tilt = of(Effect::BaseTilt).fold(Vector3::zeros(), |sum, c| {
        sum + Vector3::new(number(c, "tilt_x"), number(c, "tilt_y"), 0.0)
    });
    let patched = Patched {
        robot,
        tilt,
        causes,
    };
    let settings = values::settings(&model.robot, &patched.robot);
    let changed = of(Effect::RotorInertia).next().is_some();
    Ok(Patch {
        urdf: urdf::written(urdf, &patched, &zeros)?,
        drive: changed.then(|| values::drive(&patched.robot)),
        mjcf: mjcf::snippet(&patched, &zeros),
        values: values::table(&patched, &settings),
        settings,
    })
}

/// One line on what the patch holds.
pub fn summary(causes: &[Cause]) -> String {
    let inside = |c: &&Cause| c.effect.info().place == Some("URDF");
    let (inside, outside): (Vec<&Cause>, Vec<&Cause>) = causes.iter().partition(inside);
    let list = |c: &[&Cause]| {
        let one = |c: &&Cause| {
            c.parameters
                .first()
                .map_or(c.effect.name().to_owned(), |p| {
                    format!("{} ({})", c.effect.name(), value(p))
                })
        };
        if c.is_empty() {
            "nothing".to_owned()
        } else {
            c.iter().map(one).collect::<Vec<_>>().join(", ")
        }
    };
    format!(
        "in the URDF: {}; beside it: {}",
        list(&inside),
        list(&outside)
    )
}
