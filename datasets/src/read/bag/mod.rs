//! Bags: MCAP and SQLite files and rosbag2 folders, whose messages are brought to the columns of a recording.
//!
//! One pass over the file; of the messages only the columns that are needed stay in memory.

mod align;
mod bytes;
mod clock;
mod collect;
mod db3;
mod definition;
mod folder;
mod mcap;
mod message;
mod plan;
mod planned;
mod source;
mod sqlite;
mod topic;
mod topics;
mod wanted;

use super::contained::contained;
use crate::assemble::{Columns, LabelRuns, assemble};
use crate::columns::{Affine, Group, Layout, Role, Used};
use crate::{Problem, ReadError, ReadOptions, Recording};
use align::Series;
use clock::Times;
use collect::{Collected, Collector};
use source::Sink;
use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::Path;
use topics::Listing;
use wanted::{Want, Wanted};

pub use planned::planned_trajectories;
pub use topics::TopicSummary;

/// Source of a bag: a path, or bytes in memory.
#[derive(Clone, Copy)]
pub(super) enum Input<'a> {
    /// Path of a file or folder.
    Path(&'a Path),
    /// An MCAP or SQLite file in memory.
    Bytes(&'a [u8]),
}

impl Input<'_> {
    /// Reads everything, from start to end.
    fn scan(self, name: &Path, sink: &mut dyn Sink) -> Result<(), ReadError> {
        match self {
            Self::Bytes(bytes) => {
                sink.file();
                match bytes.starts_with(b"SQLite") {
                    true => db3::read(Cursor::new(bytes), sink),
                    false => mcap::read(bytes, sink),
                }
                .map_err(|p| p.in_file(name))
            }
            Self::Path(path) if path.is_dir() => folder::files(path)?
                .iter()
                .try_for_each(|file| scan_file(file, sink)),
            Self::Path(path) => scan_file(path, sink),
        }
    }
}

fn scan_file(path: &Path, sink: &mut dyn Sink) -> Result<(), ReadError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    sink.file();
    match ending.to_ascii_lowercase().as_str() {
        "mcap" => File::open(path)
            .map_err(Problem::Io)
            .and_then(|file| mcap::read(BufReader::with_capacity(1 << 18, file), sink)),
        "db3" if unfinished(path) => Err(Problem::Unfinished),
        "db3" => File::open(path)
            .map_err(Problem::Io)
            .and_then(|file| db3::read(file, sink)),
        _ => Err(Problem::UnknownFormat(ending.to_owned())),
    }
    .map_err(|p| p.in_file(path))
}

/// Whether the last messages of an SQLite file are still in its log beside it.
fn unfinished(path: &Path) -> bool {
    let mut log = path.as_os_str().to_owned();
    log.push("-wal");
    std::fs::metadata(log).is_ok_and(|log| log.len() > 0)
}

/// Reads a recording from a bag.
pub(super) fn read(
    input: Input<'_>,
    name: &Path,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    contained("bag", name, || {
        let wanted = wanted(input, name, options)?;
        let mut collector = Collector::new(wanted.clone());
        input.scan(name, &mut collector)?;
        let collected = collector.finish().map_err(|(problem, message)| {
            let error = problem.in_file(name);
            match message {
                Some(message) => error.at_row(message),
                None => error,
            }
        })?;
        recording(collected, wanted.dof, options, name)
    })
}

/// Summary of each topic of a bag.
pub(super) fn topics(path: &Path) -> Result<Vec<TopicSummary>, ReadError> {
    contained("bag", path, || {
        let mut listing = Listing::default();
        Input::Path(path).scan(path, &mut listing)?;
        Ok(listing.finish())
    })
}

/// Columns wanted; of a robot that is not known, those of all joints of the bag.
fn wanted(input: Input<'_>, name: &Path, options: &ReadOptions) -> Result<Wanted, ReadError> {
    if let Some(dof) = options.dof {
        return Ok(Wanted::new(options, dof, None));
    }
    let mut listing = Listing::default();
    input.scan(name, &mut listing)?;
    let joints = listing.joints().unwrap_or_default();
    Ok(Wanted::new(options, joints.len(), Some(&joints)))
}

