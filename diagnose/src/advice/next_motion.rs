//! The next experiment: the motion that best tells apart two causes that the recording cannot.
//!
//! With c_A and c_B the torques of the two causes as fitted, evidence for A against B is half of what remains of c_A when
//! everything that B's model may move is fitted to it: B's coefficients, and the parameters within their tolerances.
//! The recorded data and the new motion count together:
//!
//! E(A, B) = ½ min_δ Σ_j w_j ‖c_A − X_B δ‖² + δᵀΛδ, in nats as everywhere in the search,
//!
//! which is the T-criterion of Atkinson and Fedorov (Biometrika 62(1), 1975). The motion, a Fourier series within the
//! robot's limits, is chosen for the smaller of E(A, B) and E(B, A).

use crate::algebra::cholesky::Cholesky;
use crate::algebra::fit::Variable;
use crate::catalogue::effect::Effect;
use crate::error::DiagnoseError;
use crate::motion::frame::Frame;
use crate::motion::scene::{Scale, Scene};
use crate::outcome::Outcome;
use crate::schema::NextExperiment;
use crate::search::dictionary::Dictionary;
use crate::search::find::Findings;
use crate::search::objective::Objective;
use crate::settings::AdviceSettings;
use crate::simulator::NominalModel;
use datasets::write_reference;
use identify::excitation::{Bounds, MotionLimits, Room, SearchOptions, Series, optimise};
use ndarray::{Array1, Array2};
use std::path::Path;

/// Period of the motion, s, and number of periods.
const PERIOD: f64 = 12.5;
const PERIODS: usize = 2;
/// Sampling rate during the search, Hz; the higher one where the effects vibrate.
const RATE: [f64; 2] = [62.5, 250.0];
/// Sampling rate of the written file, Hz.
const FILE_RATE: f64 = 100.0;
/// Harmonics of the motion's Fourier series, as multiples of 1 / [`PERIOD`].
const HARMONICS: [usize; 5] = [1, 2, 3, 4, 5];
/// Search: number of random starts, and of motions evaluated in all.
const SEARCH: (usize, usize) = (6, 280);

/// Designed motion that is to be run on the robot, and its purpose.
pub struct Experiment {
    /// Purpose of the motion, for the report.
    pub summary: NextExperiment,
    trajectory: Series,
}

/// Designs the motion for the first cause that has a rival. None where no name is ambiguous, or no motion separates the two.
///
/// # Errors
/// Limits that leave no motion.
pub fn design(
    model: &NominalModel,
    outcome: &Outcome,
) -> Result<Option<Experiment>, DiagnoseError> {
    let found = &outcome.findings;
    let Some((accepted, rival)) = pair(outcome) else {
        return Ok(None);
    };
    let frame = &outcome.frames.data;
    let scale = &outcome.frames.scale;
    let objective = Objective::new(&found.grams, scale, &found.settings.search);
    let own = &found.accepted[accepted];
    let rival = &own.tried[rival];
    let theirs: Vec<Variable> = found.dictionary.members[rival.candidate]
        .iter()
        .map(|&m| objective.wide(m))
        .collect();
    let ours = found.tight.0[own.variables.clone()].to_vec();
    let sizes = own.variables.clone().map(|i| found.tight.1[i]).collect();
    let effects = [
        found.candidates[own.candidate].effect,
        found.candidates[rival.candidate].effect,
    ];
    let base = found.tight.0[..found.base].to_vec();
    let trial = Rivals {
        weights: objective.weights(&rival.error),
        columns: columns(&base, &ours, &theirs),
        sides: [
            Side::new(&base, &ours, sizes),
            Side::new(&base, &theirs, rival.gamma.clone()),
        ],
    };
    let recorded = Products::recorded(&trial, found);
    let vibrates = effects.iter().any(|e| e.info().vibrates);
    let rate = RATE[usize::from(vibrates)];
    let view = View {
        found,
        dictionary: &found.dictionary,
        scale: Scale {
            step: 1.0 / rate,
            channel: None,
            ..scale.clone()
        },
        rate,
        // A row of the search stands for so many of the rows that weights are meant for.
        share: frame.row_rate() / rate * PERIODS as f64,
    };
    let options = SearchOptions {
        starts: SEARCH.0,
        evaluations: SEARCH.1,
        ..SearchOptions::default()
    };
    let bounds = Bounds::of(limits(model, frame, &found.settings.advice));
    let room = Room::new(bounds, PERIOD, &HARMONICS, options.seed)?;
    let chosen = optimise(&room, &options, |trajectory| {
        Ok(-trial.evidence(&recorded.plus(&view.products(&trial, trajectory))))
    })?;
    let names = model.robot.joint_names();
    let joints = &found.candidates[own.candidate].joints;
    Ok(Some(Experiment {
        summary: NextExperiment {
            effects,
            joints: joints.iter().map(|&j| names[j].clone()).collect(),
            seconds: PERIOD * PERIODS as f64,
            evidence_recorded: trial.evidence(&recorded),
            evidence_expected: -chosen.cost,
        },
        trajectory: chosen.trajectory,
    }))
}

