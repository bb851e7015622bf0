//! CSV text to be spoilt cell by cell.

use datasets::Recording;
use std::path::Path;

/// A table as text.
#[derive(Clone, Debug)]
pub struct Csv {
    /// Column names.
    pub header: Vec<String>,
    /// Cells.
    pub rows: Vec<Vec<String>>,
}

impl Csv {
    /// A recording as `datasets` writes it.
    ///
    /// # Panics
    /// When the temporary folder cannot be written to.
    pub fn of(recording: &Recording) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("recording.csv");
        datasets::write(recording, &path).expect("a recording can be written");
        let text = std::fs::read_to_string(&path).expect("it was just written");
        let mut lines = text
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        Self {
            header: lines.next().unwrap_or_default(),
            rows: lines.collect(),
        }
    }

    /// With another content of one cell; `row` counts data rows from 1, as messages do.
    ///
    /// # Panics
    /// Without such a cell.
    #[must_use]
    pub fn with(mut self, row: usize, column: &str, value: &str) -> Self {
        let place = self.place(column);
        value.clone_into(&mut self.rows[row - 1][place]);
        self
    }

    /// Without these columns.
    ///
    /// # Panics
    /// Without such a column.
    #[must_use]
    pub fn without(mut self, columns: &[&str]) -> Self {
        for column in columns {
            let place = self.place(column);
            self.header.remove(place);
            for row in &mut self.rows {
                row.remove(place);
            }
        }
        self
    }

    /// The whole text.
    pub fn text(&self) -> String {
        let lines = std::iter::once(&self.header).chain(&self.rows);
        lines.map(|cells| cells.join(",") + "\n").collect()
    }

    /// Writes it.
    ///
    /// # Panics
    /// When that fails.
    pub fn write(&self, path: &Path) {
        std::fs::write(path, self.text()).expect("writable");
    }

    fn place(&self, column: &str) -> usize {
        let place = self.header.iter().position(|name| name == column);
        place.unwrap_or_else(|| panic!("no column {column}"))
    }
}
