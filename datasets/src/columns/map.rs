//! Names and units that a drive file declares.

use super::{Affine, Group};
use std::collections::BTreeMap;

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
        // A torque that a controller adds is in SI units at the joint, so that only its direction may differ.
        let direction = |c: &Affine| Affine {
            scale: c.scale.signum(),
            offset: 0.0,
        };
        let added = rate.iter().map(direction).collect();
        let units = [
            (Group::Q, &position),
            (Group::Ql, &position),
            (Group::QRef, &position),
            (Group::Qd, &rate),
            (Group::Qdd, &rate),
            (Group::QdRef, &rate),
            (Group::Tau, &torque),
            (Group::TauFf, &added),
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

impl ColumnMap {
    /// Whether the map itself names the columns of a group, one by one or as a whole.
    pub(super) fn declares(&self, group: Group, dof: usize) -> bool {
        let single = |j: usize| {
            self.names
                .contains_key(&format!("{}{}", group.name(), j + 1))
        };
        self.names.contains_key(group.name()) || (0..dof.max(1)).any(single)
    }
}
