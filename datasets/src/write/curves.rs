//! Named curves over time, as plotters read them: Parquet with a column for each, or MCAP with a JSON message for each
//! sample. PlotJuggler and Foxglove show the names as a tree: a branch for each group.

use super::mcap::{Channel, Mcap};
use super::{WriteError, WriteProblem, atomically, parquet};
use serde_json::{Map, Value, json};
use std::io::Write;
use std::ops::Range;
use std::path::Path;

/// Names of the curves of a group, each with its values: one per time stamp.
pub type Group = Vec<(&'static str, Vec<f64>)>;

/// Curves over time.
pub struct Curves<'a> {
    /// Topic of the messages, as `torque`.
    pub topic: &'a str,
    /// Time stamps, s, increasing within a trajectory.
    pub time: &'a [f64],
    /// Rows of the trajectories, in order, without gaps.
    pub segments: &'a [Range<usize>],
    /// Groups by name.
    pub groups: Vec<(String, Group)>,
}

/// Endings of files that [`write_curves`] writes.
pub const ENDINGS: [&str; 2] = ["mcap", "parquet"];

/// Whether [`write_curves`] writes a file of this name.
///
/// # Errors
/// An unknown ending.
pub fn curves_ending(path: &Path) -> Result<(), WriteError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    if ENDINGS.contains(&ending.to_ascii_lowercase().as_str()) {
        return Ok(());
    }
    Err(WriteError {
        file: path.to_owned(),
        problem: WriteProblem::NoCurves(ending.to_owned()),
    })
}

/// Writes curves; the ending of the name (.mcap or .parquet) decides on the format. Time runs from 0 s at the first sample;
/// a trajectory whose clock starts again begins where the one before it ended. In Parquet the columns are `time`,
/// `trajectory` (counted from 0) and `GROUP/CURVE`; in MCAP a message holds the same.
///
/// # Errors
/// An unknown ending or a failure of the disk; the file is then as it was before.
pub fn write_curves(curves: &Curves, path: &Path) -> Result<(), WriteError> {
    curves_ending(path)?;
    let time = running(curves.time, curves.segments);
    let ending = path.extension().and_then(|e| e.to_str());
    let written = if ending.is_some_and(|e| e.eq_ignore_ascii_case("mcap")) {
        let bytes = messages(curves, &time);
        atomically(path, |out| Ok(out.write_all(&bytes)?))
    } else {
        let columns = columns(curves, time);
        atomically(path, |out| parquet::numbered(&columns, out))
    };
    written.map_err(|problem| WriteError {
        file: path.to_owned(),
        problem,
    })
}

/// Times from the first sample on that never go back.
fn running(time: &[f64], segments: &[Range<usize>]) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::with_capacity(time.len());
    let mut ahead = time.first().copied().unwrap_or(0.0);
    for segment in segments {
        let begins = time[segment.start] - ahead;
        if let Some(&ended) = out.last().filter(|ended| begins < **ended) {
            ahead = time[segment.start] - ended;
        }
        out.extend(segment.clone().map(|row| time[row] - ahead));
    }
    out
}

/// Name and values of every column.
fn columns(curves: &Curves, time: Vec<f64>) -> Vec<(String, Vec<f64>)> {
    let counted = curves.segments.iter().enumerate();
    let trajectory = counted.flat_map(|(k, rows)| std::iter::repeat_n(k as f64, rows.len()));
    let mut out = vec![
        ("time".to_owned(), time),
        ("trajectory".to_owned(), trajectory.collect()),
    ];
    for (group, list) in &curves.groups {
        let named = list.iter();
        out.extend(named.map(|(name, values)| (format!("{group}/{name}"), values.clone())));
    }
    out
}

fn messages(curves: &Curves, time: &[f64]) -> Vec<u8> {
    let number = || json!({"type": "number"});
    let mut properties = Map::from_iter([
        ("time".to_owned(), number()),
        ("trajectory".to_owned(), number()),
    ]);
    for (group, list) in &curves.groups {
        let inner: Map<String, Value> = list
            .iter()
            .map(|(n, _)| ((*n).to_owned(), number()))
            .collect();
        properties.insert(
            group.clone(),
            json!({"type": "object", "properties": inner}),
        );
    }
    let definition = json!({"type": "object", "properties": properties}).to_string();
    let mut file = Mcap::new(&Channel {
        profile: "",
        kind: curves.topic,
        language: "jsonschema",
        definition: &definition,
        topic: &format!("/{}", curves.topic),
        encoding: "json",
    });
    for (k, segment) in curves.segments.iter().enumerate() {
        for row in segment.clone() {
            let mut message = Map::from_iter([
                ("time".to_owned(), json!(time[row])),
                ("trajectory".to_owned(), json!(k)),
            ]);
            for (group, list) in &curves.groups {
                let inner = list.iter();
                let inner: Map<String, Value> = inner
                    .map(|(name, v)| ((*name).to_owned(), json!(v[row])))
                    .collect();
                message.insert(group.clone(), Value::Object(inner));
            }
            let logged = (time[row] * 1e9).round() as u64;
            file.message(logged, Value::Object(message).to_string().as_bytes());
        }
    }
    file.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_starts_again_goes_on_where_it_ended() {
        let time = [5.0, 5.5, 1.0, 2.0, 9.0];
        let running = running(&time, &[0..2, 2..4, 4..5]);
        assert_eq!(running, [0.0, 0.5, 0.5, 1.5, 8.5]);
        // One clock for all keeps its breaks.
        assert_eq!(
            super::running(&[1.0, 2.0, 7.0], &[0..2, 2..3]),
            [0.0, 1.0, 6.0]
        );
    }

    #[test]
    fn what_is_no_format_for_curves_is_refused_before_anything_is_written() {
        for name in ["a.csv", "a", "mcap"] {
            let error = curves_ending(Path::new(name)).unwrap_err();
            assert!(error.to_string().contains(".mcap or .parquet"), "{error}");
        }
        assert!(curves_ending(Path::new("a.MCAP")).is_ok());
    }
}
