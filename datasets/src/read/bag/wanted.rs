//! Source of each column: topic and field.

use crate::columns::Group;
use crate::{ColumnMap, ReadOptions};

/// Source of a column of the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Want {
    pub group: Group,
    pub joint: usize,
    /// Topic of the column; `None` for the topic of the joint states.
    pub topic: Option<String>,
    pub field: String,
    /// Element of the field, from 0, where a drive file gives it.
    pub index: Option<usize>,
    /// Whether the recording is refused without the column.
    pub needed: bool,
}

/// All columns wanted of a bag.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub columns: Vec<Want>,
    pub dof: usize,
    /// Names of the joints in the messages, base first, where they are known beforehand.
    pub joints: Option<Vec<String>>,
    /// Field with the joints' names, where a drive file gives it.
    pub names: Option<String>,
    /// Field with the time, where a drive file gives it.
    pub time: Option<String>,
    /// Seconds per unit of the time field.
    pub time_scale: f64,
}

impl Wanted {
    /// Columns that the options ask for, of a robot with `dof` joints; `found` are the bag's joints, for a
    /// robot that is not known.
    pub fn new(options: &ReadOptions, dof: usize, found: Option<&[String]>) -> Self {
        let map = &options.columns;
        let mut columns: Vec<Want> = Group::ALL
            .into_iter()
            .flat_map(|group| (0..dof).filter_map(move |joint| want(options, group, joint)))
            .collect();
        // Positions come first: what names no topic stands beside its joint's.
        let topics: Vec<Option<String>> = columns[..dof].iter().map(|w| w.topic.clone()).collect();
        for column in &mut columns {
            column.topic = column.topic.take().or_else(|| topics[column.joint].clone());
        }
        let known = if options.joints.is_empty() {
            found.unwrap_or_default()
        } else {
            &options.joints
        };
        Self {
            columns,
            dof,
            joints: (0..dof)
                .map(|joint| own(map, "joint", joint).or_else(|| known.get(joint).cloned()))
                .collect(),
            names: map.names.get("names").cloned(),
            time: map.names.get("time").cloned(),
            time_scale: map.time_scale.unwrap_or(1.0),
        }
    }

    /// Topic of the positions, where a drive file gives it.
    pub fn base(&self) -> Option<&str> {
        self.columns
            .iter()
            .find(|w| w.group == Group::Q)
            .and_then(|w| w.topic.as_deref())
    }
}

/// A drive file's name for a joint's column.
fn own(map: &ColumnMap, group: &str, joint: usize) -> Option<String> {
    let number = (joint + 1).to_string();
    let single = map.names.get(&format!("{group}{number}")).cloned();
    single.or_else(|| Some(map.names.get(group)?.replace("{}", &number)))
}

fn want(options: &ReadOptions, group: Group, joint: usize) -> Option<Want> {
    let usual = match group {
        Group::Q => Some("position"),
        Group::Qd => Some("velocity"),
        Group::Tau => Some("effort"),
        _ => None,
    };
    let named = own(&options.columns, group.name(), joint);
    let needed =
        named.is_some() || group == Group::Q || (group == Group::Tau && options.torque_needed);
    let (topic, field, index) = named.as_deref().map_or((None, None, None), place);
    Some(Want {
        group,
        joint,
        topic: topic.map(str::to_owned),
        field: field.or(usual)?.to_owned(),
        index,
        needed,
    })
}

/// Topic, field and element of `TOPIC:FIELD[K]`; `/TOPIC` alone is a topic, anything else without colon a field.
fn place(text: &str) -> (Option<&str>, Option<&str>, Option<usize>) {
    let (rest, index) = match text.strip_suffix(']').and_then(|t| t.rsplit_once('[')) {
        Some((rest, index)) => match index.parse() {
            Ok(index) => (rest, Some(index)),
            Err(_) => (text, None),
        },
        None => (text, None),
    };
    let (topic, field) = match rest.rsplit_once(':') {
        Some((topic, field)) => (Some(topic), Some(field)),
        None if rest.starts_with('/') => (Some(rest), None),
        None => (None, Some(rest)),
    };
    (topic, field.filter(|f| !f.is_empty()), index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places() {
        assert_eq!(place("/a/b:c.d[3]"), (Some("/a/b"), Some("c.d"), Some(3)));
        assert_eq!(place("/a"), (Some("/a"), None, None));
        assert_eq!(place("/a:"), (Some("/a"), None, None));
        assert_eq!(place("effort"), (None, Some("effort"), None));
        assert_eq!(place("q[x]"), (None, Some("q[x]"), None));
    }

    #[test]
    fn a_topic_for_each_joint() {
        let mut options = ReadOptions::for_robot(2);
        options.torque_needed = false;
        let names = &mut options.columns.names;
        names.insert("q".into(), "/joint_{}/state:angle".into());
        names.insert("tau2".into(), "/torques:data[7]".into());
        let wanted = Wanted::new(&options, 2, None);
        let found: Vec<(Group, &str, &str, bool)> = wanted
            .columns
            .iter()
            .map(|w| {
                (
                    w.group,
                    w.topic.as_deref().unwrap(),
                    w.field.as_str(),
                    w.needed,
                )
            })
            .collect();
        let expected = [
            (Group::Q, "/joint_1/state", "angle", true),
            (Group::Q, "/joint_2/state", "angle", true),
            (Group::Qd, "/joint_1/state", "velocity", false),
            (Group::Qd, "/joint_2/state", "velocity", false),
            (Group::Tau, "/joint_1/state", "effort", false),
            (Group::Tau, "/torques", "data", true),
        ];
        assert_eq!(found, expected);
        assert_eq!(wanted.base(), Some("/joint_1/state"));
        assert_eq!(wanted.columns[5].index, Some(7));
    }
}
