//! Which column of a file holds what.

use crate::{Problem, ReadError};
use std::collections::BTreeMap;
use std::path::Path;

/// A group of columns, one per joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// Joint position.
    Q,
    /// Link-side position.
    Ql,
    /// Velocity.
    Qd,
    /// Acceleration.
    Qdd,
    /// Torque.
    Tau,
    /// Commanded position.
    QRef,
    /// Commanded velocity.
    QdRef,
    /// Temperature.
    Temp,
}

impl Group {
    /// All groups, in the order in which they are written.
    pub const ALL: [Self; 8] = [
        Self::Q,
        Self::Ql,
        Self::Qd,
        Self::Qdd,
        Self::Tau,
        Self::QRef,
        Self::QdRef,
        Self::Temp,
    ];

    /// Name of the group: the column of joint j is this with j (from 1) behind it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Q => "q",
            Self::Ql => "ql",
            Self::Qd => "qd",
            Self::Qdd => "qdd",
            Self::Tau => "tau",
            Self::QRef => "q_ref",
            Self::QdRef => "qd_ref",
            Self::Temp => "temp",
        }
    }
}

/// Conversion of a stored value to SI link-side units: `value · scale + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// Factor: unit, gear ratio, torque constant.
    pub scale: f64,
    /// Added after scaling, in SI units: joint zero.
    pub offset: f64,
}

impl Affine {
    /// Leaves a value as it is.
    pub const IDENTITY: Self = Self {
        scale: 1.0,
        offset: 0.0,
    };

    /// Converts one value.
    pub fn apply(self, value: f64) -> f64 {
        value * self.scale + self.offset
    }
}

/// Names and units of a recording's columns, where they differ from those of docs/formats.md.
///
/// A drive file gives it. Empty means those names and SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap {
    /// The file's name for a column: the key is `time`, `trajectory`, one column
    /// (`tau3`) or a group (`tau`); the value of a group holds `{}` where the joint's number,
    /// from 1, stands (`motor_current_{}`). Of a bag: `/TOPIC:FIELD`, and under the keys `joint` or `joint3`
    /// the names that its messages give the joints, under `names` the field that holds them.
    pub names: BTreeMap<String, String>,
    /// Conversion to SI link-side units, one entry per joint, base first. A group that is not
    /// here, or a list that is too short, means no conversion.
    pub units: BTreeMap<Group, Vec<Affine>>,
    /// Factor that turns the file's time into seconds; `None` is 1.
    pub time_scale: Option<f64>,
}

impl ColumnMap {
    /// The map of a drive file: the recording's own names, and one conversion per joint for positions, for velocities and
    /// accelerations, and for torque.
    pub fn of_drive(
        names: BTreeMap<String, String>,
        position: Vec<Affine>,
        rate: Vec<Affine>,
        torque: Vec<Affine>,
        time_scale: f64,
    ) -> Self {
        let units = [
            (Group::Q, &position),
            (Group::Ql, &position),
            (Group::QRef, &position),
            (Group::Qd, &rate),
            (Group::Qdd, &rate),
            (Group::QdRef, &rate),
            (Group::Tau, &torque),
        ];
        Self {
            names,
            units: units.map(|(group, list)| (group, list.clone())).into(),
            time_scale: Some(time_scale),
        }
    }

    /// The names of the columns of a text that has no header, from the key `header`: in order, between commas or blanks.
    pub(crate) fn header(&self) -> Option<Vec<String>> {
        let names = self.names.get("header")?;
        let names = names
            .split([',', ' ', '\t', '\n'])
            .filter(|n| !n.is_empty());
        Some(names.map(str::to_owned).collect())
    }

    /// The file's name of `time` or `trajectory`.
    pub(crate) fn single(&self, key: &str) -> String {
        self.names
            .get(key)
            .cloned()
            .unwrap_or_else(|| key.to_owned())
    }

