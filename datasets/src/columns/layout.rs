//! The columns of a file that are used.

use super::recognised::{Found, Header, Trouble};
use super::{Affine, Group, declaration};
use crate::{Problem, ReadError, ReadOptions};
use std::path::Path;

/// Use of a column of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// One of the clocks: where there are several, the steadiest is taken.
    Time,
    /// Part of a stamp below the second, in ns: belongs to the clock before it.
    Nanoseconds,
    Label,
    Joint(Group, usize),
}

/// Column of a file that the recording is made of.
#[derive(Clone, Debug)]
pub(crate) struct Used {
    /// Index of the column in the header, from 0.
    pub index: usize,
    /// Name of the column in the file.
    pub name: String,
    pub role: Role,
    /// Conversion to SI units on the link side; of a clock, to seconds where its unit is known.
    pub unit: Option<Affine>,
}

/// The columns of a file that are used.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub used: Vec<Used>,
    pub dof: usize,
    /// Messages for the user on columns that were recognised by their names.
    pub notes: Vec<String>,
}

impl Layout {
    /// Finds the columns: by the names that a drive file gives or those of docs/formats.md; a group with neither by the
    /// meaning of its columns' names. Time (unless a rate is given), position and, where `torque_needed`, torque must be
    /// there. Other groups may be absent.
    ///
    /// # Errors
    /// A name that stands twice; a required column missing, or a group that lacks some joints; another number of joints
    /// than the robot has, unless the robot's joints can be picked from columns of the whole description.
    pub fn resolve(
        header: &[String],
        options: &ReadOptions,
        file: &Path,
    ) -> Result<Self, ReadError> {
        for name in header.iter().filter(|n| !n.is_empty()) {
            let count = header.iter().filter(|n| *n == name).count();
            if count > 1 {
                return Err(Problem::DuplicateColumn(count).in_column(file, name));
            }
        }
        let read = Header::new(header, options);
        let mut search = Search {
            header,
            read,
            options,
            file,
            used: Vec::new(),
            notes: Vec::new(),
        };
        search.time()?;
        search.label();
        let dof = search.positions()?;
        for group in Group::ALL.into_iter().filter(|g| *g != Group::Q) {
            search.group(group, dof)?;
        }
        Ok(Self {
            used: search.used,
            dof,
            notes: search.notes,
        })
    }
}

/// What works with a file that has commands and no torque.
const WITHOUT_TORQUE: &str =
    "`residyn replay` needs no torque: it compares the motion with the commands that stand here.";

struct Search<'a> {
    header: &'a [String],
    read: Header<'a>,
    options: &'a ReadOptions,
    file: &'a Path,
    used: Vec<Used>,
    notes: Vec<String>,
}

