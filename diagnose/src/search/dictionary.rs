//! From candidates and a recording to sums of products.

use crate::algebra::gram::{Grams, JointGram, Layout};
use crate::catalogue::{Candidate, Column, ColumnTorque, base_columns};
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use ndarray::{Array1, Array2};
use physics::dynamics::{Workspace, regressor};
use physics::robot::PARAMETERS_PER_LINK;
use rayon::prelude::*;
use std::ops::Range;

/// Columns that are in memory at the fine rate together, beside the inertial ones, which one pass over the motion gives.
const BATCH: usize = 32;

/// Columns that the low-pass takes together.
const TOGETHER: usize = 8;

/// What a fit leaves, by stretch of time.
pub struct Stretches {
    /// Fold of each stretch.
    pub fold: Vec<usize>,
    /// By joint, shape (active columns, stretches).
    pub products: Vec<Array2<f64>>,
    /// Weighted sums of squares, shape (stretches, joints).
    pub squares: Array2<f64>,
}

/// The columns of base and candidates, without repeats.
pub struct Dictionary {
    columns: Vec<Column>,
    /// Columns of each candidate.
    pub members: Vec<Vec<usize>>,
}

impl Dictionary {
    /// Numbers the columns: the base first, then the candidates' own.
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

    /// A column by its number.
    pub fn column(&self, id: usize) -> &Column {
        &self.columns[id]
    }

    /// Number of columns.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// True when there is no column.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Columns named by `ids` at the fine rate, as they are recorded: (column, joint, values).
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

    /// Numbers of all columns: the inertial ones, then the others by the batch.
    fn batches(&self, dof: usize) -> Vec<Vec<usize>> {
        let (inertial, others): (Vec<usize>, Vec<usize>) =
            (0..self.len()).partition(|&c| c < PARAMETERS_PER_LINK * dof);
        let others = others.chunks(BATCH).map(<[usize]>::to_vec);
        std::iter::once(inertial).chain(others).collect()
    }

    /// Columns named by `ids` on the rows that are fitted: (column, joint, values).
    fn reduced(
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

    /// Products of all columns with what a fit leaves of the fitted rows, by stretch of time; each stretch lies in one fold.
    pub fn by_stretch(
        &self,
        scene: &Scene,
        frame: &Frame,
        residual: &Array2<f64>,
        weight: &Array2<f64>,
        stretches: &[(usize, Range<usize>)],
    ) -> Stretches {
        let dof = scene.dof();
        let joints: Vec<Vec<usize>> = self.columns.iter().map(|c| c.joints.clone()).collect();
        let layout = Layout::new(dof, &joints);
        let size = |a: &Vec<usize>| Array2::zeros((a.len(), stretches.len()));
        let mut products: Vec<Array2<f64>> = layout.active.iter().map(size).collect();
        let weighted = residual * weight;
        for batch in self.batches(dof) {
            let sums: Vec<(usize, usize, Array1<f64>)> = self
                .reduced(scene, frame, &batch)
                .into_par_iter()
                .map(|(c, j, rows)| {
                    let of = |(_, r): &(usize, Range<usize>)| -> f64 {
                        r.clone().map(|i| rows[i] * weighted[[i, j]]).sum()
                    };
                    (c, j, stretches.iter().map(of).collect())
                })
                .collect();
            for (c, j, values) in sums {
                let p = layout
                    .position(j, c)
                    .expect("a column touches the joints that it names");
                products[j].row_mut(p).assign(&values);
            }
        }
        let squares = Array2::from_shape_fn((stretches.len(), dof), |(b, j)| {
            let rows = stretches[b].1.clone();
            rows.map(|i| weighted[[i, j]] * residual[[i, j]]).sum()
        });
        Stretches {
            fold: stretches.iter().map(|s| s.0).collect(),
            squares,
            products,
        }
    }

    /// Products of all columns and the gap `y` (rows, joints), by fold of whole trajectories.
    pub fn grams(
        &self,
        scene: &Scene,
        frame: &Frame,
        y: &Array2<f64>,
        weight: &Array2<f64>,
        folds: &[Vec<Range<usize>>],
    ) -> Grams {
        let dof = scene.dof();
        let joints: Vec<Vec<usize>> = self.columns.iter().map(|c| c.joints.clone()).collect();
        let layout = Layout::new(dof, &joints);
        let mut tables: Vec<Array2<f64>> = layout
            .active
            .iter()
            .map(|a| Array2::zeros((frame.len(), a.len())))
            .collect();
        for batch in self.batches(dof) {
            for (c, j, values) in self.reduced(scene, frame, &batch) {
                let p = layout
                    .position(j, c)
                    .expect("a column touches the joints that it names");
                tables[j].column_mut(p).assign(&values);
            }
        }
        let cells: Vec<(usize, usize)> = (0..folds.len())
            .flat_map(|f| (0..dof).map(move |j| (f, j)))
            .collect();
        let grams: Vec<JointGram> = cells
            .into_par_iter()
            .map(|(f, j)| {
                let rows: Vec<usize> = folds[f].iter().cloned().flatten().collect();
                let axis = ndarray::Axis(0);
                let pick = |t: &Array2<f64>| t.column(j).select(axis, &rows);
                JointGram::new(
                    tables[j].select(axis, &rows).view(),
                    pick(y).view(),
                    pick(weight).view(),
                )
            })
            .collect();
        Grams::new(
            layout,
            grams.chunks(dof).map(<[JointGram]>::to_vec).collect(),
        )
    }
}

/// Columns of inertial parameters, joints below their link.
fn inertial_columns(scene: &Scene, wanted: &[usize]) -> Vec<(usize, usize, Array1<f64>)> {
    if wanted.is_empty() {
        return Vec::new();
    }
    let (dof, n) = (scene.dof(), scene.len());
    let mut out: Vec<(usize, usize, Array1<f64>)> = wanted
        .iter()
        .flat_map(|&c| (0..=c / PARAMETERS_PER_LINK).map(move |j| (c, j, Array1::zeros(n))))
        .collect();
    let mut workspace = Workspace::new(scene.robot);
    let width = PARAMETERS_PER_LINK * dof;
    let mut y = vec![0.0; dof * width];
    let m = scene.motion;
    for i in 0..n {
        let row = |t: &Array2<f64>| t.row(i).to_vec();
        regressor(
            scene.robot,
            &mut workspace,
            &row(&m.q),
            &row(&m.qd),
            &row(&m.qdd),
            &mut y,
        );
        for (c, j, values) in &mut out {
            values[i] = y[*j * width + *c];
        }
    }
    out
}
