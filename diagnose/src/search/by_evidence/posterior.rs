//! Posterior of one set of variables, and its evidence, from whitened sums of products.

use super::rows::{JointRows, SIZES};
use crate::algebra::cholesky::Cholesky;
use crate::algebra::fit::Variable;
use crate::algebra::gram::Layout;
use ndarray::{Array1, Array2, Axis};
use std::collections::HashMap;

/// Prior odds that something unknown acts on a joint, as those of any other effect.
pub(super) const ODDS: f64 = 0.1;
/// Number of passes in which coefficients, variances and sizes of the unknown torque are found in turns.
const PASSES: usize = 4;

/// Noise of each joint.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    /// Size of the unknown torque, an index of [`SIZES`].
    pub size: Vec<usize>,
    /// Variance of the white noise, (N·m)².
    pub variance: Vec<f64>,
}

/// Whitened rows of a recording.
pub(super) struct Rows<'a> {
    /// Sums of products by joint.
    pub joints: Vec<JointRows>,
    /// Joints that each column touches.
    pub layout: &'a Layout,
    /// Least variance of the white noise, (N·m)², by joint.
    pub least: Vec<f64>,
}

/// Coefficients of one hypothesis with their common normal prior.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Columns of the coefficients.
    pub columns: Vec<usize>,
    /// Prior mean of all coefficients.
    pub mean: f64,
    /// Prior precision matrix.
    pub precision: Array2<f64>,
    /// Logarithm of the precision's determinant.
    pub log_determinant: f64,
}

impl Group {
    /// Hypothesis with a prior precision matrix.
    pub(super) fn new(columns: Vec<usize>, mean: f64, precision: Array2<f64>) -> Self {
        Self {
            log_determinant: Cholesky::new(&precision).log_determinant(),
            columns,
            mean,
            precision,
        }
    }

    /// Part of the log evidence that the prior alone gives, nats.
    fn log_prior(&self) -> f64 {
        0.5 * self.log_determinant - 0.5 * self.mean * self.mean * self.precision.sum()
    }
}

/// Posterior of some variables.
pub(super) struct Posterior {
    /// Columns, in the order of `beta`.
    pub variables: Vec<usize>,
    /// Posterior means.
    pub beta: Array1<f64>,
    /// Noise under which the recording is likeliest.
    pub noise: Noise,
    /// Log evidence, nats, with the prior of the unknown torques.
    pub log_evidence: f64,
    factor: Cholesky,
    /// Variables that touch each joint: (variable, place among its active columns).
    places: Vec<Vec<(usize, usize)>>,
}

/// Column added to a posterior: its products with the variables and with what they leave.
struct Beside {
    /// Σ C⁻¹ products with each variable.
    cross: Array2<f64>,
    /// Its rows times the posterior covariance.
    moved: Array2<f64>,
    /// Σ C⁻¹ products with the residual.
    left: Vec<f64>,
}

