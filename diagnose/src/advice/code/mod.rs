//! Code for two simulators with the causes that none of their parameters holds: a passive-force callback for
//! MuJoCo and an actuator for Isaac Lab. Both are written from the causes' terms of the torque model
//! ([`ColumnTorque::Terms`]), with which the control loop steps as well. The law is one text that NumPy and
//! PyTorch read.

mod law;

use crate::catalogue::effect::Effect;
use crate::catalogue::{ColumnTorque, REFERENCE};
use crate::outcome::Outcome;
use crate::schema::Cause;
use crate::schema::value::value;
use crate::simulator::NominalModel;
use law::{Law, Piece, comment};
use std::path::{Path, PathBuf};

const MUJOCO: &str = include_str!("mujoco.py.in");
const ISAAC_LAB: &str = include_str!("isaaclab.py.in");

/// Generated code for simulators, before the names of its files are inserted.
pub struct Code {
    law: Law,
    /// Names of the law's joints.
    joints: Vec<String>,
    /// Velocity below which the sign of each joint's friction is softened, rad/s (m/s).
    softness: Vec<f64>,
    /// Whether a cause modulates the friction of each joint.
    level: Vec<bool>,
    /// Causes that the code holds, as text.
    held: Vec<String>,
    /// Causes that neither this generated code nor the corrected description holds, one text each with sizes and reason.
    /// Generated files list them.
    beyond: Vec<String>,
}

/// First text of a generated file.
const MARK: &str = "\"\"\"What `diagnose` found and no";
/// Simulators for which code is generated, with the template of each.
const SIMULATORS: [(&str, &str); 2] = [("mujoco", MUJOCO), ("isaaclab", ISAAC_LAB)];

/// Whether generated code can hold a cause: simulators have no temperature of a joint.
pub(super) fn holds(cause: &Cause) -> bool {
    cause.effect.info().coded && !cause.parameters.iter().any(|p| p.name == REFERENCE)
}

/// Reason why neither a description nor code holds an effect.
pub fn beyond(effect: Effect) -> &'static str {
    effect.info().unwritten
}

/// Code for the accepted causes, with the coefficients of the report; none where no cause needs code.
/// `described` tells which causes are in the corrected description.
pub(super) fn code(
    model: &NominalModel,
    outcome: &Outcome,
    described: impl Fn(&Cause) -> bool,
) -> Option<Code> {
    let found = &outcome.findings;
    let mut pieces = Vec::new();
    for (cause, accepted) in found.accepted.iter().enumerate() {
        let candidate = found.candidate(cause);
        if !candidate.effect.info().coded {
            continue;
        }
        for (variable, column) in accepted.variables.clone().zip(&candidate.columns) {
            let ColumnTorque::Terms(terms) = &column.torque else {
                continue;
            };
            let size = found.tight.1[variable];
            pieces.extend(terms.iter().map(|(factor, term)| Piece {
                joint: column.joints[0],
                effect: candidate.effect.name(),
                size: factor * size,
                term: term.clone(),
            }));
        }
    }
    if pieces.is_empty() {
        return None;
    }
    pieces.sort_by_key(|p| (p.joint, p.effect));
    let names: Vec<String> = model
        .robot
        .joints()
        .iter()
        .map(|j| j.name.clone())
        .collect();
    let softness = &outcome.frames.scale.softness;
    let law = Law::new(&pieces, softness, &names);
    let of = |joints: &[usize]| joints.iter().map(|&j| names[j].clone()).collect();
    let level = (0..law.joints.len()).map(|at| {
        let start = format!("level[..., {at}]");
        law.lines.iter().any(|l| l.starts_with(&start))
    });
    let causes = &outcome.diagnosis.causes;
    let (held, rest): (Vec<&Cause>, Vec<&Cause>) = causes.iter().partition(|c| holds(c));
    let rest = rest.into_iter().filter(|c| !described(c));
    Some(Code {
        joints: of(&law.joints),
        softness: law.joints.iter().map(|&j| softness[j]).collect(),
        level: level.collect(),
        held: held.into_iter().map(words).collect(),
        beyond: rest
            .map(|c| format!("{}: {}", words(c), beyond(c.effect)))
            .collect(),
        law,
    })
}

/// A cause with its joints and sizes as text.
fn words(cause: &Cause) -> String {
    let joints = cause.joints.join(", ");
    let sizes: Vec<String> = cause.parameters.iter().take(4).map(value).collect();
    let doubt = match cause.confirmed {
        true => "",
        false => ", not confirmed by the held-out recording",
    };
    comment(&format!(
        "{} of {joints} ({}){doubt}",
        cause.effect.name(),
        sizes.join(", ")
    ))
}

