//! What a machine is: kind, model, geometry, axes. A TOML file; the built-in machines are such files.
//!
//! ```toml
//! name = "delta3"
//! kind = "delta"             # rotary_axis, linear_axis, scara, delta, puma
//! dynamic_model = 1          # which of the kind's torque models
//!
//! [geometry]                 # what the kind needs, m
//! base_radius = 0.2
//! plate_radius = 0.045
//! arm = 0.235
//! forearm = 0.8
//!
//! [[axis]]                   # one for each axis, base first
//! name = "A1"
//! kind = "rotary"            # rotary, linear
//! lower = -0.7               # rad or m
//! upper = 1.4
//! speed = 6.0                # rad/s or m/s
//! effort = 100.0             # N·m or N
//!
//! [motion]                   # optional: sine waves to identify with
//! start = [-0.5, -0.5, -0.5]
//! target = [1.2, 1.2, 1.2]
//! frequency = [0.3, 0.381, 0.429] # Hz
//! ```

use crate::MachineError;
use physics::robot::drive::{Driven, DrivenAxis};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Kind of a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// One rotating axis; models 1 simple, 2 horizontal crank arm, 3 vertical crank arm.
    RotaryAxis,
    /// One sliding axis; models 1 horizontal, 2 tilted or vertical.
    LinearAxis,
    /// Two parallel rotating axes, a sliding one, and a rotating one where there are four; models 1 as the manual's,
    /// 2 with the third and fourth axis coupled by their spindle.
    Scara,
    /// Three arms on one plate, and a rotating axis through it where there are four; models 1 as the manual's (forearms
    /// shared out to arms and plate), 2 with forearms as rods.
    Delta,
    /// Six rotating joints; models 1 full, 2 gravity and friction alone.
    Puma,
}

impl Kind {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::RotaryAxis => "rotary_axis",
            Self::LinearAxis => "linear_axis",
            Self::Scara => "scara",
            Self::Delta => "delta",
            Self::Puma => "puma",
        }
    }

    /// Numbers of axes that there are, and of torque models.
    fn sizes(self) -> (&'static [usize], usize) {
        match self {
            Self::RotaryAxis => (&[1], 3),
            Self::LinearAxis => (&[1], 2),
            Self::Scara | Self::Delta => (&[3, 4], 2),
            Self::Puma => (&[6], 2),
        }
    }

    /// Number of torque models of this kind.
    pub fn models(self) -> usize {
        self.sizes().1
    }
}

/// How an axis moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Moves {
    /// Position in rad, torque in N·m.
    Rotary,
    /// Position in m, force in N.
    Linear,
}

/// One axis with its limits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Name, as programs of the controller call it.
    pub name: String,
    /// How it moves.
    pub kind: Moves,
    /// Lowest position, rad or m.
    pub lower: f64,
    /// Highest position, rad or m.
    pub upper: f64,
    /// Highest speed, rad/s or m/s.
    pub speed: f64,
    /// Highest torque or force, N·m or N.
    pub effort: f64,
}

impl Axis {
    /// Unit of speed.
    pub fn speed_unit(&self) -> &'static str {
        match self.kind {
            Moves::Rotary => "rad/s",
            Moves::Linear => "m/s",
        }
    }

    /// Unit of torque or force.
    pub fn effort_unit(&self) -> &'static str {
        match self.kind {
            Moves::Rotary => "N·m",
            Moves::Linear => "N",
        }
    }
}

/// Lengths that a kind needs, m; others stay empty.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Geometry {
    /// Rotary axis with a crank: from the axis to where a payload sits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crank: Option<f64>,
    /// Delta: from the middle to the axes of the arms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_radius: Option<f64>,
    /// Delta: from the middle of the plate to the joints of the forearms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plate_radius: Option<f64>,
    /// Delta: from an arm's axis to its forearm's joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arm: Option<f64>,
    /// Delta: length of the forearms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forearm: Option<f64>,
    /// PUMA: a built-in robot or, in a file, the path of a URDF; a stored model holds the URDF itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
}

/// Sine waves of all axes at once: from `start` to `target` and back, `frequency` times a second (the manual's motion for an
/// identification).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SineWaves {
    /// Where each axis starts, rad or m.
    pub start: Vec<f64>,
    /// Where it turns round, rad or m.
    pub target: Vec<f64>,
    /// Frequency, Hz.
    pub frequency: Vec<f64>,
}

/// A machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// Name.
    pub name: String,
    /// Kind.
    pub kind: Kind,
    /// Which of the kind's torque models, from 1.
    pub dynamic_model: usize,
    /// Lengths.
    #[serde(default)]
    pub geometry: Geometry,
    /// Axes, base first.
    pub axis: Vec<Axis>,
    /// Motion to identify with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<SineWaves>,
}

/// Built-in machines by name; each file says where its numbers come from.
pub const BUILTIN: [(&str, &str); 6] = [
    ("rotary_axis", include_str!("builtin/rotary_axis.toml")),
    ("linear_axis", include_str!("builtin/linear_axis.toml")),
    ("scara4", include_str!("builtin/scara4.toml")),
    ("delta3", include_str!("builtin/delta3.toml")),
    ("delta4", include_str!("builtin/delta4.toml")),
    ("puma560", include_str!("builtin/puma560.toml")),
];

