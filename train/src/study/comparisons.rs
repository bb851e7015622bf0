//! Comparisons of the study.

use super::data::{Data, Run};
use super::results::{Nodes, Variant};
use super::settings::{DEALT, SPAN, Settings};
use super::trial::{Outcome, Trial};
use compensator::inputs::InputSet;
use compensator::training::{Control, Fold, Split};
use feedforward::network::{Architecture, Memory, Recurrent};
use model::failure::Failure;
use std::path::Path;

/// Lengths of windows that are compared, samples. The published length is trained for Table 6.
const TIMESTEPS: [usize; 4] = [2, 3, 5, 10];

/// Number of samples in the published window.
const PUBLISHED: usize = 3;

/// The study's trials and their common data.
pub struct Comparisons<'a> {
    pub data: &'a Data,
    pub settings: &'a Settings,
    /// Folder of the networks that are trained already.
    pub kept: &'a Path,
    pub control: Control<'a>,
}

fn recurrent(hidden: usize, attention: bool, timestep: usize) -> Architecture {
    Architecture::Recurrent(Recurrent {
        encoder: hidden,
        attention: attention.then_some(hidden),
        reencoder: hidden,
        memory: Memory::Window { timestep },
    })
}

impl Comparisons<'_> {
    /// Number of networks that the whole study trains.
    pub fn networks(settings: &Settings, data: &Data) -> usize {
        let (joints, repeats) = (data.joints.len(), settings.repeats as usize);
        let table_6 = 2 * settings.folds.len();
        let published = repeats - 1;
        let compared = repeats * (2 + TIMESTEPS.len() - 1);
        joints * (table_6 + published + compared + 3) + 2 * settings.nodes.len()
    }

    /// Trial of units on the moves, on the first fold or all; `name` is unique to it.
    fn trial(
        &self,
        name: &str,
        (inputs, architecture): (InputSet, Architecture),
        (joints, folds): (&[usize], &[Fold]),
        repeat: u64,
    ) -> Result<Vec<Outcome>, Failure> {
        let moves = &self.data.moves;
        self.on(
            [moves, moves],
            name,
            (inputs, architecture),
            (joints, folds),
            repeat,
        )
    }

    fn on(
        &self,
        runs: [&Run; 2],
        name: &str,
        (inputs, architecture): (InputSet, Architecture),
        (joints, folds): (&[usize], &[Fold]),
        repeat: u64,
    ) -> Result<Vec<Outcome>, Failure> {
        let trial = Trial {
            name: format!("{name}-{repeat}"),
            runs,
            settings: self.settings,
            inputs,
            architecture,
            repeat,
        };
        trial.run(joints, folds, &self.control, self.kept)
    }

    fn joints(&self) -> Vec<usize> {
        (0..self.data.joints.len()).collect()
    }

    fn first_fold(&self) -> &[Fold] {
        &self.settings.folds[..1]
    }

    fn headline(&self) -> (InputSet, Architecture) {
        let unit = recurrent(self.settings.hidden, true, PUBLISHED);
        (InputSet::Icm, unit)
    }

    /// The published unit of every joint on all folds.
    pub fn published(&self) -> Result<Vec<Outcome>, Failure> {
        let all = self.joints();
        let on = (&all[..], &self.settings.folds[..]);
        self.trial("published", self.headline(), on, 0)
    }

    /// Mean RMSE over the folds, N·m, by joint, of the headline's unit without attention.
    pub fn without_attention(&self) -> Result<Vec<f64>, Failure> {
        let all = self.joints();
        let unit = recurrent(self.settings.hidden, false, PUBLISHED);
        let on = (&all[..], &self.settings.folds[..]);
        let outcomes = self.trial("plain", (InputSet::Icm, unit), on, 0)?;
        Ok(outcomes.iter().map(Outcome::mean).collect())
    }

    /// RMSE on the first fold by seed and joint, N·m; `first` is the unit of the first seed.
    pub fn published_over_seeds(&self, first: &[Outcome]) -> Result<Vec<Vec<f64>>, Failure> {
        let mut seeds = vec![first.iter().map(Outcome::first).collect()];
        seeds.extend(self.on_first("published", &self.headline(), 1)?);
        Ok(seeds)
    }

    /// RMSE on the first fold by seed, from seed `from` on, and joint, N·m.
    fn on_first(
        &self,
        name: &str,
        unit: &(InputSet, Architecture),
        from: u64,
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let all = self.joints();
        let of = |repeat: u64| {
            let on = (&all[..], self.first_fold());
            let outcomes = self.trial(name, unit.clone(), on, repeat)?;
            Ok(outcomes.iter().map(Outcome::first).collect())
        };
        (from..self.settings.repeats).map(of).collect()
    }

    /// Comparison of the unit's inputs.
    pub fn inputs(&self, published: &[Vec<f64>]) -> Result<Vec<Variant<&'static str>>, Failure> {
        let (_, unit) = self.headline();
        let own = self.on_first("own", &(InputSet::Own, unit.clone()), 0)?;
        let all = self.on_first("all", &(InputSet::All, unit), 0)?;
        Ok(vec![
            Variant::over_seeds("own", &own),
            Variant::over_seeds("all", &all),
            Variant::over_seeds("icm", published),
        ])
    }

    /// Comparison of the number of samples in a window.
    pub fn timesteps(&self, published: &[Vec<f64>]) -> Result<Vec<Variant<usize>>, Failure> {
        let of = |timestep: usize| {
            if timestep == PUBLISHED {
                return Ok(Variant::over_seeds(timestep, published));
            }
            let unit = recurrent(self.settings.hidden, true, timestep);
            let name = format!("timestep-{timestep}");
            let seeds = self.on_first(&name, &(InputSet::Icm, unit), 0)?;
            Ok(Variant::over_seeds(timestep, &seeds))
        };
        TIMESTEPS.into_iter().map(of).collect()
    }

    /// Fully connected against LSTM, joint 1 on the first fold.
    pub fn nodes(&self) -> Result<Vec<Nodes>, Failure> {
        let of = |nodes: usize| {
            let one = |name: &str, unit: Architecture| -> Result<f64, Failure> {
                let name = format!("{name}-{nodes}");
                let on = (&[0][..], self.first_fold());
                Ok(self.trial(&name, (InputSet::Icm, unit), on, 0)?[0].first())
            };
            let connected = Architecture::Perceptron {
                hidden: vec![nodes],
                timestep: PUBLISHED,
            };
            Ok(Nodes {
                nodes,
                fully_connected: one("connected", connected)?,
                lstm: one("lstm", recurrent(nodes, false, PUBLISHED))?,
            })
        };
        self.settings.nodes.iter().map(|&n| of(n)).collect()
    }

    /// Results of the published unit on torque smoothed by RLOESS (`smooth`), and on a split that deals out single
    /// samples. There windows share samples with those held out, so that the score has leaked.
    pub fn papers_way(
        &self,
        smooth: &Data,
        published: &[f64],
    ) -> Result<Vec<Variant<&'static str>>, Failure> {
        let all = self.joints();
        let every: Vec<usize> = (0..self.data.moves.segments.len()).collect();
        let dealt = [Fold {
            split: Split {
                train: every.clone(),
                validation: Vec::new(),
            },
            test: every,
        }];
        let by_samples = |name: &str, moves: &Run| -> Result<Vec<f64>, Failure> {
            let held = |row: usize| row % DEALT == DEALT - 1;
            let (train, test) = (moves.counting(|row| !held(row)), moves.counting(held));
            let on = (&all[..], &dealt[..]);
            let outcomes = self.on([&train, &test], name, self.headline(), on, 0)?;
            Ok(outcomes.iter().map(Outcome::first).collect())
        };
        let (raw, smoothed) = (&self.data.moves, &smooth.moves);
        let first = self.first_fold();
        let name = format!("smooth-{SPAN}");
        let by_trajectory = self.on(
            [smoothed, smoothed],
            &name,
            self.headline(),
            (&all, first),
            0,
        )?;
        Ok(vec![
            Variant::once("physics", self.data.physics_rmse(first)),
            Variant::once("smoothed_physics", smooth.physics_rmse(first)),
            Variant::once("trajectories", published.to_vec()),
            Variant::once(
                "smoothed_trajectories",
                by_trajectory.iter().map(Outcome::first).collect(),
            ),
            Variant::once("samples", by_samples("samples", raw)?),
            Variant::once(
                "smoothed_samples",
                by_samples(&format!("smooth-{SPAN}-samples"), smoothed)?,
            ),
        ])
    }
}
