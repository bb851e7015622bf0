//! The table of source documents: every system of theirs, whether it works here, by which command, and the published figure beside
//! ours. `docs/sources.md` is what it prints.

use serde::Deserialize;
use std::fmt::Write;

/// The rows: the one place to change when a system does.
const ROWS: &str = include_str!("sources.toml");

/// Whether a system of a source works here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum State {
    /// With a command and figures.
    Works,
    /// Some of it.
    Partly,
    /// Not at all.
    Missing,
}

impl State {
    fn name(self) -> &'static str {
        match self {
            Self::Works => "works",
            Self::Partly => "partly",
            Self::Missing => "missing",
        }
    }
}

/// A system of a source.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct System {
    name: String,
    state: State,
    /// What runs it; empty where nothing does.
    #[serde(default)]
    command: String,
    /// The source's figure; "not in our copy" where the text has lost it.
    published: String,
    /// Ours.
    #[serde(default)]
    ours: String,
}

/// A source document.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    name: String,
    title: String,
    system: Vec<System>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sources {
    introduction: String,
    document: Vec<Document>,
}

/// The table as Markdown.
///
/// # Errors
/// The rows built into the program are damaged, which a test excludes.
pub fn markdown() -> Result<String, toml::de::Error> {
    let sources: Sources = toml::from_str(ROWS)?;
    let systems = || sources.document.iter().flat_map(|d| &d.system);
    let count = |state| systems().filter(|s| s.state == state).count();
    let mut out = String::from("# Source documents\n\n");
    let _ = writeln!(out, "{}\n", sources.introduction.trim());
    let _ = writeln!(
        out,
        "{} systems: {} work, {} partly, {} missing.",
        systems().count(),
        count(State::Works),
        count(State::Partly),
        count(State::Missing)
    );
    for document in &sources.document {
        let _ = writeln!(out, "\n## {}\n{}\n", document.name, document.title);
        out.push_str("| system | state | command | published | here |\n|---|---|---|---|---|\n");
        for system in &document.system {
            let command = if system.command.is_empty() {
                "–".to_owned()
            } else {
                format!("`{}`", system.command)
            };
            let ours = if system.ours.is_empty() {
                "–"
            } else {
                &system.ours
            };
            let _ = writeln!(
                out,
                "| {} | {} | {command} | {} | {ours} |",
                system.name,
                system.state.name(),
                system.published
            );
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_system_is_there_and_says_what_it_claims() {
        let sources: Sources = toml::from_str(ROWS).expect("the table is valid");
        let counts: Vec<usize> = sources.document.iter().map(|d| d.system.len()).collect();
        assert_eq!(counts, [11, 6, 4, 3, 4]);
        for system in sources.document.iter().flat_map(|d| &d.system) {
            let claimed = system.state != State::Missing;
            assert_eq!(!system.command.is_empty(), claimed, "{}", system.name);
            assert_eq!(!system.ours.is_empty(), claimed, "{}", system.name);
            assert!(
                !system.published.is_empty() && !system.published.contains('|'),
                "{}",
                system.name
            );
        }
    }
}