impl Search<'_> {
    fn find(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|h| h == name)
    }

    fn missing(&self, name: String, declare: Option<String>) -> ReadError {
        let problem = Problem::MissingColumn {
            missing: name.into(),
            present: list(self.header).into(),
            declare: declare.map(Into::into),
        };
        problem.in_file(self.file)
    }

    fn take(&mut self, index: usize, role: Role, unit: Option<Affine>) {
        self.used.push(Used {
            index,
            name: self.header[index].clone(),
            role,
            unit,
        });
    }

    fn time(&mut self) -> Result<(), ReadError> {
        let map = &self.options.columns;
        let name = map.single("time");
        let scaled = |scale| Affine { scale, offset: 0.0 };
        if let Some(index) = self.find(&name) {
            let declared = map.time_scale.filter(|s| *s != 1.0);
            self.take(index, Role::Time, declared.map(scaled));
            return Ok(());
        }
        let clocks = if map.names.contains_key("time") {
            Vec::new()
        } else {
            self.read.clocks()
        };
        if clocks.is_empty() && self.options.rate_hz.is_none() {
            let declare = declaration::of_time(&self.read, map);
            return Err(self.missing(name, Some(declare)));
        }
        for (index, own, rest) in clocks {
            let unit = map.time_scale.filter(|s| *s != 1.0).or(own);
            self.take(index, Role::Time, unit.map(scaled));
            if let Some(rest) = rest {
                self.take(rest, Role::Nanoseconds, None);
            }
        }
        Ok(())
    }

    fn label(&mut self) {
        let name = self.options.columns.single("trajectory");
        if let Some(index) = self.find(&name) {
            self.take(index, Role::Label, None);
        } else if !self.options.columns.names.contains_key("trajectory")
            && let Some(index) = self.read.label()
        {
            self.notes.push(format!(
                "column `{}` is read as the trajectories' label",
                self.header[index]
            ));
            self.take(index, Role::Label, None);
        }
    }

    /// Joints in the file: the highest number with any column of the group, found by its documented or declared name.
    fn numbered(&self, group: Group) -> usize {
        let name = |j| self.options.columns.joint(group, j);
        (0..self.header.len())
            .rev()
            .find(|&j| self.find(&name(j)).is_some())
            .map_or(0, |j| j + 1)
    }

    /// Takes the columns of the positions and returns the number of joints.
    fn positions(&mut self) -> Result<usize, ReadError> {
        let named = self.numbered(Group::Q);
        let declared = self.options.columns.declares(Group::Q, named);
        if named == 0 && !declared {
            let found = self
                .read
                .group(Group::Q, self.options.dof)
                .map_err(|trouble| self.refusal(Group::Q, &trouble))?;
            let dof = found.columns.len();
            self.take_found(Group::Q, &found);
            return Ok(dof);
        }
        if named == 0 {
            return Err(self.missing(self.options.columns.joint(Group::Q, 0), None));
        }
        let dof = self.options.dof.unwrap_or(named);
        self.group(Group::Q, dof)?;
        Ok(dof)
    }

    /// Takes the columns of a group of a robot with `dof` joints.
    fn group(&mut self, group: Group, dof: usize) -> Result<(), ReadError> {
        let map = &self.options.columns;
        let needed = group == Group::Q || (group == Group::Tau && self.options.torque_needed);
        let beyond = self.numbered(group);
        if beyond == 0 && !map.declares(group, dof) {
            match self.read.group(group, Some(dof)) {
                Ok(found) => self.take_found(group, &found),
                Err(trouble) if needed => return Err(self.refusal(group, &trouble)),
                Err(_) => {}
            }
            return Ok(());
        }
        if !needed && beyond == 0 {
            return Ok(());
        }
        let places: Vec<Option<usize>> = (0..beyond.max(dof))
            .map(|j| self.find(&map.joint(group, j)))
            .collect();
        if beyond > dof {
            let all: Option<Vec<usize>> = places.iter().copied().collect();
            let chosen = all.and_then(|all| self.read.chosen(all, Some(dof)).ok());
            let Some(found) = chosen else {
                let name = map.joint(group, beyond - 1);
                return Err(self
                    .wrong(dof, &self.named(&places))
                    .in_column(self.file, &name));
            };
            self.take_found(group, &found);
            return Ok(());
        }
        if let Some(gap) = places.iter().position(Option::is_none) {
            // All joints beyond the gap missing as well: the file is of a smaller robot.
            if group == Group::Q && places[gap..].iter().all(Option::is_none) {
                let problem = self.wrong(dof, &self.named(&places));
                return Err(problem.in_column(self.file, &map.joint(group, gap)));
            }
            return Err(self.missing(map.joint(group, gap), None));
        }
        let units: Vec<Affine> = (0..dof).map(|j| map.conversion(group, j)).collect();
        for (joint, (index, unit)) in places.into_iter().flatten().zip(units).enumerate() {
            self.take(index, Role::Joint(group, joint), Some(unit));
        }
        if group == Group::Q && self.read.turned_round() {
            let chain = self.options.joints.join(", ");
            self.notes.push(format!(
                "numbers of columns count along the chain from the base: {chain}"
            ));
        }
        Ok(())
    }

    fn take_found(&mut self, group: Group, found: &Found) {
        for (joint, &index) in found.columns.iter().enumerate() {
            // What a drive file declares of units counts; a name's unit only without one.
            let declared = self.options.columns.units.contains_key(&group);
            let unit = if declared {
                self.options.columns.conversion(group, joint)
            } else {
                found.unit
            };
            self.take(index, Role::Joint(group, joint), Some(unit));
        }
        let names: Vec<&str> = found
            .columns
            .iter()
            .map(|&i| self.header[i].as_str())
            .collect();
        let aside = found
            .aside
            .as_ref()
            .map_or(String::new(), |a| format!("; {a}"));
        let own = (1..=names.len()).map(|j| format!("{}{j}", group.name()));
        if names.iter().zip(own).all(|(name, own)| *name == own) && aside.is_empty() {
            return;
        }
        self.notes.push(format!(
            "{}1 to {}{} are read from {}{aside}",
            group.name(),
            group.name(),
            names.len(),
            names.join(", ")
        ));
    }

    /// Names of the columns at these places.
    fn named(&self, places: &[Option<usize>]) -> Vec<&str> {
        let found = places.iter().flatten();
        found.map(|&i| self.header[i].as_str()).collect()
    }

    /// Refusal of the columns `found` of a robot with `expected` joints.
    fn wrong(&self, expected: usize, found: &[&str]) -> Problem {
        let model = self.options.stored_model;
        Problem::WrongDof {
            expected,
            found: found.len(),
            columns: list(found).into(),
            model: model.then(|| self.options.joints.join(", ").into()),
        }
    }

    fn refusal(&self, group: Group, trouble: &Trouble) -> ReadError {
        let own = self.options.columns.joint(group, 0);
        if let Trouble::Count(found) = trouble {
            let names: Vec<&str> = found.iter().map(|&i| self.header[i].as_str()).collect();
            let problem = self.wrong(self.options.dof.unwrap_or(0), &names);
            let last = names.last().copied().unwrap_or_default();
            return problem.in_column(self.file, last);
        }
        let dof = self.options.dof.unwrap_or_else(|| self.numbered(Group::Q));
        let mut declare = declaration::of_group(&self.read, group, trouble, dof);
        if group == Group::Tau && *trouble == Trouble::None && declare.is_none() {
            let problem = Problem::NoTorque {
                missing: own,
                present: list(self.header),
            };
            return problem.in_file(self.file);
        }
        if group == Group::Tau && self.commanded(dof) {
            declare = declare.map(|text| format!("{WITHOUT_TORQUE} {text}"));
        }
        self.missing(own, declare)
    }

    /// Whether the file has the commands of a robot with `dof` joints beside its motion.
    fn commanded(&self, dof: usize) -> bool {
        self.numbered(Group::QRef) == dof || self.read.group(Group::QRef, Some(dof)).is_ok()
    }
}

/// Names in one line, shortened.
fn list(header: &[impl AsRef<str>]) -> String {
    const SHOWN: usize = 30;
    let shown = header.iter().take(SHOWN).map(AsRef::as_ref);
    let mut text = shown.collect::<Vec<&str>>().join(", ");
    if header.len() > SHOWN {
        text.push_str(&format!(", and {} more", header.len() - SHOWN));
    }
    text
}
