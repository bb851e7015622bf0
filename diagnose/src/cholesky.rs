//! Cholesky factor of a small symmetric positive definite matrix.

use ndarray::{Array1, Array2, ArrayView1};

/// A = L·Lᵀ with L lower triangular, shape (n, n), row-major.
#[derive(Clone, Debug)]
pub struct Cholesky {
    l: Array2<f64>,
}

impl Cholesky {
    /// Factorises `a`, of which only the lower triangle is read. A pivot lost to rounding is
    /// replaced by 1e-13 of its diagonal entry, which pins that unknown near zero: every system
    /// here carries a prior, so a vanishing pivot means two columns that differ by rounding alone.
    pub fn new(mut a: Array2<f64>) -> Self {
        let n = a.nrows();
        let mut current = vec![0.0; n];
        for i in 0..n {
            current.copy_from_slice(&a.as_slice().expect("standard layout")[i * n..(i + 1) * n]);
            let flat = a.as_slice_mut().expect("standard layout");
            let floor = (1e-13 * current[i]).max(f64::MIN_POSITIVE);
            for j in 0..i {
                let dot: f64 = current[..j]
                    .iter()
                    .zip(&flat[j * n..j * n + j])
                    .map(|(x, y)| x * y)
                    .sum();
                current[j] = (current[j] - dot) / flat[j * n + j];
            }
            let squares: f64 = current[..i].iter().map(|x| x * x).sum();
            current[i] = (current[i] - squares).max(floor).sqrt();
            current[i + 1..].fill(0.0);
            flat[i * n..(i + 1) * n].copy_from_slice(&current);
        }
        Self { l: a }
    }

    /// Order of the matrix.
    pub fn order(&self) -> usize {
        self.l.nrows()
    }

    /// x with L·x = b.
    pub fn forward(&self, b: ArrayView1<f64>) -> Array1<f64> {
        let n = self.order();
        let l = self.l.as_slice().expect("standard layout");
        let mut x = b.to_vec();
        for i in 0..n {
            let dot: f64 = l[i * n..i * n + i]
                .iter()
                .zip(&x[..i])
                .map(|(p, q)| p * q)
                .sum();
            x[i] = (x[i] - dot) / l[i * n + i];
        }
        Array1::from(x)
    }

    /// x with Lᵀ·x = b.
    pub fn backward(&self, b: ArrayView1<f64>) -> Array1<f64> {
        let n = self.order();
        let l = self.l.as_slice().expect("standard layout");
        let mut x = b.to_vec();
        for i in (0..n).rev() {
            let xi = x[i] / l[i * n + i];
            x[i] = xi;
            for (xk, lk) in x[..i].iter_mut().zip(&l[i * n..i * n + i]) {
                *xk -= lk * xi;
            }
        }
        Array1::from(x)
    }

    /// x with A·x = b.
    pub fn solve(&self, b: ArrayView1<f64>) -> Array1<f64> {
        self.backward(self.forward(b).view())
    }

    /// Diagonal of A⁻¹.
    pub fn inverse_diagonal(&self) -> Array1<f64> {
        let n = self.order();
        (0..n)
            .map(|i| {
                let mut e = Array1::zeros(n);
                e[i] = 1.0;
                self.forward(e.view()).iter().map(|x| x * x).sum()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn solves_a_system_by_hand() {
        // [[4, 2], [2, 3]]·[1, −1] = [2, −1]; the inverse has the diagonal [3, 4]/8.
        let c = Cholesky::new(array![[4.0, 2.0], [2.0, 3.0]]);
        let x = c.solve(array![2.0, -1.0].view());
        assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] + 1.0).abs() < 1e-15);
        let d = c.inverse_diagonal();
        assert!((d[0] - 0.375).abs() < 1e-15 && (d[1] - 0.5).abs() < 1e-15);
    }
}
