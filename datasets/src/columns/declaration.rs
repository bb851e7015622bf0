//! Lines of a drive file that declare the columns which the header does not tell.

use super::ReadOptions;
use super::names::style;
use super::recognised::{Header, Trouble};
use super::{Group, map::ColumnMap};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Declaration, or other remedy, where columns of a group are not found.
pub(super) fn of_group(
    header: &Header<'_>,
    group: Group,
    trouble: &Trouble,
    dof: usize,
) -> Option<String> {
    let names = |columns: &[usize]| -> Vec<&str> {
        columns.iter().map(|&i| header.names[i].as_str()).collect()
    };
    let key = group.name();
    let lines = |found: &[&str], unit: &str| declared(key, found, dof, unit);
    match trouble {
        Trouble::Several(found) => {
            let found = names(found);
            let (first, _) = found.split_at(dof.min(found.len()));
            Some(format!(
                "Several could be meant ({}): choose in a drive file (--drive FILE.toml), for example{}",
                found.join(", "),
                lines(first, "")
            ))
        }
        Trouble::Names(found) => Some(format!(
            "Its joints have other names than the robot's: put them in the order of the chain, base first, in a drive file \
             (--drive FILE.toml){}",
            lines(&names(found), "")
        )),
        Trouble::Unit(found, unit) => Some(format!(
            "{} is no torque in N·m by its name: declare it in a drive file (--drive FILE.toml; `{unit}` needs gear_ratio \
             and torque_constant; where only N·m per A at the joint is known, leave [units] out and give torque_scale){}",
            header.names[found[0]],
            lines(&names(found), unit)
        )),
        Trouble::Command(found) => Some(format!(
            "{} is a command, not what was measured; if it is all that there is, say so in a drive file (--drive FILE.toml){}",
            header.names[found[0]],
            lines(&names(found), "")
        )),
        Trouble::None if matches!(group, Group::Q | Group::Tau) => {
            // Numbered columns that nothing is known of: one run for each joint.
            let mut styles: BTreeMap<String, Vec<&str>> = BTreeMap::new();
            for name in header.unread() {
                styles.entry(style(name)).or_default().push(name);
            }
            let runs = styles.into_values().find(|run| run.len() == dof)?;
            Some(format!(
                "If it is called otherwise here, say so in a drive file (--drive FILE.toml), for example{}",
                lines(&runs, "")
            ))
        }
        Trouble::None | Trouble::Count(_) => None,
    }
}

/// The lines for these columns: one with a template where they are numbered from 1, else one for each joint.
fn declared(key: &str, found: &[&str], dof: usize, unit: &str) -> String {
    let mut text = String::from(":\n    [columns]");
    let template = found.first().map(|name| style(name)).unwrap_or_default();
    let numbered = |(k, name): (usize, &&str)| {
        **name == template.replace("{}", &(k + 1).to_string()) && template.contains("{}")
    };
    if found.len() == dof && found.iter().enumerate().all(numbered) {
        let _ = write!(text, "\n    {key} = \"{template}\"");
    } else {
        for (k, name) in found.iter().take(dof).enumerate() {
            let _ = write!(text, "\n    {key}{} = \"{name}\"", k + 1);
        }
    }
    if !unit.is_empty() {
        let _ = write!(text, "\n    [units]\n    torque = \"{unit}\"");
    }
    text
}

/// Declaration where no column is a time.
pub(super) fn of_time(header: &Header<'_>, map: &ColumnMap) -> String {
    let counter = header.names.iter().find(|name| {
        matches!(
            name.to_lowercase().as_str(),
            "frame" | "step" | "index" | "i" | "k"
        )
    });
    let named = map.names.contains_key("time");
    match counter {
        Some(name) if !named => format!(
            "If the rows are evenly spaced, give their rate by --rate HZ (`{name}` counts them); a column with time is named in a drive file \
             (columns.time = \"…\")"
        ),
        _ => "If the rows are evenly spaced, give their rate by --rate HZ; a column with time is named in a drive file \
              (columns.time = \"…\")"
            .to_owned(),
    }
}

/// Lines of a drive file for a table whose columns are called `own` in the file and `said` by the recogniser: the
/// columns of positions and torque that are found.
pub(crate) fn lines(said: &[String], own: &[String], options: &ReadOptions) -> String {
    let header = Header::new(said, options);
    let mut text = String::from("\n    [columns]");
    let mut torque = "link";
    for group in [Group::Q, Group::Tau] {
        let columns = match header.group(group, options.dof) {
            Ok(found) => found.columns,
            Err(Trouble::Unit(columns, unit)) => {
                torque = unit;
                columns
            }
            Err(Trouble::Names(columns) | Trouble::Several(columns)) => columns,
            Err(_) => Vec::new(),
        };
        for (j, &column) in columns.iter().enumerate() {
            let _ = write!(
                text,
                "\n    {}{} = \"{}\"",
                group.name(),
                j + 1,
                own[column]
            );
        }
    }
    let _ = write!(text, "\n    [units]\n    angle = \"deg\"");
    if torque != "link" {
        let _ = write!(text, "\n    torque = \"{torque}\"");
    }
    text
}
