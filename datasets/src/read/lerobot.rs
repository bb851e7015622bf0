//! LeRobot data sets: a folder whose `meta/info.json` names the elements of the features, and Parquet files of one or more episodes
//! each (versions 2 and 3 of the format).
//!
//! Time is `timestamp`, which restarts with every episode, and an episode is a trajectory. Features are lists of one element per motor;
//! the drive file says which are joints, by the data set's own names (`observation.state.shoulder_pan.pos`) or by number
//! (`observation.state[0]`).

use super::parquet::{self, LONGEST};
use crate::columns::ColumnMap;
use crate::{Problem, ReadError, ReadOptions, Recording};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// File that marks a folder as a data set.
const INFO: &str = "meta/info.json";

/// Summary of a data set, from its own `meta/info.json`.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetSummary {
    /// Frames per second; `None` where the data set does not state it.
    pub rate_hz: Option<f64>,
    /// Number of episodes; `None` where the data set does not state it.
    pub episodes: Option<u64>,
    /// Number of frames of all episodes; `None` where the data set does not state it.
    pub frames: Option<u64>,
    /// Features of the data set, in order of their names.
    pub features: Vec<FeatureSummary>,
}

/// Feature of a data set, such as positions.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureSummary {
    /// Name of the feature in the data set.
    pub name: String,
    /// Type of its elements (`float32`; `video` and `image` do not hold numbers).
    pub kind: String,
    /// Names by which a drive file calls its elements; that of the feature itself where it has no list of them.
    pub columns: Vec<String>,
}

/// Summary of a folder, where it is a data set.
///
/// # Errors
/// A `meta/info.json` that cannot be read.
pub fn dataset(folder: &Path) -> Result<Option<DatasetSummary>, ReadError> {
    if !is_dataset(folder) {
        return Ok(None);
    }
    let info = info(folder)?;
    let features = info["features"].as_object().into_iter().flatten();
    let features = features.map(|(name, of)| {
        let named = elements(&of["names"]).into_iter();
        let length = of["shape"][0].as_u64().unwrap_or(1);
        let numbered = (0..length).map(|k| format!("{name}[{k}]"));
        let kind = of["dtype"].as_str().unwrap_or("unknown").to_owned();
        let columns: Vec<String> = match kind.as_str() {
            "video" | "image" => Vec::new(),
            _ if length > LONGEST as u64 => Vec::new(),
            _ if !of["names"].is_null() => named.map(|n| format!("{name}.{n}")).collect(),
            _ if length > 1 => numbered.collect(),
            _ => vec![name.clone()],
        };
        FeatureSummary {
            name: name.clone(),
            kind,
            columns,
        }
    });
    Ok(Some(DatasetSummary {
        rate_hz: info["fps"].as_f64(),
        episodes: info["total_episodes"].as_u64(),
        frames: info["total_frames"].as_u64(),
        features: features.collect(),
    }))
}

/// Whether a folder is a data set.
pub(super) fn is_dataset(folder: &Path) -> bool {
    folder.join(INFO).is_file()
}

/// Reads all episodes of a data set as one recording.
pub(super) fn read(folder: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    let info = info(folder)?;
    if !options.columns.names.keys().any(|key| key.starts_with('q')) {
        return Err(undeclared(&info, options).in_file(folder));
    }
    let options = ReadOptions {
        columns: by_number(&options.columns, &info),
        ..options.clone()
    };
    let mut episodes = Vec::new();
    for file in files(&folder.join("data"))? {
        let bytes = std::fs::read(&file).map_err(|e| Problem::Io(e).in_file(&file))?;
        episodes.push(parquet::read(&bytes, &file, &options)?);
    }
    let mut whole = Recording::joined(&episodes).ok_or_else(|| Problem::Empty.in_file(folder))?;
    whole.source = folder.display().to_string();
    Ok(whole)
}

fn info(folder: &Path) -> Result<Value, ReadError> {
    let file = folder.join(INFO);
    let text = std::fs::read(&file).map_err(|e| Problem::Io(e).in_file(&file))?;
    serde_json::from_slice(&text).map_err(|e| {
        let (format, detail) = ("LeRobot", e.to_string());
        Problem::Damaged { format, detail }.in_file(&file)
    })
}

