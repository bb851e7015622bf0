//! Text in columns with a header.

use super::text::Style;
use crate::assemble::{Columns, LabelRuns, assemble};
use crate::columns::{Layout, Role};
use crate::{Problem, ReadError, ReadOptions, Recording, stamps};
use csv::{ByteRecord, ErrorKind, ReaderBuilder, Trim};
use std::collections::BTreeSet;
use std::path::Path;

/// Reads a table in text: a header line and any order of columns, between commas, semicolons, tabs or blanks, with
/// points or (but for commas) decimal commas. Columns that are not used may hold anything. A text whose header the
/// drive file gives has no header line.
pub(crate) fn read(
    bytes: &[u8],
    file: &Path,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if text.iter().all(u8::is_ascii_whitespace) {
        return Err(Problem::Empty.in_file(file));
    }
    let style = Style::of(text);
    let (text, skipped) = style.body(text);
    let given = options.columns.header();
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .has_headers(false)
        .flexible(true)
        .delimiter(style.delimiter())
        .from_reader(&*text);
    let mut record = ByteRecord::new();
    let mut header = match given {
        Some(names) => names,
        None => header(&mut reader, &mut record, file)?,
    };
    let mut layout = None;
    let mut numbers = Vec::new();
    let mut labels = None;
    let mut empty = BTreeSet::new();
    let (mut lines, mut blank) = (Vec::new(), 0);
    loop {
        let row = lines.len();
        match reader.read_byte_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(e) => return Err(broken_row(e, row, file)),
        }
        let line = record.position().map_or(0, |p| line_at(&text, p)) + skipped;
        if record.iter().all(<[u8]>::is_empty) {
            blank += 1;
            continue;
        }
        let at = |error: ReadError| ReadError {
            line: Some(line),
            ..error.at_row(row)
        };
        let Layout { used, .. } = match &mut layout {
            Some(layout) => layout,
            None => {
                // Tables with row names have none over these.
                if record.len() == header.len() + 1 && !record[header.len()].is_empty() {
                    header.insert(0, String::new());
                }
                let found = Layout::resolve(&header, options, file)?;
                let is_label = |role: Role| role == Role::Label;
                numbers = vec![Vec::new(); found.used.iter().filter(|u| !is_label(u.role)).count()];
                labels = found
                    .used
                    .iter()
                    .any(|u| is_label(u.role))
                    .then(LabelRuns::default);
                layout.insert(found)
            }
        };
        let trailing = record.len() == header.len() + 1 && record[header.len()].is_empty();
        if record.len() != header.len() && !trailing {
            let problem = Problem::RowLength {
                expected: header.len() as u64,
                found: record.len() as u64,
            };
            return Err(at(problem.in_file(file)));
        }
        let mut place = 0;
        for column in used.iter() {
            let cell = record.get(column.index).unwrap_or_default();
            if let (Role::Label, Some(labels)) = (column.role, &mut labels) {
                labels.push(&String::from_utf8_lossy(cell));
                continue;
            }
            if cell.is_empty() {
                empty.insert((place, row));
            }
            let value = number(cell, &style, column.role == Role::Time);
            let value = value.map_err(|problem| at(problem.in_column(file, &column.name)))?;
            numbers[place].push(value);
            place += 1;
        }
        lines.push(line);
    }
    let mut layout = match layout {
        Some(layout) => layout,
        None => Layout::resolve(&header, options, file)?,
    };
    if blank > 0 {
        layout
            .notes
            .push(format!("{blank} blank rows are left out"));
    }
    let columns = Columns {
        numbers,
        empty,
        labels,
        lines: Some(lines),
        torque_filter: None,
    };
    assemble(&layout, columns, options, file)
}

fn header(
    reader: &mut csv::Reader<&[u8]>,
    record: &mut ByteRecord,
    file: &Path,
) -> Result<Vec<String>, ReadError> {
    reader
        .read_byte_record(record)
        .map_err(|e| broken_row(e, 0, file))?;
    let mut names: Vec<String> = record
        .iter()
        .map(|c| String::from_utf8_lossy(c).into_owned())
        .collect();
    // A separator behind the last name.
    if names.len() > 1 && names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    // A first line of numbers is data without a header.
    let numeric = |n: &String| n.replace(',', ".").parse::<f64>().is_ok();
    if names.iter().all(numeric) {
        let start: String = names.join(",").chars().take(40).collect();
        return Err(Problem::NoHeader(start).in_file(file));
    }
    Ok(names)
}

/// Number in a cell, NaN for an empty one. A cell of a time column is read as a stamp, s.
fn number(cell: &[u8], style: &Style, time: bool) -> Result<f64, Problem> {
    let odd = || Problem::NotANumber(String::from_utf8_lossy(cell).chars().take(40).collect());
    let text = std::str::from_utf8(cell).map_err(|_| odd())?;
    if text.is_empty() {
        return Ok(f64::NAN);
    }
    let plain = text.parse::<f64>().ok();
    let value = plain.or_else(|| style.decimal(text)).or_else(|| {
        // What pandas, R and SQL write where there is no value.
        let none = matches!(text, "NA" | "N/A" | "null" | "NULL" | "None" | "<NA>");
        none.then_some(f64::NAN)
    });
    value
        .or_else(|| time.then(|| stamps::from_text(text)).flatten())
        .ok_or_else(odd)
}

/// Line of a row, from 1. Its position may stand before line feeds: those of blank lines, and that of a row before which ends
/// in a carriage return and a line feed.
fn line_at(text: &[u8], position: &csv::Position) -> u64 {
    let rest = text.get(position.byte() as usize..).unwrap_or_default();
    let ends = rest.iter().take_while(|b| matches!(b, b'\r' | b'\n'));
    position.line() + ends.filter(|b| **b == b'\n').count() as u64
}

fn broken_row(error: csv::Error, row: usize, file: &Path) -> ReadError {
    let line = error.position().map(csv::Position::line);
    let problem = match error.into_kind() {
        ErrorKind::Io(e) => Problem::Io(e),
        other => Problem::Damaged {
            format: "CSV",
            detail: format!("{other:?}"),
        },
    };
    let mut error = problem.in_file(file).at_row(row);
    error.line = line;
    error
}

/// Names in the header of a table, whatever stands between them.
pub(super) fn names(bytes: &[u8]) -> Option<Vec<String>> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let line = text
        .split(|&b| b == b'\n')
        .find(|line| !line.trim_ascii().is_empty())?;
    let line = std::str::from_utf8(line).ok()?;
    let names = line
        .split([',', ';', '\t'])
        .map(|n| n.trim().trim_matches('"').to_owned());
    Some(names.collect())
}
