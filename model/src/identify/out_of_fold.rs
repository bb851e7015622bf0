//! Out-of-fold error of a joint fit of all joints.

use crate::identify::design::{JointSystem, scale};
use crate::identify::selection::FoldGrams;
use ::identify::least_squares::{Gram, LeastSquaresError, Triangle};
use datasets::Folds;
use ndarray::{Array2, Axis};

/// Ridge of the fits, relative to the columns' norms.
const RIDGE: f64 = 3e-5;

/// Systems of all joints and sums for each fold, ready to be solved with different priors.
pub struct OutOfFold<'a> {
    systems: &'a [JointSystem],
    /// Indices of each joint's columns among all.
    maps: Vec<Vec<usize>>,
    total: usize,
    /// Sums of each fold: of the rows that are fitted without it, and of its own rows by joint, on which the fit is
    /// tested.
    folds: Vec<(Gram, Vec<Gram>)>,
    /// Sums of the rows of all folds.
    whole: Gram,
    rows: Vec<usize>,
}

impl<'a> OutOfFold<'a> {
    /// `offsets`: index of the first parameter of each joint's terms; `total`: number of parameters. Joints are
    /// weighted by the inverse residual deviation of a fit of each joint alone.
    ///
    /// # Errors
    /// Systems that do not fit together.
    pub fn new(
        systems: &'a [JointSystem],
        offsets: &[usize],
        total: usize,
        folds: &Folds,
    ) -> Result<Self, LeastSquaresError> {
        let maps: Vec<Vec<usize>> = systems
            .iter()
            .zip(offsets)
            .map(|(s, &o)| s.map(o))
            .collect();
        let cells: Vec<Vec<Gram>> = systems.iter().map(JointSystem::grams).collect();
        let mut sigma = Vec::with_capacity(systems.len());
        for (system, cells) in systems.iter().zip(&cells) {
            let columns: Vec<usize> = (0..system.columns()).collect();
            let alone = FoldGrams::new(cells, folds)?;
            let fit = alone.parameters(&columns, RIDGE)?;
            sigma.push(match fit {
                Some(parameters) if system.rows() > 0 => system.deviation(&parameters)?,
                _ => system.target_deviation(),
            });
        }
        let empty = || Gram::from(&Triangle::empty(total));
        let joined = |cell: usize| -> Result<Gram, LeastSquaresError> {
            let mut sum = empty();
            for ((cells, map), sigma) in cells.iter().zip(&maps).zip(&sigma) {
                if cells[cell].rows() > 0 {
                    let own = cells[cell].scaled(scale(*sigma));
                    sum = sum.plus(&own.embed(map, total)?)?;
                }
            }
            Ok(sum)
        };
        let joined: Vec<Gram> = (0..folds.cells.len())
            .map(joined)
            .collect::<Result<_, _>>()?;
        let mut dealt = Vec::new();
        for fold in 0..folds.count {
            let mut fitted = empty();
            for cell in folds.fitted(fold) {
                fitted = fitted.plus(&joined[cell])?;
            }
            let mut tested = Vec::with_capacity(systems.len());
            for (system, cells) in systems.iter().zip(&cells) {
                let mut own = Gram::from(&Triangle::empty(system.columns()));
                for cell in folds.tested(fold) {
                    own = own.plus(&cells[cell])?;
                }
                tested.push(own);
            }
            dealt.push((fitted, tested));
        }
        let mut whole = empty();
        for cell in &joined {
            whole = whole.plus(cell)?;
        }
        Ok(Self {
            rows: systems.iter().map(JointSystem::rows).collect(),
            systems,
            maps,
            total,
            folds: dealt,
            whole,
        })
    }

    /// Parameters fitted on all rows, with further rows `prior` of unit standard deviation.
    ///
    /// # Errors
    /// A prior over other columns.
    pub fn parameters(&self, prior: Option<&Gram>) -> Result<Option<Vec<f64>>, LeastSquaresError> {
        let columns: Vec<usize> = (0..self.total).collect();
        let whole = match prior {
            Some(prior) => &self.whole.plus(prior)?,
            None => &self.whole,
        };
        Ok(whole.fit(&columns, RIDGE)?.map(|f| f.parameters))
    }

    /// Squared error of each fold (row) and joint (column) summed over the rows left out, (N·m)², with further rows
    /// `prior` in every fit; `None` where a fold cannot be fitted or there are fewer than two.
    ///
    /// # Errors
    /// A prior over other columns.
    pub fn squares(&self, prior: Option<&Gram>) -> Result<Option<Array2<f64>>, LeastSquaresError> {
        if self.folds.len() < 2 {
            return Ok(None);
        }
        let columns: Vec<usize> = (0..self.total).collect();
        let mut squares = Array2::zeros((self.folds.len(), self.systems.len()));
        for ((fitted, tested), mut row) in self.folds.iter().zip(squares.rows_mut()) {
            let fit = match prior {
                Some(prior) => fitted.plus(prior)?.fit(&columns, RIDGE)?,
                None => fitted.fit(&columns, RIDGE)?,
            };
            let Some(fit) = fit else { return Ok(None) };
            for ((square, test), map) in row.iter_mut().zip(tested).zip(&self.maps) {
                let own: Vec<usize> = (0..map.len()).collect();
                let parameters: Vec<f64> = map.iter().map(|&c| fit.parameters[c]).collect();
                *square = test.residual_sum_of_squares(&own, &parameters)?;
            }
        }
        Ok(Some(squares))
    }

    /// RMSE of each joint on rows left out, N·m, as [`Self::squares`]; NaN for a joint without rows.
    ///
    /// # Errors
    /// A prior over other columns.
    pub fn rmse(&self, prior: Option<&Gram>) -> Result<Option<Vec<f64>>, LeastSquaresError> {
        let of = |squares: Array2<f64>| {
            let sums = squares.sum_axis(Axis(0));
            sums.iter()
                .zip(&self.rows)
                .map(|(s, &n)| (s / n as f64).sqrt())
                .collect()
        };
        Ok(self.squares(prior)?.map(of))
    }
}
