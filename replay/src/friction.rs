//! Dry friction with sticking: one implicit step of a chain whose joints can rest.

/// State of a joint's dry friction during a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slip {
    /// Joint at rest: friction takes whatever torque holds it, up to its limit.
    Stick,
    /// Joint moving in the positive direction: friction is at its limit, against the motion.
    Forward,
    /// Joint moving in the negative direction: friction is at its limit, against the motion.
    Backward,
}

impl Slip {
    /// Sign of the joint's motion: 1, −1, or 0 at rest.
    pub fn sign(self) -> f64 {
        match self {
            Self::Stick => 0.0,
            Self::Forward => 1.0,
            Self::Backward => -1.0,
        }
    }
}

/// Solver for velocities v and friction f after an implicit step: A v + f = b with |f_i| ≤ limit_i, and f_i =
/// limit_i·sign(v_i) where v_i ≠ 0.
///
/// A is symmetric positive definite, so that the solution is unique (a box-constrained linear complementarity problem;
/// Cottle, Pang and Stone, 1992, theorem 3.1.6).
#[derive(Debug, Clone)]
pub struct Friction {
    /// Number N of joints.
    n: usize,
    /// State of each joint's friction in the last step, from which the next solution starts.
    pub slip: Vec<Slip>,
    /// Joint velocities v after the last step, N values.
    pub velocity: Vec<f64>,
    /// Friction f of each joint in the last step, N values, in the unit of b (an impulse).
    pub force: Vec<f64>,
    /// Lower Cholesky factor of A over the joints that slip, row-major with N columns.
    factor: Vec<f64>,
    /// Indices of the joints that slip, increasing.
    moving: Vec<usize>,
}

impl Friction {
    /// Solver for a chain of `n` joints, all at rest.
    pub fn new(n: usize) -> Self {
        Self {
            n,
            slip: vec![Slip::Stick; n],
            velocity: vec![0.0; n],
            force: vec![0.0; n],
            factor: vec![0.0; n * n],
            moving: Vec::with_capacity(n),
        }
    }

    /// Indices of the joints that slip after [`Friction::solve`].
    pub fn moving(&self) -> &[usize] {
        &self.moving
    }

    /// Solves one step and stores the result. False where A is not positive definite or no consistent set of slipping
    /// joints was found.
    pub fn solve(&mut self, a: &[f64], b: &[f64], limit: &[f64]) -> bool {
        let n = self.n;
        // Joints whose state contradicts their solution all change at once in the first rounds. Later they change one
        // at a time (Murty's least index), which always ends.
        for round in 0..8 * n + 8 {
            if !self.slide(a, b, limit) {
                return false;
            }
            let mut wrong = 0;
            for (i, &limit) in limit.iter().enumerate() {
                let next = self.next(i, limit);
                if next != self.slip[i] {
                    wrong += 1;
                    self.slip[i] = next;
                    if round > 4 {
                        break;
                    }
                }
            }
            if wrong == 0 {
                return true;
            }
        }
        false
    }

    /// State that joint `i` must change to by its present velocity and friction; its own state where that is
    /// consistent.
    fn next(&self, i: usize, limit: f64) -> Slip {
        match self.slip[i] {
            Slip::Stick if self.force[i] > limit => Slip::Forward,
            Slip::Stick if self.force[i] < -limit => Slip::Backward,
            Slip::Stick => Slip::Stick,
            slip if self.velocity[i] * slip.sign() >= 0.0 => slip,
            _ if limit > 0.0 => Slip::Stick,
            Slip::Forward => Slip::Backward,
            _ => Slip::Forward,
        }
    }

    /// Velocities and friction for the present states of the joints. False where A is not positive definite.
    fn slide(&mut self, a: &[f64], b: &[f64], limit: &[f64]) -> bool {
        let n = self.n;
        self.moving.clear();
        self.moving
            .extend((0..n).filter(|&i| self.slip[i] != Slip::Stick));
        for r in 0..self.moving.len() {
            for c in 0..=r {
                let mut sum = a[self.moving[r] * n + self.moving[c]];
                for k in 0..c {
                    sum -= self.factor[r * n + k] * self.factor[c * n + k];
                }
                if r == c {
                    if sum.is_nan() || sum <= 0.0 {
                        return false;
                    }
                    self.factor[r * n + r] = sum.sqrt();
                } else {
                    self.factor[r * n + c] = sum / self.factor[c * n + c];
                }
            }
        }
        for (i, &limit) in limit.iter().enumerate() {
            self.force[i] = limit * self.slip[i].sign();
            self.velocity[i] = 0.0;
        }
        let m = self.moving.len();
        for r in 0..m {
            let i = self.moving[r];
            let mut sum = b[i] - self.force[i];
            for k in 0..r {
                sum -= self.factor[r * n + k] * self.velocity[self.moving[k]];
            }
            self.velocity[i] = sum / self.factor[r * n + r];
        }
        for r in (0..m).rev() {
            let i = self.moving[r];
            let mut sum = self.velocity[i];
            for k in r + 1..m {
                sum -= self.factor[k * n + r] * self.velocity[self.moving[k]];
            }
            self.velocity[i] = sum / self.factor[r * n + r];
        }
        for i in (0..n).filter(|&i| self.slip[i] == Slip::Stick) {
            let row = &a[i * n..][..n];
            let moved: f64 = row.iter().zip(&self.velocity).map(|(a, v)| a * v).sum();
            self.force[i] = b[i] - moved;
        }
        true
    }

