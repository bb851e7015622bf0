//! Search on the expected recording of one effect of one size.

use super::choice::{Choice, Visible};
use crate::algebra::folds::folds;
use crate::algebra::gram::{Grams, JointGram, Layout, Symmetric};
use crate::catalogue::{Bound, Candidate};
use crate::motion::scene::Scene;
use crate::search::dictionary::Dictionary;
use crate::search::objective::Objective;
use crate::search::select::Search;
use crate::settings::Settings;
use crate::simulator::NominalModel;
use datasets::{PrepareOptions, Recording, Trajectory};
use model::preparation::cutoff;
use ndarray::{Array1, Array2, Axis};
use signal::Motion;
use std::collections::HashSet;
use std::ops::Range;
use std::sync::OnceLock;

/// Rate of the rows for which the search's thresholds are meant, Hz, and the cut-off of the low-pass before
/// thinning, relative to it.
const ROWS: f64 = 62.5;
const CUTOFF: f64 = 0.4;
/// Smallest and largest size that is tried: torque on the strongest joint over that joint's own.
const SIZES: (f64, f64) = (1e-5, 3.0);
/// Factor between sizes that are tried upwards, and number of bisections after the first accepted one: to 1 %.
const STRIDE: f64 = 4.0;
const BISECTIONS: usize = 7;
/// Factor on the least size by which another shape must be accepted sooner to be named.
const SOONER: f64 = 0.95;
/// Part of a coefficient's upper bound up to which sizes are tried.
const INSIDE: f64 = 0.98;

/// Picks one row in `stride` fine samples, by segment: indices of the samples, and ranges of the rows.
fn thinned(segments: &[Range<usize>], stride: usize) -> (Vec<usize>, Vec<Range<usize>>) {
    let (mut picked, mut rows) = (Vec::new(), Vec::new());
    for s in segments {
        let start = picked.len();
        picked.extend(s.clone().step_by(stride));
        rows.push(start..picked.len());
    }
    (picked, rows)
}

/// Expected search on one motion.
pub(super) struct Judge<'a> {
    scene: &'a Scene<'a>,
    candidates: &'a [Candidate],
    settings: &'a Settings,
    model: NominalModel,
    /// Indices of the fine samples that are rows.
    picked: Vec<usize>,
    /// Sums of products of the rows on which each fold is scored. In `near`, those of the rows near a fold, which are
    /// not fitted where it is scored; empty where no fold has such rows.
    scored: Vec<Part>,
    near: Vec<Part>,
    /// Variance of the noise on a row, (N·m)², by joint.
    variance: Vec<f64>,
}

impl<'a> Judge<'a> {
    pub fn new(
        scene: &'a Scene<'a>,
        candidates: &'a [Candidate],
        noise: &[f64],
        settings: &'a Settings,
        rate: f64,
        share: f64,
    ) -> Self {
        let stride = ((rate / ROWS).round() as usize).max(1);
        let (picked, rows) = thinned(&scene.motion.segments, stride);
        let dictionary = Dictionary::new(scene.dof(), &[]);
        let ids: Vec<usize> = (0..dictionary.len()).collect();
        let mut base: Vec<Vec<Array1<f64>>> = vec![Vec::new(); scene.dof()];
        let mut columns = dictionary.evaluate(scene, &ids);
        columns.sort_by_key(|c| (c.1, c.0));
        for (_, j, values) in columns {
            base[j].push(values.select(Axis(0), &picked));
        }
        let m = &settings.motion;
        let each = ROWS * stride as f64 / rate * share;
        let weight = Array2::from_shape_fn((picked.len(), scene.dof()), |(i, j)| {
            let slow = scene.motion.qd[[picked[i], j]].abs() < m.crossing_speed;
            each * if slow { m.crossing_weight } else { 1.0 }
        });
        // Thinning comes after a low-pass, which takes white noise away.
        let passed = (2.0 * CUTOFF * ROWS / rate).min(1.0);
        let folds = folds(
            &planned(scene.motion),
            &rows,
            stride,
            cutoff::gap(&PrepareOptions::default()),
        );
        let base: Vec<Array2<f64>> = base.iter().map(|c| table(c, picked.len())).collect();
        let part = |rows: &[Range<usize>]| Part::new(rows, &base, &weight);
        let has_near = folds.iter().any(|fold| !fold.near.is_empty());
        Self {
            scene,
            candidates,
            settings,
            model: NominalModel::new(scene.robot.clone()),
            scored: folds.iter().map(|fold| part(&fold.scored)).collect(),
            near: match has_near {
                true => folds.iter().map(|fold| part(&fold.near)).collect(),
                false => Vec::new(),
            },
            picked,
            variance: noise.iter().map(|s| s * s * passed).collect(),
        }
    }

