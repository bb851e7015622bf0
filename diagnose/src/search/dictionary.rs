//! Dictionary of columns: torque per unit of each parameter, for the base and all candidates.

use crate::algebra::gram::Layout;
use crate::catalogue::{Candidate, Column, ColumnTorque, base_columns};
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use ndarray::Array1;
use physics::batch::regressor_columns;
use physics::robot::PARAMETERS_PER_LINK;
use rayon::prelude::*;

/// Number of columns that are in memory at the fine rate at the same time. Inertial columns come in addition: one pass
/// over the motion gives all of them.
const BATCH: usize = 16;

/// Number of columns that one call of the low-pass filters.
const TOGETHER: usize = 8;

/// Columns of the regression: torque per unit of each parameter of the base and of the candidates, each column once.
pub struct Dictionary {
    /// Columns by their number: those of the base first.
    columns: Vec<Column>,
    /// Numbers of the columns of each candidate.
    pub members: Vec<Vec<usize>>,
}

impl Dictionary {
    /// Numbers the columns: the base first, then those of the candidates.
    pub fn new(dof: usize, candidates: &[Candidate]) -> Self {
        let mut columns = base_columns(dof);
        let base = columns.len();
        let mut members = Vec::with_capacity(candidates.len());
        for candidate in candidates {
            let mut ids = Vec::with_capacity(candidate.columns.len());
            for column in &candidate.columns {
                if let ColumnTorque::Base(id) = column.torque {
                    ids.push(id);
                    continue;
                }
                let known = columns[base..].iter().position(|c| c.is(column));
                ids.push(base + known.unwrap_or(columns.len() - base));
                if known.is_none() {
                    columns.push(column.clone());
                }
            }
            members.push(ids);
        }
        Self { columns, members }
    }

    /// Column with the index `id`.
    pub fn column(&self, id: usize) -> &Column {
        &self.columns[id]
    }

    /// Number of columns in the dictionary.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether the dictionary has no column.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Columns `ids` at the fine rate, delayed as they are recorded: (column, joint, torque per unit).
    pub fn evaluate(&self, scene: &Scene, ids: &[usize]) -> Vec<(usize, usize, Array1<f64>)> {
        let inertial = PARAMETERS_PER_LINK * scene.dof();
        let wanted: Vec<usize> = ids.iter().copied().filter(|&c| c < inertial).collect();
        let mut out = inertial_columns(scene, &wanted);
        let made: Vec<Vec<(usize, usize, Array1<f64>)>> = ids
            .par_iter()
            .filter(|&&c| c >= inertial)
            .map(|&c| match &self.columns[c].torque {
                ColumnTorque::Base(b) => {
                    let (kind, joint) =
                        ((b - inertial) / scene.dof(), (b - inertial) % scene.dof());
                    let table = if kind == 0 {
                        &scene.motion.qd
                    } else {
                        &scene.sign
                    };
                    vec![(c, joint, table.column(joint).to_owned())]
                }
                ColumnTorque::Terms(terms) => {
                    let joint = self.columns[c].joints[0];
                    vec![(c, joint, scene.terms(joint, terms))]
                }
                ColumnTorque::Made(make) => {
                    let joints = self.columns[c].joints.iter();
                    joints
                        .zip(make(scene))
                        .map(|(&j, values)| (c, j, values))
                        .collect()
                }
            })
            .collect();
        out.extend(made.into_iter().flatten());
        if let Some(channel) = &scene.scale.channel {
            out.par_iter_mut().for_each(|(c, j, values)| {
                if !self.columns[*c].recorded {
                    *values = channel.recorded(scene.motion, *j, values.view());
                }
            });
        }
        out
    }

    /// Joints on whose torque each column acts.
    pub fn layout(&self, dof: usize) -> Layout {
        let joints: Vec<Vec<usize>> = self.columns.iter().map(|c| c.joints.clone()).collect();
        Layout::new(dof, &joints)
    }

    /// Column numbers from `first` on in batches to evaluate together: the inertial ones, then the others by [`BATCH`].
    pub(super) fn batches(&self, dof: usize, first: usize) -> Vec<Vec<usize>> {
        let (inertial, others): (Vec<usize>, Vec<usize>) =
            (first..self.len()).partition(|&c| c < PARAMETERS_PER_LINK * dof);
        let others = others.chunks(BATCH).map(<[usize]>::to_vec);
        std::iter::once(inertial).chain(others).collect()
    }

    /// Columns `ids` on the fitted rows: (column, joint, torque per unit).
    pub(super) fn reduced(
        &self,
        scene: &Scene,
        frame: &Frame,
        ids: &[usize],
    ) -> Vec<(usize, usize, Array1<f64>)> {
        let fine = self.evaluate(scene, ids);
        let together = |some: &[(usize, usize, Array1<f64>)]| {
            let columns: Vec<&Array1<f64>> = some.iter().map(|c| &c.2).collect();
            let rows = frame.reduce_each(&columns).into_iter();
            let named = some
                .iter()
                .zip(rows)
                .map(|((c, j, _), rows)| (*c, *j, rows));
            named.collect::<Vec<_>>()
        };
        fine.par_chunks(TOGETHER).flat_map_iter(together).collect()
    }
}

/// Columns `wanted` of inertial parameters at the fine rate: (column, joint, torque per unit). A link's parameters act
/// on its own joint and all joints before it.
fn inertial_columns(scene: &Scene, wanted: &[usize]) -> Vec<(usize, usize, Array1<f64>)> {
    let entries: Vec<(usize, usize)> = wanted
        .iter()
        .flat_map(|&c| (0..=c / PARAMETERS_PER_LINK).map(move |j| (j, c)))
        .collect();
    let m = scene.motion;
    let columns = regressor_columns(scene.robot, &m.q, &m.qd, &m.qdd, &entries, |_| true);
    let named = entries.into_iter().zip(columns);
    named
        .map(|((j, c), column)| (c, j, column.into()))
        .collect()
}
