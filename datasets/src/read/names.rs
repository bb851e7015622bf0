//! Joints that a file names, found before the layout of the file is known.

use super::{Format, bag, csv, lerobot, npz, parquet};
use std::path::Path;

/// Names of a recording's columns, or of its joints where it is a bag; none where they cannot be read.
fn names(path: &Path) -> Option<Vec<String>> {
    if let Some(summary) = lerobot::dataset(path).ok()? {
        let features = summary.features.into_iter();
        return Some(features.flat_map(|f| f.columns).collect());
    }
    let format = Format::of(path).ok()?;
    if format == Format::Bag {
        let topics = bag::topics(path).ok()?.into_iter();
        return Some(topics.flat_map(|t| t.joints).collect());
    }
    let bytes = std::fs::read(path).ok()?;
    match format {
        Format::Csv => csv::names(&bytes),
        Format::Parquet => parquet::names(&bytes),
        Format::Npz => npz::names(&bytes, path),
        Format::Mat | Format::Bag => None,
    }
}

/// Words of a name, in lower case: runs of letters and of digits, broken at a capital behind a small letter.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = ' ';
    for c in name.chars() {
        if c.is_alphanumeric() {
            let goes_on = last.is_alphanumeric()
                && last.is_ascii_digit() == c.is_ascii_digit()
                && !(last.is_lowercase() && c.is_uppercase());
            let small = c.to_lowercase();
            match words.last_mut() {
                Some(word) if goes_on => word.extend(small),
                _ => words.push(small.collect()),
            }
        }
        last = c;
    }
    words
}

/// Names among `joints` that a recording has, in the order of `joints`. A name must stand in at least two of the
/// columns, as a position and a torque, or in a bag. Empty where the columns are numbered.
pub fn named_joints(path: &Path, joints: &[String]) -> Vec<String> {
    let Some(columns) = names(path) else {
        return Vec::new();
    };
    let bag =
        columns.iter().any(|c| joints.contains(c)) && matches!(Format::of(path), Ok(Format::Bag));
    let least = if bag { 1 } else { 2 };
    let known: Vec<Vec<String>> = joints.iter().map(|j| words(j)).collect();
    let mut times = vec![0; joints.len()];
    for column in &columns {
        let column = words(column);
        // Of two joints whose names both stand in a column's the longer is meant.
        let holds = |joint: &Vec<String>| {
            !joint.is_empty() && column.windows(joint.len()).any(|part| part == joint)
        };
        let of = (0..joints.len()).filter(|&j| holds(&known[j]));
        if let Some(j) = of.max_by_key(|&j| known[j].len()) {
            times[j] += 1;
        }
    }
    let named = joints.iter().zip(times).filter(|(_, n)| *n >= least);
    named.map(|(joint, _)| joint.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(header: &str, joints: &[&str]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        std::fs::write(&path, format!("{header}\n")).unwrap();
        let joints: Vec<String> = joints.iter().map(|&j| j.to_owned()).collect();
        named_joints(&path, &joints).join(" ")
    }

    #[test]
    fn joints_are_found_in_whatever_style() {
        let arm = ["torso", "shoulder_pan", "wrist_2_joint", "wrist_2"];
        assert_eq!(
            named("time,q_shoulder_pan,tau_shoulder_pan,temp_torso", &arm),
            "shoulder_pan"
        );
        assert_eq!(
            named(
                "t;wrist_2_joint.pos;wrist2Joint.effort;shoulderPan/q;shoulder-pan/tau",
                &arm
            ),
            "shoulder_pan wrist_2_joint"
        );
        assert_eq!(named("time,q1,q2,tau1,tau2", &["joint1", "joint2"]), "");
        assert_eq!(named("time,q1,q2,tau1,tau2", &["q1", "q2"]), "");
    }
}
