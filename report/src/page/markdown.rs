//! The page as Markdown, for a README or a merge request.

use super::{Block, Page};
use crate::Table;
use crate::table::HtmlTable;
use std::fmt::Write;

impl Page {
    /// The page as Markdown (CommonMark with tables): the same bytes for the same content. Figures are left
    /// out; blocks that a reader of the page would open are shown open.
    pub fn to_markdown(&self) -> String {
        let mut out = format!("# {}\n", plain(&self.title));
        if !self.subtitle.is_empty() {
            paragraph(&mut out, &plain(&self.subtitle));
        }
        let figures = self.key_figures.iter().map(|f| {
            let note = match f.note.as_str() {
                "" => String::new(),
                note => format!(" ({note})"),
            };
            format!("{}: {}{note}", f.label, f.value)
        });
        list(&mut out, figures);
        for section in &self.sections {
            blocks(&mut out, &section.heading, 2, &section.blocks);
        }
        if !self.footer.is_empty() {
            paragraph(&mut out, &plain(&self.footer));
        }
        out
    }
}

impl Table {
    /// The table alone as Markdown, for a README: the best numbers in bold, a line break at the end.
    pub fn to_markdown(&self) -> String {
        let mut out = String::new();
        table(&mut out, &self.html());
        out.trim_start().to_owned()
    }
}

/// A heading with the blocks below it.
fn blocks(out: &mut String, heading: &str, level: usize, blocks_below: &[Block]) {
    paragraph(out, &format!("{} {}", "#".repeat(level), plain(heading)));
    for block in blocks_below {
        match block {
            Block::Paragraph { text } => paragraph(out, &plain(text)),
            Block::Heading { text } => {
                paragraph(out, &format!("{} {}", "#".repeat(level + 1), plain(text)));
            }
            Block::Callout { title, text, .. } => {
                let callout = format!("> **{}** {}", plain(title), plain(text));
                paragraph(out, callout.trim_end());
            }
            Block::List { items } => list(out, items.iter().cloned()),
            Block::Pairs { pairs } => list(out, pairs.iter().map(|(k, v)| format!("{k}: {v}"))),
            Block::Code { text } => code(out, text),
            Block::Table { table: t } => table(out, t),
            Block::Figures { .. } => {}
            Block::Details { summary, blocks: b } => blocks(out, summary, level + 1, b),
        }
    }
}

fn paragraph(out: &mut String, text: &str) {
    let _ = writeln!(out, "\n{text}");
}

fn list(out: &mut String, items: impl Iterator<Item = String>) {
    for (k, item) in items.enumerate() {
        let gap = if k == 0 { "\n" } else { "" };
        let _ = writeln!(out, "{gap}- {}", plain(&item));
    }
}

/// A block of code between fences that are longer than any run of backticks in it.
fn code(out: &mut String, text: &str) {
    let runs = text.split(|c| c != '`').map(str::len);
    let fence = "`".repeat(runs.max().unwrap_or(0).max(2) + 1);
    let _ = writeln!(out, "\n{fence}\n{}\n{fence}", text.trim_end_matches('\n'));
}

fn table(out: &mut String, table: &HtmlTable) {
    if let Some(caption) = &table.caption {
        paragraph(out, &plain(caption));
    }
    let cell = |text: &str| plain(text).replace('|', "\\|");
    let header: Vec<String> = table.header.iter().map(|c| cell(&c.text)).collect();
    let rule: Vec<&str> = table
        .header
        .iter()
        .map(|c| if c.class == "n" { "---:" } else { "---" })
        .collect();
    let _ = writeln!(out, "\n| {} |\n|{}|", header.join(" | "), rule.join("|"));
    for row in &table.rows {
        let cells = row.cells.iter().map(|c| {
            let text = cell(&c.text);
            if c.class.ends_with("best") {
                format!("**{text}**")
            } else {
                text
            }
        });
        let cells: Vec<String> = cells.collect();
        let _ = writeln!(out, "| {} |", cells.join(" | "));
    }
}

/// Text on one line with nothing in it that Markdown takes for a sign of its own.
fn plain(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut out = String::with_capacity(text.len());
    for (k, c) in words.join(" ").chars().enumerate() {
        let begins_a_block = k == 0 && matches!(c, '#' | '>' | '-' | '+' | '~' | '=');
        if begins_a_block || matches!(c, '\\' | '`' | '*' | '<') {
            out.push('\\');
        }
        out.push(if c.is_control() { '?' } else { c });
    }
    out
}

#[cfg(test)]
mod tests {
    use crate::{Best, Cell, Column, KeyFigure, Page, Section, Table, Tone};

    #[test]
    fn every_block_in_its_form() {
        let table = Table::new([
            Column::text("model"),
            Column::number("NRMSE").best(Best::Lowest),
        ])
        .caption("Scores")
        .row([Cell::text("a|b"), Cell::number(0.2, 1)])
        .row([Cell::text("c*d"), Cell::number(-0.1, 1)]);
        let page = Page::new("Title")
            .subtitle("of\nthis")
            .key_figure(KeyFigure::new("mean", "0.1").note("all"))
            .section(
                Section::new("First")
                    .paragraph("# no heading <b>")
                    .list(["one", "two"])
                    .table(table)
                    .callout(Tone::Good, "Well", "done")
                    .details(Section::new("More").code("x = `1`\n").pairs([("k", "v")])),
            )
            .footer("end");
        let expected = "# Title

of this

- mean: 0.1 (all)

## First

\\# no heading \\<b>

- one
- two

Scores

| model | NRMSE |
|---|---:|
| a\\|b | 0.2 |
| c\\*d | **−0.1** |

> **Well** done

### More

```
x = `1`
```

- k: v

end
";
        assert_eq!(page.to_markdown(), expected);
    }

    #[test]
    fn a_table_alone() {
        let table = Table::new([Column::text("a"), Column::number("b").best(Best::Lowest)])
            .row([Cell::text("x"), Cell::number(1.0, 1)])
            .row([Cell::text("y"), Cell::number(2.0, 1)]);
        let expected = "| a | b |\n|---|---:|\n| x | **1.0** |\n| y | 2.0 |\n";
        assert_eq!(table.to_markdown(), expected);
    }

    #[test]
    fn fences_are_longer_than_what_they_hold() {
        let page = Page::new("t").section(Section::new("s").code("````\n"));
        assert!(page.to_markdown().contains("\n`````\n````\n`````\n"));
    }
}
