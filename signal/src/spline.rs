//! Interpolating splines: position samples to position, velocity and acceleration at any time.
//!
//! B-splines with the not-a-knot end condition (C. de Boor, *A Practical Guide to Splines*,
//! ch. XIII), equal to `scipy.interpolate.make_interp_spline`.

mod coarsest;

/// Samples that no spline can go through.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Times and values differ in number.
    #[error("{times} times for {values} values")]
    Length {
        /// Number of times that were given.
        times: usize,
        /// Number of values that were given.
        values: usize,
    },
    /// Fewer samples than the degree needs.
    #[error("{samples} samples, a spline of this degree needs {needed}")]
    TooFew {
        /// Number of samples that were given.
        samples: usize,
        /// Number of samples needed.
        needed: usize,
    },
    /// Times that do not increase.
    #[error("time does not increase at sample {0}")]
    Time(usize),
}

/// End condition of the cubic spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CubicEnd {
    /// The third derivative is continuous at the second and the last but one sample.
    NotAKnot,
    /// The second derivative vanishes at both ends.
    Natural,
}

/// An interpolating spline with its first two derivatives.
#[derive(Clone, Debug)]
pub struct Spline {
    levels: [BSpline; 3],
}

impl Spline {
    /// Quintic spline, not-a-knot: four continuous derivatives. Needs 6 samples.
    ///
    /// # Errors
    /// Too few samples, times that do not increase.
    pub fn quintic(time: &[f64], values: &[f64]) -> Result<Self, SplineError> {
        Ok(Self::with_derivatives(BSpline::not_a_knot(
            time, values, 5,
        )?))
    }

    /// Cubic spline: two continuous derivatives. Needs 4 samples, or 3 if natural.
    ///
    /// # Errors
    /// Too few samples, times that do not increase.
    pub fn cubic(time: &[f64], values: &[f64], end: CubicEnd) -> Result<Self, SplineError> {
        let value = match end {
            CubicEnd::NotAKnot => BSpline::not_a_knot(time, values, 3)?,
            CubicEnd::Natural => BSpline::natural_cubic(time, values)?,
        };
        Ok(Self::with_derivatives(value))
    }

    fn with_derivatives(value: BSpline) -> Self {
        let first = value.derivative();
        let second = first.derivative();
        Self {
            levels: [value, first, second],
        }
    }

    /// Value, first and second derivative at `t`. Outside the samples the end pieces go on.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let piece = self.levels[0].piece(t);
        self.levels.each_ref().map(|l| l.evaluate(t, piece))
    }

    /// Values, first and second derivatives at many times.
    pub fn sample(&self, times: &[f64]) -> [Vec<f64>; 3] {
        let mut out = [(); 3].map(|()| Vec::with_capacity(times.len()));
        for &t in times {
            for (column, v) in out.iter_mut().zip(self.at(t)) {
                column.push(v);
            }
        }
        out
    }
}

/// Highest degree; sizes the work arrays on the stack.
const MAX_DEGREE: usize = 5;

/// Σ cᵢ Bᵢ(t) on a knot vector with full multiplicity at both ends.
///
/// A derivative keeps the knots of its parent and drops one at each end by an offset, so that one
/// search for the piece serves all of them.
#[derive(Clone, Debug)]
struct BSpline {
    knots: Vec<f64>,
    coefficients: Vec<f64>,
    degree: usize,
    /// Degree of the spline that this is the derivative of: piece indices refer to its knots.
    parent: usize,
}

impl BSpline {
    fn not_a_knot(time: &[f64], values: &[f64], degree: usize) -> Result<Self, SplineError> {
        check(time, values, degree + 1)?;
        let n = time.len();
        let margin = degree.div_ceil(2);
        let inner = &time[margin..n - margin];
        let knots = clamped(time, inner, degree);
        let mut system = Banded::new(n, degree);
        let spline = Self {
            knots,
            coefficients: Vec::new(),
            degree,
            parent: degree,
        };
        for (row, &t) in time.iter().enumerate() {
            let piece = spline.piece_among(t, n);
            let basis = spline.basis(t, piece);
            for (k, b) in basis.iter().take(degree + 1).enumerate() {
                system.set(row, piece - degree + k, *b);
            }
        }
        Ok(Self {
            coefficients: system.solve(values.to_vec()),
            ..spline
        })
    }

    /// Every sample is a knot; the two free coefficients make the end curvatures zero.
    fn natural_cubic(time: &[f64], values: &[f64]) -> Result<Self, SplineError> {
        check(time, values, 3)?;
        let n = time.len();
        let m = n + 2;
        let knots = clamped(time, &time[1..n - 1], 3);
        let spline = Self {
            knots,
            coefficients: Vec::new(),
            degree: 3,
            parent: 3,
        };
        // S'' at an end is proportional to the difference of two neighbouring slopes
        // (c_{i+1} − c_i)/(k_{i+4} − k_{i+1}).
        let k = &spline.knots;
        let curvature =
            |first: f64, second: f64| [1.0 / first, -1.0 / first - 1.0 / second, 1.0 / second];
        let left = curvature(k[4] - k[1], k[5] - k[2]);
        let right = curvature(k[m + 1] - k[m - 2], k[m + 2] - k[m - 1]);
        let mut system = Banded::new(m, 3);
        system.set(0, 0, 1.0);
        system.set(m - 1, m - 1, 1.0);
        for j in 0..3 {
            system.set(1, j, left[j]);
            system.set(m - 2, m - 3 + j, right[j]);
        }
        for (row, &t) in time.iter().enumerate().take(n - 1).skip(1) {
            let piece = spline.piece_among(t, m);
            for (j, b) in spline.basis(t, piece).iter().take(4).enumerate() {
                system.set(row + 1, piece - 3 + j, *b);
            }
        }
        let mut side = vec![0.0; m];
        side[0] = values[0];
        side[m - 1] = values[n - 1];
        side[2..m - 2].copy_from_slice(&values[1..n - 1]);
        Ok(Self {
            coefficients: system.solve(side),
            ..spline
        })
    }

