//! Session: several recordings of one robot, in the order in which the robot moved.

use datasets::prepare::Prepared;
use feedforward::clock::{LONGEST_PAUSE, last_before};
use ndarray::Array2;
use physics::batch::rigid_torque;
use physics::effects::{BankState, Sample, Term, TermBank};
use physics::robot::Robot;
use signal::Motion;
use std::ops::Range;

/// Trajectory of a session, with the state of memory before it.
#[derive(Clone, Debug)]
pub struct Step {
    /// Index of the trajectory's recording in `parts`.
    pub part: usize,
    /// Rows of the recording's fine motion that the trajectory takes.
    pub rows: Range<usize>,
    /// State of memory before the trajectory.
    pub start: Start,
}

/// State of memory before a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Memory that runs on after the sample before.
    RunsOn,
    /// Neutral memory: nothing is known of what was before.
    Neutral,
    /// Memory at the end of the known trajectory with this index.
    Known(usize),
}

/// Prepared recordings in the order in which memory passes through them.
#[derive(Clone, Debug)]
pub struct Session {
    /// Prepared recordings, in that order.
    pub parts: Vec<Prepared>,
    /// Trajectories in the order of the clock.
    pub steps: Vec<Step>,
    /// Whether each recording is on the clock of the warm-up terms.
    pub clock_known: Vec<bool>,
    known: Vec<[f64; 2]>,
}

impl Session {
    /// Puts recordings on a common clock.
    ///
    /// Recordings share the clock of the first one unless their trajectories overlap in time with one already
    /// on it: then they restarted their own clock, and memory and warm-up start neutral. `known` holds the time
    /// spans of trajectories recorded earlier on the clock that the model was trained on (empty: the first
    /// recording defines it).
    pub fn new(parts: Vec<Prepared>, known: &[[f64; 2]]) -> Self {
        let motions: Vec<&Motion> = parts.iter().map(|p| &p.fine).collect();
        let (steps, clock_known) = order(&motions, known);
        Self {
            parts,
            steps,
            clock_known,
            known: known.to_vec(),
        }
    }

    /// Rigid-body torque of `robot` over each recording's fine motion, shape (fine samples, joints).
    pub fn load(&self, robot: &Robot) -> Vec<Array2<f64>> {
        self.parts
            .iter()
            .map(|p| rigid_torque(robot, &p.fine.q, &p.fine.qd, &p.fine.qdd))
            .collect()
    }

    /// Columns of one joint's terms at the recorded samples of every recording, shape (samples, terms), with
    /// the recorded torque's filter: see [`Prepared::to_samples`].
    ///
    /// `memory` holds the terms' states at the end of each known trajectory (empty: none is stored).
    pub fn columns(
        &self,
        joint: usize,
        terms: &[Term],
        load: &[Array2<f64>],
        memory: &[&BankState],
    ) -> Vec<Array2<f64>> {
        let mut fine: Vec<Vec<Vec<f64>>> = self
            .parts
            .iter()
            .map(|p| vec![vec![0.0; p.fine.len()]; terms.len()])
            .collect();
        self.run(joint, terms, load, memory, |part, row, _, values| {
            for (column, value) in fine[part].iter_mut().zip(values) {
                column[row] = *value;
            }
        });
        self.parts
            .iter()
            .zip(fine)
            .map(|(part, columns)| {
                let mut table = Array2::zeros((part.at_samples.len(), terms.len()));
                for (mut target, column) in table.columns_mut().into_iter().zip(columns) {
                    target.assign(&ndarray::Array1::from(part.to_samples(&column)));
                }
                table
            })
            .collect()
    }

    /// Memory of one joint's terms at the end of each trajectory on the known clock, in the order of
    /// [`Session::clock`]. Only the first `recordings` recordings count.
    pub fn end_states(
        &self,
        joint: usize,
        terms: &[Term],
        load: &[Array2<f64>],
        recordings: usize,
    ) -> Vec<BankState> {
        let ends: Vec<(usize, usize)> = self
            .clock_steps(recordings)
            .map(|s| (s.part, s.rows.end - 1))
            .collect();
        let mut states = Vec::with_capacity(ends.len());
        self.run(joint, terms, load, &[], |part, row, bank, _| {
            if ends.get(states.len()) == Some(&(part, row)) {
                states.extend(bank.state());
            }
        });
        states
    }

    /// Spans of time of the trajectories of the first `recordings` recordings on the known clock, s.
    pub fn clock(&self, recordings: usize) -> Vec<[f64; 2]> {
        self.clock_steps(recordings)
            .map(|s| {
                let time = &self.parts[s.part].fine.time;
                [time[s.rows.start], time[s.rows.end - 1]]
            })
            .collect()
    }

    fn clock_steps(&self, recordings: usize) -> impl Iterator<Item = &Step> {
        self.steps
            .iter()
            .filter(move |s| s.part < recordings && self.clock_known[s.part])
    }

    /// Steps one joint's terms through all recordings.
    fn run(
        &self,
        joint: usize,
        terms: &[Term],
        load: &[Array2<f64>],
        memory: &[&BankState],
        mut visit: impl FnMut(usize, usize, &TermBank, &[f64]),
    ) {
        let mut bank = TermBank::new(joint, terms.to_vec());
        let mut values = vec![0.0; terms.len()];
        self.walk(Some(load), |start, part, row, sample| {
            match start {
                Start::RunsOn => {}
                Start::Neutral => bank.reset(),
                Start::Known(k) => match memory.get(k) {
                    Some(state) => bank.restore(state),
                    None => bank.reset(),
                },
            }
            bank.step(sample, &mut values);
            visit(part, row, &bank, &values);
        });
    }

