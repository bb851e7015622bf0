//! Values of a session's columns in a temporary file. A further search reads them, which takes a fraction of the time of
//! evaluating them again, and they take no memory.

use crate::search::dictionary::Values;
use ndarray::Array1;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Largest size of the file, bytes. A recording with more is evaluated again for each search.
const LARGEST: usize = 2 << 30;

/// Columns that all dictionaries of a session begin with, and their values once they have been evaluated.
pub struct Kept {
    /// Number of these columns.
    columns: usize,
    stored: OnceLock<Stored>,
}

/// Values on the fitted rows in a file without a name, which the system removes with the process.
pub struct Stored {
    file: Mutex<File>,
    /// Column and joint of each vector of a part, in the order of the file.
    places: Vec<(usize, usize)>,
    /// Offset in the file, bytes, and number of rows of each part.
    parts: Vec<(usize, usize)>,
}

/// Values that are being stored, part by part.
pub struct Storing {
    file: BufWriter<File>,
    columns: usize,
    places: Vec<(usize, usize)>,
    parts: Vec<(usize, usize)>,
}

impl Kept {
    /// No values of so many columns.
    pub fn new(columns: usize) -> Self {
        Self {
            columns,
            stored: OnceLock::new(),
        }
    }

    /// Number of columns whose values need no evaluation.
    pub fn known(&self) -> usize {
        self.stored.get().map_or(0, |_| self.columns)
    }

    /// The values, where they are stored.
    pub fn stored(&self) -> Option<&Stored> {
        self.stored.get()
    }

    /// Storage of `vectors` of `rows` values each. None where they are stored already, are too many, or where there is
    /// no room for temporary files.
    pub fn storing(&self, vectors: usize, rows: usize) -> Option<Storing> {
        let small = vectors * rows * size_of::<f64>() <= LARGEST;
        (small && self.stored.get().is_none()).then_some(())?;
        Some(Storing {
            file: BufWriter::new(tempfile::tempfile().ok()?),
            columns: self.columns,
            places: Vec::new(),
            parts: Vec::new(),
        })
    }

    /// Takes values that were stored to the end.
    pub fn take(&self, storing: Storing) {
        let Storing {
            file,
            places,
            parts,
            ..
        } = storing;
        if let Ok(file) = file.into_inner() {
            // Another search may have stored the same values meanwhile.
            _ = self.stored.set(Stored {
                file: Mutex::new(file),
                places,
                parts,
            });
        }
    }
}

impl Storing {
    /// Stores a part's values, each vector of the same number of rows. Those of columns of one search alone are left out.
    ///
    /// # Errors
    /// No room on the disk.
    pub fn add(&mut self, values: &Values) -> io::Result<()> {
        let offset = self.parts.last().map_or(0, |(offset, rows)| {
            offset + rows * self.places.len() * size_of::<f64>()
        });
        let shared = || values.iter().filter(|v| v.0 < self.columns);
        self.parts
            .push((offset, shared().next().map_or(0, |v| v.2.len())));
        if self.places.is_empty() {
            self.places = shared().map(|v| (v.0, v.1)).collect();
        }
        for (_, _, x) in values.iter().filter(|v| v.0 < self.columns) {
            for value in x {
                self.file.write_all(&value.to_le_bytes())?;
            }
        }
        Ok(())
    }
}

impl Stored {
    /// Values of a part, by its number.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn part(&self, part: usize) -> io::Result<Values> {
        let (offset, rows) = self.parts[part];
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(offset as u64))?;
        let mut file = BufReader::with_capacity(1 << 18, &*file);
        let mut bytes = vec![0; rows * size_of::<f64>()];
        let mut next = |&(c, j): &(usize, usize)| {
            file.read_exact(&mut bytes)?;
            let (values, _) = bytes.as_chunks();
            let x: Array1<f64> = values.iter().map(|b| f64::from_le_bytes(*b)).collect();
            Ok((c, j, x))
        };
        self.places.iter().map(&mut next).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_by_part_and_only_those_of_the_session() {
        let kept = Kept::new(2);
        let part = |rows: usize, by: f64| -> Values {
            let x = |c: usize| Array1::from_shape_fn(rows, |i| by * (i + 10 * c) as f64);
            vec![(0, 0, x(0)), (2, 0, x(2)), (1, 0, x(1)), (1, 1, x(3))]
        };
        let mut storing = kept.storing(4, 12).unwrap();
        let parts = [part(5, 1.0), part(7, 1.0 / 3.0)];
        parts.iter().for_each(|p| storing.add(p).unwrap());
        assert_eq!(kept.known(), 0);
        kept.take(storing);
        assert_eq!(kept.known(), 2);
        assert!(kept.storing(4, 12).is_none());
        for k in [1, 0] {
            let shared = parts[k].iter().filter(|v| v.0 < 2).cloned();
            assert_eq!(
                kept.stored().unwrap().part(k).unwrap(),
                shared.collect::<Values>()
            );
        }
        assert!(Kept::new(2).storing(1 << 20, 1 << 20).is_none());
    }
}
