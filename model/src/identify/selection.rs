//! Forward selection of terms by cross-validation.

use ::identify::least_squares::{Gram, LeastSquaresError};
use datasets::Folds;

/// Settings of the selection [`forward`].
#[derive(Clone, Copy, Debug)]
pub struct ForwardOptions {
    /// Least part of the cross-validated error that a term must remove to be selected.
    pub least_gain: f64,
    /// Number of standard errors, over the folds, by which the error removed must exceed zero where trajectories are cut.
    pub standard_errors: f64,
    /// Largest number of terms that are selected.
    pub most: usize,
    /// Ridge relative to the columns' norms.
    pub ridge: f64,
}

impl Default for ForwardOptions {
    fn default() -> Self {
        Self {
            least_gain: 0.003,
            standard_errors: 1.0,
            most: 24,
            ridge: 3e-5,
        }
    }
}

impl ForwardOptions {
    /// Whether squared errors by fold fall by more than chance. The mean fall must exceed `standard_errors` of
    /// its standard error, and the sum `least_gain` of the error before.
    pub fn falls(&self, before: &[f64], after: &[f64]) -> bool {
        let n = before.len() as f64;
        let falls: Vec<f64> = before.iter().zip(after).map(|(b, a)| b - a).collect();
        let mean = falls.iter().sum::<f64>() / n;
        let spread = falls.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
        mean * n > self.least_gain * before.iter().sum::<f64>()
            && mean > self.standard_errors * (spread / n).sqrt()
    }
}

/// Selected terms in the order of selection.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Indices of the columns of the selected terms.
    pub taken: Vec<usize>,
    /// Cross-validated sum of squared errors before the first and after each term.
    pub errors: Vec<f64>,
}

/// Sums over the fitted and the test rows of each fold.
pub struct FoldGrams {
    fitted: Vec<Gram>,
    tested: Vec<Gram>,
    whole: Gram,
}

impl FoldGrams {
    /// Sums of each fold from the normal equations of each cell of `folds`; folds without rows are left out.
    ///
    /// # Errors
    /// Cells with different numbers of columns, or no cell.
    pub fn new(cells: &[Gram], folds: &Folds) -> Result<Self, LeastSquaresError> {
        let sum = |picked: &mut dyn Iterator<Item = usize>| -> Result<Gram, LeastSquaresError> {
            let first = picked.next().ok_or(LeastSquaresError::NoRows)?;
            let mut sum = cells[first].clone();
            for cell in picked {
                sum = sum.plus(&cells[cell])?;
            }
            Ok(sum)
        };
        let (mut fitted, mut tested) = (Vec::new(), Vec::new());
        for fold in 0..folds.count {
            let (Ok(fit), Ok(test)) = (sum(&mut folds.fitted(fold)), sum(&mut folds.tested(fold)))
            else {
                continue;
            };
            if fit.rows() > 0 && test.rows() > 0 {
                fitted.push(fit);
                tested.push(test);
            }
        }
        Ok(Self {
            fitted,
            tested,
            whole: sum(&mut (0..cells.len()))?,
        })
    }

    /// Number of folds with rows.
    pub fn len(&self) -> usize {
        self.fitted.len()
    }

    /// Whether there are too few folds for a test.
    pub fn is_empty(&self) -> bool {
        self.len() < 2
    }

    /// Squared error on each fold of a fit of `columns` without it; `None` where they are linearly dependent.
    ///
    /// # Errors
    /// Columns that do not exist.
    pub fn errors(
        &self,
        columns: &[usize],
        ridge: f64,
    ) -> Result<Option<Vec<f64>>, LeastSquaresError> {
        let mut errors = Vec::with_capacity(self.len());
        for (train, test) in self.fitted.iter().zip(&self.tested) {
            match train.fit(columns, ridge)? {
                Some(fit) => errors.push(test.residual_sum_of_squares(columns, &fit.parameters)?),
                None => return Ok(None),
            }
        }
        Ok(Some(errors))
    }

    /// Root mean square of a column over all rows.
    ///
    /// # Errors
    /// A column that does not exist.
    pub fn rms(&self, column: usize) -> Result<f64, LeastSquaresError> {
        self.whole.rms(column)
    }

    /// Parameters of `columns` fitted on all rows; `None` where they are linearly dependent.
    ///
    /// # Errors
    /// Columns that do not exist.
    pub fn parameters(
        &self,
        columns: &[usize],
        ridge: f64,
    ) -> Result<Option<Vec<f64>>, LeastSquaresError> {
        Ok(self.whole.fit(columns, ridge)?.map(|fit| fit.parameters))
    }
}

/// Greedy forward selection: adds the best candidate as long as it lowers the out-of-fold error enough, and by more than chance.
///
/// `always` are the columns in every fit; `admissible` judges the parameters of a fit of all rows (columns in
/// order of `always`, then as selected). With fewer than two folds nothing can be tested and nothing is
/// selected.
///
/// # Errors
/// Columns that the normal equations do not have.
pub fn forward(
    folds: &FoldGrams,
    always: &[usize],
    candidates: &[usize],
    options: &ForwardOptions,
    admissible: impl Fn(&[usize], &[f64]) -> bool,
) -> Result<Selection, LeastSquaresError> {
    let mut selection = Selection::default();
    if folds.is_empty() {
        return Ok(selection);
    }
    let mut columns = always.to_vec();
    let Some(mut best) = folds.errors(&columns, options.ridge)? else {
        return Ok(selection);
    };
    selection.errors.push(best.iter().sum());
    while selection.taken.len() < options.most {
        let mut tried = Vec::new();
        for &candidate in candidates.iter().filter(|c| !selection.taken.contains(c)) {
            columns.push(candidate);
            if let Some(errors) = folds.errors(&columns, options.ridge)? {
                tried.push((errors.iter().sum::<f64>(), candidate, errors));
            }
            columns.pop();
        }
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut winner = None;
        for (sum, candidate, errors) in tried {
            if !options.falls(&best, &errors) {
                // A smaller fall may be a steadier one, but not below the least gain.
                if sum > best.iter().sum::<f64>() * (1.0 - options.least_gain) {
                    break;
                }
                continue;
            }
            columns.push(candidate);
            let fit = folds.parameters(&columns, options.ridge)?;
            if fit.is_some_and(|p| admissible(&columns, &p)) {
                winner = Some((candidate, sum, errors));
                break;
            }
            columns.pop();
        }
        let Some((candidate, sum, errors)) = winner else {
            break;
        };
        best = errors;
        selection.taken.push(candidate);
        selection.errors.push(sum);
    }
    Ok(selection)
}
