//! The source documents: each of their systems, whether it works here, the command, and the published figure
//! beside ours. `docs/sources.md` and a page for each document in `docs/sources/` are its output.

use serde::Deserialize;
use std::fmt::Write;

/// The rows, which are edited when a system changes.
const ROWS: &str = include_str!("sources.toml");

/// Whether a system of a source works here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum State {
    /// Working system, with a command and figures.
    Works,
    /// System that is partly reproduced.
    Partly,
    /// System that is not reproduced.
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

/// System of a source document, with its figures.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct System {
    name: String,
    state: State,
    /// Command that runs the system; empty where it has no command.
    #[serde(default)]
    command: String,
    /// Figure that the source states; "not in our copy" where its text has lost it.
    published: String,
    /// Figure that this project reaches.
    #[serde(default)]
    ours: String,
}

/// Source document, such as a paper or manual.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    name: String,
    title: String,
    /// Name of the document's page.
    page: String,
    /// Content of the document, in a sentence.
    about: String,
    /// Differences between source and project, with the reasons.
    differs: Vec<String>,
    /// Reproductions of its experiments.
    #[serde(default)]
    experiment: Vec<Experiment>,
    system: Vec<System>,
}

/// Commands that reproduce an experiment of a source.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Experiment {
    what: String,
    /// Commands that reproduce the experiment, one a line.
    commands: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sources {
    introduction: String,
    document: Vec<Document>,
}

/// Reason why a page of the sources cannot be printed.
#[derive(Debug, thiserror::Error)]
pub enum SourcesError {
    /// The rows built into the program are damaged, which a test excludes.
    #[error("the table of sources is damaged: {0}")]
    Rows(#[from] toml::de::Error),
    /// A page that does not exist.
    #[error("no source document is called {name}; there are {pages}")]
    Page {
        /// Name of the page asked for.
        name: String,
        /// Names of the existing pages.
        pages: String,
    },
}

/// The table of all documents as Markdown.
///
/// # Errors
/// [`SourcesError::Rows`].
pub fn markdown() -> Result<String, SourcesError> {
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
        let Document {
            name, title, page, ..
        } = document;
        let _ = writeln!(
            out,
            "\n## {name}\n{title} [What it does, and what differs here](sources/{page}.md).\n"
        );
        rows(&document.system, &mut out);
    }
    Ok(out)
}

/// Page of one document as Markdown: content, reproductions, figures side by side, differences.
///
/// # Errors
/// [`SourcesError`].
pub fn page(name: &str) -> Result<String, SourcesError> {
    let sources: Sources = toml::from_str(ROWS)?;
    let Some(document) = sources.document.iter().find(|d| d.page == name) else {
        let pages: Vec<&str> = sources.document.iter().map(|d| d.page.as_str()).collect();
        return Err(SourcesError::Page {
            name: name.to_owned(),
            pages: pages.join(", "),
        });
    };
    // Links of the table are relative to the folder above.
    let title = document.title.replace("](", "](../");
    let mut out = format!("# {}\n{title}\n\n", document.name);
    let _ = writeln!(out, "{}\n\n## Its experiments, here", document.about.trim());
    for experiment in &document.experiment {
        let _ = writeln!(out, "{}\n", experiment.what);
        for command in experiment.commands.trim().lines() {
            let _ = writeln!(out, "    {command}");
        }
        out.push('\n');
    }
    if document.experiment.is_empty() {
        out.push_str("None yet.\n\n");
    }
    out.push_str("## Figures side by side\n");
    rows(&document.system, &mut out);
    out.push_str("\n## What differs, and why\n");
    for difference in &document.differs {
        let _ = writeln!(out, "- {difference}");
    }
    let _ = writeln!(
        out,
        "\nAll documents: [sources.md](../sources.md). This page is printed by `eval --sources {name}`."
    );
    Ok(out)
}

/// The systems of a document as a table.
fn rows(systems: &[System], out: &mut String) {
    let dash = |text: &str| {
        if text.is_empty() {
            "–".to_owned()
        } else {
            text.to_owned()
        }
    };
    out.push_str("| system | state | command | published | here |\n|---|---|---|---|---|\n");
    for system in systems {
        let command = match system.command.as_str() {
            "" => dash(""),
            command => format!("`{command}`"),
        };
        let _ = writeln!(
            out,
            "| {} | {} | {command} | {} | {} |",
            system.name,
            system.state.name(),
            system.published,
            dash(&system.ours)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_system_is_there_and_says_what_it_claims() {
        let sources: Sources = toml::from_str(ROWS).expect("the table is valid");
        let counts: Vec<usize> = sources.document.iter().map(|d| d.system.len()).collect();
        assert_eq!(counts, [11, 6, 4, 3, 4]);
        for document in &sources.document {
            let page = page(&document.page).expect("the page is there");
            assert!(page.contains(document.about.trim()) && !document.differs.is_empty());
            let works = document.system.iter().any(|s| s.state != State::Missing);
            assert_eq!(!document.experiment.is_empty(), works, "{}", document.name);
        }
        assert!(page("no such document").is_err());
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
