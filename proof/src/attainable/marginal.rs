//! Likelihood of rows in which some torque is linear in unknown numbers with a Gaussian prior: integrated in closed form.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Whitened rows of each joint; none for a joint with nothing but zeros.
pub type Table = Vec<Option<Vec<f64>>>;

/// Columns of the unknown numbers in the rows of one joint.
pub struct Columns {
    /// Index of each column among all unknown numbers.
    pub which: Vec<usize>,
    /// Rows × columns, whitened.
    pub values: DMatrix<f64>,
}

/// Marginal law of the rows: noise of unit variance and `columns · x` with x ~ N(0, 1).
pub struct Marginal<'a> {
    columns: &'a [Columns],
    /// Number of rows of each joint that count.
    rows: usize,
    factor: Cholesky<f64, Dyn>,
}

/// A table with its product with the unknown numbers' columns, from which all inner products come.
#[derive(Clone)]
pub struct Seen {
    /// The table itself.
    pub table: Table,
    /// L⁻¹ Zᵀ table, for the factor L of ZᵀZ + 1.
    along: DVector<f64>,
}

impl<'a> Marginal<'a> {
    /// Law of the first `rows` rows of each joint with `count` unknown numbers. None where a column is not finite.
    pub fn new(columns: &'a [Columns], rows: usize, count: usize) -> Option<Self> {
        let mut products = DMatrix::<f64>::identity(count, count);
        for own in columns {
            let values = own.values.rows(0, rows);
            let gram = values.tr_mul(&values);
            for (a, &i) in own.which.iter().enumerate() {
                for (b, &k) in own.which.iter().enumerate() {
                    products[(i, k)] += gram[(a, b)];
                }
            }
        }
        Some(Self {
            columns,
            rows,
            factor: Cholesky::new(products)?,
        })
    }

    /// A table's first rows as this law sees them.
    pub fn see(&self, mut table: Table) -> Seen {
        let mut products = DVector::zeros(self.factor.l_dirty().nrows());
        for (own, rows) in self.columns.iter().zip(&mut table) {
            let Some(rows) = rows else { continue };
            rows.truncate(self.rows);
            let vector = DVector::from_column_slice(rows);
            let along = own.values.rows(0, self.rows).tr_mul(&vector);
            for (&i, x) in own.which.iter().zip(along.iter()) {
                products[i] += x;
            }
        }
        self.factor
            .l_dirty()
            .solve_lower_triangular_mut(&mut products);
        Seen {
            table,
            along: products,
        }
    }
}

impl Seen {
    /// aᵀ (1 + Z Zᵀ)⁻¹ b: the inner product that the unknown numbers leave.
    pub fn dot(&self, other: &Self) -> f64 {
        let tables = self.table.iter().zip(&other.table);
        let plain: f64 = tables
            .filter_map(|(a, b)| a.as_ref().zip(b.as_ref()))
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>())
            .sum();
        plain - self.along.dot(&other.along)
    }

    /// self + factor · other.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let tables = self.table.iter().zip(&other.table);
        let table = tables.map(|pair| match pair {
            (Some(a), Some(b)) => Some(a.iter().zip(b).map(|(a, b)| a + factor * b).collect()),
            (Some(a), None) => Some(a.clone()),
            (None, Some(b)) => Some(b.iter().map(|b| factor * b).collect()),
            (None, None) => None,
        });
        Self {
            table: table.collect(),
            along: &self.along + factor * &other.along,
        }
    }
}

/// Logarithm of ∫ exp(−½ (u − û)ᵀ H (u − û)) du over a cube of side 1 around û, within 0.33 for each direction: each eigenvalue λ of H
/// gives (1 + λ/2π)^−½, which is right for those that are flat and those that are sharp.
pub fn log_volume(information: DMatrix<f64>) -> f64 {
    let eigenvalues = information.symmetric_eigenvalues();
    let one = |l: &f64| (l.max(0.0) / std::f64::consts::TAU).ln_1p();
    -0.5 * eigenvalues.iter().map(one).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(values: &[f64]) -> [Columns; 1] {
        [Columns {
            which: vec![0],
            values: DMatrix::from_column_slice(values.len(), 1, values),
        }]
    }

    /// Rows (3, 4) with the column (1, 2): 1 + Z Zᵀ = [[2, 2], [2, 5]], whose inverse is [[5, −2], [−2, 2]]/6.
    #[test]
    fn an_unknown_number_is_integrated_out() {
        let columns = law(&[1.0, 2.0]);
        let marginal = Marginal::new(&columns, 2, 1).unwrap();
        let rows = marginal.see(vec![Some(vec![3.0, 4.0])]);
        assert!((rows.dot(&rows) - (45.0 - 48.0 + 32.0) / 6.0).abs() < 1e-12);
        let other = marginal.see(vec![Some(vec![1.0, 0.0])]);
        assert!((rows.dot(&other) - (15.0 - 8.0) / 6.0).abs() < 1e-12);
        let sum = rows.plus(-2.0, &other);
        let again = marginal.see(vec![Some(vec![1.0, 4.0])]);
        assert!((sum.dot(&sum) - again.dot(&again)).abs() < 1e-12);
    }

    /// One mechanism of the torque u·(3, 4) in white noise, u uniform from 0 to 1, and the rows 0.6·(3, 4) + (0.8, −0.6):
    /// the evidence is exp(−½·1) ∫ exp(−½ 25 (u − 0.6)²) du, whose integral is √(2π)/5 but for its tails.
    #[test]
    fn one_mechanism_in_white_noise_has_its_closed_form() {
        let columns = [Columns {
            which: Vec::new(),
            values: DMatrix::zeros(2, 0),
        }];
        let marginal = Marginal::new(&columns, 2, 0).unwrap();
        let rows = marginal.see(vec![Some(vec![1.8 + 0.8, 2.4 - 0.6])]);
        let torque = marginal.see(vec![Some(vec![3.0, 4.0])]);
        let size = rows.dot(&torque) / torque.dot(&torque);
        assert!((size - 0.6).abs() < 1e-12);
        let left = rows.plus(-size, &torque);
        let information = DMatrix::from_element(1, 1, torque.dot(&torque));
        let evidence = -0.5 * left.dot(&left) + log_volume(information);
        let steps = 20_000;
        let density = |i: usize| {
            let u = (i as f64 + 0.5) / f64::from(steps);
            let left = rows.plus(-u, &torque);
            (-0.5 * left.dot(&left)).exp()
        };
        let exact = ((0..steps as usize).map(density).sum::<f64>() / f64::from(steps)).ln();
        // Flat and sharp meet in the formula: ½ ln(1 + 2π/25) is its error for a sharp bell, the tails less.
        assert!((evidence - exact).abs() < 0.15, "{evidence} {exact}");
        assert!((left.dot(&left) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_volume_is_that_of_a_narrow_bell_and_of_a_flat_cube() {
        let sharp = log_volume(DMatrix::from_diagonal(&DVector::from_vec(vec![1e6, 0.0])));
        let bell = 0.5 * (std::f64::consts::TAU / 1e6).ln();
        assert!((sharp - bell).abs() < 1e-5, "{sharp} {bell}");
        assert_eq!(log_volume(DMatrix::zeros(3, 3)), 0.0);
    }
}