    /// Solves A x = rhs over the joints that slip, for many right-hand sides at once and in place. Rows of joints at
    /// rest become zero. `rhs` is row-major, N rows of `columns` values.
    #[inline(always)]
    pub fn back_substitute(&self, rhs: &mut [f64], columns: usize) {
        let n = self.n;
        for i in (0..n).filter(|&i| self.slip[i] == Slip::Stick) {
            rhs[i * columns..][..columns].fill(0.0);
        }
        let m = self.moving.len();
        for r in 0..m {
            for k in 0..r {
                subtract(
                    rhs,
                    columns,
                    self.moving[r],
                    self.moving[k],
                    self.factor[r * n + k],
                );
            }
            scale(rhs, columns, self.moving[r], 1.0 / self.factor[r * n + r]);
        }
        for r in (0..m).rev() {
            for k in r + 1..m {
                subtract(
                    rhs,
                    columns,
                    self.moving[r],
                    self.moving[k],
                    self.factor[k * n + r],
                );
            }
            scale(rhs, columns, self.moving[r], 1.0 / self.factor[r * n + r]);
        }
    }
}

/// Subtracts `factor` times row `from` from row `to`.
#[inline(always)]
fn subtract(rows: &mut [f64], columns: usize, to: usize, from: usize, factor: f64) {
    let (low, high) = (to.min(from), to.max(from));
    let (before, after) = rows.split_at_mut(high * columns);
    let (low, high) = (
        &mut before[low * columns..][..columns],
        &mut after[..columns],
    );
    let (target, source) = if to < from { (low, high) } else { (high, low) };
    for (t, s) in target.iter_mut().zip(source.iter()) {
        *t -= factor * s;
    }
}

/// Multiplies one row by `factor`.
#[inline(always)]
fn scale(rows: &mut [f64], columns: usize, row: usize, factor: f64) {
    for v in &mut rows[row * columns..][..columns] {
        *v *= factor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_weight_rests_until_friction_is_exceeded() {
        let mut one = Friction::new(1);
        assert!(one.solve(&[2.0], &[0.9], &[1.0]));
        assert_eq!((one.velocity[0], one.force[0]), (0.0, 0.9));
        assert!(one.solve(&[2.0], &[1.5], &[1.0]));
        assert!((one.velocity[0] - 0.25).abs() < 1e-15 && one.force[0] == 1.0);
        // Too slow to turn round within the step: it stops.
        assert!(one.solve(&[2.0], &[-0.5], &[1.0]));
        assert_eq!((one.velocity[0], one.force[0]), (0.0, -0.5));
    }

    proptest! {
        /// The conditions of the problem hold, whatever the joints did before.
        #[test]
        fn the_solution_is_consistent(
            l in prop::collection::vec(-1.0..1.0f64, 25),
            b in prop::collection::vec(-2.0..2.0f64, 5),
            limit in prop::collection::vec(0.0..2.0f64, 5),
            before in prop::collection::vec(0..3usize, 5),
        ) {
            let n = 5;
            let mut a = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..n {
                    a[i * n + j] = (0..n).map(|k| l[i * n + k] * l[j * n + k]).sum::<f64>()
                        + if i == j { 0.1 } else { 0.0 };
                }
            }
            let mut friction = Friction::new(n);
            friction.slip = before.iter().map(|&k| [Slip::Stick, Slip::Forward, Slip::Backward][k]).collect();
            prop_assert!(friction.solve(&a, &b, &limit));
            for i in 0..n {
                let av: f64 = (0..n).map(|j| a[i * n + j] * friction.velocity[j]).sum();
                prop_assert!((av + friction.force[i] - b[i]).abs() < 1e-9);
                prop_assert!(friction.force[i].abs() <= limit[i] + 1e-12);
                let v = friction.velocity[i];
                if v.abs() > 1e-12 {
                    prop_assert!((friction.force[i] - limit[i] * v.signum()).abs() < 1e-12);
                }
            }
        }
    }
}
