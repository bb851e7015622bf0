//! Tables, shown in a page or in the terminal.

use serde::Serialize;

/// End of a group of numbers that counts as the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Best {
    /// Smallest number is best, as for an error.
    Lowest,
    /// Largest number is best, as for R².
    Highest,
}

/// A column: its header and alignment.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub(crate) header: String,
    pub(crate) numeric: bool,
    pub(crate) best: Option<Best>,
}

impl Column {
    /// A left-aligned column of text.
    pub fn text(header: impl Into<String>) -> Self {
        Self {
            header: header.into(),
            numeric: false,
            best: None,
        }
    }

    /// Column of numbers, right-aligned; name the unit in the header, as in `RMSE / N·m`.
    pub fn number(header: impl Into<String>) -> Self {
        Self {
            numeric: true,
            ..Self::text(header)
        }
    }

    /// Marks the best number of the column.
    pub fn best(mut self, best: Best) -> Self {
        self.best = Some(best);
        self
    }
}

/// A cell: its text, and its value where it is a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    pub(crate) text: String,
    pub(crate) value: Option<f64>,
}

impl Cell {
    /// Cell of words.
    pub fn text(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            value: None,
        }
    }

    /// Cell with a number of `decimals` digits after the point; a number that is not finite shows as missing.
    pub fn number(value: f64, decimals: usize) -> Self {
        if !value.is_finite() {
            return Self::missing();
        }
        // Adding zero turns −0 into 0.
        let rounded = format!("{value:.decimals$}");
        let zero = rounded.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
        let text = if zero {
            rounded.trim_start_matches('-').to_owned()
        } else {
            rounded
        };
        Self {
            text,
            value: Some(value),
        }
    }

    /// Cell with a number that may not exist.
    pub fn optional(value: Option<f64>, decimals: usize) -> Self {
        value.map_or_else(Self::missing, |v| Self::number(v, decimals))
    }

    /// A number with `digits` significant digits, for columns of mixed magnitude.
    pub fn significant(value: f64, digits: usize) -> Self {
        let magnitude = value.abs();
        if value == 0.0 || !value.is_finite() {
            return Self::number(value, 0);
        }
        if !(1e-4..1e6).contains(&magnitude) {
            return Self {
                text: format!("{value:.*e}", digits.saturating_sub(1)),
                value: Some(value),
            };
        }
        let decimals = digits as i32 - 1 - magnitude.log10().floor() as i32;
        Self::number(value, decimals.max(0) as usize)
    }

    /// `value ± std`, rounded to two significant digits of the deviation.
    pub fn with_std(value: f64, std: f64) -> Self {
        if !(std.is_finite() && std > 0.0 && value.is_finite()) {
            return Self::significant(value, 4);
        }
        let decimals = (1 - std.log10().floor() as i32).clamp(0, 12) as usize;
        Self {
            text: format!("{value:.decimals$} ± {std:.decimals$}"),
            value: Some(value),
        }
    }

    /// Cell of the form `value [low, high]`; the value alone without an interval.
    pub fn with_interval(value: f64, interval: Option<[f64; 2]>, decimals: usize) -> Self {
        let cell = Self::number(value, decimals);
        match interval.filter(|_| cell.value.is_some()) {
            None => cell,
            Some(ends) => {
                let [low, high] = ends.map(|end| Self::number(end, decimals).text);
                Self {
                    text: format!("{} [{low}, {high}]", cell.text),
                    ..cell
                }
            }
        }
    }

    /// A figure that does not exist.
    pub fn missing() -> Self {
        Self::text("–")
    }
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(&self.text)
    }
}

/// A table with a header row, an optional caption and marked best numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub(crate) caption: Option<String>,
    pub(crate) columns: Vec<Column>,
    pub(crate) rows: Vec<Vec<Cell>>,
    pub(crate) emphasised: Vec<usize>,
}

impl Table {
    /// Table with these columns and no row yet.
    pub fn new(columns: impl IntoIterator<Item = Column>) -> Self {
        Self {
            columns: columns.into_iter().collect(),
            ..Self::default()
        }
    }

    /// Adds a row; missing cells are empty, cells beyond the last column are dropped.
    pub fn row(mut self, cells: impl IntoIterator<Item = Cell>) -> Self {
        self.push(cells);
        self
    }

    /// Adds a row to this table in place.
    pub fn push(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let mut row: Vec<Cell> = cells.into_iter().collect();
        row.resize(self.columns.len(), Cell::text(""));
        self.rows.push(row);
    }

    /// Sets the last row apart, as for a mean.
    pub fn emphasise_last(mut self) -> Self {
        if let Some(last) = self.rows.len().checked_sub(1) {
            self.emphasised.push(last);
        }
        self
    }

