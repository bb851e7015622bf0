//! What `train --list` prints.

use datasets::read::{TopicSummary, topics};
use model::failure::Failure;
use model::preparation::setup::SetupError;
use report::say;
use std::path::PathBuf;

/// Prints the topics of bags.
///
/// # Errors
/// A recording that cannot be read, or is no bag.
pub fn list(paths: &[PathBuf]) -> Result<(), Failure> {
    for path in paths {
        let found = topics(path).map_err(SetupError::from)?;
        say!("{}: {} topics", path.display(), found.len());
        found.iter().for_each(show);
    }
    Ok(())
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
