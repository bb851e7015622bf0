//! What can be known of a sealed case at all: the Bayes choice of an observer who is told more than any diagnosis has, an upper bound.
//!
//! The observer is told the true motion, the filter and the noise law of the torque, its outliers, the shapes of the background and
//! how far descriptions are off. Not told are the withheld effects, the plant's parameters, the background's sizes and a bias. Mechanisms
//! are the plant's own, their shapes, sizes and places as the generator draws them; nothing of the detector takes part.

mod choice;
mod fit;
pub mod lost;
mod marginal;
mod rows;
mod search;
mod tables;
mod unknown;

pub use tables::{by_drawn, by_kind, rates};

use crate::prove::{Draw, ProveError, Score, folder_of, judge, same_draw, specs};
use choice::{names, posterior};
use fit::Window;
use rayon::prelude::*;
use rows::Rows;
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;
use trials::cases::{CaseSpec, name, witnessed};
use unknown::Unknown;

/// The observer's answer to a case.
pub struct Known {
    /// Its scores, as a diagnosis would have them.
    pub score: Score,
    /// Posterior probability of its choice.
    pub probability: f64,
    /// Nats by which the true names lead all others; below zero where others lead.
    pub lead: Option<f64>,
    /// Mean square of what the true mechanisms leave of the log, over the noise's variance: 1 where the observer's torque is the plant's.
    pub left: Option<f64>,
}

/// Part of the trajectories in which hypotheses are sought before all of the log is used.
const PART: usize = 3;

/// The observer's answers to the cases of a proof, scored as a diagnosis is. With `out` the answers go into its `attainable`, and those
/// that are there are scored as they are.
///
/// # Errors
/// The first case that fails, or a kind that does not exist.
pub fn attainable(
    wanted: &Draw,
    out: Option<&Path>,
    done: impl Fn() + Sync,
) -> Result<Vec<Known>, ProveError> {
    let folder = out
        .map(|out| folder_of(&out.join("attainable")))
        .transpose()?;
    specs(wanted)?
        .into_par_iter()
        .map(|spec| {
            let id = name(&spec, wanted.seed);
            let path = folder.as_ref().map(|f| f.join(format!("{id}.json")));
            let kept = path.as_ref().and_then(|p| std::fs::read_to_string(p).ok());
            let kept = kept.and_then(|text| serde_json::from_str::<Value>(&text).ok());
            let answer = match kept {
                Some(answer) => {
                    let truth = &answer["truth"];
                    same_draw(truth, out.unwrap_or(Path::new("")), &id, &spec)?;
                    answer
                }
                None => {
                    let answer = answered(&spec, wanted.seed)?;
                    if let Some(path) = path {
                        report::write_atomic(&path, format!("{answer:#}"))?;
                    }
                    answer
                }
            };
            done();
            Ok(Known {
                score: judge(&answer["truth"], &answer["report"]),
                probability: answer["probability"].as_f64().unwrap_or(f64::NAN),
                lead: answer["lead"].as_f64(),
                left: answer["left"].as_f64(),
            })
        })
        .collect()
}

/// The observer's answer to one case, with the truth.
fn answered(spec: &CaseSpec, seed: u64) -> Result<Value, ProveError> {
    let begun = Instant::now();
    let (case, witness) = witnessed(spec, seed)?;
    let truth = serde_json::to_value(&case.truth).expect("fields with names, numbers and strings");
    let fail = |reason: &str| ProveError::Observer {
        case: case.id.clone(),
        reason: reason.to_owned(),
    };
    let rows = Rows::new(&witness);
    let unknown = Unknown::of(&witness, &rows).map_err(|e| fail(&e.to_string()))?;
    let trajectories = rows.starts.len() - 1;
    let window = |count: usize| {
        Window::new(&witness, &rows, &unknown, count).ok_or_else(|| fail("rows are not finite"))
    };
    let part = window(trajectories.div_ceil(PART).max(2).min(trajectories))?;
    let hypotheses = search::hypotheses(&witness, spec.hard, &part, &window(trajectories)?);
    let chosen = posterior(&hypotheses);
    let true_names = {
        let effects = case.truth.effects.iter();
        let mut names: Vec<&str> = effects.map(|e| e.effect.as_str()).collect();
        names.sort_unstable();
        names
    };
    let weight = |own: bool| {
        let some = hypotheses
            .iter()
            .filter(|h| (names(h) == true_names) == own);
        some.map(|h| h.weight).fold(f64::NEG_INFINITY, f64::max)
    };
    let true_point = hypotheses.iter().filter(|h| names(h) == true_names);
    let misfit = true_point
        .map(|h| h.point.misfit)
        .fold(f64::INFINITY, f64::min);
    Ok(json!({
        "truth": truth,
        "report": choice::report(&hypotheses, &chosen, witness.dof()),
        "probability": chosen.answers.values().copied().fold(0.0, f64::max),
        // Nats by which the truth leads, and the mean square of what it leaves, in the noise's variance.
        "lead": weight(true) - weight(false),
        "left": misfit / rows.counted(trajectories) as f64,
        "seconds": begun.elapsed().as_secs_f64(),
    }))
}