impl Code {
    /// Files beside a corrected description `out`: `OUT_mujoco.py` and `OUT_isaaclab.py`, with names that Python can import.
    pub fn files(&self, out: &Path) -> Vec<(PathBuf, String)> {
        let name = out.file_name().map(|s| s.to_string_lossy().into_owned());
        let description = comment(&name.unwrap_or_default());
        let of = |(path, (_, template)): (PathBuf, (&str, &str))| {
            let module = path.file_stem().map(|s| s.to_string_lossy().into_owned());
            let text = self.text(template, &module.unwrap_or_default(), &description);
            (path, text)
        };
        names(out).into_iter().zip(SIMULATORS).map(of).collect()
    }

    fn text(&self, template: &str, module: &str, description: &str) -> String {
        let array = if template == MUJOCO { "numpy" } else { "torch" };
        let list = |lines: &[String]| {
            let lines = lines.iter().map(|l| format!("  {l}\n"));
            lines.collect::<String>()
        };
        let beyond = match self.beyond.is_empty() {
            true => String::new(),
            false => format!("\nHeld by nothing:\n{}", list(&self.beyond)),
        };
        template
            .replace("@MODULE@", module)
            .replace("@DESCRIPTION@", description)
            .replace("@HELD@\n", &list(&self.held))
            .replace("@BEYOND@\n", &beyond)
            .replace("@LAW@\n", &self.law_text(array))
    }

    /// Constants, helpers and the function `law`.
    fn law_text(&self, array: &str) -> String {
        let mut text = String::new();
        if self.law.helpers.iter().any(|h| h.contains("math.")) {
            text.push_str("import math\n");
        }
        let mut names = self.law.imports.clone();
        if !names.contains(&"tanh") {
            names.push("tanh");
        }
        text.push_str(&format!("from {array} import {}\n\n", names.join(", ")));
        let python = |b: &bool| if *b { "True" } else { "False" };
        let level: Vec<&str> = self.level.iter().map(python).collect();
        let names: Vec<String> = self.joints.iter().map(|n| string(n)).collect();
        text.push_str(&format!(
            "#: Joints that the law reads or loads, in the order of its last axis.\nJOINTS = [{}]\n\
             #: Those whose Coulomb friction it changes.\nLEVEL = [{}]\n\
             #: Speed over which each one's friction turns round, rad/s (m/s).\nSOFTNESS = {:?}\n\
             #: Number of states.\nMEMORY = {}\n#: Whether it reads the torque that transmissions carry.\nLOAD = {}\n\n\n",
            names.join(", "),
            level.join(", "),
            self.softness,
            self.law.memory,
            python(&self.law.sees.load),
        ));
        for helper in &self.law.helpers {
            text.push_str(helper);
            text.push_str("\n\n");
        }
        text.push_str(
            "def law(q, dq, qd, qdd, load, dt, clock, z):\n    \
             \"\"\"What resists the motion, in N*m (N), joints on the last axis: friction's level, torque, and memory after it.\n\n    \
             `dq` is the displacement since the memory `z`, `dt` the time, `load` what the rigid body asks of the joint, `clock` the\n    \
             session's (None: unknown).\"\"\"\n    \
             before, z = z, z + 0.0\n    level, torque = 0.0 * q, 0.0 * q\n",
        );
        for line in &self.law.lines {
            text.push_str(&format!("    {line}\n"));
        }
        text.push_str("    return level, torque, z\n");
        text
    }
}

/// Paths of the generated files beside a corrected description `out`, whether there is code for it or not.
pub(super) fn names(out: &Path) -> Vec<PathBuf> {
    let stem = out.file_stem().map(|s| s.to_string_lossy().into_owned());
    let stem = identifier(&stem.unwrap_or_default());
    let name = |(simulator, _)| out.with_file_name(format!("{stem}_{simulator}.py"));
    SIMULATORS.map(name).into()
}

/// Whether a file was generated by this module.
pub(super) fn is_generated(path: &Path) -> bool {
    std::fs::read_to_string(path).is_ok_and(|text| text.starts_with(MARK))
}

/// A Python string literal, whose escapes differ from Rust's.
fn string(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out.push_str(&format!("\\x{:02x}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A file stem as a name that Python can import.
fn identifier(stem: &str) -> String {
    let mut name: String = stem
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.insert(0, '_');
    }
    name
}

#[cfg(test)]
mod tests;
