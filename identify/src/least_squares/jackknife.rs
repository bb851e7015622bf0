//! Deviations that hold for autocorrelated noise: leave a stretch of time out and see how the estimate moves.

use super::{Estimate, Gram, LeastSquaresError, check_size};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use ndarray::Array2;

/// Least number of blocks from which a deviation is computed: with 24, 3σ intervals cover 99.4 % of normal noise.
const FEWEST: usize = 24;

/// Covariance of an estimate whose noise is correlated in time, from the normal equations of blocks of
/// consecutive rows (each of all joints, weighted as in the fit); together the blocks are the rows of the fit.
///
/// With s_g = h_g − N_g x the score of block g and P the ridge (relative to the columns, as in
/// [`SolveOptions`](super::SolveOptions)), the estimate without that block differs by exactly −(N + P − N_g)⁻¹ s_g;
/// (G − 1)/G times the sum of the squares of these differences is the block jackknife (Künsch, "The jackknife and
/// the bootstrap for general stationary observations", Annals of Statistics 17(3), 1989). It holds where blocks are
/// longer than the memory of the noise, which nobody knows beforehand: neighbouring blocks are joined two by two as
/// long as 24 are left, and each parameter keeps its largest deviation (Flyvbjerg and Petersen, "Error estimates
/// on averages of correlated data", J. Chem. Phys. 91, 1989). It is never below the deviation for independent noise.
///
/// `held` are rows that stay in every fit: those of a prior.
///
/// Fewer than 24 blocks are too few: the estimate's own covariance is returned.
///
/// # Errors
/// Blocks of another number of columns; a system that is singular without one of its blocks.
pub fn block_covariance(
    blocks: &[Gram],
    estimate: &Estimate,
    ridge: f64,
    held: Option<&Gram>,
) -> Result<Array2<f64>, LeastSquaresError> {
    let p = estimate.parameters.len();
    if let Some(held) = held {
        check_size("the rows of every fit", held.columns(), p)?;
    }
    let mut level: Vec<Gram> = blocks.iter().filter(|b| b.rows() > 0).cloned().collect();
    for block in &level {
        check_size("a block", block.columns(), p)?;
    }
    if level.len() < FEWEST {
        return Ok(estimate.covariance.clone());
    }
    let finest = jackknife(&level, estimate, ridge, held)?;
    let mut largest: Vec<f64> = (0..p)
        .map(|i| estimate.covariance[(i, i)].max(finest[(i, i)]))
        .collect();
    while level.len() / 2 >= FEWEST {
        level = joined(&level)?;
        let variance = jackknife(&level, estimate, ridge, held)?;
        for (largest, new) in std::iter::zip(&mut largest, variance.diag()) {
            *largest = largest.max(*new);
        }
    }
    // The correlations of the finest level, which has most blocks to tell directions apart.
    Ok(Array2::from_shape_fn((p, p), |(i, j)| {
        let scale = (finest[(i, i)] * finest[(j, j)]).sqrt();
        if i == j {
            largest[i]
        } else if scale > 0.0 {
            finest[(i, j)] / scale * (largest[i] * largest[j]).sqrt()
        } else {
            0.0
        }
    }))
}

/// Standard deviations of any estimate by the block jackknife, from the sums of blocks of consecutive rows: it
/// is made again without each block.
///
/// Blocks are joined two by two as long as 24 are left, an odd last one counting as a block, and each value keeps its largest deviation,
/// as in [`block_covariance`]; none where there are fewer than 24 blocks.
///
/// # Errors
/// Blocks of different numbers of columns; whatever the estimate fails with.
pub fn refitted_deviations<E: From<LeastSquaresError>>(
    blocks: &[Gram],
    estimate: impl Fn(&Gram) -> Result<Vec<f64>, E>,
) -> Result<Option<Vec<f64>>, E> {
    let mut level: Vec<Gram> = blocks.iter().filter(|b| b.rows() > 0).cloned().collect();
    let mut largest: Option<Vec<f64>> = None;
    while level.len() >= FEWEST {
        let whole = Gram::sum(&level)?;
        let made: Vec<Vec<f64>> = level
            .iter()
            .map(|block| estimate(&whole.less(block)?))
            .collect::<Result<_, E>>()?;
        let count = made.len() as f64;
        let deviations = (0..made[0].len()).map(|i| {
            let mean = made.iter().map(|m| m[i]).sum::<f64>() / count;
            let squares: f64 = made.iter().map(|m| (m[i] - mean).powi(2)).sum();
            ((count - 1.0) / count * squares).sqrt()
        });
        largest = Some(match largest {
            None => deviations.collect(),
            Some(before) => std::iter::zip(before, deviations)
                .map(|(a, b)| a.max(b))
                .collect(),
        });
        level = joined(&level)?;
    }
    Ok(largest)
}

/// Neighbouring blocks joined two by two.
fn joined(blocks: &[Gram]) -> Result<Vec<Gram>, LeastSquaresError> {
    blocks.chunks(2).map(Gram::sum).collect()
}

