//! Decoys: candidates whose columns are built on another trajectory's motion, which can explain nothing, must lose.

use crate::Options;
use crate::catalogue::Candidate;
use crate::catalogue::candidate::{Column, ColumnTorque, Maker};
use crate::catalogue::effect::Effect;
use crate::diagnosis::first_search;
use crate::motion::scene::Scene;
use crate::search::dictionary::Dictionary;
use crate::search::find::gap;
use crate::search::objective::Objective;
use crate::search::products::Rows;
use crate::search::select::Search;
use crate::simulator::NominalModel;
use ndarray::Array1;
use physics::robot::Robot;
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::{Arc, OnceLock};
use trials::cases::{draw, generate};

/// The values of each of `n` trajectories of one length in the place of the next one's.
fn elsewhere(values: &Array1<f64>, n: usize) -> Array1<f64> {
    let (all, one) = (values.len(), values.len() / n);
    Array1::from_shape_fn(all, |i| values[(i + one) % all])
}

/// A candidate with other columns.
fn with(candidate: &Candidate, columns: Vec<Column>) -> Candidate {
    Candidate {
        columns,
        ..candidate.clone()
    }
}

/// A candidate on another trajectory's motion; none of what is a parameter, or the same whatever the motion.
fn decoy(candidate: &Candidate, trajectories: usize) -> Option<Candidate> {
    let moved = |column: &Column| {
        let make: Arc<Maker> = match &column.torque {
            ColumnTorque::Base(_) | ColumnTorque::Link(..) => return None,
            ColumnTorque::Terms(terms) => {
                let (terms, joint) = (terms.clone(), column.joints[0]);
                Arc::new(move |s: &Scene| vec![s.terms(joint, &terms)])
            }
            ColumnTorque::Made(make) => make.clone(),
        };
        let make = move |s: &Scene| {
            let here = make(s.whole());
            let each = here.iter().map(|x| elsewhere(x, trajectories));
            each.map(|x| s.own(&x).to_owned()).collect()
        };
        Some(Column {
            joints: column.joints.clone(),
            torque: ColumnTorque::Made(Arc::new(make)),
            recorded: column.recorded,
        })
    };
    let info = candidate.effect.info();
    if info.parameter || candidate.effect == Effect::TorqueOffset {
        return None;
    }
    let columns: Option<Vec<Column>> = candidate.columns.iter().map(moved).collect();
    Some(with(candidate, columns?))
}

#[test]
#[ignore = "long: .ci/release"]
fn what_another_trajectory_moved_explains_nothing() {
    const SEED: u64 = 40_962;
    let one = |index: u64| {
        let mut named = 0;
        let case = generate(&draw(index, SEED), SEED).unwrap();
        let model = NominalModel::new(Robot::from_urdf_str(&case.urdf).unwrap());
        let recordings = [&case.train, &case.test];
        let (frames, found, weight) =
            first_search(&model, recordings, &Options::default()).unwrap();
        let data = &frames.data;
        let own = found.candidates.iter();
        let mut all: Vec<Candidate> = own.clone().cloned().collect();
        // Where each candidate's decoy stands among them.
        let mut places = Vec::new();
        for candidate in own {
            let decoy = decoy(candidate, data.rows.len());
            places.push(decoy.is_some().then_some(all.len()));
            all.extend(decoy);
        }
        let dictionary = Dictionary::new(data.dof(), &all);
        let scene = Scene::new(&found.session.present, frames.passage(), &frames.scale);
        let y = data.table_thin(&gap(&model, data, &frames.scale));
        let rows = Rows {
            dictionary: &dictionary,
            scene: &scene,
            frame: data,
            weight: &weight,
            kept: None,
        };
        let grams = rows.grams(&y);
        let objective = Objective::new(&grams, &frames.scale, &found.settings.search);
        let search = Search {
            objective: &objective,
            candidates: &all,
            members: &dictionary.members,
            robot: model.sizes(),
            base: found.tight.0[..found.base].to_vec(),
            barred: HashSet::new(),
            chance: 0.0,
            missing: OnceLock::new(),
        };
        let selection = search.run();
        let accepted = selection.accepted.iter().filter(|c| **c >= places.len());
        let accepted: Vec<_> = accepted.map(|&c| (all[c].effect, &all[c].joints)).collect();
        assert!(accepted.is_empty(), "case {index}: {accepted:?}");
        let tried = search.tried(&search.fit(&[]), &[]);
        for cause in &found.accepted {
            let Some(place) = places[cause.candidate] else {
                continue;
            };
            let own = cause.tried.iter().find(|t| t.candidate == cause.candidate);
            let decoy = tried.iter().find(|t| t.candidate == place);
            // By their columns alone.
            let own = found.earned(own.unwrap());
            let decoy = decoy.map_or(0.0, |d| d.gain - all[place].evidence);
            let effect = all[place].effect;
            assert!(decoy < own, "case {index}, {effect:?}: {decoy} of {own}");
            named += 1;
        }
        named
    };
    let named: usize = (0..2u64).into_par_iter().map(one).sum();
    assert!(named > 0);
}