    /// dB-spline/dt: c'ᵢ = p (cᵢ₊₁ − cᵢ)/(kᵢ₊ₚ₊₁ − kᵢ₊₁), one degree lower.
    fn derivative(&self) -> Self {
        let p = self.degree;
        let k = &self.knots;
        let coefficients = self
            .coefficients
            .windows(2)
            .enumerate()
            .map(|(i, c)| p as f64 * (c[1] - c[0]) / (k[i + p + 1] - k[i + 1]))
            .collect();
        let knots = k[1..k.len() - 1].to_vec();
        Self {
            knots,
            coefficients,
            degree: p - 1,
            parent: self.parent,
        }
    }

    /// Index i of the knot interval [kᵢ, kᵢ₊₁) that holds `t`, the end intervals going on.
    fn piece(&self, t: f64) -> usize {
        self.piece_among(t, self.coefficients.len())
    }

    fn piece_among(&self, t: f64, coefficients: usize) -> usize {
        let inside = &self.knots[self.degree + 1..coefficients];
        self.degree + inside.partition_point(|&k| k <= t)
    }

    /// The `degree + 1` basis functions that do not vanish on a piece (Cox–de Boor).
    fn basis(&self, t: f64, piece: usize) -> [f64; MAX_DEGREE + 1] {
        let mut b = [0.0; MAX_DEGREE + 1];
        b[0] = 1.0;
        for d in 1..=self.degree {
            let mut carried = 0.0;
            for (r, value) in b.iter_mut().enumerate().take(d) {
                let (low, high) = (self.knots[piece + 1 + r - d], self.knots[piece + 1 + r]);
                let share = *value / (high - low);
                *value = carried + (high - t) * share;
                carried = (t - low) * share;
            }
            b[d] = carried;
        }
        b
    }

    /// Value at `t` on a piece of the spline that this descends from.
    fn evaluate(&self, t: f64, piece: usize) -> f64 {
        let piece = piece - (self.parent - self.degree);
        let basis = self.basis(t, piece);
        let first = piece - self.degree;
        let active = &self.coefficients[first..=piece];
        active.iter().zip(basis).map(|(c, b)| c * b).sum()
    }
}

fn check(time: &[f64], values: &[f64], needed: usize) -> Result<(), SplineError> {
    if time.len() != values.len() {
        return Err(SplineError::Length {
            times: time.len(),
            values: values.len(),
        });
    }
    if time.len() < needed {
        return Err(SplineError::TooFew {
            samples: time.len(),
            needed,
        });
    }
    let increases = |w: &[f64]| w[1] > w[0];
    match time.windows(2).position(|w| !increases(w)) {
        Some(row) => Err(SplineError::Time(row + 1)),
        None => Ok(()),
    }
}

/// Inner knots between ends of full multiplicity.
fn clamped(time: &[f64], inner: &[f64], degree: usize) -> Vec<f64> {
    let (first, last) = (time[0], time[time.len() - 1]);
    let end = degree + 1;
    let mut knots = Vec::with_capacity(inner.len() + 2 * end);
    knots.extend(std::iter::repeat_n(first, end));
    knots.extend_from_slice(inner);
    knots.extend(std::iter::repeat_n(last, end));
    knots
}

/// Square banded matrix, solved without pivoting: collocation matrices of B-splines are totally
/// positive, for which elimination without pivoting is stable (de Boor, ch. XIII).
struct Banded {
    size: usize,
    band: usize,
    /// Cells of the band, row by row: columns row − band … row + band.
    cells: Vec<f64>,
}

impl Banded {
    fn new(size: usize, band: usize) -> Self {
        Self {
            size,
            band,
            cells: vec![0.0; size * (2 * band + 1)],
        }
    }

    fn index(&self, row: usize, column: usize) -> usize {
        row * (2 * self.band + 1) + column + self.band - row
    }

    /// Sets a cell; one outside the band is a zero of the basis and is skipped.
    fn set(&mut self, row: usize, column: usize, value: f64) {
        if row.abs_diff(column) <= self.band {
            let index = self.index(row, column);
            self.cells[index] = value;
        }
    }

    /// Adds to a cell inside the band.
    fn add(&mut self, row: usize, column: usize, value: f64) {
        let index = self.index(row, column);
        self.cells[index] += value;
    }

    fn solve(mut self, mut x: Vec<f64>) -> Vec<f64> {
        for pivot in 0..self.size {
            let end = (pivot + self.band + 1).min(self.size);
            let diagonal = self.cells[self.index(pivot, pivot)];
            for row in pivot + 1..end {
                let factor = self.cells[self.index(row, pivot)] / diagonal;
                if factor == 0.0 {
                    continue;
                }
                for column in pivot + 1..end {
                    let above = self.cells[self.index(pivot, column)];
                    let index = self.index(row, column);
                    self.cells[index] -= factor * above;
                }
                x[row] -= factor * x[pivot];
            }
        }
        for row in (0..self.size).rev() {
            let end = (row + self.band + 1).min(self.size);
            let mut sum = x[row];
            for (column, known) in x.iter().enumerate().take(end).skip(row + 1) {
                sum -= self.cells[self.index(row, column)] * known;
            }
            x[row] = sum / self.cells[self.index(row, row)];
        }
        x
    }
}
