//! Unknown numbers of the plant without effects: its links and friction as the generator draws them around the description, the
//! background's sizes, and a bias of the torque.

use super::marginal::{Columns, Table};
use super::rows::Rows;
use nalgebra::{DMatrix, DVector};
use physics::dynamics::{Workspace, regressor};
use physics::robot::RobotError;
use plant::arm::Arm;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use trials::cases::Witness;

/// Number of plants from which the generator's own covariance is taken.
const DRAWS: usize = 400;
/// Directions of a link's parameters with less than this part of the largest variance are none: they are rounding of the draws.
const RANK: f64 = 1e-6;
/// Number of inertial parameters of a link.
const LINK: usize = 10;

/// Numbers of one link or of one joint's friction: mean, and what each unknown number of unit variance changes.
struct Group {
    mean: DVector<f64>,
    by: DMatrix<f64>,
}

/// Mean and covariance of draws.
fn group(draws: &[DVector<f64>]) -> Group {
    let count = draws.len() as f64;
    let mean = draws.iter().sum::<DVector<f64>>() / count;
    let width = mean.len();
    let deviation = DVector::from_fn(width, |i, _| {
        let sum: f64 = draws.iter().map(|d| (d[i] - mean[i]).powi(2)).sum();
        (sum / count).sqrt()
    });
    let scale = deviation.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 });
    let mut correlation = DMatrix::zeros(width, width);
    for d in draws {
        let x = (d - &mean).component_mul(&scale);
        correlation += &x * x.transpose() / count;
    }
    let eigen = correlation.symmetric_eigen();
    let least = RANK * eigen.eigenvalues.max();
    let own: Vec<DVector<f64>> = (0..width)
        .filter(|&i| eigen.eigenvalues[i] > least.max(0.0))
        .map(|i| {
            let direction = eigen.eigenvectors.column(i) * eigen.eigenvalues[i].sqrt();
            direction.component_mul(&deviation)
        })
        .collect();
    let by = match own.is_empty() {
        true => DMatrix::zeros(width, 0),
        false => DMatrix::from_columns(&own),
    };
    Group { mean, by }
}

/// Columns of the unknown numbers by joint, how many they are, and the rows of the log less what is expected.
pub struct Unknown {
    /// Columns in each joint's rows.
    pub columns: Vec<Columns>,
    /// Number of unknown numbers.
    pub count: usize,
    /// Whitened rows of the log, less those of the plant that is expected.
    pub rest: Table,
}

