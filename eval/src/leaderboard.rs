//! `eval --leaderboard`: models side by side.

use model::directory::json;
use model::failure::Failure;
use model::leaderboard::{Contest, hold, page, summary, table};
use report::{say, say_text};
use std::path::PathBuf;

/// Output files of the page; each form with a path is written.
pub struct Places<'a> {
    pub html: Option<&'a PathBuf>,
    pub markdown: Option<&'a PathBuf>,
    pub json: Option<&'a PathBuf>,
}

/// Form in which the board is printed.
#[derive(Clone, Copy)]
pub enum Printed {
    /// The rows with their costs.
    Rows,
    /// The rows as a Markdown table that another run prints again.
    Table,
    /// No output on the terminal.
    Nothing,
}

/// Holds the contest, writes its page and prints the table.
pub fn run(contest: &Contest, places: &Places, printed: Printed) -> Result<(), Failure> {
    let board = hold(contest)?;
    let page = page(&board);
    if let Some(path) = places.json {
        report::write_atomic(path, json(&board))?;
    }
    if let Some(path) = places.html {
        report::write_atomic(path, page.render())?;
    }
    if let Some(path) = places.markdown {
        report::write_atomic(path, page.to_markdown())?;
    }
    if let Printed::Table = printed {
        say_text!(summary(&board).to_markdown());
    }
    if let Printed::Rows = printed {
        let (recording, samples, robot) = (&board.recording, board.samples, &board.robot);
        say!("{recording}: {samples} samples, robot {robot}\n");
        say_text!(table(&board).to_text());
        let over = &board.intervals;
        say!(
            "\nIn brackets: 95 % intervals over {} {}. µs per sample are measured now.",
            over.stretches,
            over.over
        );
        let outputs = [places.json, places.html, places.markdown];
        report::write::say_written(outputs.into_iter().flatten());
    }
    Ok(())
}