/// The Parquet files below a folder, in the order of their names: chunks, then files or episodes.
fn files(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        let io = |e: std::io::Error| Problem::Io(e).in_file(&folder);
        for entry in std::fs::read_dir(&folder).map_err(io)? {
            let path = entry.map_err(io)?.path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == "parquet") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Refusal of a data set without a drive file: its units stand nowhere in it. The lines to declare name the
/// columns that look like the robot's joints, in the order of the chain.
fn undeclared(info: &Value, options: &ReadOptions) -> Problem {
    let mut columns: Vec<(String, String)> = Vec::new();
    for (feature, of) in info["features"].as_object().into_iter().flatten() {
        // A motor is named after what it reports to LeRobot, whatever the feature holds: `elbow.pos` of its current.
        let plain = feature.trim_start_matches("observation.");
        for name in elements(&of["names"]) {
            let joint = name.strip_suffix(".pos").unwrap_or(&name);
            let quantity = if plain == "state" { "position" } else { plain };
            columns.push((format!("{quantity}.{joint}"), format!("{feature}.{name}")));
        }
    }
    let (said, own): (Vec<String>, Vec<String>) = columns.into_iter().unzip();
    let lines = crate::columns::lines(&said, &own, options);
    let declare = format!(
        "A LeRobot data set does not say its units: positions are degrees where it was recorded with use_degrees=true, else per cent of each \
         motor's range, which no description turns into angles (record it in degrees). Put in a drive file (--drive FILE.toml), for \
         example:{lines}"
    );
    Problem::MissingColumn {
        missing: "q1".into(),
        present: own.join(", ").into(),
        declare: Some(declare.into()),
    }
}

/// The column map with the data set's own names of elements replaced by numbers, and its time and episodes
/// where the map names no others.
fn by_number(map: &ColumnMap, info: &Value) -> ColumnMap {
    let mut map = map.clone();
    for (key, own) in [("time", "timestamp"), ("trajectory", "episode_index")] {
        map.names.entry(key.to_owned()).or_insert(own.to_owned());
    }
    let features = info["features"].as_object();
    let named: Vec<(String, String)> = features
        .into_iter()
        .flatten()
        .flat_map(|(feature, of)| {
            let each = elements(&of["names"]).into_iter().enumerate();
            each.map(move |(k, name)| (format!("{feature}.{name}"), format!("{feature}[{k}]")))
        })
        .collect();
    // A template of names, as it stands for the columns of a table.
    let patterns = map.names.iter().filter(|(_, name)| name.contains("{}"));
    let expanded: Vec<(String, String)> = patterns
        .flat_map(|(key, pattern)| {
            (1..=LONGEST).map(move |j| (format!("{key}{j}"), pattern.replace("{}", &j.to_string())))
        })
        .filter(|(_, name)| named.iter().any(|(n, _)| n == name))
        .collect();
    for (key, name) in expanded {
        map.names.entry(key).or_insert(name);
    }
    for name in map.names.values_mut() {
        if let Some((_, number)) = named.iter().find(|(n, _)| n == name) {
            name.clone_from(number);
        }
    }
    map
}

/// Names of a feature's elements: a list, or lists by kind (`{"motors": […]}`).
fn elements(names: &Value) -> Vec<String> {
    let text = |v: &Value| v.as_str().map(str::to_owned);
    match names {
        Value::Array(list) => list.iter().filter_map(text).collect(),
        Value::Object(kinds) => kinds.values().flat_map(elements).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_elements_are_numbers() {
        let info = serde_json::json!({"features": {
            "observation.state": {"names": ["pan.pos", "lift.pos"]},
            "observation.load": {"names": {"motors": ["pan", "lift"]}},
        }});
        let mut map = ColumnMap::default();
        for (key, name) in [
            ("q1", "observation.state.lift.pos"),
            ("tau1", "observation.load.pan"),
            ("q2", "x"),
        ] {
            map.names.insert(key.to_owned(), name.to_owned());
        }
        let map = by_number(&map, &info);
        let name = |key: &str| map.names[key].as_str();
        assert_eq!(
            [name("q1"), name("tau1"), name("q2")],
            ["observation.state[1]", "observation.load[0]", "x"]
        );
        assert_eq!(
            [name("time"), name("trajectory")],
            ["timestamp", "episode_index"]
        );
    }
}
