//! Recognition of columns by the meaning of their names, where no drive file names them and they are not called
//! as in docs/formats.md.

use super::ReadOptions;
use super::names::{Chain, Quantity, Said, Unit, said};
use super::{Affine, Group};
use std::collections::BTreeMap;

/// The header, with the meaning of each name.
pub(super) struct Header<'a> {
    pub names: &'a [String],
    said: Vec<Option<Said>>,
    joints: &'a [String],
    described: &'a [String],
    /// Whether a drive file converts the torque.
    converted: bool,
}

/// Reason why a group of columns is not read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    /// No column of the header with this meaning.
    None,
    /// Several columns could be meant.
    Several(Vec<usize>),
    /// Columns for another number of joints than the robot has.
    Count(Vec<usize>),
    /// Joints by names that the robot does not have.
    Names(Vec<usize>),
    /// A torque in another unit than N·m.
    Unit(Vec<usize>, &'static str),
    /// Columns of commanded values alone.
    Command(Vec<usize>),
}

/// Columns of a group, in the order of the robot's chain.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    pub columns: Vec<usize>,
    pub unit: Affine,
    /// Message for the user on why these columns were chosen.
    pub aside: Option<String>,
}

impl<'a> Header<'a> {
    pub fn new(names: &'a [String], options: &'a ReadOptions) -> Self {
        let chain = Chain::new(&options.joints);
        Self {
            said: names.iter().map(|name| said(name, &chain)).collect(),
            names,
            joints: &options.joints,
            described: &options.described,
            converted: options
                .columns
                .units
                .get(&Group::Tau)
                .is_some_and(|units| units.iter().any(|u| u.scale.abs() != 1.0)),
        }
    }

    fn those(&self, quantity: Quantity) -> impl Iterator<Item = (usize, &Said)> {
        let all = self.said.iter().enumerate();
        all.filter_map(move |(i, s)| s.as_ref().map(|s| (i, s)))
            .filter(move |(_, s)| s.quantity == quantity)
    }

    /// Columns that could be the time, plainest first, each with its seconds per unit where the name states it; and of a stamp in
    /// two parts the column of the ns.
    pub fn clocks(&self) -> Vec<(usize, Option<f64>, Option<usize>)> {
        let mut found: Vec<(usize, &Said)> = self.those(Quantity::Time).collect();
        found.sort_by_key(|(_, s)| s.unknown);
        let prefix = |i: usize| {
            let name = &self.names[i];
            let end = name.rfind(|c: char| !c.is_alphanumeric());
            name[..end.unwrap_or(0)].to_owned()
        };
        let rest = |i: usize| {
            self.those(Quantity::Nanoseconds)
                .map(|(k, _)| k)
                .find(|&k| prefix(k) == prefix(i))
        };
        found
            .into_iter()
            .map(|(i, s)| match s.unit {
                Unit::Seconds(power) => (i, Some(10_f64.powi(power)), None),
                _ => (i, None, rest(i)),
            })
            .collect()
    }

    /// Index of the column of labels.
    pub fn label(&self) -> Option<usize> {
        let mut all = self.those(Quantity::Label).map(|(i, _)| i);
        let first = all.next()?;
        all.next().is_none().then_some(first)
    }

    /// The columns of a group of a robot with `dof` joints, or of as many as the file has.
    pub fn group(&self, group: Group, dof: Option<usize>) -> Result<Found, Trouble> {
        let all: Vec<(usize, &Said)> = self.those(Quantity::Of(group)).collect();
        if all.is_empty() {
            let commands: Vec<usize> = match group {
                Group::Tau => self.those(Quantity::CommandedTorque).map(|c| c.0).collect(),
                _ => Vec::new(),
            };
            return Err(if commands.is_empty() {
                Trouble::None
            } else {
                Trouble::Command(commands)
            });
        }
        let mut found = match self.by_name(&all, dof) {
            Some(found) => found?,
            None => self.by_number(&all, dof)?,
        };
        let units: Vec<Unit> = found
            .columns
            .iter()
            .filter_map(|&i| Some(self.said[i].as_ref()?.unit))
            .collect();
        let any = |unit| units.contains(&unit);
        if any(Unit::Current) && !self.converted {
            return Err(Trouble::Unit(found.columns, "current"));
        }
        if any(Unit::Load) && !self.converted {
            return Err(Trouble::Unit(found.columns, "percent"));
        }
        if any(Unit::Degrees) {
            found.unit.scale = 1_f64.to_radians();
            let aside = found
                .aside
                .take()
                .map_or(String::new(), |a| format!("; {a}"));
            found.aside = Some(format!("in degrees, as the names say{aside}"));
        }
        Ok(found)
    }

