//! Base parameters: the combinations of standard parameters that torque can reveal.
//!
//! Some columns of a regressor depend linearly on others whatever the motion, so only combinations of
//! parameters act on the torque. They are found numerically for any chain (Gautier, 1991, "Numerical
//! calculation of the base inertial parameters of robots"): the regressor of random states has as many independent columns as there are
//! base parameters, and each dependent column is a fixed combination of independent ones.

mod columns;
mod formula;
mod selection;

pub use columns::Extra;

use faer::{Mat, MatRef};
use physics::robot::Robot;
use selection::Selection;

/// Base parameters of a regressor with p columns: β = G·π with b ≤ p values, and for every motion
/// Y·π = Y\[:, independent\]·β.
#[derive(Debug, Clone)]
pub struct BaseParameters {
    names: Vec<String>,
    independent: Vec<usize>,
    unidentifiable: Vec<usize>,
    grouping: Mat<f64>,
}

impl BaseParameters {
    /// Base parameters of the rigid body, with further columns behind the 10 N standard ones.
    ///
    /// Deterministic: the random states come from a fixed seed. Among equivalent choices the parameters of the links nearer the
    /// base are kept, and within a link mass, m·cz and Iyy go first, so that for joints about z the classical
    /// grouping results (Khalil and Gautier).
    pub fn of_robot(robot: &Robot, extras: &[Extra]) -> Self {
        let (samples, names) = columns::random_samples(robot, extras);
        let mut order = Vec::new();
        for link in 0..robot.dof() {
            // Ixx Ixy Ixz Iyz Izz mx my | Iyy mz m: what comes first is kept.
            order.extend([4, 5, 7, 8, 9, 1, 2, 6, 3, 0].map(|k| 10 * link + k));
        }
        order.extend(10 * robot.dof()..names.len());
        Self::from_samples(samples.as_ref(), names, &order)
    }

    /// Base parameters of any regressor from samples of it (rows: torques of random states, several times as
    /// many as columns). Columns named first in `order` are kept where there is a choice.
    ///
    /// # Panics
    /// When `names` or `order` do not have one entry per column.
    pub fn from_samples(samples: MatRef<'_, f64>, names: Vec<String>, order: &[usize]) -> Self {
        assert_eq!(names.len(), samples.ncols(), "one name per column");
        assert_eq!(order.len(), samples.ncols(), "one place per column");
        let Selection {
            independent,
            unidentifiable,
            grouping,
        } = selection::select(samples, order);
        Self {
            names,
            independent,
            unidentifiable,
            grouping,
        }
    }

    /// Number of base parameters, b.
    pub fn len(&self) -> usize {
        self.independent.len()
    }

    /// Whether nothing can be identified.
    pub fn is_empty(&self) -> bool {
        self.independent.is_empty()
    }

    /// Names of the p columns: `m1` … `Izz6`, then the extra ones.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Indices, ascending, of the independent columns, one per base parameter (b values).
    pub fn independent(&self) -> &[usize] {
        &self.independent
    }

    /// Indices of the columns that no motion excites: their parameters have no effect at all.
    pub fn unidentifiable(&self) -> &[usize] {
        &self.unidentifiable
    }

    /// G (b × p): base parameters from all parameters; the identity in the independent columns.
    pub fn grouping(&self) -> MatRef<'_, f64> {
        self.grouping.as_ref()
    }

    /// β = G·π.
    ///
    /// # Panics
    /// When `parameters` has not p values.
    pub fn base_from(&self, parameters: &[f64]) -> Vec<f64> {
        assert_eq!(parameters.len(), self.names.len(), "one value per column");
        (0..self.len())
            .map(|i| {
                let row = self.grouping.row(i);
                row.iter().zip(parameters).map(|(g, p)| g * p).sum()
            })
            .collect()
    }

    /// The simplest π with G·π = β: β in the independent columns, zero elsewhere. It predicts the same
    /// torque, but its links need not be physically possible.
    ///
    /// # Panics
    /// When `base` has not b values.
    pub fn standard_from(&self, base: &[f64]) -> Vec<f64> {
        assert_eq!(base.len(), self.len(), "one value per base parameter");
        let mut parameters = vec![0.0; self.names.len()];
        for (&column, &value) in self.independent.iter().zip(base) {
            parameters[column] = value;
        }
        parameters
    }

    /// Names of the base parameters: those of the independent columns.
    pub fn base_names(&self) -> Vec<String> {
        self.independent
            .iter()
            .map(|&i| self.names[i].clone())
            .collect()
    }

    /// The parameters that form each base parameter, e.g. `Ixx2 - Iyy2 - 0.0729 m3`.
    pub fn formulae(&self) -> Vec<String> {
        (0..self.len())
            .map(|i| {
                formula::sum(
                    self.independent[i],
                    self.grouping.row(i).iter(),
                    &self.names,
                )
            })
            .collect()
    }
}
