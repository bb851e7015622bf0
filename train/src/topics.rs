//! Output of `train --list`: topics of a bag, features of a data set.

use datasets::read::{DatasetSummary, TopicSummary, dataset, topics};
use model::failure::Failure;
use model::preparation::setup::SetupError;
use report::say;
use std::path::{Path, PathBuf};

/// Prints the topics of bags and the features of data sets.
///
/// # Errors
/// A recording that cannot be read, or is neither.
pub fn list(paths: &[PathBuf]) -> Result<(), Failure> {
    for path in paths {
        if let Some(found) = dataset(path).map_err(SetupError::from)? {
            show_dataset(path, &found);
            continue;
        }
        let found = topics(path).map_err(SetupError::from)?;
        let topics = if found.len() == 1 { "topic" } else { "topics" };
        say!("{}: {} {topics}", path.display(), found.len());
        found.iter().for_each(show);
    }
    Ok(())
}

fn show_dataset(path: &Path, found: &DatasetSummary) {
    let count = |number: Option<u64>, of: &str| match number {
        Some(number) => format!(", {number} {of}"),
        None => String::new(),
    };
    let rate = found
        .rate_hz
        .map_or(String::new(), |r| format!(", {r:.1} Hz"));
    say!(
        "{}: data set of {} features{}{}{rate}",
        path.display(),
        found.features.len(),
        count(found.episodes, "episodes"),
        count(found.frames, "frames"),
    );
    for feature in &found.features {
        say!("  {} ({})", feature.name, feature.kind);
        match feature.columns.as_slice() {
            [] => say!("    no numbers"),
            columns => say!("    columns: {}", columns.join(", ")),
        }
    }
}

fn show(topic: &TopicSummary) {
    let rate = match topic.rate_hz {
        Some(rate) => format!(", {rate:.1} Hz"),
        None => String::new(),
    };
    say!(
        "  {} ({}): {} messages{rate}",
        topic.topic,
        topic.kind,
        topic.messages
    );
    for (what, names) in [("joints", &topic.joints), ("fields", &topic.fields)] {
        if !names.is_empty() {
            say!("    {what}: {}", names.join(", "));
        }
    }
    if let Some(reason) = &topic.unreadable {
        say!("    cannot be read: {reason}");
    }
}