impl Description {
    /// A built-in machine by name, or else the description in a file.
    ///
    /// # Errors
    /// Neither exists, or the file is no description that can be used.
    pub fn load(name_or_path: &str) -> Result<Self, MachineError> {
        if let Some((name, text)) = BUILTIN.iter().find(|(name, _)| *name == name_or_path) {
            return Self::parse(text, name);
        }
        let path = Path::new(name_or_path);
        if !path.exists() && path.extension().is_none() {
            return Err(MachineError::Unknown {
                name: name_or_path.to_owned(),
                builtins: BUILTIN.map(|(name, _)| name).join(", "),
            });
        }
        let text = std::fs::read_to_string(path).map_err(|source| MachineError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&text, name_or_path)
    }

    /// Reads the text of a description; `origin` names it in messages.
    ///
    /// # Errors
    /// An unknown kind of machine or axis, or numbers that are impossible.
    pub fn parse(text: &str, origin: &str) -> Result<Self, MachineError> {
        let description: Self = toml::from_str(text).map_err(|e| MachineError::Description {
            name: origin.to_owned(),
            reason: e.to_string().trim_end().to_owned(),
        })?;
        description.check()?;
        Ok(description)
    }

    /// Whether there is no contradiction in it; lengths are the business of the models that need them.
    ///
    /// # Errors
    /// A wrong number or order of axes, limits that cannot hold, a model that the kind does not have.
    pub fn check(&self) -> Result<(), MachineError> {
        let (counts, models) = self.kind.sizes();
        let kind = self.kind.name();
        if !counts.contains(&self.axis.len()) {
            let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
            return Err(self.wrong(format!(
                "{} axes are described, a {kind} has {}",
                self.axis.len(),
                counts.join(" or ")
            )));
        }
        if !(1..=models).contains(&self.dynamic_model) {
            return Err(self.wrong(format!(
                "dynamic_model {} does not exist: a {kind} has 1 to {models}",
                self.dynamic_model
            )));
        }
        for (i, axis) in self.axis.iter().enumerate() {
            let linear = self.kind == Kind::LinearAxis || (self.kind == Kind::Scara && i == 2);
            let needed = if linear { Moves::Linear } else { Moves::Rotary };
            if axis.kind != needed {
                let needed = if linear { "linear" } else { "rotary" };
                return Err(self.wrong(format!("axis {} of a {kind} is {needed}", i + 1)));
            }
            let finite = [axis.lower, axis.upper, axis.speed, axis.effort];
            if finite.iter().any(|v| !v.is_finite())
                || axis.lower >= axis.upper
                || axis.speed <= 0.0
                || axis.effort <= 0.0
            {
                return Err(self.wrong(format!(
                    "limits of axis {:?} cannot hold; lower below upper, speed and effort positive are needed",
                    axis.name
                )));
            }
        }
        if let Some(motion) = &self.motion {
            let lists = [&motion.start, &motion.target, &motion.frequency];
            let fits = lists.iter().all(|l| l.len() == self.axis.len());
            if !fits
                || motion
                    .frequency
                    .iter()
                    .any(|f| !(*f > 0.0 && f.is_finite()))
            {
                return Err(self.wrong(
                    "motion needs start, target and a positive frequency for every axis".to_owned(),
                ));
            }
        }
        Ok(())
    }

    /// A length of the geometry that the kind needs.
    pub(crate) fn length(&self, value: Option<f64>, name: &str) -> Result<f64, MachineError> {
        value
            .filter(|v| v.is_finite() && *v > 0.0)
            .ok_or_else(|| self.wrong(format!("needs a positive geometry.{name} in m")))
    }

    /// An error about this description.
    pub(crate) fn wrong(&self, reason: String) -> MachineError {
        MachineError::Description {
            name: self.name.clone(),
            reason,
        }
    }
}

impl Driven for Description {
    fn name(&self) -> &str {
        &self.name
    }

    fn axes(&self) -> Vec<DrivenAxis> {
        let axes = self.axis.iter();
        axes.map(|axis| DrivenAxis {
            name: axis.name.clone(),
            rotates: axis.kind == Moves::Rotary,
            gear_ratio: None,
            torque_constant: None,
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_descriptions_are_valid_and_called_by_their_name() {
        for (name, _) in BUILTIN {
            let description = Description::load(name).expect(name);
            assert_eq!(description.name, name);
            assert!(description.motion.is_some(), "{name}");
        }
    }

    #[test]
    fn refusals_say_what_to_do() {
        let text = BUILTIN[3].1;
        for (from, to, expected) in [
            ("kind = \"delta\"", "kind = \"hexapod\"", "unknown variant"),
            ("kind = \"rotary\"", "kind = \"ball\"", "unknown variant"),
            (
                "kind = \"rotary\"",
                "kind = \"linear\"",
                "axis 1 of a delta is rotary",
            ),
            (
                "dynamic_model = 1",
                "dynamic_model = 3",
                "a delta has 1 to 2",
            ),
            ("kind = \"delta\"", "kind = \"puma\"", "a puma has 6"),
            ("upper = ", "upper = -", "cannot hold"),
        ] {
            let changed = text.replacen(from, to, 1);
            assert_ne!(changed, text, "{from}");
            let error = Description::parse(&changed, "x").expect_err(expected);
            assert!(error.to_string().contains(expected), "{error}");
            assert!(error.is_input());
        }
        let error = Description::load("delta5").expect_err("no such machine");
        assert!(error.to_string().contains("delta3, delta4"), "{error}");
    }
}