    /// Least accepted size among choices that differ in shape or coefficient.
    pub fn first(&self, group: &[Choice]) -> Visible {
        let c = &self.candidates[group[0].candidate];
        let first = &c.quantities[group[0].place];
        let mut best = Visible {
            effect: c.effect,
            joints: c.joints.clone(),
            driver: c.driver,
            quantity: first.name,
            unit: first.unit,
            from: None,
            torque: None,
            shape: Vec::new(),
        };
        for &choice in group {
            let candidate = &self.candidates[choice.candidate];
            let quantity = &candidate.quantities[choice.place];
            let factor = quantity.factor.abs();
            let at_most = best.from.map(|from| SOONER * from / factor);
            if let Some((size, torque)) = Expected::new(self, choice).least(at_most) {
                best.quantity = quantity.name;
                best.from = Some(size * factor);
                best.torque = Some(torque);
                best.shape.clone_from(&candidate.shape);
            }
        }
        best
    }
}

/// Some rows with the base's columns, which every candidate has beside its own.
struct Part {
    rows: Vec<usize>,
    /// Square roots of the rows' weights, by joint.
    root: Vec<Array1<f64>>,
    /// Columns of the base times the roots in `root`; in `products`, their sums of products.
    base: Vec<Array2<f64>>,
    products: Vec<JointGram>,
}

impl Part {
    fn new(rows: &[Range<usize>], base: &[Array2<f64>], weight: &Array2<f64>) -> Self {
        let rows: Vec<usize> = rows.iter().cloned().flatten().collect();
        let none = Array1::zeros(rows.len());
        let each = base.iter().zip(weight.columns());
        let products = each.clone().map(|(base, weight)| {
            let own = base.select(Axis(0), &rows);
            JointGram::new(
                own.view(),
                none.view(),
                weight.select(Axis(0), &rows).view(),
            )
        });
        let products = products.collect();
        let root: Vec<Array1<f64>> = each
            .clone()
            .map(|(_, weight)| weight.select(Axis(0), &rows).map(|w| w.sqrt()))
            .collect();
        let base = base.iter().zip(&root);
        let base = base
            .map(|(base, root)| weighted(base, &rows, root))
            .collect();
        Self {
            rows,
            root,
            base,
            products,
        }
    }

    /// Products of the base and of further columns of each joint.
    fn with(&self, more: &[Array2<f64>]) -> Vec<JointGram> {
        let of = |(j, more): (usize, &Array2<f64>)| {
            let (base, products) = (&self.base[j], &self.products[j]);
            let own = weighted(more, &self.rows, &self.root[j]);
            let (k, all) = (base.ncols(), base.ncols() + own.ncols());
            let (cross, inner) = (base.t().dot(&own), own.t().dot(&own));
            let xx = Symmetric::from_fn(all, |a, b| match (a < k, b < k) {
                (true, _) => products.xx[[a, b]],
                (false, true) => cross[[b, a - k]],
                (false, false) => inner[[a - k, b - k]],
            });
            JointGram {
                xx,
                xy: Array1::zeros(all),
                ..*products
            }
        };
        more.iter().enumerate().map(of).collect()
    }
}

/// Some rows of columns, each times its weight's root.
fn weighted(columns: &Array2<f64>, rows: &[usize], root: &Array1<f64>) -> Array2<f64> {
    let mut out = columns.select(Axis(0), rows);
    for (mut row, root) in out.rows_mut().into_iter().zip(root) {
        row *= *root;
    }
    out
}

/// A planned motion as a recording of it would be dealt into folds.
fn planned(motion: &Motion) -> Recording {
    let label = |(k, range): (usize, &Range<usize>)| Trajectory {
        label: k.to_string(),
        range: range.clone(),
    };
    Recording {
        trajectories: motion.segments.iter().enumerate().map(label).collect(),
        ..Recording::new(
            "planned motion",
            motion.time.clone(),
            motion.q.clone(),
            None,
        )
    }
}

fn table(columns: &[Array1<f64>], rows: usize) -> Array2<f64> {
    let mut out = Array2::zeros((rows, columns.len()));
    for (mut to, from) in out.columns_mut().into_iter().zip(columns) {
        to.assign(from);
    }
    out
}