    /// Sets the caption of the table.
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = Some(caption.into());
        self
    }

    /// Whether each cell is the best of its column, rows × columns. Ties are all marked; a lone number is not.
    pub(crate) fn marks(&self) -> Vec<Vec<bool>> {
        let mut marks = vec![vec![false; self.columns.len()]; self.rows.len()];
        for (c, column) in self.columns.iter().enumerate() {
            if let Some(best) = column.best {
                let rows = self.rows.iter().enumerate();
                mark(&mut marks, best, rows.map(|(r, row)| ((r, c), &row[c])));
            }
        }
        marks
    }

    pub(crate) fn html(&self) -> HtmlTable {
        let marks = self.marks();
        let rows = self.rows.iter().zip(&marks).enumerate();
        HtmlTable {
            caption: self.caption.clone(),
            header: self
                .columns
                .iter()
                .map(|c| HtmlCell {
                    text: c.header.clone(),
                    class: if c.numeric { "n" } else { "t" },
                })
                .collect(),
            rows: rows
                .map(|(r, (cells, marks))| HtmlRow {
                    emphasised: self.emphasised.contains(&r),
                    cells: cells
                        .iter()
                        .zip(marks)
                        .zip(&self.columns)
                        .map(|((cell, best), column)| HtmlCell {
                            text: if cell.value.is_some() {
                                cell.text.replace('-', "−")
                            } else {
                                cell.text.clone()
                            },
                            class: match (column.numeric, best) {
                                (true, true) => "n best",
                                (true, false) => "n",
                                (false, true) => "t best",
                                (false, false) => "t",
                            },
                        })
                        .collect(),
                })
                .collect(),
        }
    }
}

fn mark<'a>(
    marks: &mut [Vec<bool>],
    best: Best,
    cells: impl Iterator<Item = ((usize, usize), &'a Cell)>,
) {
    let numbers: Vec<_> = cells
        .filter_map(|(at, cell)| cell.value.map(|v| (at, v, &cell.text)))
        .collect();
    let extreme = numbers.iter().max_by(|a, b| match best {
        Best::Lowest => b.1.total_cmp(&a.1),
        Best::Highest => a.1.total_cmp(&b.1),
    });
    if let (Some(extreme), true) = (extreme, numbers.len() > 1) {
        // What reads the same is a tie.
        for ((r, c), ..) in numbers.iter().filter(|n| n.2 == extreme.2) {
            marks[*r][*c] = true;
        }
    }
}

#[derive(Debug, Serialize)]
pub(crate) struct HtmlTable {
    pub(crate) caption: Option<String>,
    pub(crate) header: Vec<HtmlCell>,
    pub(crate) rows: Vec<HtmlRow>,
}

#[derive(Debug, Serialize)]
pub(crate) struct HtmlRow {
    pub(crate) emphasised: bool,
    pub(crate) cells: Vec<HtmlCell>,
}

#[derive(Debug, Serialize)]
pub(crate) struct HtmlCell {
    pub(crate) text: String,
    pub(crate) class: &'static str,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_and_minus_zero_is_zero() {
        assert_eq!(Cell::number(1.005, 1).text, "1.0");
        assert_eq!(Cell::number(-0.0001, 2).text, "0.00");
        assert_eq!(Cell::number(-0.006, 2).text, "-0.01");
        assert_eq!(Cell::number(f64::NAN, 2), Cell::missing());
        assert_eq!(Cell::optional(None, 2), Cell::missing());
        assert_eq!(Cell::significant(123.456, 3).text, "123");
        assert_eq!(Cell::significant(0.012_345, 3).text, "0.0123");
        assert_eq!(Cell::significant(0.000_012_34, 3).text, "1.23e-5");
        assert_eq!(Cell::significant(0.0, 3).text, "0");
        assert_eq!(Cell::with_std(12.3456, 0.123).text, "12.35 ± 0.12");
        assert_eq!(Cell::with_std(1234.5, 56.7).text, "1234 ± 57");
        let cell = Cell::with_interval(0.123, Some([-0.1, 0.2]), 2);
        assert_eq!(
            (&*cell.text, cell.value),
            ("0.12 [-0.10, 0.20]", Some(0.123))
        );
        assert_eq!(Cell::with_interval(0.123, None, 2).text, "0.12");
    }

    #[test]
    fn the_best_number_is_marked_by_row_and_by_column() {
        let table = Table::new([
            Column::text("method"),
            Column::number("NRMSE").best(Best::Lowest),
            Column::number("R²").best(Best::Highest),
        ])
        .row([
            Cell::text("a"),
            Cell::number(0.30, 2),
            Cell::number(91.0, 1),
        ])
        .row([
            Cell::text("b"),
            Cell::number(0.20, 2),
            Cell::number(96.0, 1),
        ])
        .row([Cell::text("c"), Cell::number(0.201, 2), Cell::missing()]);
        let expected = [
            [false, false, false],
            [false, true, true],
            [false, true, false],
        ];
        assert_eq!(table.marks(), expected);
    }

    #[test]
    fn rows_of_the_wrong_length_are_fitted_to_the_columns() {
        let table = Table::new([Column::text("a"), Column::text("b")])
            .row([Cell::text("1")])
            .row(["1", "2", "3"].map(Cell::text));
        assert!(table.rows.iter().all(|r| r.len() == 2));
    }
}
