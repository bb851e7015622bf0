//! Borrowed training data.

use std::ops::Range;

use ndarray::{ArrayView1, ArrayView2};
use sha2::{Digest, Sha256};

use crate::Error;

/// Samples of one unit's target with the inputs of all units, borrowed: windows are gathered batch by
/// batch and never copied as a whole.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    inputs: ArrayView2<'a, f32>,
    target: ArrayView1<'a, f32>,
    weight: Option<ArrayView1<'a, f32>>,
    trajectories: &'a [Range<usize>],
}

impl<'a> Samples<'a> {
    /// Samples from tables that agree in their rows.
    ///
    /// `inputs` has the shape (samples, input columns), `target` is the residual torque in N·m. `weight` is at least 0;
    /// a sample of weight 0 is not scored but may serve as history. No window crosses the rows of a trajectory.
    ///
    /// # Errors
    /// [`Error::Samples`] where lengths disagree or a trajectory is empty or out of range, [`Error::NotFinite`] for
    /// NaN, infinity or a negative weight.
    pub fn new(
        inputs: ArrayView2<'a, f32>,
        target: ArrayView1<'a, f32>,
        weight: Option<ArrayView1<'a, f32>>,
        trajectories: &'a [Range<usize>],
    ) -> Result<Self, Error> {
        let rows = inputs.nrows();
        if target.len() != rows || weight.is_some_and(|w| w.len() != rows) {
            return Err(Error::Samples(format!(
                "{rows} rows of inputs, {} targets",
                target.len()
            )));
        }
        if rows > u32::MAX as usize {
            return Err(Error::Samples(format!(
                "{rows} rows, more than {} at once",
                u32::MAX
            )));
        }
        if let Some(t) = trajectories
            .iter()
            .find(|t| t.start >= t.end || t.end > rows)
        {
            return Err(Error::Samples(format!(
                "trajectory {}..{} of {rows} rows",
                t.start, t.end
            )));
        }
        for ((row, column), x) in inputs.indexed_iter() {
            if !x.is_finite() {
                return Err(Error::NotFinite {
                    table: "input",
                    row,
                    column,
                });
            }
        }
        if let Some(row) = target.iter().position(|x| !x.is_finite()) {
            return Err(Error::NotFinite {
                table: "target",
                row,
                column: 0,
            });
        }
        if let Some(row) = weight.and_then(|w| w.iter().position(|x| !(x.is_finite() && *x >= 0.0)))
        {
            return Err(Error::NotFinite {
                table: "weight",
                row,
                column: 0,
            });
        }
        Ok(Self {
            inputs,
            target,
            weight,
            trajectories,
        })
    }

    /// Number of rows of all trajectories.
    pub fn rows(&self) -> usize {
        self.inputs.nrows()
    }

    /// Number of input columns per row.
    pub fn columns(&self) -> usize {
        self.inputs.ncols()
    }

    /// Range of the rows of each trajectory.
    pub fn trajectories(&self) -> &'a [Range<usize>] {
        self.trajectories
    }

    /// Value of one input column in a row.
    #[inline]
    pub fn input(&self, row: usize, column: usize) -> f32 {
        self.inputs[[row, column]]
    }

    /// Target of the training in a row, N·m.
    #[inline]
    pub fn target(&self, row: usize) -> f32 {
        self.target[row]
    }

    /// Weight of a row; 1 where none were given.
    #[inline]
    pub fn weight(&self, row: usize) -> f32 {
        self.weight.map_or(1.0, |w| w[row])
    }

    /// Copies the given columns of a row to `out`.
    #[inline]
    pub(crate) fn gather(&self, row: usize, columns: &[usize], out: &mut [f32]) {
        let values = self.inputs.row(row);
        for (x, &c) in out.iter_mut().zip(columns) {
            *x = values[c];
        }
    }

    /// Copies the window that ends at `row`, oldest sample first, to `out`; before `start` its trajectory's first sample repeats.
    pub(super) fn window(&self, row: usize, start: usize, columns: &[usize], out: &mut [f32]) {
        let steps = out.len() / columns.len();
        for (step, out) in out.chunks_exact_mut(columns.len()).enumerate() {
            let source = (row + step + 1).saturating_sub(steps).max(start);
            self.gather(source, columns, out);
        }
    }

    /// Fingerprint of all inputs of a unit on `columns`, to recognise a checkpoint of other data.
    pub(crate) fn digest(&self, columns: &[usize], hash: &mut Sha256) {
        let mut row = vec![0.0; columns.len()];
        for i in 0..self.rows() {
            self.gather(i, columns, &mut row);
            for v in row.iter().chain([&self.target(i), &self.weight(i)]) {
                hash.update(v.to_le_bytes());
            }
        }
        for t in self.trajectories {
            hash.update((t.start as u64).to_le_bytes());
            hash.update((t.end as u64).to_le_bytes());
        }
    }
}

/// Split into trajectories that are fitted and that stop the training, as indices into [`Samples::trajectories`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Split {
    /// Indices of the fitted trajectories.
    pub train: Vec<usize>,
    /// Indices of the trajectories that decide when to stop and whether the unit stays on. Empty: all epochs are run
    /// and the unit stays on.
    pub validation: Vec<usize>,
}

impl Split {
    /// Refuses indices out of range, a trajectory on both sides, and nothing to fit.
    ///
    /// # Errors
    /// [`Error::Samples`] or [`Error::TooLittleData`].
    pub fn check(&self, samples: &Samples) -> Result<(), Error> {
        let count = samples.trajectories.len();
        if let Some(t) = self
            .train
            .iter()
            .chain(&self.validation)
            .find(|&&t| t >= count)
        {
            return Err(Error::Samples(format!("trajectory {t} of {count}")));
        }
        if let Some(t) = self.train.iter().find(|t| self.validation.contains(t)) {
            return Err(Error::Samples(format!(
                "trajectory {t} is both fitted and used for validation"
            )));
        }
        let usable = |side: &[usize]| {
            side.iter()
                .flat_map(|&t| samples.trajectories[t].clone())
                .any(|row| samples.weight(row) > 0.0)
        };
        if !usable(&self.train) {
            return Err(Error::TooLittleData(
                "no sample with weight in the training trajectories".into(),
            ));
        }
        if !self.validation.is_empty() && !usable(&self.validation) {
            return Err(Error::TooLittleData(
                "no sample with weight in the validation trajectories".into(),
            ));
        }
        Ok(())
    }
}
