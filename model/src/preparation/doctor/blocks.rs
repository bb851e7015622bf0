//! Least squares with standard deviations by the jackknife over blocks of time.

use signal::cholesky;

/// Number of blocks that are left out in turn.
const BLOCKS: usize = 8;
/// Ridge on columns of unit norm, so that linearly dependent columns do no harm.
const RIDGE: f64 = 1e-7;

/// Products of columns and target, block by block.
pub(super) struct Blocks {
    /// Number of columns.
    width: usize,
    /// Lower triangle of the products of all columns and the target (last), for each block.
    products: Vec<Vec<f64>>,
}

/// Estimated value with its standard deviation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    /// Estimated value.
    pub value: f64,
    /// Standard deviation of the value.
    pub std: f64,
}

impl Blocks {
    /// Blocks of consecutive rows, each of `width` columns, with their `target`.
    pub fn new(rows: &[f64], target: &[f64], width: usize) -> Self {
        let count = target.len();
        let p = width + 1;
        let products = (0..BLOCKS)
            .map(|b| {
                let mut sum = vec![0.0; p * p];
                let mut line = vec![0.0; p];
                for k in b * count / BLOCKS..(b + 1) * count / BLOCKS {
                    line[..width].copy_from_slice(&rows[k * width..(k + 1) * width]);
                    line[width] = target[k];
                    for i in 0..p {
                        for j in 0..=i {
                            sum[i * p + j] += line[i] * line[j];
                        }
                    }
                }
                sum
            })
            .collect();
        Self { width, products }
    }

    /// Function that gives the product of two columns over all blocks; the target has the index after the last column.
    pub fn product(&self) -> impl Fn(usize, usize) -> f64 {
        let (sum, p) = (self.sum(None), self.width + 1);
        move |i, j| sum[i.max(j) * p + i.min(j)]
    }

    /// Products over all blocks but `without`.
    fn sum(&self, without: Option<usize>) -> Vec<f64> {
        let mut all = vec![0.0; (self.width + 1).pow(2)];
        for (b, own) in self.products.iter().enumerate() {
            if Some(b) != without {
                all.iter_mut().zip(own).for_each(|(a, o)| *a += o);
            }
        }
        all
    }

    /// Least-squares coefficients of some columns, from products.
    fn solved(&self, sum: &[f64], columns: &[usize]) -> Vec<f64> {
        let p = self.width + 1;
        let of = |i: usize, j: usize| sum[i.max(j) * p + i.min(j)];
        let scale: Vec<f64> = columns
            .iter()
            .map(|&c| of(c, c).sqrt().max(f64::MIN_POSITIVE))
            .collect();
        let n = columns.len();
        let mut a = vec![0.0; n * n];
        let mut x = vec![0.0; n];
        for i in 0..n {
            for j in 0..n {
                a[i * n + j] = of(columns[i], columns[j]) / (scale[i] * scale[j]);
            }
            a[i * n + i] += RIDGE;
            x[i] = of(columns[i], self.width) / scale[i];
        }
        cholesky::factor_above(&mut a, n, RIDGE);
        cholesky::solve(&a, &mut x);
        x.iter().zip(&scale).map(|(x, s)| x / s).collect()
    }

    /// Coefficients of some columns in a fit of these alone.
    pub fn coefficients(&self, columns: &[usize]) -> Vec<f64> {
        self.solved(&self.sum(None), columns)
    }

    /// Squared error of a fit of some columns, summed over all blocks.
    pub fn left(&self, columns: &[usize]) -> f64 {
        let sum = self.sum(None);
        self.error(&sum, columns, &self.solved(&sum, columns))
    }

    /// Squared error of each block with the coefficients of a fit to the other blocks. Columns that only fit by chance
    /// make it larger.
    pub fn left_out(&self, columns: &[usize]) -> Vec<f64> {
        let blocks = self.products.iter().enumerate();
        blocks
            .map(|(b, own)| self.error(own, columns, &self.solved(&self.sum(Some(b)), columns)))
            .collect()
    }

    /// Squared error of the coefficients `x` of some columns, from products.
    fn error(&self, sum: &[f64], columns: &[usize], x: &[f64]) -> f64 {
        let p = self.width + 1;
        let of = |i: usize, j: usize| sum[i.max(j) * p + i.min(j)];
        let mut left = of(self.width, self.width);
        for (i, &c) in columns.iter().enumerate() {
            left -= 2.0 * x[i] * of(c, self.width);
            for (j, &d) in columns.iter().enumerate() {
                left += x[i] * x[j] * of(c, d);
            }
        }
        left.max(0.0)
    }

    /// Function `of` of the coefficients of some columns, with its standard deviation by the jackknife over blocks.
    pub fn estimate(&self, columns: &[usize], of: impl Fn(&[f64]) -> f64) -> Estimate {
        let value = of(&self.coefficients(columns));
        let others: Vec<f64> = self.without(columns).iter().map(|x| of(x)).collect();
        Estimate::of_jackknife(value, &others)
    }

    /// Coefficients of some columns in the fits without each block in turn.
    pub fn without(&self, columns: &[usize]) -> Vec<Vec<f64>> {
        (0..BLOCKS)
            .map(|b| self.solved(&self.sum(Some(b)), columns))
            .collect()
    }
}

impl Estimate {
    /// Estimate of a value with the standard deviation that its values `without` each block in turn give.
    pub fn of_jackknife(value: f64, without: &[f64]) -> Self {
        let count = without.len() as f64;
        let mean = without.iter().sum::<f64>() / count;
        let square: f64 = without.iter().map(|o| (o - mean).powi(2)).sum();
        Self {
            value,
            std: (square * (count - 1.0) / count).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column that has nothing to do with the target explains some of it, and nothing of what is left out.
    #[test]
    fn chance_explains_nothing_that_is_left_out() {
        let noise =
            |seed: usize| move |k: usize| ((k * k * seed + 31 * k) % 1009) as f64 / 1009.0 - 0.5;
        let (a, b) = (noise(7), noise(13));
        let count = 64;
        let rows: Vec<f64> = (0..count).flat_map(|k| [1.0, a(k)]).collect();
        let of_chance: Vec<f64> = (0..count).map(b).collect();
        let blocks = Blocks::new(&rows, &of_chance, 2);
        assert!(blocks.left(&[0, 1]) < blocks.left(&[0]));
        let left_out = |blocks: &Blocks, columns| blocks.left_out(columns).iter().sum::<f64>();
        assert!(left_out(&blocks, &[0, 1]) > blocks.left(&[0, 1]));
        let of_cause: Vec<f64> = (0..count).map(|k| 0.3 + 2.0 * a(k)).collect();
        let blocks = Blocks::new(&rows, &of_cause, 2);
        assert!(left_out(&blocks, &[0, 1]) < 1e-6 && left_out(&blocks, &[0]) > 1.0);
    }
}
