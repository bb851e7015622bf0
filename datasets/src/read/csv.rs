//! CSV with a header.

use crate::assemble::{Columns, LabelRuns, assemble};
use crate::columns::{Layout, Role};
use crate::{Problem, ReadError, ReadOptions, Recording};
use csv::{ByteRecord, ErrorKind, ReaderBuilder, Trim};
use std::path::Path;

/// Reads CSV text. Commas, a header line, any order of columns; columns that are not used may
/// hold anything. Where a drive file gives the header, there is none in the text, and tabs or semicolons
/// may stand for the commas.
pub(crate) fn read(
    bytes: &[u8],
    file: &Path,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if text.iter().all(u8::is_ascii_whitespace) {
        return Err(Problem::Empty.in_file(file));
    }
    let given = options.columns.header();
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .has_headers(given.is_none())
        .delimiter(given.as_ref().map_or(b',', |_| delimiter(text)))
        .from_reader(text);
    let header = match given {
        Some(names) => names,
        None => header(&mut reader, file)?,
    };
    let layout = Layout::resolve(
        &header,
        &options.columns,
        options.dof,
        options.torque_needed,
        file,
    )?;
    let numeric: Vec<_> = layout
        .used
        .iter()
        .filter(|u| u.role != Role::Label)
        .collect();
    let label = layout.used.iter().find(|u| u.role == Role::Label);
    let mut numbers = vec![Vec::new(); numeric.len()];
    let mut labels = label.map(|_| LabelRuns::default());
    let mut lines = Vec::new();
    let mut record = ByteRecord::new();
    loop {
        let row = lines.len();
        match reader.read_byte_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(e) => return Err(broken_row(e, row, file)),
        }
        let line = record.position().map_or(0, csv::Position::line);
        if record.len() != header.len() {
            let problem = Problem::RowLength {
                expected: header.len() as u64,
                found: record.len() as u64,
            };
            let mut error = problem.in_file(file).at_row(row);
            error.line = Some(line);
            return Err(error);
        }
        for (column, values) in numeric.iter().zip(&mut numbers) {
            let cell = record.get(column.index).unwrap_or_default();
            let value = number(cell).map_err(|problem| {
                let mut error = problem.in_column(file, &column.name).at_row(row);
                error.line = Some(line);
                error
            })?;
            values.push(value);
        }
        if let (Some(column), Some(labels)) = (label, &mut labels) {
            labels.push(&String::from_utf8_lossy(
                record.get(column.index).unwrap_or_default(),
            ));
        }
        lines.push(line);
    }
    let columns = Columns {
        numbers,
        labels,
        lines: Some(lines),
        torque_filter: None,
    };
    assemble(&layout, columns, options, file)
}

/// What separates the cells of the first line.
fn delimiter(text: &[u8]) -> u8 {
    let mut first = text.iter().take_while(|b| **b != b'\n');
    let separator = first.find(|b| matches!(b, b',' | b';' | b'\t'));
    separator.copied().unwrap_or(b',')
}

fn header(reader: &mut csv::Reader<&[u8]>, file: &Path) -> Result<Vec<String>, ReadError> {
    let header = reader.byte_headers().map_err(|e| broken_row(e, 0, file))?;
    let names: Vec<String> = header
        .iter()
        .map(|c| String::from_utf8_lossy(c).into_owned())
        .collect();
    // A first line of numbers is data without a header.
    if names.iter().all(|n| n.parse::<f64>().is_ok()) {
        let start: String = names.join(",").chars().take(40).collect();
        return Err(Problem::NoHeader(start).in_file(file));
    }
    Ok(names)
}

fn number(cell: &[u8]) -> Result<f64, Problem> {
    let text = std::str::from_utf8(cell).map_err(|_| {
        Problem::NotANumber(String::from_utf8_lossy(cell).chars().take(40).collect())
    })?;
    if text.is_empty() {
        return Err(Problem::MissingValue);
    }
    let value: f64 = text
        .parse()
        .map_err(|_| Problem::NotANumber(text.chars().take(40).collect()))?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Problem::NotFinite(value))
    }
}

fn broken_row(error: csv::Error, row: usize, file: &Path) -> ReadError {
    let line = error.position().map(csv::Position::line);
    let problem = match error.into_kind() {
        ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => Problem::RowLength {
            expected: expected_len,
            found: len,
        },
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
