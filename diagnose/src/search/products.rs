//! Sums of products of the dictionary's columns over the fitted rows of a recording. The columns' values are of one part of
//! the recording at a time: all of them would take most of a search's memory. Further searches read them from a file.

use crate::algebra::folds::Fold;
use crate::algebra::gram::{Grams, JointGram, Layout};
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::search::dictionary::{Dictionary, Values};
use crate::search::kept::Kept;
use ndarray::{Array1, Array2, ArrayView1, Axis};
use rayon::prelude::*;
use std::ops::Range;

/// Sums of products of the columns with a fit's residual, for each stretch of time.
pub struct Stretches {
    /// Index of the fold to which each stretch belongs.
    pub fold: Vec<usize>,
    /// Σ w x r of each column x and residual r, by joint, shape (active columns, stretches).
    pub products: Vec<Array2<f64>>,
    /// Σ w r² of the residual, shape (stretches, joints).
    pub squares: Array2<f64>,
    /// Parts of stretches that are near another fold.
    pub near: Vec<Near>,
    /// Σ w x r over the parts in `near`, by joint, shape (active columns, parts).
    pub near_products: Vec<Array2<f64>>,
}

/// Part of a stretch that is so close in time to another fold that it is not fitted where that fold is scored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Near {
    /// Index of the fold near which the part lies.
    pub fold: usize,
    /// Index of the stretch that the part belongs to.
    pub stretch: usize,
}

/// A dictionary's columns on the fitted rows of a recording.
pub struct Rows<'a> {
    /// Columns that are evaluated.
    pub dictionary: &'a Dictionary,
    /// Motion and model with which they are.
    pub scene: &'a Scene<'a>,
    /// The recording, whose motion is the scene's.
    pub frame: &'a Frame,
    /// Weight of each row, shape (rows, joints).
    pub weight: &'a Array2<f64>,
    /// Values of the session's columns, with which the dictionary begins; none where it does not.
    pub kept: Option<&'a Kept>,
}