    /// The file's name of a joint's column (joint counted from 0).
    pub(crate) fn joint(&self, group: Group, joint: usize) -> String {
        let own = format!("{}{}", group.name(), joint + 1);
        if let Some(name) = self.names.get(&own) {
            return name.clone();
        }
        match self.names.get(group.name()) {
            Some(pattern) => pattern.replace("{}", &(joint + 1).to_string()),
            None => own,
        }
    }

    /// The conversion of a joint's column (joint counted from 0).
    pub fn conversion(&self, group: Group, joint: usize) -> Affine {
        self.units
            .get(&group)
            .and_then(|u| u.get(joint))
            .copied()
            .unwrap_or(Affine::IDENTITY)
    }
}

/// What a column of the file is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    Time,
    Label,
    Joint(Group, usize),
}

/// A column that is used.
#[derive(Clone, Debug)]
pub(crate) struct Used {
    /// Position in the header.
    pub index: usize,
    /// The file's name for it.
    pub name: String,
    pub role: Role,
}

/// The columns of a file that are used.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub used: Vec<Used>,
    pub dof: usize,
}

impl Layout {
    /// Finds the columns by name and checks that the set is complete.
    ///
    /// # Errors
    /// A name that stands twice, a missing column, another number of joints than `dof`.
    pub fn resolve(
        header: &[String],
        map: &ColumnMap,
        dof: Option<usize>,
        torque_needed: bool,
        file: &Path,
    ) -> Result<Self, ReadError> {
        let find = |name: &str| header.iter().position(|h| h == name);
        let missing = |name: String| Problem::MissingColumn {
            missing: name,
            present: list(header),
        };
        for name in header.iter().filter(|n| !n.is_empty()) {
            let count = header.iter().filter(|n| *n == name).count();
            if count > 1 {
                return Err(Problem::DuplicateColumn(count).in_column(file, name));
            }
        }
        let mut used = Vec::new();
        let time = map.single("time");
        let index = find(&time).ok_or_else(|| missing(time.clone()).in_file(file))?;
        used.push(Used {
            index,
            name: time,
            role: Role::Time,
        });
        let label = map.single("trajectory");
        if let Some(index) = find(&label) {
            used.push(Used {
                index,
                name: label,
                role: Role::Label,
            });
        }
        // Joints in the file: the highest number with any column of position.
        let numbered = |group: Group| {
            (0..header.len())
                .rev()
                .find(|&j| find(&map.joint(group, j)).is_some())
                .map_or(0, |j| j + 1)
        };
        let found = numbered(Group::Q);
        if found == 0 {
            return Err(missing(map.joint(Group::Q, 0)).in_file(file));
        }
        let dof = dof.unwrap_or(found);
        for group in Group::ALL {
            let there: Vec<bool> = (0..dof)
                .map(|j| find(&map.joint(group, j)).is_some())
                .collect();
            let needed = group == Group::Q || (group == Group::Tau && torque_needed);
            let beyond = numbered(group);
            if !needed && beyond == 0 {
                continue;
            }
            if beyond > dof {
                let name = map.joint(group, beyond - 1);
                return Err(Problem::WrongDof {
                    expected: dof,
                    found: beyond,
                }
                .in_column(file, &name));
            }
            if let Some(gap) = there.iter().position(|t| !t) {
                // All joints beyond the gap missing as well: the file is of a smaller robot.
                if group == Group::Q && !there[gap..].contains(&true) {
                    let problem = Problem::WrongDof {
                        expected: dof,
                        found,
                    };
                    return Err(problem.in_column(file, &map.joint(group, gap)));
                }
                return Err(missing(map.joint(group, gap)).in_file(file));
            }
            for j in 0..dof {
                let name = map.joint(group, j);
                if let Some(index) = find(&name) {
                    used.push(Used {
                        index,
                        name,
                        role: Role::Joint(group, j),
                    });
                }
            }
        }
        Ok(Self { used, dof })
    }
}

/// Names in one line, shortened.
fn list(header: &[String]) -> String {
    const SHOWN: usize = 30;
    let mut text = header
        .iter()
        .take(SHOWN)
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    if header.len() > SHOWN {
        text.push_str(&format!(", and {} more", header.len() - SHOWN));
    }
    text
}
