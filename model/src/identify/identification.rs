//! Identification: from prepared recordings to a physical model.
//!
//! 1. Base parameters, offset, viscous and Coulomb friction and rotor inertia of all joints
//!    together, rows weighted by each joint's residual deviation.
//! 2. The rigid torque of that fit is the load that load-dependent terms see.
//! 3. Further terms of each joint, chosen by cross-validation over whole groups of trajectories.
//! 4. Everything together again with the estimator asked for; standard deviations from leaving blocks of time
//!    out, because residuals are correlated in time.

use super::error::IdentifyError;
use super::target::Target;
use crate::identify::basic;
use crate::identify::design::{Data, JointSystem};
use crate::identify::dictionary::{self, SessionClock};
use crate::identify::estimators::{self, EstimatorOptions, EstimatorReport, Solution};
use crate::identify::selection::{self, FoldGrams, ForwardOptions, Selection};
use crate::identify::shrinkage::GivenInertias;
use crate::identify::steady::{pushing, top_speed};
use crate::session::Session;
use ::identify::base::BaseParameters;
use ::identify::feasible::Feasible;
use ::identify::least_squares::{Estimate, LeastSquaresError, Triangle};
use datasets::check::STILL;
use ndarray::Array2;
use physics::effects::Term;
use physics::robot::Robot;
use rayon::prelude::*;
use std::ops::Range;

/// Settings of [`identify()`].
#[derive(Clone, Debug)]
pub struct IdentifyOptions {
    /// Whether to fit on moving samples alone: for each joint, those with |q̇| above [`datasets::metrics::MOVING`].
    pub moving_only: bool,
    /// Whether to choose further terms; otherwise there are only the basic ones.
    pub select: bool,
    /// Indices of joints with basic terms only, because they are used outside the motion on which they are fitted.
    pub plain: Vec<usize>,
    /// Largest number of folds of the cross-validation.
    pub folds: usize,
    /// Settings of the selection.
    pub forward: ForwardOptions,
    /// Options of the estimator.
    pub estimator: EstimatorOptions,
}

impl Default for IdentifyOptions {
    fn default() -> Self {
        Self {
            moving_only: false,
            select: true,
            plain: Vec::new(),
            folds: 6,
            forward: ForwardOptions::default(),
            estimator: EstimatorOptions::default(),
        }
    }
}

/// Largest torque of a further friction shape over that of the joint's basic friction, and of a torque of
/// position over the joint's torque.
const LARGEST: f64 = 3.0;

/// Result of an identification.
#[derive(Clone, Debug)]
pub struct Identified {
    /// Base parameters of the rigid body.
    pub base: BaseParameters,
    /// Estimated parameters: the base parameters, then the terms of joint 1, 2, …
    pub estimate: Estimate,
    /// Estimated parameters without the condition that links be possible.
    pub free: Vec<f64>,
    /// Base parameters of the load for load-dependent terms.
    pub load_base: Vec<f64>,
    /// Terms of each joint: basic ones first, then the chosen ones in order of choice.
    pub terms: Vec<Vec<Term>>,
    /// Cross-validated error of each joint's selection.
    pub selections: Vec<Selection>,
    /// Standard deviation of each joint's residual on the fitted samples, N·m.
    pub residual_std: Vec<f64>,
    /// Number of folds of the cross-validation.
    pub folds: usize,
    /// Triangle of the weighted rows of all joints.
    pub triangle: Triangle,
    /// Possible links that the estimate is made of; none where these were not required.
    pub feasible: Option<Feasible>,
    /// Report of the estimation.
    pub report: EstimatorReport,
    /// Prior from the given inertias, where it was used.
    pub given: Option<GivenInertias>,
}

impl Identified {
    /// Index of the first parameter of each joint's terms in `estimate`.
    pub fn term_offsets(&self) -> Vec<usize> {
        self.terms
            .iter()
            .scan(self.base.len(), |next, list| {
                let first = *next;
                *next += list.len();
                Some(first)
            })
            .collect()
    }
}