impl Rows<'_> {
    /// Posterior of the parameters `base` and of some hypotheses. `unknown` allows unknown torques. The search for the noise
    /// begins at `start`.
    pub(super) fn posterior(
        &self,
        base: &[Variable],
        groups: &[&Group],
        start: Option<&Noise>,
        unknown: bool,
    ) -> Posterior {
        let mut prior = Prior::of(base);
        groups.iter().for_each(|g| prior.add(g));
        let variables = prior.columns;
        let places = self.places(&variables);
        let prior = (prior.precision, prior.push);
        let mut noise = match start {
            Some(noise) => noise.clone(),
            None => self.noise_of(&places, &Array1::zeros(variables.len()), None, unknown),
        };
        let mut solved = self.solved(&prior, &places, &noise);
        for _ in 0..PASSES {
            let last = start.map(|_| &noise);
            let next = self.noise_of(&places, &solved.1, last, unknown);
            let stays = next.size == noise.size
                && next
                    .variance
                    .iter()
                    .zip(&noise.variance)
                    .all(|(a, b)| (a / b - 1.0).abs() < 1e-3);
            noise = next;
            if stays {
                break;
            }
            solved = self.solved(&prior, &places, &noise);
        }
        let (factor, beta, b) = solved;
        let mut log_evidence = 0.5 * b.dot(&beta) - 0.5 * factor.log_determinant();
        for v in base {
            log_evidence += 0.5 * v.precision.ln() - 0.5 * v.precision * v.mean * v.mean;
        }
        log_evidence += groups.iter().map(|g| g.log_prior()).sum::<f64>();
        for (j, rows) in self.joints.iter().enumerate() {
            let (level, variance) = (&rows.levels[noise.size[j]], noise.variance[j]);
            log_evidence -= 0.5 * (rows.rows * variance.ln() + level.log_determinant);
            log_evidence -= 0.5 * level.yy / variance;
            log_evidence += log_prior(noise.size[j]);
        }
        Posterior {
            variables,
            beta,
            noise,
            log_evidence,
            factor,
            places,
        }
    }

    fn places(&self, variables: &[usize]) -> Vec<Vec<(usize, usize)>> {
        let of = |j: usize| {
            let place = |(i, v): (usize, &usize)| Some((i, self.layout.position(j, *v)?));
            variables.iter().enumerate().filter_map(place).collect()
        };
        (0..self.joints.len()).map(of).collect()
    }

    /// Noise of each joint under which the recording is likeliest, the coefficients given.
    fn noise_of(
        &self,
        places: &[Vec<(usize, usize)>],
        beta: &Array1<f64>,
        last: Option<&Noise>,
        unknown: bool,
    ) -> Noise {
        let sizes = if unknown { SIZES.len() } else { 1 };
        // From the last size on, one step at a time.
        let near = |j: usize, size: usize| {
            last.is_none_or(|n| n.size[j].abs_diff(size) <= 1 || sizes == 1)
        };
        let of = |j: usize| {
            let rows = &self.joints[j];
            let n = rows.rows.max(1.0);
            let each = rows
                .levels
                .iter()
                .take(sizes)
                .enumerate()
                .filter(|(size, _)| near(j, *size));
            let each = each.map(|(size, level)| {
                let mut error = level.yy;
                for &(i, p) in &places[j] {
                    let row = level.xx.row(p);
                    let fitted: f64 = places[j].iter().map(|&(k, r)| row[r] * beta[k]).sum();
                    error += beta[i] * (fitted - 2.0 * level.xy[p]);
                }
                let variance = (error / n).max(self.least[j]);
                let surprise = 0.5 * (n * variance.ln() + error / variance + level.log_determinant)
                    - log_prior(size);
                (surprise, size, variance)
            });
            let best = each.min_by(|a, b| a.0.total_cmp(&b.0));
            best.map_or((0, self.least[j]), |(_, size, variance)| (size, variance))
        };
        let (size, variance) = (0..self.joints.len()).map(of).unzip();
        Noise { size, variance }
    }

    /// Cholesky factor of the posterior precision, posterior means, and the right-hand side.
    fn solved(
        &self,
        prior: &(Array2<f64>, Array1<f64>),
        places: &[Vec<(usize, usize)>],
        noise: &Noise,
    ) -> (Cholesky, Array1<f64>, Array1<f64>) {
        let (mut a, mut b) = prior.clone();
        for (j, place) in places.iter().enumerate() {
            let level = &self.joints[j].levels[noise.size[j]];
            let w = 1.0 / noise.variance[j];
            for (at, &(i, p)) in place.iter().enumerate() {
                let row = level.xx.row(p);
                for &(k, r) in &place[..=at] {
                    a[[i.max(k), i.min(k)]] += w * row[r];
                }
                b[i] += w * level.xy[p];
            }
        }
        let factor = Cholesky::new(&a);
        let beta = factor.solve(b.view());
        (factor, beta, b)
    }

    /// Change of the log evidence by each of the `added` hypotheses, the noise held, and their coefficients.
    pub(super) fn gains(&self, posterior: &Posterior, added: &[&Group]) -> Vec<(f64, Vec<f64>)> {
        let mut row = HashMap::new();
        let mut columns = Vec::new();
        for &column in added.iter().flat_map(|g| &g.columns) {
            row.entry(column).or_insert_with(|| {
                columns.push(column);
                columns.len() - 1
            });
        }
        let beside = self.beside(posterior, &columns);
        added
            .iter()
            .map(|group| self.gain(posterior, &beside, &row, group))
            .collect()
    }

    fn beside(&self, posterior: &Posterior, columns: &[usize]) -> Beside {
        let m = posterior.variables.len();
        let mut cross = Array2::<f64>::zeros((columns.len(), m));
        let mut left = vec![0.0; columns.len()];
        for (j, place) in posterior.places.iter().enumerate() {
            let noise = &posterior.noise;
            let level = &self.joints[j].levels[noise.size[j]];
            let w = 1.0 / noise.variance[j];
            for (c, &column) in columns.iter().enumerate() {
                let Some(own) = self.layout.position(j, column) else {
                    continue;
                };
                let row = level.xx.row(own);
                let mut fitted = 0.0;
                for &(i, p) in place {
                    cross[[c, i]] += w * row[p];
                    fitted += row[p] * posterior.beta[i];
                }
                left[c] += w * (level.xy[own] - fitted);
            }
        }
        let moved = posterior.factor.solve_rows(&cross);
        Beside { cross, moved, left }
    }

    fn gain(
        &self,
        posterior: &Posterior,
        beside: &Beside,
        row: &HashMap<usize, usize>,
        group: &Group,
    ) -> (f64, Vec<f64>) {
        let mut s = group.precision.clone();
        let mut u = group.precision.sum_axis(Axis(1)) * group.mean;
        for (a, ca) in group.columns.iter().enumerate() {
            let ra = row[ca];
            for (b, cb) in group.columns[..=a].iter().enumerate() {
                let rb = row[cb];
                let noise = &posterior.noise;
                let own: f64 = (0..self.joints.len())
                    .filter_map(|j| {
                        let p = self.layout.position(j, *ca)?;
                        let r = self.layout.position(j, *cb)?;
                        let level = &self.joints[j].levels[noise.size[j]];
                        Some(level.xx[[p, r]] / noise.variance[j])
                    })
                    .sum();
                s[[a, b]] += own - beside.cross.row(ra).dot(&beside.moved.row(rb));
            }
            u[a] += beside.left[ra];
        }
        let factor = Cholesky::new(&s);
        let gamma = factor.solve(u.view());
        let gain = 0.5 * u.dot(&gamma) - 0.5 * factor.log_determinant() + group.log_prior();
        (gain, gamma.to_vec())
    }
}

