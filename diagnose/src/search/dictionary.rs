//! Dictionary of columns: torque per unit of each parameter, for the base and all candidates.

use crate::algebra::gram::Layout;
use crate::catalogue::{Candidate, Column, ColumnTorque, base_columns};
use crate::motion::part::Part;
use crate::motion::scene::Scene;
use ndarray::{Array1, Axis};
use physics::batch::regressor_columns;
use physics::robot::PARAMETERS_PER_LINK;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Number of columns that one task evaluates and reduces. Inertial columns come in addition: one pass over the motion
/// gives all of them.
const TOGETHER: usize = 8;

/// Columns on some trajectories: (column, joint, torque per unit).
pub type Values = Vec<(usize, usize, Array1<f64>)>;

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

    /// Columns `ids` at the fine rate, delayed as they are recorded.
    pub fn evaluate(&self, scene: &Scene, ids: &[usize]) -> Values {
        let inertial = PARAMETERS_PER_LINK * scene.dof();
        let (links, others): (Vec<usize>, Vec<usize>) = ids
            .iter()
            .copied()
            .partition(|&c| self.is_of_link(c, scene.dof()));
        let mut out = self.link_columns(scene, &links);
        let made: Vec<Vec<(usize, usize, Array1<f64>)>> = others
            .par_iter()
            .map(|&c| match &self.columns[c].torque {
                ColumnTorque::Link(..) => Vec::new(),
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

    /// Whether a column is the torque of a link's inertial parameters, or of a combination of them.
    fn is_of_link(&self, id: usize, dof: usize) -> bool {
        match self.columns[id].torque {
            ColumnTorque::Base(b) => b < PARAMETERS_PER_LINK * dof,
            ColumnTorque::Link(..) => true,
            ColumnTorque::Terms(_) | ColumnTorque::Made(_) => false,
        }
    }

    /// Columns `ids` of inertial parameters at the fine rate: (column, joint, torque per unit). One pass over the motion
    /// gives all of them. A link's parameters act on its own joint and all joints before it.
    fn link_columns(&self, scene: &Scene, ids: &[usize]) -> Values {
        let mut needed = BTreeSet::new();
        for &c in ids {
            match self.columns[c].torque {
                ColumnTorque::Link(link, _) => {
                    let first = PARAMETERS_PER_LINK * link;
                    needed.extend(first..first + PARAMETERS_PER_LINK);
                }
                _ => _ = needed.insert(c),
            }
        }
        if needed.is_empty() {
            return Vec::new();
        }
        let entries: Vec<(usize, usize)> = needed
            .iter()
            .flat_map(|&c| (0..=c / PARAMETERS_PER_LINK).map(move |j| (j, c)))
            .collect();
        let m = scene.motion;
        let columns = regressor_columns(scene.robot, &m.q, &m.qd, &m.qdd, &entries, |_| true);
        let columns = columns.into_iter().map(Array1::from);
        let made: BTreeMap<(usize, usize), Array1<f64>> =
            entries.into_iter().zip(columns).collect();
        let each = ids.par_iter().flat_map_iter(|&c| {
            let made = &made;
            let column = &self.columns[c];
            column.joints.iter().map(move |&j| match &column.torque {
                ColumnTorque::Link(link, change) => {
                    let mut sum = Array1::zeros(scene.len());
                    for (p, size) in change.iter().enumerate() {
                        sum.scaled_add(*size, &made[&(j, PARAMETERS_PER_LINK * link + p)]);
                    }
                    (c, j, sum)
                }
                _ => (c, j, made[&(j, c)].clone()),
            })
        });
        each.collect()
    }

    /// Joints on whose torque each column acts.
    pub fn layout(&self, dof: usize) -> Layout {
        let joints: Vec<Vec<usize>> = self.columns.iter().map(|c| c.joints.clone()).collect();
        Layout::new(dof, &joints)
    }

    /// Columns `ids` of a recording part by part, in one order. `reduced` takes columns on the fine grid of some
    /// trajectories to other stamps. `take` is called with each part's trajectories in turn.
    ///
    /// Columns of friction with memory, which runs on through the recording, are evaluated as a whole before.
    pub fn by_part(
        &self,
        scene: &Scene,
        ids: &[usize],
        reduced: impl Fn(Range<usize>, &[&Array1<f64>]) -> Vec<Array1<f64>> + Sync,
        mut take: impl FnMut(Range<usize>, Values),
    ) {
        let parts = Part::all(scene.motion);
        let reduce = |some: &[(usize, usize, Array1<f64>)], at: &Range<usize>| -> Values {
            let columns: Vec<&Array1<f64>> = some.iter().map(|c| &c.2).collect();
            let columns = some.iter().zip(reduced(at.clone(), &columns));
            columns.map(|((c, j, _), x)| (*c, *j, x)).collect()
        };
        let torque = |c: usize| &self.columns[c].torque;
        let remembers = |c: &usize| match torque(*c) {
            ColumnTorque::Terms(terms) => terms.iter().any(|t| t.1.remembers()),
            _ => false,
        };
        let (passed, ids): (Vec<usize>, Vec<usize>) = ids.iter().copied().partition(remembers);
        let (links, others): (Vec<usize>, Vec<usize>) = ids
            .iter()
            .copied()
            .partition(|&c| self.is_of_link(c, scene.dof()));
        let made = others
            .iter()
            .filter(|c| matches!(torque(**c), ColumnTorque::Made(_)));
        let many = made.count() > scene.dof();
        let passed: Vec<Vec<Values>> = passed
            .par_chunks(TOGETHER)
            .map(|some| {
                let fine = self.evaluate(scene, some);
                let of = |at: &Range<usize>| {
                    let rows = Part::samples(scene.motion, at);
                    let own = fine.iter().map(|(c, j, x)| {
                        let own = x.slice_axis(Axis(0), rows.clone().into());
                        (*c, *j, own.to_owned())
                    });
                    reduce(&own.collect::<Vec<_>>(), at)
                };
                parts.iter().map(of).collect()
            })
            .collect();
        let mut passed: Vec<_> = passed.into_iter().map(Vec::into_iter).collect();
        for at in parts {
            let part = Part::new(scene.motion, scene.wide(), &at);
            let mut own = scene.part(&part);
            if many {
                own = own.with_tangents();
            }
            let mut out: Values = passed
                .iter_mut()
                .filter_map(Iterator::next)
                .flatten()
                .collect();
            let fine = self.evaluate(&own, &links);
            let each = fine
                .par_chunks(TOGETHER)
                .flat_map_iter(|some| reduce(some, &at));
            out.par_extend(each);
            let each = others.par_chunks(TOGETHER);
            out.par_extend(each.flat_map_iter(|some| reduce(&self.evaluate(&own, some), &at)));
            take(at, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::catalogue;
    use crate::motion::frame::Frame;
    use crate::motion::passage::History;
    use crate::search::kept::Kept;
    use crate::search::products::Rows;
    use datasets::{PrepareOptions, Recording, Trajectory};
    use ndarray::Array2;
    use physics::effects::EarlySign;
    use physics::robot::Robot;

    #[test]
    fn columns_of_parts_are_those_of_the_whole() {
        // Two trajectories of 42 s on one clock: friction's memory passes from one to the other.
        let robot = Robot::builtin("ur5").unwrap();
        let n = 4200;
        let time: Vec<f64> = (0..2 * n)
            .map(|i| 0.01 * i as f64 + if i < n { 0.0 } else { 1.0 })
            .collect();
        let q = Array2::from_shape_fn((2 * n, robot.dof()), |(i, j)| {
            ((0.6 + 0.2 * j as f64) * time[i]).sin()
        });
        let trajectory = |k: usize| Trajectory {
            label: k.to_string(),
            range: k * n..(k + 1) * n,
        };
        let recording = Recording {
            trajectories: vec![trajectory(0), trajectory(1)],
            ..Recording::new("two", time, q.clone(), Some(q.clone()))
        };
        let frame = Frame::new(&recording, q, &PrepareOptions::low_passed(8.0)).unwrap();
        let early = EarlySign {
            velocity: 0.01,
            lead: 0.0,
        };
        let scale = frame.scale(&[], &[early; 6]);
        let passage = History::of(vec![frame.motion()], 0).with_wide(frame.wide());
        let scene = Scene::new(&robot, passage, &scale);
        let dictionary = Dictionary::new(robot.dof(), &catalogue(&scene, &[]));
        let ids: Vec<usize> = (0..dictionary.len()).step_by(7).collect();
        let remembers = |c: &&usize| match &dictionary.columns[**c].torque {
            ColumnTorque::Terms(terms) => terms.iter().any(|t| t.1.remembers()),
            _ => false,
        };
        assert!(ids.iter().filter(remembers).count() > 10);
        let fine = dictionary.evaluate(&scene, &ids);
        let mut changed = 0;
        for (c, j, torque) in &fine {
            if let ColumnTorque::Link(link, body) = &dictionary.columns[*c].torque {
                let alone = scene.torque_of_link(*link, body);
                let most = alone.iter().fold(1e-9f64, |m, x| m.max(x.abs()));
                let apart = torque - &alone.column(*j);
                assert!(apart.iter().all(|x| x.abs() <= 1e-9 * most), "{c} on {j}");
                changed += 1;
            }
        }
        assert!(changed > 5, "{changed}");
        let columns: Vec<&Array1<f64>> = fine.iter().map(|c| &c.2).collect();
        let whole = frame.reduce(0..2, &columns);
        let (mut parts, mut rows) = (Vec::new(), 0);
        let reduced = |at: Range<usize>, fine: &[&Array1<f64>]| frame.reduce(at, fine);
        dictionary.by_part(&scene, &ids, reduced, |at, values| {
            assert_eq!(values.len(), whole.len());
            for (c, j, own) in &values {
                let place = fine.iter().position(|f| (f.0, f.1) == (*c, *j)).unwrap();
                let all = whole[place].slice_axis(Axis(0), (rows..rows + own.len()).into());
                let most = all.iter().fold(0.0f64, |m, x| m.max(x.abs()));
                let apart = (&all - own).iter().fold(0.0f64, |m, x| m.max(x.abs()));
                assert!(
                    apart <= 1e-12 * most,
                    "column {c} on joint {j}: {apart} of {most}"
                );
            }
            rows += values[0].2.len();
            parts.push(at);
        });
        assert_eq!((parts, rows), (vec![0..1, 1..2], frame.len()));
        // What a second search reads is what the first has evaluated, beside columns of its own.
        let kept = Kept::new(dictionary.len() - 5);
        let ones = Array2::ones((frame.len(), robot.dof()));
        let rows = |kept| Rows {
            dictionary: &dictionary,
            scene: &scene,
            frame: &frame,
            weight: &ones,
            kept,
        };
        let sums = |kept| rows(kept).grams(&ones).total[2].xx.row(700).to_vec();
        let evaluated = sums(None);
        assert_eq!(evaluated, sums(Some(&kept)));
        assert_eq!(kept.known(), dictionary.len() - 5);
        assert_eq!(evaluated, sums(Some(&kept)));
    }
}
