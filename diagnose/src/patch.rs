//! The simulator's model with the accepted causes written in, as far as a URDF has a place for them; a snippet for
//! MuJoCo and a table of values for the rest.

use crate::diagnosis::Outcome;
use crate::effect::Effect;
use crate::error::DiagnoseError;
use crate::model::NominalModel;
use crate::report::Cause;
use crate::words::value;
use physics::robot::{Robot, RobotError, urdf_with};
use std::fmt::Write;

/// Files of a patch.
pub struct Patch {
    /// The URDF: inertials, damping and friction as fitted with the causes in place.
    pub urdf: String,
    /// MJCF snippet: what the URDF cannot hold.
    pub mjcf: String,
    /// Values of all causes, tab-separated.
    pub values: String,
}

/// Writes the accepted causes into the model; `urdf` is its description.
///
/// # Errors
/// The fitted parameters make no robot.
pub fn patch(model: &NominalModel, outcome: &Outcome, urdf: &str) -> Result<Patch, DiagnoseError> {
    let robot = patched_robot(model, outcome)?;
    Ok(Patch {
        urdf: urdf_with(urdf, &robot)?,
        mjcf: mjcf(&outcome.diagnosis.causes),
        values: values(&outcome.diagnosis.causes),
    })
}

/// The model with every fitted change of parameters that it has a place for, payload included.
fn patched_robot(model: &NominalModel, outcome: &Outcome) -> Result<Robot, RobotError> {
    let found = &outcome.findings;
    let (variables, beta) = &found.tight;
    let mut change = vec![0.0; 12 * model.robot.dof()];
    for (v, b) in variables
        .iter()
        .zip(beta)
        .filter(|(v, _)| v.column < 12 * model.robot.dof())
    {
        change[v.column] += b;
    }
    model.moved(&change)
}

fn mjcf(causes: &[Cause]) -> String {
    let mut out = String::from("<mujoco>\n  <default/>\n");
    for cause in causes {
        let first = cause.parameters.first();
        let joint = cause.joints.first().map_or("", String::as_str);
        let _ = match (cause.effect, first) {
            (Effect::RotorInertia, Some(p)) => writeln!(
                out,
                "  <!-- <joint name=\"{joint}\" armature=\"{:.6}\"/> -->",
                p.value
            ),
            (Effect::TimeDelay, Some(p)) => {
                writeln!(out, "  <!-- actuator delay=\"{:.6}\" -->", p.value)
            }
            (Effect::JointElasticity, Some(p)) => {
                writeln!(
                    out,
                    "  <!-- second joint at {joint} with stiffness=\"{:.6}\" between motor and link -->",
                    p.value
                )
            }
            (Effect::Backlash, Some(p)) => {
                writeln!(
                    out,
                    "  <!-- second joint at {joint} with range=\"{:.6} {:.6}\" -->",
                    -p.value, p.value
                )
            }
            (Effect::EncoderOffset, Some(p)) => writeln!(
                out,
                "  <!-- <joint name=\"{joint}\" ref=\"{:.6}\"/> -->",
                p.value
            ),
            _ => Ok(()),
        };
    }
    out.push_str("</mujoco>\n");
    out
}

fn values(causes: &[Cause]) -> String {
    let mut out = String::from("effect\tjoints\tparameter\tvalue\tstd\tunit\n");
    for cause in causes {
        for p in &cause.parameters {
            let joints = p.joint.clone().unwrap_or_else(|| cause.joints.join(","));
            let _ = writeln!(
                out,
                "{}\t{joints}\t{}\t{}\t{}\t{}",
                cause.effect.name(),
                p.name,
                p.value,
                p.std,
                p.unit
            );
        }
        if cause.parameters.is_empty() {
            let _ = writeln!(
                out,
                "{}\t{}\t\t\t\t",
                cause.effect.name(),
                cause.joints.join(",")
            );
        }
    }
    out
}

/// One line on what the patch holds.
pub fn summary(causes: &[Cause]) -> String {
    let written = |c: &&Cause| {
        matches!(
            c.effect,
            Effect::LinkParameters | Effect::FrictionParameters | Effect::Payload
        )
    };
    let (inside, outside): (Vec<&Cause>, Vec<&Cause>) = causes.iter().partition(written);
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
