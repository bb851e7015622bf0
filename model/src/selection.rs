//! Forward selection of terms by cross-validation.

use physics::identify::least_squares::{Gram, LeastSquaresError};

/// Settings of [`forward`].
#[derive(Clone, Copy, Debug)]
pub struct ForwardOptions {
    /// Part of the cross-validated error that a term has to remove to be taken.
    pub least_gain: f64,
    /// Most terms taken.
    pub most: usize,
    /// Ridge relative to the columns' norms.
    pub ridge: f64,
}

impl Default for ForwardOptions {
    fn default() -> Self {
        Self {
            least_gain: 0.003,
            most: 24,
            ridge: 3e-5,
        }
    }
}

/// Terms taken, in the order in which they were taken.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Column indices.
    pub taken: Vec<usize>,
    /// Cross-validated sum of squared errors before the first and after each term.
    pub errors: Vec<f64>,
}

/// Greedy selection: as long as the best candidate lowers the error on folds left out enough.
///
/// `folds` holds the normal equations of each fold over all columns, `always` the columns in every
/// fit. With fewer than two folds nothing can be tested and nothing is taken.
///
/// # Errors
/// Columns that the normal equations do not have.
pub fn forward(
    folds: &[Gram],
    always: &[usize],
    candidates: &[usize],
    options: ForwardOptions,
) -> Result<Selection, LeastSquaresError> {
    let mut selection = Selection::default();
    let populated: Vec<&Gram> = folds.iter().filter(|g| g.rows() > 0).collect();
    let [first, rest @ ..] = populated.as_slice() else {
        return Ok(selection);
    };
    if rest.is_empty() {
        return Ok(selection);
    }
    let mut total = (*first).clone();
    for gram in rest {
        total = total.plus(gram)?;
    }
    let training: Vec<Gram> = populated
        .iter()
        .map(|g| total.minus(g))
        .collect::<Result<_, _>>()?;
    let error = |columns: &[usize]| -> Result<f64, LeastSquaresError> {
        let mut sum = 0.0;
        for (train, test) in training.iter().zip(&populated) {
            match train.fit(columns, options.ridge)? {
                Some(fit) => sum += test.residual_sum_of_squares(columns, &fit.parameters)?,
                None => return Ok(f64::INFINITY),
            }
        }
        Ok(sum)
    };
    let mut columns = always.to_vec();
    let mut best = error(&columns)?;
    selection.errors.push(best);
    while selection.taken.len() < options.most {
        let mut winner = None;
        for &candidate in candidates.iter().filter(|c| !selection.taken.contains(c)) {
            columns.push(candidate);
            let e = error(&columns)?;
            columns.pop();
            if e < winner.map_or(f64::INFINITY, |(least, _)| least) {
                winner = Some((e, candidate));
            }
        }
        let Some((e, candidate)) = winner.filter(|&(e, _)| e < best * (1.0 - options.least_gain))
        else {
            break;
        };
        best = e;
        columns.push(candidate);
        selection.taken.push(candidate);
        selection.errors.push(e);
    }
    Ok(selection)
}