/// Index of the cause among the accepted, and index of its best rival among the candidates tried in its place.
fn pair(outcome: &Outcome) -> Option<(usize, usize)> {
    let found = &outcome.findings;
    let settled = |e: Effect| !e.info().passing;
    outcome.diagnosis.causes.iter().find_map(|cause| {
        let rival = *cause.ambiguous_with.iter().find(|e| settled(**e))?;
        let names = &outcome.diagnosis.joints;
        let accepted = (0..found.accepted.len()).find(|&a| {
            let c = found.candidate(a);
            c.effect == cause.effect
                && settled(c.effect)
                && (c.joints.len() > 1 || names[c.joints[0]] == cause.joints[0])
        })?;
        let tried = &found.accepted[accepted].tried;
        let place = tried
            .iter()
            .position(|t| found.candidates[t.candidate].effect == rival)?;
        Some((accepted, place))
    })
}

/// Columns of the base and both causes, without duplicates.
fn columns(base: &[Variable], ours: &[Variable], theirs: &[Variable]) -> Vec<usize> {
    let all = base.iter().chain(ours).chain(theirs);
    let mut columns: Vec<usize> = all.map(|v| v.column).collect();
    columns.sort_unstable();
    columns.dedup();
    columns
}

/// One of both causes: its torque by column, and the variables that its model may move.
struct Side {
    torque: Vec<(usize, f64)>,
    free: Vec<Variable>,
}

impl Side {
    fn new(base: &[Variable], own: &[Variable], sizes: Vec<f64>) -> Self {
        Self {
            torque: own.iter().map(|v| v.column).zip(sizes).collect(),
            free: base.iter().chain(own).copied().collect(),
        }
    }
}

struct Rivals {
    weights: Vec<f64>,
    columns: Vec<usize>,
    sides: [Side; 2],
}

impl Rivals {
    fn place(&self, column: usize) -> usize {
        self.columns
            .binary_search(&column)
            .expect("the columns are those of both sides")
    }

    /// The smaller of both evidences, nats.
    fn evidence(&self, products: &Products) -> f64 {
        let [a, b] = &self.sides;
        self.against(products, a, b)
            .min(self.against(products, b, a))
    }

    fn against(&self, products: &Products, truth: &Side, model: &Side) -> f64 {
        let g = &products.0;
        let torque: Vec<(usize, f64)> = truth
            .torque
            .iter()
            .map(|&(c, x)| (self.place(c), x))
            .collect();
        let free: Vec<usize> = model.free.iter().map(|v| self.place(v.column)).collect();
        let with = |i: usize| torque.iter().map(|&(k, x)| g[[i, k]] * x).sum::<f64>();
        let square: f64 = torque.iter().map(|&(k, x)| x * with(k)).sum();
        let right: Array1<f64> = free.iter().map(|&i| with(i)).collect();
        let mut normal =
            Array2::from_shape_fn((free.len(), free.len()), |(i, k)| g[[free[i], free[k]]]);
        for (i, v) in model.free.iter().enumerate() {
            normal[[i, i]] += v.precision;
        }
        let solution = Cholesky::new(&normal).solve(right.view());
        0.5 * (square - right.dot(&solution)).max(0.0)
    }
}