impl Rows<'_> {
    /// Calls `take` with the rows of each part of the recording in turn, and there with the values of the columns by
    /// joint, shape (columns that act on it, rows).
    fn by_part(&self, layout: &Layout, mut take: impl FnMut(Range<usize>, Vec<Array2<f64>>)) {
        let mut tables = |at: Range<usize>, values: Values| {
            let rows = &self.frame.rows[at];
            let rows = rows[0].start..rows[rows.len() - 1].end;
            let active = layout.active.iter();
            let mut tables: Vec<Array2<f64>> = active
                .map(|active| Array2::zeros((active.len(), rows.len())))
                .collect();
            for (c, j, values) in values {
                let p = layout
                    .position(j, c)
                    .expect("a column touches the joints that it names");
                tables[j].row_mut(p).assign(&values);
            }
            take(rows, tables);
        };
        let reduced = |at: Range<usize>, fine: &[&Array1<f64>]| self.frame.reduce(at, fine);
        let evaluate = |first: usize, take: &mut dyn FnMut(Range<usize>, Values)| {
            let ids: Vec<usize> = (first..self.dictionary.len()).collect();
            self.dictionary.by_part(self.scene, &ids, reduced, take);
        };
        // Parts that were taken with values from the file: all, if it can be read.
        let (mut done, mut readable) = (0, false);
        if let Some(stored) = self.kept.and_then(Kept::stored) {
            readable = true;
            evaluate(self.kept.map_or(0, Kept::known), &mut |at, mut values| {
                readable = readable && stored.part(done).map(|v| values.extend(v)).is_ok();
                if readable {
                    tables(at, values);
                    done += 1;
                }
            });
        }
        if readable {
            return;
        }
        let vectors = layout.active.iter().map(Vec::len).sum();
        let mut storing = self
            .kept
            .and_then(|kept| kept.storing(vectors, self.frame.len()));
        let mut part = 0;
        evaluate(0, &mut |at, values| {
            storing = storing
                .take()
                .and_then(|mut s| s.add(&values).ok().map(|()| s));
            if part >= done {
                tables(at, values);
            }
            part += 1;
        });
        if let Some((kept, storing)) = self.kept.zip(storing) {
            kept.take(storing);
        }
    }

    /// Sums of products of all columns and the gap `y` (rows, joints), by fold.
    pub fn grams(&self, y: &Array2<f64>) -> Grams {
        let layout = self.dictionary.layout(self.scene.dof());
        let folds = self.frame.folds();
        let empty = |active: &Vec<usize>| vec![JointGram::zeros(active.len()); folds.len()];
        let empty = || -> Vec<Vec<JointGram>> { layout.active.iter().map(empty).collect() };
        // By joint, then fold: each joint's sums are one task.
        let mut scored = empty();
        let has_near = folds.iter().any(|fold| !fold.near.is_empty());
        let mut near = has_near.then(empty);
        self.by_part(&layout, |rows, tables| {
            for (sums, of_near) in [(Some(&mut scored), false), (near.as_mut(), true)] {
                let Some(sums) = sums else { continue };
                let each = sums.par_iter_mut().zip(&tables).enumerate();
                each.for_each(|(j, (sums, table))| {
                    let own = (table, &rows, y.column(j), self.weight.column(j));
                    for (sum, fold) in sums.iter_mut().zip(folds) {
                        let some = if of_near { &fold.near } else { &fold.scored };
                        some.iter().for_each(|some| add(sum, own, some));
                    }
                });
            }
        });
        let by_fold = |sums: Vec<Vec<JointGram>>| -> Vec<Vec<JointGram>> {
            let mut joints: Vec<_> = sums.into_iter().map(Vec::into_iter).collect();
            let fold = |_| joints.iter_mut().filter_map(Iterator::next).collect();
            (0..folds.len()).map(fold).collect()
        };
        let grams = Grams::new(layout, by_fold(scored));
        match near {
            Some(near) => grams.with_near(by_fold(near)),
            None => grams,
        }
    }

    /// Sums of products of all columns and the residual of a fit on the fitted rows, by stretch of time. Each
    /// stretch lies in one fold.
    pub fn by_stretch(
        &self,
        residual: &Array2<f64>,
        stretches: &[(usize, Range<usize>)],
    ) -> Stretches {
        let weighted = residual * self.weight;
        let layout = self.dictionary.layout(self.scene.dof());
        let whole: Vec<Range<usize>> = stretches.iter().map(|s| s.1.clone()).collect();
        let parts: Vec<(Near, Range<usize>)> = near(stretches, self.frame.folds()).collect();
        let (near, parts): (Vec<Near>, Vec<Range<usize>>) = parts.into_iter().unzip();
        let empty = |ranges: &[Range<usize>]| -> Vec<Array2<f64>> {
            let each = layout.active.iter();
            each.map(|active| Array2::zeros((active.len(), ranges.len())))
                .collect()
        };
        let mut sums = [(empty(&whole), &whole), (empty(&parts), &parts)];
        self.by_part(&layout, |rows, tables| {
            for (sums, ranges) in &mut sums {
                let each = sums.par_iter_mut().zip(&tables).enumerate();
                each.for_each(|(j, (sums, table))| {
                    let left: Vec<f64> = rows.clone().map(|i| weighted[[i, j]]).collect();
                    for (mut sums, some) in sums.columns_mut().into_iter().zip(ranges.iter()) {
                        let own = within(some, &rows);
                        let x = table.slice_axis(Axis(1), own.clone().into());
                        sums += &x.dot(&ArrayView1::from(&left[own]));
                    }
                });
            }
        });
        let squares = Array2::from_shape_fn((stretches.len(), layout.dof()), |(b, j)| {
            let rows = stretches[b].1.clone();
            rows.map(|i| weighted[[i, j]] * residual[[i, j]]).sum()
        });
        let [(products, _), (near_products, _)] = sums;
        Stretches {
            fold: stretches.iter().map(|s| s.0).collect(),
            squares,
            products,
            near,
            near_products,
        }
    }
}

/// Those of some rows that are among `rows`, counted from the first of these.
fn within(some: &Range<usize>, rows: &Range<usize>) -> Range<usize> {
    let start = some.start.clamp(rows.start, rows.end);
    let end = some.end.clamp(start, rows.end);
    start - rows.start..end - rows.start
}

/// Adds the products of a joint's columns and torque on those of some rows that are in a part of the recording: its columns,
/// its rows, and the torque and weights of all.
fn add(
    sum: &mut JointGram,
    (table, rows, y, weight): (
        &Array2<f64>,
        &Range<usize>,
        ArrayView1<f64>,
        ArrayView1<f64>,
    ),
    some: &Range<usize>,
) {
    let own = within(some, rows);
    let all = rows.start + own.start..rows.start + own.end;
    let x = table.slice_axis(Axis(1), own.into());
    let cut = |x: &ArrayView1<f64>| x.slice_axis(Axis(0), all.clone().into()).to_vec();
    let [y, weight] = [cut(&y), cut(&weight)].map(Array1::from);
    sum.add_rows(x, y.view(), weight.view());
}

/// Parts of stretches that lie near a fold, with their rows.
fn near<'a>(
    stretches: &'a [(usize, Range<usize>)],
    folds: &'a [Fold],
) -> impl Iterator<Item = (Near, Range<usize>)> + 'a {
    let each = folds.iter().enumerate();
    let each = each.flat_map(|(fold, f)| f.near.iter().map(move |near| (fold, near)));
    each.flat_map(move |(fold, near)| {
        let part = move |(stretch, (_, rows)): (usize, &(usize, Range<usize>))| {
            let both = rows.start.max(near.start)..rows.end.min(near.end);
            (!both.is_empty()).then_some((Near { fold, stretch }, both))
        };
        stretches.iter().enumerate().filter_map(part)
    })
}