impl Unknown {
    /// Unknown numbers of a witness's plant.
    ///
    /// # Errors
    /// The bodies make no possible robot.
    pub fn of(witness: &Witness, rows: &Rows) -> Result<Self, RobotError> {
        let n = witness.dof();
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let plants: Vec<Arm> = (0..DRAWS).map(|_| witness.another(&mut rng)).collect();
        let of = |take: &dyn Fn(&Arm) -> Vec<f64>| {
            let draws: Vec<DVector<f64>> = plants
                .iter()
                .map(|arm| DVector::from_vec(take(arm)))
                .collect();
            group(&draws)
        };
        let links: Vec<Group> = (0..n)
            .map(|l| of(&|arm| arm.joints[l].link.inertia.parameters().to_vec()))
            .collect();
        let friction: Vec<Group> = (0..n)
            .map(|j| of(&|arm| vec![arm.joints[j].damping, arm.joints[j].friction]))
            .collect();
        let mut count = 0;
        let mut number = |own: usize| {
            count += own;
            count - own
        };
        let first_of_link: Vec<usize> = links.iter().map(|g| number(g.by.ncols())).collect();
        let first_of_joint: Vec<usize> = friction.iter().map(|g| number(g.by.ncols())).collect();
        let beside: Vec<usize> = witness.background.iter().map(|_| number(1)).collect();
        let bias = witness
            .log
            .bias
            .map(|(joint, size)| (joint, size, number(1)));
        let bodies = Bodies::of(witness)?;
        let arm = witness.plain();
        let mut columns = Vec::new();
        let mut rest = Vec::new();
        let ticks = witness.log.torque.len() / n;
        for j in 0..n {
            let logged: Vec<f64> = (0..ticks).map(|k| witness.log.torque[k * n + j]).collect();
            let mut left = DVector::from_vec(rows.of_log(j, &logged));
            let (mut which, mut own) = (Vec::new(), Vec::new());
            let mut take = |group: &Group, first: usize, raw: Vec<Vec<f64>>| {
                let raw = raw.iter().map(|c| DVector::from_vec(rows.of_torque(j, c)));
                let raw = DMatrix::from_columns(&raw.collect::<Vec<_>>());
                left -= &raw * &group.mean;
                which.extend(first..first + group.by.ncols());
                own.extend((raw * &group.by).column_iter().map(|c| c.into_owned()));
            };
            for l in j..n {
                let raw = (0..LINK).map(|p| bodies.column(j, l * LINK + p));
                take(&links[l], first_of_link[l], raw.collect());
            }
            let speed = |k: usize| witness.state(k)[1][j];
            let laws: [&dyn Fn(f64) -> f64; 2] = [&|v| v, &|v| arm.rest.sign(v, arm.v_eps[j])];
            let raw = laws.map(|law| (0..ticks).map(|k| law(speed(k))).collect());
            take(&friction[j], first_of_joint[j], raw.to_vec());
            for (b, &first) in witness.background.iter().zip(&beside) {
                let torque: Vec<f64> = (0..ticks).map(|k| b[k * n + j]).collect();
                if torque.iter().any(|t| t.abs() > 1e-9) {
                    // As likely as not twice as large, or absent.
                    let one = Group {
                        mean: DVector::from_element(1, 1.0),
                        by: DMatrix::from_element(1, 1, 1.0),
                    };
                    take(&one, first, vec![torque]);
                }
            }
            if let Some((_, size, first)) = bias.filter(|b| b.0 == j) {
                let one = Group {
                    mean: DVector::zeros(1),
                    by: DMatrix::from_element(1, 1, size),
                };
                take(&one, first, vec![vec![1.0; ticks]]);
            }
            columns.push(Columns {
                which,
                values: DMatrix::from_columns(&own),
            });
            rest.push(Some(left.as_slice().to_vec()));
        }
        Ok(Self {
            columns,
            count,
            rest,
        })
    }
}

/// Rigid-body torque per inertial parameter, by row of the trace.
struct Bodies {
    values: Vec<f32>,
    dof: usize,
}

impl Bodies {
    fn of(witness: &Witness) -> Result<Self, RobotError> {
        let robot = witness.plain().robot()?;
        let n = robot.dof();
        let mut workspace = Workspace::new(&robot);
        let mut y = vec![0.0; n * n * LINK];
        let ticks = witness.log.torque.len() / n;
        let mut values = Vec::with_capacity(ticks * y.len());
        for k in 0..ticks {
            let [q, v, a] = witness.state(k);
            regressor(&robot, &mut workspace, q, v, a, &mut y);
            values.extend(y.iter().map(|x| *x as f32));
        }
        Ok(Self { values, dof: n })
    }

    fn column(&self, joint: usize, parameter: usize) -> Vec<f64> {
        let width = self.dof * LINK;
        let rows = self.values.chunks(self.dof * width);
        rows.map(|row| f64::from(row[joint * width + parameter]))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers (x, 2x) for x = −1, 1: one direction, which carries all of the covariance.
    #[test]
    fn a_group_has_as_many_directions_as_its_draws() {
        let draws = [-1.0, 1.0].map(|x| DVector::from_vec(vec![3.0 + x, 2.0 * x]));
        let group = group(&draws);
        assert_eq!(group.mean.as_slice(), &[3.0, 0.0]);
        assert_eq!(group.by.ncols(), 1);
        let covariance = &group.by * group.by.transpose();
        let expected = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]);
        assert!((covariance - expected).norm() < 1e-12);
    }
}
