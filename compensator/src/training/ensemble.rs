//! Training of ensembles: from jobs to units, one network per seed, on all cores.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use super::batches::{Gatherer, Layout};
use super::checkpoint;
use super::epoch::{Epoch, Position};
use super::job::{Control, Job, Prepared, Report, Trained};
use super::progress::{Clock, Progress};
use super::state::State;
use super::trainer::Trainer;
use crate::Error;

impl Prepared<'_, '_> {
    /// Cost of an epoch, samples × parameters, to which its time is proportional, and the largest number of epochs of a
    /// network.
    fn cost(&self) -> (f64, usize) {
        let config = &self.job.config;
        let parameters = config.architecture.parameter_count(self.job.columns.len());
        let cost = self.train.len() as f64 * parameters.unwrap_or(1) as f64;
        (cost, config.training.epochs)
    }

    /// Trains one network; returns its best weights and the position at which the training ended. `report` is called
    /// after every epoch, and with true for the state of a checkpoint.
    fn network(
        &self,
        member: usize,
        path: Option<PathBuf>,
        control: &Control,
        report: impl Fn(&State, bool),
    ) -> Result<(Vec<f32>, Position), Error> {
        let config = &self.job.config;
        let seed = self.job.seed.wrapping_add(member as u64);
        let layout = Layout::new(&config.architecture, &config.training);
        let gather = Gatherer {
            samples: self.job.samples,
            columns: &self.job.columns,
            input: &self.input,
            target: &self.target,
            bounds: &self.bounds,
            layout,
        };
        let origin = checkpoint::Origin {
            fingerprint: match control.tensors {
                Some(_) => format!("{}-{seed}-tensors", self.fingerprint),
                None => format!("{}-{seed}", self.fingerprint),
            },
            config,
        };
        let items = (&self.train[..], &self.validation[..]);
        let mut trainer = Trainer::new(
            &gather,
            (&config.architecture, &config.training),
            items,
            (seed, self.level),
            control.tensors,
        )?;
        if let Some(path) = path.as_deref().filter(|path| path.exists()) {
            trainer.state = checkpoint::load(path, &origin, trainer.state)?;
            report(&trainer.state, true);
        }
        let run = trainer.run(control.cancel, |state| {
            report(state, false);
            path.as_deref()
                .map_or(Ok(()), |path| checkpoint::save(path, &origin, state))
        });
        if let (Err(Error::Interrupted), Some(path)) = (&run, &path) {
            checkpoint::save(path, &origin, &trainer.state)?;
        }
        run?;
        Ok((trainer.state.best.values(), trainer.state.progress))
    }
}

/// Best weights of a network, and the position at which its training ended.
type Ended = Result<(Vec<f32>, Position), Error>;

/// Trains every job; the result does not depend on the number of threads.
///
/// # Errors
/// The first job's error, in the order of the jobs; [`Error::Interrupted`] once the flag is raised.
pub fn train(jobs: &[Job], control: &Control) -> Result<Vec<Trained>, Error> {
    let prepared = jobs
        .iter()
        .map(Prepared::new)
        .collect::<Result<Vec<_>, _>>()?;
    if let Some(directory) = control.checkpoints {
        std::fs::create_dir_all(directory).map_err(|source| Error::Io {
            path: directory.to_owned(),
            source,
        })?;
    }
    let tasks: Vec<(usize, usize)> = jobs
        .iter()
        .enumerate()
        .flat_map(|(i, job)| (0..job.config.members).map(move |m| (i, m)))
        .collect();
    let results: Vec<OnceLock<Ended>> = tasks.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let clock = Clock::new(tasks.iter().map(|&(i, _)| prepared[i].cost()));
    let work = || {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(&(i, member)) = tasks.get(index) else {
                break;
            };
            let path = control
                .checkpoints
                .map(|d| d.join(format!("unit{i}-member{member}.safetensors")));
            let result = prepared[i].network(member, path, control, |state, kept| {
                let remaining = clock.note(index, &state.progress, kept);
                if let Some(progress) = control.progress {
                    progress(&describe(&prepared[i], (i, member), state, remaining));
                }
            });
            // Each index is taken once, so the cell is empty.
            let _ = results[index].set(result);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..control.threads.clamp(1, tasks.len().max(1)) {
            scope.spawn(work);
        }
        work();
    });
    let mut networks = results
        .into_iter()
        .map(|cell| cell.into_inner().unwrap_or(Err(Error::Interrupted)));
    prepared
        .iter()
        .map(|p| {
            let networks = networks
                .by_ref()
                .take(p.job.config.members)
                .collect::<Result<Vec<_>, _>>()?;
            let (members, positions): (Vec<_>, Vec<_>) = networks.into_iter().unzip();
            let best_epoch = positions.iter().map(|at| at.best_epoch).collect();
            let history = positions.into_iter().map(|at| at.history).collect();
            let unit = p.unit(members);
            let (unit, validation_rmse, validation_rmse_off) = p.judge(unit)?;
            Ok(Trained {
                unit,
                report: Report {
                    history,
                    best_epoch,
                    validation_rmse,
                    validation_rmse_off,
                },
            })
        })
        .collect()
}

fn describe(
    p: &Prepared,
    (job, member): (usize, usize),
    state: &State,
    remaining: Duration,
) -> Progress {
    let position = &state.progress;
    let last = position.history.last().copied().unwrap_or(Epoch {
        train_loss: f64::NAN,
        validation_rmse: None,
    });
    Progress {
        job,
        joint: p.job.joint,
        member,
        epoch: position.history.len(),
        epochs: p.job.config.training.epochs,
        last,
        best_validation_rmse: position
            .history
            .get(position.best_epoch)
            .and_then(|e| e.validation_rmse),
        finished: position.finished,
        remaining,
    }
}
