//! Rows of the board.

use super::bootstrap::Judged;
use crate::baseline::published::Published;
use crate::directory::Timing;
use datasets::metrics::Scores;
use serde::Serialize;

/// Name of the row of a whole model with compensator.
pub(super) const WHOLE: &str = "physics+compensator";

/// Row of a leaderboard: a model of this project, or a published one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    /// Name of the model: `linear_baseline`, `physics`, `physics+compensator`, `physics+ridge`, `physics+trees`, or the
    /// name in a publication.
    pub model: String,
    /// Model directories that give exactly these figures; empty for a published result.
    pub directories: Vec<String>,
    /// Publication of the row; none for a model of this project.
    pub published: Option<Publication>,
    /// Whether the model was fitted on this very recording, so that its scores do not tell of new motion; false for
    /// published rows.
    pub fitted_on_it: bool,
    /// Scores over all samples of the recording.
    pub all: Judged,
    /// Scores in motion; none where they were not published.
    pub moving: Option<Judged>,
    /// Number of fitted parameters, without those of a network.
    pub parameters: Option<usize>,
    /// Number of weights of the active networks; for yardsticks the ridge's weights or the trees' leaves.
    pub network_parameters: Option<usize>,
    /// Time of one sample in a control loop, µs.
    pub inference_us: Option<f64>,
    /// Wall time of its training.
    pub training: Option<Training>,
}

/// Publication of a row that is not this project's.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Publication {
    /// Part of the benchmark: `train` or `test`.
    pub part: &'static str,
    /// Document and table that state the figures.
    pub source: &'static str,
    /// Inputs of the model, and deviations from the benchmark's protocol.
    pub protocol: &'static str,
}

/// Wall time of a model's training.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Training {
    /// Wall time of the training, s.
    pub seconds: f64,
    /// Number of CPU threads of the training's pool, from `timing.json`.
    pub threads: usize,
    /// Whether the time is complete: that of an interrupted and resumed run is not.
    pub whole: bool,
}

impl Entry {
    /// Row of a model of this project, with scores alone.
    pub(super) fn of(model: &str, directory: &str, [all, moving]: [Judged; 2]) -> Self {
        Self {
            model: model.to_owned(),
            directories: vec![directory.to_owned()],
            published: None,
            fitted_on_it: false,
            all,
            moving: Some(moving),
            parameters: None,
            network_parameters: None,
            inference_us: None,
            training: None,
        }
    }

    /// Row of the board for a published result.
    pub(super) fn published(p: &Published) -> Self {
        let list = |of: Option<[f64; 6]>| match of {
            Some(values) => values.map(Some).to_vec(),
            None => vec![None; 6],
        };
        let scores = Scores {
            rmse: vec![None; 6],
            nrmse: list(p.nrmse),
            r2: list(p.r2),
            mean_nrmse: Some(p.mean_nrmse),
            mean_r2: p.mean_r2,
        };
        Self {
            model: p.model.to_owned(),
            directories: Vec::new(),
            published: Some(Publication {
                part: p.part.name(),
                source: p.source,
                protocol: p.protocol,
            }),
            fitted_on_it: false,
            all: Judged::bare(scores),
            moving: None,
            parameters: None,
            network_parameters: None,
            inference_us: None,
            training: None,
        }
    }

    /// Directories of the row, or its publication.
    pub(super) fn origin(&self) -> String {
        match &self.published {
            Some(p) => format!("published, {}", p.part),
            None if self.fitted_on_it => format!("{} (fitted on it)", self.directories.join(", ")),
            None => self.directories.join(", "),
        }
    }
}

impl Training {
    /// Cost of a directory's physics, or of the whole model with its compensator.
    pub(super) fn of(timing: &Timing, whole_model: bool) -> Self {
        Self {
            seconds: if whole_model {
                timing.seconds()
            } else {
                timing.physics_s
            },
            threads: timing.threads,
            // Only networks have checkpoints.
            whole: !(timing.resumed && whole_model),
        }
    }
}

/// Adds a row. A row of another directory with the same scores is merged as the same model, except for whole
/// models with a compensator.
pub(super) fn enter(rows: &mut Vec<Entry>, entry: Entry) {
    let twin = rows.iter_mut().find(|r| {
        entry.model != WHOLE
            && (&r.model, &r.all, &r.moving) == (&entry.model, &entry.all, &entry.moving)
    });
    match twin {
        Some(twin) => twin.directories.extend(entry.directories),
        None => rows.push(entry),
    }
}

/// Sorts rows by mean NRMSE over all samples, lowest first, rows without one last.
pub(super) fn rank(rows: &mut [Entry]) {
    let key = |r: &Entry| r.all.scores.mean_nrmse.unwrap_or(f64::INFINITY);
    rows.sort_by(|a, b| key(a).total_cmp(&key(b)));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(mean_nrmse: Option<f64>) -> Judged {
        Judged::bare(Scores {
            rmse: vec![None],
            nrmse: vec![mean_nrmse],
            r2: vec![None],
            mean_nrmse,
            mean_r2: None,
        })
    }

    fn entry(model: &str, directory: &str, nrmse: Option<f64>) -> Entry {
        Entry::of(model, directory, [judged(nrmse), judged(nrmse)])
    }

    #[test]
    fn the_lowest_error_stands_first() {
        let mut rows = vec![
            entry("physics", "a", None),
            entry("physics", "b", Some(0.3)),
            entry("physics", "c", Some(0.1)),
        ];
        rank(&mut rows);
        let order: Vec<String> = rows.iter().map(Entry::origin).collect();
        assert_eq!(order, ["c", "b", "a"]);
    }

    #[test]
    fn the_same_physics_stands_once_and_every_whole_model_for_itself() {
        let mut rows = Vec::new();
        for (model, directory, nrmse) in [
            ("physics", "a", 0.3),
            (WHOLE, "a", 0.2),
            ("physics", "b", 0.3),
            (WHOLE, "b", 0.2),
            ("physics", "c", 0.4),
        ] {
            enter(&mut rows, entry(model, directory, Some(nrmse)));
        }
        let list: Vec<(String, String)> =
            rows.iter().map(|r| (r.model.clone(), r.origin())).collect();
        let expected = [
            ("physics", "a, b"),
            (WHOLE, "a"),
            (WHOLE, "b"),
            ("physics", "c"),
        ];
        assert_eq!(list, expected.map(|(m, d)| (m.to_owned(), d.to_owned())));
    }

    #[test]
    fn time_of_physics_is_whole_after_a_resumed_training() {
        let timing = Timing::new(2, 3.0, Some(10.0), true);
        let (physics, whole) = (Training::of(&timing, false), Training::of(&timing, true));
        assert_eq!((physics.seconds, physics.whole), (3.0, true));
        assert_eq!((whole.seconds, whole.whole), (13.0, false));
    }
}
