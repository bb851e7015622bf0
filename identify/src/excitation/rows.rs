//! Regressor rows of the base parameters.

use crate::base::{BaseParameters, Extra};
use physics::dynamics::{Workspace, regressor};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Rows of a robot's base regressor, with the extra columns that the base parameters were found with.
#[derive(Debug, Clone)]
pub struct BaseRows<'a> {
    robot: &'a Robot,
    extras: &'a [Extra],
    /// Column of each base parameter among the 10 N standard ones and the extras.
    columns: Vec<usize>,
    workspace: Workspace,
    rigid: Vec<f64>,
}

impl<'a> BaseRows<'a> {
    /// `extras` as given to [`BaseParameters::of_robot`].
    pub fn new(robot: &'a Robot, base: &BaseParameters, extras: &'a [Extra]) -> Self {
        let n = robot.dof();
        Self {
            robot,
            extras,
            columns: base.independent().to_vec(),
            workspace: Workspace::new(robot),
            rigid: vec![0.0; PARAMETERS_PER_LINK * n * n],
        }
    }

    /// Number of joints N of the robot.
    pub fn dof(&self) -> usize {
        self.robot.dof()
    }

    /// Number of base parameters b.
    pub fn columns(&self) -> usize {
        self.columns.len()
    }

    /// The N × b rows of a state, row-major.
    ///
    /// # Panics
    /// When a slice has another length.
    pub fn fill(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], rows: &mut [f64]) {
        let n = self.robot.dof();
        let width = PARAMETERS_PER_LINK * n;
        regressor(self.robot, &mut self.workspace, q, qd, qdd, &mut self.rigid);
        for (joint, row) in rows.chunks_exact_mut(self.columns.len()).enumerate() {
            for (entry, &column) in std::iter::zip(row, &self.columns) {
                *entry = if column < width {
                    self.rigid[joint * width + column]
                } else {
                    let (extra, owner) = ((column - width) / n, (column - width) % n);
                    if owner == joint {
                        self.extras[extra].value(qd[joint], qdd[joint])
                    } else {
                        0.0
                    }
                };
            }
        }
    }

    /// Columns of second moments and rotor inertias, of masses and first moments, and of friction: the parts of
    /// Han's criterion.
    pub fn parts(&self) -> [Vec<usize>; 3] {
        let n = self.robot.dof();
        let width = PARAMETERS_PER_LINK * n;
        let mut parts = [Vec::new(), Vec::new(), Vec::new()];
        for (j, &column) in self.columns.iter().enumerate() {
            let part = if column < width {
                usize::from(column % PARAMETERS_PER_LINK < 4)
            } else if self.extras[(column - width) / n] == Extra::RotorInertia {
                0
            } else {
                2
            };
            parts[part].push(j);
        }
        parts
    }
}