/// Σ_j w_j XᵀX over the columns of both sides.
struct Products(Array2<f64>);

impl Products {
    /// Sums of products of the recorded data.
    fn recorded(rivals: &Rivals, found: &Findings) -> Self {
        let n = rivals.columns.len();
        let mut sum = Array2::zeros((n, n));
        for (j, (gram, w)) in found.grams.total.iter().zip(&rivals.weights).enumerate() {
            let place = |c: usize| found.grams.layout.position(j, c);
            let known: Vec<(usize, usize)> = rivals
                .columns
                .iter()
                .enumerate()
                .filter_map(|(i, &c)| Some((i, place(c)?)))
                .collect();
            for &(i, p) in &known {
                for &(k, r) in &known {
                    sum[[i, k]] += w * gram.xx[[p, r]];
                }
            }
        }
        Self(sum)
    }

    fn plus(&self, other: &Self) -> Self {
        Self(&self.0 + &other.0)
    }
}

/// Evaluation of columns on a planned motion.
struct View<'a> {
    found: &'a Findings,
    dictionary: &'a Dictionary,
    scale: Scale,
    rate: f64,
    share: f64,
}

impl View<'_> {
    fn products(&self, rivals: &Rivals, trajectory: &Series) -> Products {
        let motion = trajectory.sampled(self.rate, 1, self.scale.session.0);
        let scene = Scene::new(&self.found.session.present, &motion, &self.scale);
        let n = rivals.columns.len();
        let mut tables = vec![Array2::<f64>::zeros((motion.len(), n)); scene.dof()];
        for (c, j, values) in self.dictionary.evaluate(&scene, &rivals.columns) {
            tables[j].column_mut(rivals.place(c)).assign(&values);
        }
        let mut sum = Array2::zeros((n, n));
        for (table, w) in tables.iter().zip(&rivals.weights) {
            sum.scaled_add(w * self.share, &table.t().dot(table));
        }
        Products(sum)
    }
}

/// Limits of each joint for the designed motion: the robot's own with a margin; the recorded motion's range where the
/// robot has none.
fn limits(model: &NominalModel, frame: &Frame, settings: &AdviceSettings) -> Vec<MotionLimits> {
    let motion = frame.samples();
    let most = |t: &Array2<f64>, j: usize| t.column(j).iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let own = MotionLimits::of_robot(&model.robot);
    let joints = model.robot.joints().iter().zip(own).enumerate();
    joints
        .map(|(j, (joint, own))| {
            let l = &joint.limits;
            let [lower, upper] = if l.lower.is_finite() && l.upper.is_finite() && l.upper > l.lower
            {
                let margin = settings.margin * (own.upper - own.lower);
                [own.lower + margin, own.upper - margin]
            } else {
                let column = motion.q.column(j);
                let bound = |f: fn(f64, f64) -> f64, from| column.iter().copied().fold(from, f);
                [
                    bound(f64::min, f64::INFINITY),
                    bound(f64::max, f64::NEG_INFINITY),
                ]
            };
            MotionLimits {
                lower,
                upper,
                velocity: if own.velocity.is_finite() && own.velocity > 0.0 {
                    settings.speed * own.velocity
                } else {
                    settings.faster * most(&motion.qd, j)
                },
                acceleration: settings.faster * most(&motion.qdd, j),
                ..own
            }
        })
        .collect()
}

impl Experiment {
    /// Writes the motion as CSV or Parquet, by the file's ending, in the form that `excite` writes.
    ///
    /// # Errors
    /// An ending of neither, or a failure of the disk; nothing half-written is left.
    pub fn write(&self, path: &Path) -> Result<(), DiagnoseError> {
        let motion = self.trajectory.sampled(FILE_RATE, PERIODS, 0.0);
        Ok(write_reference(&motion, &["next".to_owned()], path)?)
    }
}
