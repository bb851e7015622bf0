//! Tables as aligned plain text.

use crate::Table;
use std::fmt::Write;
use unicode_width::UnicodeWidthStr;

/// Text in lines of at most `width` columns, all after `indent`, those after the first two columns further in;
/// a word that is longer stands alone. Every line ends with a line break, control characters are shown as `?`.
pub fn wrapped(text: &str, width: usize, indent: &str) -> String {
    let mut out = String::new();
    let mut line = indent.to_owned();
    let mut empty = true;
    for word in printable(text).split_whitespace() {
        if !empty && line.width() + 1 + word.width() > width {
            let _ = writeln!(out, "{line}");
            line = format!("{indent}  ");
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    let _ = writeln!(out, "{line}");
    out
}

impl Table {
    /// The table as plain text, aligned by display width; the best numbers carry a `*`.
    ///
    /// Every line ends with a line break. Control characters (a file's name could carry escape
    /// sequences) are shown as `?`.
    pub fn to_text(&self) -> String {
        let marks = self.marks();
        let columns = self.columns.len();
        // A column with a mark keeps one place for it in every row, so that digits stay aligned.
        let marked: Vec<bool> = (0..columns)
            .map(|c| marks.iter().any(|row| row[c]))
            .collect();
        let header: Vec<String> = (0..columns)
            .map(|c| pad_mark(printable(&self.columns[c].header), marked[c], false))
            .collect();
        let body: Vec<Vec<String>> = std::iter::zip(&self.rows, &marks)
            .map(|(row, marks)| {
                (0..columns)
                    .map(|c| pad_mark(printable(&row[c].text), marked[c], marks[c]))
                    .collect()
            })
            .collect();
        let widths: Vec<usize> = (0..columns)
            .map(|c| {
                let lines = std::iter::once(&header).chain(&body);
                lines.map(|line| line[c].width()).max().unwrap_or(0)
            })
            .collect();

        let mut text = String::new();
        if let Some(caption) = &self.caption {
            let _ = writeln!(text, "{}", printable(caption));
        }
        let mut line = |cells: &[String]| {
            let mut out = String::new();
            for (c, cell) in cells.iter().enumerate() {
                let gap = " ".repeat(widths[c] - cell.width());
                let separator = if c == 0 { "" } else { "  " };
                let _ = if self.columns[c].numeric {
                    write!(out, "{separator}{gap}{cell}")
                } else {
                    write!(out, "{separator}{cell}{gap}")
                };
            }
            let _ = writeln!(text, "{}", out.trim_end());
        };
        let rule: Vec<String> = widths.iter().map(|&w| "─".repeat(w)).collect();
        line(&header);
        line(&rule);
        for (r, row) in body.iter().enumerate() {
            if self.emphasised.contains(&r) && r > 0 {
                line(&rule);
            }
            line(row);
        }
        text
    }
}

fn pad_mark(text: String, column_is_marked: bool, best: bool) -> String {
    match (column_is_marked, best) {
        (true, true) => text + "*",
        (true, false) => text + " ",
        (false, _) => text,
    }
}

fn printable(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { '?' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::{Best, Cell, Column, Table};
    use proptest::prelude::*;
    use unicode_width::UnicodeWidthStr;

    #[test]
    fn columns_are_aligned_by_display_width() {
        let table = Table::new([
            Column::text("joint"),
            Column::number("q\u{307} / rad/s"),
            Column::number("NRMSE").best(Best::Lowest),
        ])
        .caption("Scores")
        .row([
            Cell::text("肩"),
            Cell::number(1.5, 1),
            Cell::number(0.334, 3),
        ])
        .row([
            Cell::text("elbow"),
            Cell::number(-12.25, 2),
            Cell::number(0.1, 3),
        ])
        .row([Cell::text("mean"), Cell::missing(), Cell::number(0.217, 3)])
        .emphasise_last();
        let expected = "\
Scores
joint  q\u{307} / rad/s  NRMSE
─────  ─────────  ──────
肩           1.5  0.334
elbow     -12.25  0.100*
─────  ─────────  ──────
mean           –  0.217
";
        assert_eq!(table.to_text(), expected);
    }

    proptest! {
        #[test]
        fn lines_fit_the_rule_and_hold_no_control_character(
            cells in proptest::collection::vec(("\\PC{0,8}", -1e6..1e6_f64), 1..6),
            odd in "\\PC{0,3}\u{1b}\\[31m",
        ) {
            let mut table = Table::new([Column::text(odd), Column::number("value").best(Best::Lowest)]);
            for (text, value) in cells {
                table.push([Cell::text(text), Cell::number(value, 2)]);
            }
            let text = table.to_text();
            prop_assert!(!text.chars().any(|c| c.is_control() && c != '\n'));
            let rule = text.lines().nth(1).unwrap().width();
            for line in text.lines() {
                prop_assert!(line.width() <= rule);
            }
        }
    }
}