/// Sums of products of the base and one candidate. The expected torque is one of the candidate's columns times a size.
struct Expected<'a> {
    judge: &'a Judge<'a>,
    choice: Choice,
    members: Vec<usize>,
    grams: Grams,
}

impl<'a> Expected<'a> {
    fn new(judge: &'a Judge<'a>, choice: Choice) -> Self {
        let dof = judge.scene.dof();
        let own = &judge.candidates[choice.candidate];
        let dictionary = Dictionary::new(dof, std::slice::from_ref(own));
        let joints: Vec<Vec<usize>> = (0..dictionary.len())
            .map(|c| dictionary.column(c).joints.clone())
            .collect();
        let base = Dictionary::new(dof, &[]).len();
        let added: Vec<usize> = (base..dictionary.len()).collect();
        let mut more: Vec<Vec<Array1<f64>>> = vec![Vec::new(); dof];
        let mut columns = dictionary.evaluate(judge.scene, &added);
        columns.sort_by_key(|c| (c.1, c.0));
        for (_, j, values) in columns {
            more[j].push(values.select(Axis(0), &judge.picked));
        }
        let more: Vec<Array2<f64>> = more.iter().map(|c| table(c, judge.picked.len())).collect();
        let with = |parts: &[Part]| parts.iter().map(|p| p.with(&more)).collect();
        let mut grams = Grams::new(Layout::new(dof, &joints), with(&judge.scored));
        if !judge.near.is_empty() {
            grams = grams.with_near(with(&judge.near));
        }
        Self {
            judge,
            choice,
            members: dictionary.members[0].clone(),
            grams,
        }
    }

    /// Number of the column in the expected torque.
    fn column(&self) -> usize {
        self.members[self.choice.place]
    }

    /// Sets the expected torque by its size.
    fn set(&mut self, size: f64) {
        let column = self.column();
        let layout = self.grams.layout.clone();
        for grams in self.grams.each_mut() {
            for (j, g) in grams.iter_mut().enumerate() {
                g.yy = g.samples * self.judge.variance[j];
                g.xy.fill(0.0);
                if let Some(p) = layout.position(j, column) {
                    g.xy.scaled_add(size, &g.xx.columns(&[p]).column(0));
                    g.yy += size * size * g.xx[[p, p]];
                }
            }
        }
    }

    /// Whether the search accepts the candidate at this size.
    fn accepted(&mut self, size: f64) -> bool {
        self.set(size);
        let judge = self.judge;
        let objective = Objective::new(&self.grams, judge.scene.scale, &judge.settings.search);
        let mut members = vec![Vec::new(); judge.candidates.len()];
        members[self.choice.candidate].clone_from(&self.members);
        let search = Search {
            objective: &objective,
            candidates: judge.candidates,
            members: &members,
            robot: judge.model.sizes(),
            base: objective.base(&judge.model, 1.0),
            barred: HashSet::new(),
            chance: 0.0,
            missing: OnceLock::new(),
        };
        search.accepts(self.choice.candidate)
    }

    /// Least accepted size below `at_most`, and the root mean square of its torque on the strongest joint, N·m.
    fn least(mut self, at_most: Option<f64>) -> Option<(f64, f64)> {
        let scale = &self.judge.scene.scale.torque;
        let per_unit = self.grams.column_rms(self.column(), scale);
        if per_unit <= 0.0 {
            return None;
        }
        let (mut low, mut high) = (SIZES.0 / per_unit, SIZES.1 / per_unit);
        let bounds = &self.judge.candidates[self.choice.candidate].bounds;
        if let Bound::Between(from, to) = bounds[self.choice.place] {
            (low, high) = (low.max(from), high.min(INSIDE * to));
        }
        if let Some(most) = at_most {
            high = high.min(most);
            if high <= low || !self.accepted(high) {
                return None;
            }
        }
        // Upwards: what is too large may be refused as well, for a link of ten times its mass is no likely one.
        let (mut below, mut size) = (low, low);
        while !self.accepted(size) {
            if size >= high {
                return None;
            }
            below = size;
            size = (STRIDE * size).min(high);
        }
        for _ in 0..BISECTIONS {
            let middle = (below * size).sqrt();
            if self.accepted(middle) {
                size = middle;
            } else {
                below = middle;
            }
        }
        let torque = self
            .grams
            .column_rms(self.column(), &vec![1.0; scale.len()]);
        Some((size, size * torque))
    }
}