fn jackknife(
    blocks: &[Gram],
    estimate: &Estimate,
    ridge: f64,
    held: Option<&Gram>,
) -> Result<Array2<f64>, LeastSquaresError> {
    let p = estimate.parameters.len();
    let x = Mat::from_fn(p, 1, |i, _| estimate.parameters[i]);
    let mut whole = Mat::<f64>::zeros(p, p);
    for block in blocks {
        whole += block.products().submatrix(0, 0, p, p);
    }
    if let Some(held) = held {
        whole += held.products().submatrix(0, 0, p, p);
    }
    // Columns of unit norm; those that no row excites stay where the ridge holds them.
    let scale: Vec<f64> = (0..p)
        .map(|j| {
            let norm = whole[(j, j)].sqrt();
            if norm > 0.0 { 1.0 / norm } else { 0.0 }
        })
        .collect();
    // Squared condition numbers leave room for no less than 1e-6, as in `Gram::fit`.
    let ridge2 = ridge.max(1e-6).powi(2);
    let mut steps = Mat::<f64>::zeros(p, blocks.len());
    for (g, block) in blocks.iter().enumerate() {
        let products = block.products();
        let own = products.submatrix(0, 0, p, p);
        let score = products.submatrix(0, p, p, 1) - own * &x;
        let rest = Mat::from_fn(p, p, |i, j| {
            let entry = (whole[(i, j)] - own[(i, j)]) * scale[i] * scale[j];
            let diagonal = if scale[i] > 0.0 { ridge2 } else { 1.0 };
            entry + if i == j { diagonal } else { 0.0 }
        });
        let factor = rest
            .llt(Side::Lower)
            .map_err(|_| LeastSquaresError::Decomposition)?;
        let step = factor.solve(&Mat::from_fn(p, 1, |i, _| scale[i] * score[(i, 0)]));
        for i in 0..p {
            steps[(i, g)] = scale[i] * step[(i, 0)];
        }
    }
    let factor = (blocks.len() - 1) as f64 / blocks.len() as f64;
    let covariance = faer::Scale(factor) * (&steps * steps.transpose());
    Ok(Array2::from_shape_fn((p, p), |(i, j)| covariance[(i, j)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::{Accumulator, SolveOptions, Triangle, solve};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const TRUTH: [f64; 5] = [3.0, -1.0, 0.5, 2.0, 0.3];

    /// Rows of slow and fast motion, friction and an offset in 64 blocks, with noise e ← ρ e + white.
    fn blocks(rho: f64, rng: &mut ChaCha8Rng) -> Vec<Triangle> {
        let mut e = 0.0;
        let phase: f64 = rng.random_range(0.0..6.0);
        (0..64)
            .map(|block| {
                let mut rows = Accumulator::new(5);
                for k in 0..60 {
                    let t = 0.1 * f64::from(60 * block + k);
                    let v = (0.31 * t + phase).sin() + 0.6 * (0.83 * t).cos();
                    let a = [(1.7 * t).sin() * v, v, v.signum(), 1.0, (2.9 * t).cos()];
                    let fresh: f64 = rng.sample(StandardNormal);
                    e = rho * e + fresh;
                    let clean: f64 = std::iter::zip(a, TRUTH).map(|(a, x)| a * x).sum();
                    rows.push(&a, clean + e, 1.0).unwrap();
                }
                rows.finish().unwrap()
            })
            .collect()
    }

    /// Share of parameters within three deviations of the truth: for independent noise, and by blocks; and the
    /// mean ratio of the second deviation to the first.
    fn coverage(rho: f64) -> [f64; 3] {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut within = [0.0; 3];
        let repeats = 200;
        for _ in 0..repeats {
            let blocks = blocks(rho, &mut rng);
            let options = SolveOptions::default();
            let plain = solve(&Triangle::stack(&blocks).unwrap(), &options).unwrap();
            let grams: Vec<Gram> = blocks.iter().map(Gram::from).collect();
            let covariance = block_covariance(&grams, &plain, options.ridge, None).unwrap();
            let aware = plain.clone().with_covariance(covariance).unwrap();
            for (i, truth) in TRUTH.iter().enumerate() {
                let off = (plain.parameters[i] - truth).abs();
                within[0] += f64::from(u8::from(off < 3.0 * plain.std[i]));
                within[1] += f64::from(u8::from(off < 3.0 * aware.std[i]));
                within[2] += aware.std[i] / plain.std[i];
            }
        }
        within.map(|w| w / f64::from(repeats * 5))
    }

    #[test]
    fn three_deviations_cover_coloured_noise() {
        let [plain, aware, _] = coverage(0.95);
        assert!(aware > 0.985, "{aware}");
        // What the deviations for independent noise claim is not true.
        assert!(plain < 0.85, "{plain}");
    }

    #[test]
    fn white_noise_gains_little() {
        let [plain, aware, ratio] = coverage(0.0);
        assert!(aware >= plain && plain > 0.985, "{plain} {aware}");
        assert!((1.0..1.3).contains(&ratio), "{ratio}");
    }

    #[test]
    fn leaving_a_block_out_is_exact() {
        // One parameter, three equal blocks repeated: x is the mean, x without g is the mean of the others.
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let values: Vec<f64> = (0..30).map(|_| rng.sample(StandardNormal)).collect();
        let triangles: Vec<Triangle> = values
            .iter()
            .map(|v| {
                let mut rows = Accumulator::new(1);
                rows.push(&[1.0], *v, 1.0).unwrap();
                rows.finish().unwrap()
            })
            .collect();
        let estimate = solve(
            &Triangle::stack(&triangles).unwrap(),
            &SolveOptions::default(),
        )
        .unwrap();
        let grams: Vec<Gram> = triangles.iter().map(Gram::from).collect();
        let found = jackknife(&grams, &estimate, 0.0, None).unwrap()[(0, 0)];
        let mean = values.iter().sum::<f64>() / 30.0;
        let squares: f64 = values
            .iter()
            .map(|v| ((30.0 * mean - v) / 29.0 - mean).powi(2))
            .sum();
        assert!((found / (squares * 29.0 / 30.0) - 1.0).abs() < 1e-9);
    }
}
