//! Several recordings of one robot, walked through in the order in which the robot moved.

use datasets::prepare::Prepared;
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::effects::{Sample, Term, TermBank};
use physics::robot::Robot;
use signal::Motion;
use std::ops::Range;

/// Trajectories of one clock: a new one starts where the clock of a recording does not continue
/// another's.
#[derive(Clone, Debug)]
pub struct Step {
    /// Index of the recording.
    pub part: usize,
    /// Rows of the fine motion.
    pub rows: Range<usize>,
    /// Memory starts neutral before this trajectory.
    pub restart: bool,
}

/// Prepared recordings with the order in which memory runs through them.
#[derive(Clone, Debug)]
pub struct Session {
    /// The recordings.
    pub parts: Vec<Prepared>,
    /// Trajectories in the order of the clock.
    pub steps: Vec<Step>,
    /// Whether each recording is on the clock that warm-up terms know.
    pub clock_known: Vec<bool>,
}

/// Longest pause between two trajectories that memory is carried over, s.
///
/// Longer, and joints may have been moved or brakes applied meanwhile.
pub const LONGEST_PAUSE: f64 = 600.0;

impl Session {
    /// Puts recordings on a common clock.
    ///
    /// Recordings share the clock of the first one unless their trajectories overlap in time with
    /// one already on it: then they restarted their own clock, and memory and warm-up start neutral.
    /// `known` holds the spans of time of trajectories recorded earlier on the clock that the model
    /// knows (empty: the first recording defines it).
    pub fn new(parts: Vec<Prepared>, known: &[[f64; 2]]) -> Self {
        let mut taken: Vec<[f64; 2]> = known.to_vec();
        let mut clock_known = Vec::with_capacity(parts.len());
        for part in &parts {
            let spans = spans(&part.fine);
            let fits = taken.is_empty() || continues(&taken, &spans);
            clock_known.push(fits);
            if fits {
                taken.extend(spans);
            }
        }
        let mut steps: Vec<Step> = Vec::new();
        for (part, prepared) in parts.iter().enumerate() {
            for rows in &prepared.fine.segments {
                steps.push(Step {
                    part,
                    rows: rows.clone(),
                    restart: false,
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
            let time = |s: &Step| parts[s.part].fine.time[s.rows.start];
            key(a).cmp(&key(b)).then(time(a).total_cmp(&time(b)))
        });
        let mut last: Option<(usize, f64)> = None;
        for step in &mut steps {
            let time = &parts[step.part].fine.time;
            step.restart = last.is_none_or(|(part, end)| {
                let same_clock = part == step.part || (clock_known[part] && clock_known[step.part]);
                let pause = time[step.rows.start] - end;
                !same_clock || !(0.0..=LONGEST_PAUSE).contains(&pause)
            });
            last = Some((step.part, time[step.rows.end - 1]));
        }
        Self {
            parts,
            steps,
            clock_known,
        }
    }

    /// Rigid-body torque of `robot` over each recording's fine motion, shape (fine samples, joints).
    pub fn load(&self, robot: &Robot) -> Vec<Array2<f64>> {
        self.parts
            .iter()
            .map(|p| rigid_torque(robot, &p.fine))
            .collect()
    }

    /// Columns of one joint's terms at the recorded samples of every recording, shape
    /// (samples, terms), as the recorded torque would show them: see [`Prepared::to_samples`].
    pub fn columns(&self, joint: usize, terms: &[Term], load: &[Array2<f64>]) -> Vec<Array2<f64>> {
        let mut fine: Vec<Vec<Vec<f64>>> = self
            .parts
            .iter()
            .map(|p| vec![vec![0.0; p.fine.len()]; terms.len()])
            .collect();
        let mut bank = TermBank::new(joint, terms.to_vec());
        let mut values = vec![0.0; terms.len()];
        self.walk(Some(load), |restart, part, row, sample| {
            if restart {
                bank.reset();
            }
            bank.step(sample, &mut values);
            for (column, value) in fine[part].iter_mut().zip(&values) {
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

    /// Visits every fine sample in the order of memory: whether memory restarts, recording, row, sample.
    ///
    /// Without `load` the samples carry an empty one.
    pub fn walk(
        &self,
        load: Option<&[Array2<f64>]>,
        mut visit: impl FnMut(bool, usize, usize, &Sample),
    ) {
        let mut last = f64::NAN;
        for step in &self.steps {
            let motion = &self.parts[step.part].fine;
            for row in step.rows.clone() {
                let restart = step.restart && row == step.rows.start;
                let time = motion.time[row];
                let dt = if restart { 0.0 } else { time - last };
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
                    restart,
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

/// Rigid-body torque over a motion, shape (samples, joints).
pub fn rigid_torque(robot: &Robot, motion: &Motion) -> Array2<f64> {
    let mut workspace = Workspace::new(robot);
    let mut table = Array2::zeros((motion.len(), robot.dof()));
    for (row, mut tau) in table.rows_mut().into_iter().enumerate() {
        let (q, qd, qdd) = (motion.q.row(row), motion.qd.row(row), motion.qdd.row(row));
        if let (Some(q), Some(qd), Some(qdd), Some(tau)) = (
            q.to_slice(),
            qd.to_slice(),
            qdd.to_slice(),
            tau.as_slice_mut(),
        ) {
            inverse_dynamics(robot, &mut workspace, q, qd, qdd, tau);
        }
    }
    table
}

/// First and last time stamp of each trajectory, s.
pub fn spans(motion: &Motion) -> Vec<[f64; 2]> {
    motion
        .segments
        .iter()
        .map(|r| [motion.time[r.start], motion.time[r.end - 1]])
        .collect()
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