/// Recording from columns on clocks of their own.
fn recording(
    collected: Collected,
    dof: usize,
    options: &ReadOptions,
    file: &Path,
) -> Result<Recording, ReadError> {
    let Collected {
        mut topics,
        mut notes,
    } = collected;
    let Times {
        times,
        resets,
        note,
    } = clock::times(&mut topics).map_err(|(p, message)| p.in_file(file).at_row(message))?;
    notes.extend(note);
    let mut wants = Vec::new();
    let mut series = Vec::new();
    for (topic, times) in topics.into_iter().zip(times) {
        let name = topic.name;
        wants.extend(topic.wants.into_iter().map(|w| (name.clone(), w)));
        series.push(Series {
            name,
            times,
            columns: topic.columns,
        });
    }
    let mut base = series.remove(0);
    let dropped = align::onto(&mut base, &mut series).map_err(|p| p.in_file(file))?;
    if dropped > 0 {
        notes.push(format!(
            "{dropped} messages of `{}` are left out, for the other topics have nothing at their time",
            base.name
        ));
    }
    let labels = labels(&resets, base.times.len());
    let first = base.times.iter().copied().min().unwrap_or_default();
    let seconds = base
        .times
        .iter()
        .map(|t| t.saturating_sub(first) as f64 * 1e-9);
    let seconds: Vec<f64> = seconds.collect();
    let columns = std::iter::once(base).chain(series).flat_map(|s| s.columns);
    let (used, mut numbers): (Vec<Used>, Vec<Vec<f64>>) =
        complete(wants, columns, options).into_iter().unzip();
    numbers.insert(0, seconds);
    let layout = Layout {
        used: std::iter::once(time()).chain(used).collect(),
        dof,
        notes,
    };
    let columns = Columns {
        numbers,
        labels,
        lines: None,
        empty: std::collections::BTreeSet::new(),
        torque_filter: None,
    };
    assemble(&layout, columns, options, file)
}

fn time() -> Used {
    Used {
        index: 0,
        name: "time".to_owned(),
        role: Role::Time,
        // In seconds already.
        unit: Some(Affine::IDENTITY),
    }
}

/// A trajectory from each start of the clock to the next.
fn labels(resets: &[usize], rows: usize) -> Option<LabelRuns> {
    if resets.is_empty() {
        return None;
    }
    let mut labels = LabelRuns::default();
    for row in 0..rows {
        labels.push(&resets.partition_point(|&r| r <= row).to_string());
    }
    Some(labels)
}

/// The columns that are used: all but groups that are not needed and that a joint lacks.
fn complete(
    wants: Vec<(String, Want)>,
    columns: impl Iterator<Item = Vec<f64>>,
    options: &ReadOptions,
) -> Vec<(Used, Vec<f64>)> {
    let mut all: Vec<(String, Want, Vec<f64>)> = wants
        .into_iter()
        .zip(columns)
        .map(|((topic, want), column)| (topic, want, column))
        .collect();
    let lacking = |(_, want, column): &(String, Want, Vec<f64>)| {
        (!want.needed && column.iter().all(|v| v.is_nan())).then_some(want.group)
    };
    let lacking: Vec<Group> = all.iter().filter_map(lacking).collect();
    all.retain(|(_, want, _)| !lacking.contains(&want.group));
    all.into_iter()
        .map(|(topic, want, column)| {
            let used = Used {
                index: 0,
                name: format!(
                    "{}{} of {topic}:{}",
                    want.group.name(),
                    want.joint + 1,
                    want.field
                ),
                role: Role::Joint(want.group, want.joint),
                unit: Some(options.columns.conversion(want.group, want.joint)),
            };
            (used, column)
        })
        .collect()
}