    /// Columns by the joints' names in them; none where they hold no name of a joint.
    fn by_name(
        &self,
        all: &[(usize, &Said)],
        dof: Option<usize>,
    ) -> Option<Result<Found, Trouble>> {
        let dof = dof.filter(|&n| n == self.joints.len())?;
        let mut columns = Vec::with_capacity(dof);
        for joint in 0..dof {
            let own: Vec<&(usize, &Said)> =
                all.iter().filter(|(_, s)| s.joint == Some(joint)).collect();
            let least = own.iter().map(|(_, s)| s.unknown).min()?;
            let plain: Vec<usize> = own
                .iter()
                .filter(|(_, s)| s.unknown == least)
                .map(|c| c.0)
                .collect();
            match plain[..] {
                [one] => columns.push(one),
                _ => return Some(Err(Trouble::Several(plain))),
            }
        }
        Some(Ok(Found {
            columns,
            unit: Affine::IDENTITY,
            aside: None,
        }))
    }

    /// Columns by their numbers, from 0 or from 1, in the order of the chain.
    fn by_number(&self, all: &[(usize, &Said)], dof: Option<usize>) -> Result<Found, Trouble> {
        type Members = Vec<(Option<usize>, usize)>;
        let mut styles: BTreeMap<&str, (usize, Members)> = BTreeMap::new();
        for (i, s) in all {
            let (_, members) = styles.entry(&s.style).or_insert((s.unknown, Vec::new()));
            members.push((s.number, *i));
        }
        // A single joint needs no number.
        let whole = |members: &mut Vec<(Option<usize>, usize)>| {
            members.sort_unstable();
            let first = members[0].0;
            let runs = |(k, m): (usize, &(Option<usize>, usize))| m.0 == first.map(|f| f + k);
            let lone = members.len() == 1 && first.is_none();
            let numbered = first.is_some_and(|f| f < 2) && members.iter().enumerate().all(runs);
            lone || numbered
        };
        styles.retain(|_, (_, members)| whole(members));
        // Several without numbers are several joints, by names that the robot does not have.
        if styles.len() > 1 && styles.values().all(|(_, m)| m[0].0.is_none()) {
            return Err(Trouble::Names(all.iter().map(|c| c.0).collect()));
        }
        let Some(least) = styles.values().map(|(unknown, _)| *unknown).min() else {
            return Err(Trouble::Names(all.iter().map(|c| c.0).collect()));
        };
        let mut plain = styles
            .into_values()
            .filter(|(unknown, _)| *unknown == least);
        let (_, members) = plain.next().unwrap_or_default();
        let columns: Vec<usize> = members.iter().map(|m| m.1).collect();
        let others: Vec<usize> = plain.flat_map(|(_, m)| m).map(|m| m.1).collect();
        if !others.is_empty() {
            return Err(Trouble::Several([columns, others].concat()));
        }
        self.chosen(columns, dof)
    }

    /// Numbered columns in the order of the description: all where they are as many as the chain's joints; of a chain
    /// that was chosen among more, those at the places of its joints.
    pub fn chosen(&self, columns: Vec<usize>, dof: Option<usize>) -> Result<Found, Trouble> {
        let dof = dof.unwrap_or(columns.len());
        if columns.len() == dof {
            let aside = self.turned_round().then(|| {
                format!(
                    "numbers count along the chain from the base ({})",
                    self.joints.join(", ")
                )
            });
            return Ok(Found {
                columns,
                unit: Affine::IDENTITY,
                aside,
            });
        }
        let places: Option<Vec<usize>> = self
            .joints
            .iter()
            .map(|joint| self.described.iter().position(|name| name == joint))
            .collect();
        match places {
            Some(places) if self.described.len() == columns.len() && places.len() == dof => {
                let numbers: Vec<String> = places.iter().map(|p| (p + 1).to_string()).collect();
                Ok(Found {
                    aside: Some(format!(
                        "of {} columns those at the places {} of the description's joints",
                        columns.len(),
                        numbers.join(", ")
                    )),
                    columns: places.into_iter().map(|p| columns[p]).collect(),
                    unit: Affine::IDENTITY,
                })
            }
            _ => Err(Trouble::Count(columns)),
        }
    }

    /// Whether the joints' own numbers do not rise along the chain.
    pub fn turned_round(&self) -> bool {
        let numbers: Vec<usize> = self
            .joints
            .iter()
            .filter_map(|name| super::names::last_number(name))
            .collect();
        numbers.len() == self.joints.len() && !numbers.is_sorted()
    }

    /// Columns whose names have no known meaning.
    pub fn unread(&self) -> impl Iterator<Item = &'a str> {
        let all = self.names.iter().zip(&self.said);
        all.filter(|(name, said)| said.is_none() && !name.is_empty())
            .map(|(name, _)| name.as_str())
    }
}