    /// Visits every fine sample in the order of memory, with state of memory, recording, row and sample.
    ///
    /// Without `load` the samples have an empty one.
    pub fn walk(
        &self,
        load: Option<&[Array2<f64>]>,
        mut visit: impl FnMut(Start, usize, usize, &Sample),
    ) {
        let mut last = f64::NAN;
        for step in &self.steps {
            let motion = &self.parts[step.part].fine;
            for row in step.rows.clone() {
                let start = if row == step.rows.start {
                    step.start
                } else {
                    Start::RunsOn
                };
                let time = motion.time[row];
                let dt = match start {
                    Start::RunsOn => time - last,
                    Start::Neutral => 0.0,
                    Start::Known(k) => time - self.known[k][1],
                };
                last = time;
                let (q, qd, qdd) = (motion.q.row(row), motion.qd.row(row), motion.qdd.row(row));
                let load = load.map(|tables| tables[step.part].row(row));
                let (Some(q), Some(qd), Some(qdd), Some(load)) = (
                    q.to_slice(),
                    qd.to_slice(),
                    qdd.to_slice(),
                    load.map_or(Some(&[][..]), |l| l.to_slice()),
                ) else {
                    unreachable!("tables are in standard layout");
                };
                let clock = self.clock_known[step.part].then_some(time);
                visit(
                    start,
                    step.part,
                    row,
                    &Sample {
                        clock,
                        dt,
                        q,
                        qd,
                        qdd,
                        load,
                    },
                );
            }
        }
    }
}

/// Trajectories of several recordings in the order in which memory passes through them, and whether each
/// recording is on the clock of the warm-up terms. `known` as in [`Session::new`].
pub fn order(motions: &[&Motion], known: &[[f64; 2]]) -> (Vec<Step>, Vec<bool>) {
    let mut taken: Vec<[f64; 2]> = known.to_vec();
    let mut clock_known = Vec::with_capacity(motions.len());
    for motion in motions {
        let spans = spans(motion);
        let fits = runs_on(&spans) && (taken.is_empty() || continues(&taken, &spans));
        clock_known.push(fits);
        if fits {
            taken.extend(spans);
        }
    }
    let mut steps: Vec<Step> = Vec::new();
    for (part, motion) in motions.iter().enumerate() {
        for rows in &motion.segments {
            steps.push(Step {
                part,
                rows: rows.clone(),
                start: Start::RunsOn,
            });
        }
    }
    // The common clock first, in order of time; then each recording with a clock of its own.
    steps.sort_by(|a, b| {
        let key = |s: &Step| {
            (
                !clock_known[s.part],
                if clock_known[s.part] { 0 } else { s.part },
            )
        };
        let time = |s: &Step| motions[s.part].time[s.rows.start];
        key(a).cmp(&key(b)).then(time(a).total_cmp(&time(b)))
    });
    let mut last: Option<(usize, f64)> = None;
    for step in &mut steps {
        let time = &motions[step.part].time;
        let start = time[step.rows.start];
        let before = last.filter(|&(part, end)| {
            let same_clock = part == step.part || (clock_known[part] && clock_known[step.part]);
            same_clock && last_before(&[[end; 2]], start).is_some()
        });
        let stored = last_before(known, start).filter(|_| clock_known[step.part]);
        step.start = match (before, stored) {
            (Some((_, end)), Some(k)) if known[k][1] > end => Start::Known(k),
            (Some(_), _) => Start::RunsOn,
            (None, Some(k)) => Start::Known(k),
            (None, None) => Start::Neutral,
        };
        last = Some((step.part, time[step.rows.end - 1]));
    }
    (steps, clock_known)
}

/// First and last time stamp of each trajectory, s.
pub fn spans(motion: &Motion) -> Vec<[f64; 2]> {
    motion
        .segments
        .iter()
        .map(|r| [motion.time[r.start], motion.time[r.end - 1]])
        .collect()
}

/// Whether time increases from trajectory to trajectory of one recording.
fn runs_on(spans: &[[f64; 2]]) -> bool {
    spans.windows(2).all(|w| w[1][0] > w[0][1])
}

/// Whether trajectories with these spans can be on a clock on which `known` ones were recorded: no
/// overlap in time, and no long pause before or after.
fn continues(known: &[[f64; 2]], spans: &[[f64; 2]]) -> bool {
    let start = known.iter().map(|s| s[0]).fold(f64::INFINITY, f64::min);
    let end = known.iter().map(|s| s[1]).fold(f64::NEG_INFINITY, f64::max);
    let near = spans.iter().all(|s| s[1] >= start - LONGEST_PAUSE)
        && spans.first().is_some_and(|s| s[0] <= end + LONGEST_PAUSE);
    near && spans
        .iter()
        .all(|s| known.iter().all(|k| s[1] < k[0] || s[0] > k[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks() {
        let known = [[0.0, 10.0], [20.0, 30.0]];
        assert!(
            continues(&known, &[[11.0, 19.0], [31.0, 40.0]]),
            "interleaved"
        );
        assert!(continues(&known, &[[30.5, 40.0]]), "goes on");
        assert!(!continues(&known, &[[0.0, 10.0]]), "restarted");
        assert!(!continues(&known, &[[1e6, 1e6 + 10.0]]), "another day");
    }
}