/// Identifies `robot` from the first `target.tau.len()` recordings of `session`. Of further recordings only the
/// motion is used, for memory.
///
/// # Errors
/// See [`IdentifyError`].
pub fn identify(
    robot: &Robot,
    session: &Session,
    target: &Target,
    options: &IdentifyOptions,
) -> Result<Identified, IdentifyError> {
    if !moves(session, 0..target.tau.len()) {
        return Err(IdentifyError::NothingMoves);
    }
    let base = BaseParameters::of_robot(robot, &[]);
    let basic = basic::terms(robot);
    let rigid =
        crate::identify::design::rigid_columns(robot, &base, session, 0..target.tau.len(), 1);
    let data = Data {
        robot,
        base: &base,
        rigid: &rigid,
        session,
        target,
        moving_only: options.moving_only,
        every: 1,
    };
    let no_load: Vec<Array2<f64>> = session
        .parts
        .iter()
        .map(|p| Array2::zeros(p.fine.q.dim()))
        .collect();
    let whole = |solution: Solution, load_base, selections, given| Identified {
        base: base.clone(),
        load_base,
        selections,
        folds: target.folds.count,
        given,
        estimate: solution.estimate,
        free: solution.free,
        terms: solution.terms,
        residual_std: solution.residual_std,
        triangle: solution.triangle,
        feasible: solution.feasible,
        report: solution.report,
    };
    if !options.select || target.folds.count < 2 {
        let only = estimators::solve(&data, basic, &no_load, &options.estimator)?;
        let load_base = only.estimate.parameters[..base.len()].to_vec();
        let selections = vec![Selection::default(); robot.dof()];
        return Ok(whole(only, load_base, selections, None));
    }

    // Whole visits left out judge fairly; blocks of one motion share what the motion does not show.
    let forward = ForwardOptions {
        standard_errors: if target.folds.whole {
            0.0
        } else {
            options.forward.standard_errors
        },
        ..options.forward
    };
    let basic = basic::with_signs(&data, basic, &no_load, &forward)?;
    let mut estimator = options.estimator.clone();
    if estimator.prior.is_none() {
        estimator.given = basic::given_inertias(&data, &basic, &no_load)?;
    }
    let first = estimators::solve(&data, basic.clone(), &no_load, &estimator.quick())?;
    let load_base = first.estimate.parameters[..base.len()].to_vec();
    let load = session.load(&robot.with_parameters(&base.standard_from(&load_base))?);
    let clock = clock(session);
    let chosen: Vec<(Vec<Term>, Vec<f64>, Selection)> = (0..robot.dof())
        .into_par_iter()
        .map(|joint| {
            let candidates =
                dictionary::candidates(robot.joints()[joint].kind.is_rotation(), clock);
            let terms: Vec<Term> = basic[joint].iter().cloned().chain(candidates).collect();
            let system = JointSystem::new(&data, joint, &terms, &load, false)?;
            if system.rows() == 0 || options.plain.contains(&joint) {
                let free = vec![f64::INFINITY; basic[joint].len()];
                return Ok((basic[joint].clone(), free, Selection::default()));
            }
            let folds = FoldGrams::new(&system.grams(), &target.folds)?;
            let always: Vec<usize> = (0..system.rigid() + basic[joint].len()).collect();
            let rest: Vec<usize> = (always.len()..system.columns()).collect();
            let torque = system.target_deviation();
            let bounds = bounds(&folds, torque, &terms, system.rigid(), &always, options)?;
            let admissible = |columns: &[usize], parameters: &[f64]| {
                let mut taken = columns.iter().zip(parameters).skip(always.len());
                taken.all(|(&c, value)| value.abs() <= bounds[c - system.rigid()])
            };
            let selection = selection::forward(&folds, &always, &rest, &forward, admissible)?;
            let taken = selection
                .taken
                .iter()
                .map(|&c| terms[c - system.rigid()].clone());
            Ok((
                basic[joint].iter().cloned().chain(taken).collect(),
                kept(&selection, &bounds, system.rigid(), basic[joint].len()),
                selection,
            ))
        })
        .collect::<Result<_, LeastSquaresError>>()?;
    let (mut terms, mut bounds, mut selections) = (Vec::new(), Vec::new(), Vec::new());
    for (list, bound, selection) in chosen {
        terms.push(list);
        bounds.push(bound);
        selections.push(selection);
    }
    let last = loop {
        let last = estimators::solve(&data, terms.clone(), &load, &estimator)?;
        // Fitted with the other joints a coefficient may have grown after all.
        let leave = beyond(&last, base.len(), &bounds);
        let Some((joint, k)) = leave.or_else(|| pushes(&last, &data, &basic)) else {
            break last;
        };
        terms[joint].remove(k);
        bounds[joint].remove(k);
    };
    Ok(whole(last, load_base, selections, estimator.given))
}