/// Prior of all coefficients of a set.
struct Prior {
    columns: Vec<usize>,
    precision: Array2<f64>,
    /// Precision times mean.
    push: Array1<f64>,
}

impl Prior {
    fn of(base: &[Variable]) -> Self {
        Self {
            columns: base.iter().map(|v| v.column).collect(),
            precision: Array2::from_diag(
                &base.iter().map(|v| v.precision).collect::<Array1<f64>>(),
            ),
            push: base.iter().map(|v| v.precision * v.mean).collect(),
        }
    }

    fn add(&mut self, group: &Group) {
        let first = self.columns.len();
        self.columns.extend(&group.columns);
        let all = self.columns.len();
        let precision = Array2::from_shape_fn((all, all), |(i, k)| match (i < first, k < first) {
            (true, true) => self.precision[[i, k]],
            (false, false) => group.precision[[i - first, k - first]],
            _ => 0.0,
        });
        self.precision = precision;
        let push = group.precision.sum_axis(Axis(1)) * group.mean;
        self.push = ndarray::concatenate![Axis(0), self.push, push];
    }
}

/// Log prior of a size of the unknown torque of one joint.
fn log_prior(size: usize) -> f64 {
    if size == 0 {
        0.0
    } else {
        (ODDS / (SIZES.len() - 1) as f64).ln()
    }
}

#[cfg(test)]
mod tests {
    use super::super::noise::Shape;
    use super::*;

    /// Gain of a hypothesis is the ratio of two normal densities of the recording, written out.
    #[test]
    fn a_gain_is_a_ratio_of_densities() {
        let wave = |w: f64| Array1::from_shape_fn(9, |i| (w * i as f64).sin() + 0.2);
        let (x, y) = (wave(0.7), 2.0 * wave(0.7) + 0.3 * wave(2.9));
        let layout = Layout::new(1, &[vec![0]]);
        let shape = Shape {
            time: 2.0,
            ratio: 0.0,
        };
        let (none, ones) = (Array2::zeros((1, 9)), Array1::ones(9));
        let columns = [x.view()].into_iter();
        let joint = JointRows::new(
            columns,
            &none,
            y.view(),
            ones.view(),
            std::slice::from_ref(&(0..9)),
            shape,
        );
        let rows = Rows {
            joints: vec![joint],
            layout: &layout,
            least: vec![1e-9],
        };
        let empty = rows.posterior(&[], &[], None, true);
        let variance = empty.noise.variance[0];
        assert!((variance - y.dot(&y) / 9.0).abs() < 1e-12);
        assert_eq!(empty.noise.size, [0]);
        let group = Group::new(vec![0], 0.5, Array2::from_elem((1, 1), 0.25));
        let (gain, gamma) = rows.gains(&empty, &[&group]).remove(0);
        let log_density = |mean: &Array1<f64>, covariance: &Array2<f64>| {
            let (left, factor) = (&y - mean, Cholesky::new(covariance));
            -0.5 * left.dot(&factor.solve(left.view())) - 0.5 * factor.log_determinant()
        };
        let white = variance * Array2::<f64>::eye(9);
        let column = x.clone().insert_axis(Axis(1));
        let with = &white + &(4.0 * column.dot(&column.t()));
        let by_hand = log_density(&(0.5 * &x), &with) - log_density(&Array1::zeros(9), &white);
        assert!((gain - by_hand).abs() < 1e-9, "{gain} {by_hand}");
        let precision = x.dot(&x) / variance + 0.25;
        assert!((gamma[0] - (x.dot(&y) / variance + 0.125) / precision).abs() < 1e-12);
        // With its own noise the hypothesis explains more.
        let own = rows.posterior(&[], &[&group], Some(&empty.noise), true);
        assert!(own.log_evidence > empty.log_evidence + gain);
        assert!(own.noise.variance[0] < 0.1 * variance);
    }
}