/// Bound on the coefficient of each of a joint's terms. A friction shape moves at most [`LARGEST`] times the
/// torque (RMS) of viscous and Coulomb friction in the basic fit. A torque of position moves at most
/// [`LARGEST`] times the deviation `torque` of the joint's. Others are free.
fn bounds(
    folds: &FoldGrams,
    torque: f64,
    terms: &[Term],
    rigid: usize,
    always: &[usize],
    options: &IdentifyOptions,
) -> Result<Vec<f64>, LeastSquaresError> {
    let Some(plain) = folds.parameters(always, options.forward.ridge)? else {
        return Ok(vec![f64::INFINITY; terms.len()]);
    };
    let mut friction = 0.0;
    for (&c, value) in always.iter().zip(&plain).skip(rigid) {
        if matches!(terms[c - rigid], Term::Sliding(_)) {
            friction += value.abs() * folds.rms(c)?;
        }
    }
    terms
        .iter()
        .enumerate()
        .map(|(k, term)| {
            let rms = folds.rms(rigid + k)?;
            let most = if dictionary::is_friction_shape(term) {
                friction
            } else if dictionary::is_torque_of_position(term) {
                torque
            } else {
                f64::INFINITY
            };
            let bounded = k + rigid >= always.len() && rms > 0.0;
            Ok(if bounded {
                LARGEST * most / rms
            } else {
                f64::INFINITY
            })
        })
        .collect()
}

/// Bounds of the basic terms, then of the selected ones.
fn kept(selection: &Selection, bounds: &[f64], rigid: usize, basic: usize) -> Vec<f64> {
    let taken = selection.taken.iter().map(|&c| bounds[c - rigid]);
    bounds[..basic].iter().copied().chain(taken).collect()
}

/// Term whose coefficient exceeds its bound most: joint, index; none where none does.
fn beyond(solution: &Solution, base: usize, bounds: &[Vec<f64>]) -> Option<(usize, usize)> {
    let (offsets, _) = estimators::offsets(base, &solution.terms);
    let mut worst = (1.0, None);
    for (joint, (list, offset)) in bounds.iter().zip(offsets).enumerate() {
        for (k, bound) in list.iter().enumerate() {
            let part = solution.estimate.parameters[offset + k].abs() / bound;
            if part > worst.0 {
                worst = (part, Some((joint, k)));
            }
        }
    }
    worst.1
}

/// Joint and term of a friction shape that makes friction push with the motion: see [`pushing`].
fn pushes(solution: &Solution, data: &Data, basic: &[Vec<Term>]) -> Option<(usize, usize)> {
    let joints = solution.terms.len();
    let (offsets, _) = estimators::offsets(data.base.len(), &solution.terms);
    let parts = &data.session.parts[..data.target.tau.len()];
    (0..joints).find_map(|joint| {
        let values = &solution.estimate.parameters[offsets[joint]..];
        let list: Vec<(Term, f64)> =
            std::iter::zip(solution.terms[joint].clone(), values.iter().copied()).collect();
        let top = top_speed(parts.iter().map(|p| &p.at_samples), joint)?;
        let shape = pushing(&list, basic[joint].len(), (joint, joints), top)?;
        Some((joint, shape))
    })
}

/// Whether some joint's position varies: poses held still depend on gravity too.
fn moves(session: &Session, recordings: Range<usize>) -> bool {
    let parts = &session.parts[recordings];
    let columns = parts.first().map_or(0, |p| p.at_samples.q.ncols());
    (0..columns).any(|joint| {
        let values = || parts.iter().flat_map(|p| p.at_samples.q.column(joint));
        let low = values().copied().fold(f64::INFINITY, f64::min);
        let high = values().copied().fold(f64::NEG_INFINITY, f64::max);
        high - low >= STILL
    })
}

fn clock(session: &Session) -> SessionClock {
    let known = session
        .parts
        .iter()
        .zip(&session.clock_known)
        .filter(|&(_, &known)| known);
    let (mut start, mut end) = (f64::INFINITY, f64::NEG_INFINITY);
    for (part, _) in known {
        for [a, b] in crate::session::spans(&part.fine) {
            start = start.min(a);
            end = end.max(b);
        }
    }
    SessionClock { start, end }
}
