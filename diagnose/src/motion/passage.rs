//! A recording's motion among those of its session, in the order in which memory of friction passes through them.

use super::sensed::Sensed;
use model::session::{Start, Step, order};
use ndarray::{Array1, Array2, Axis};
use physics::effects::{Sample, Term, TermBank};
use signal::Motion;

/// One motion, and the earlier motions on the same clock.
#[derive(Clone, Debug)]
pub struct History<'a> {
    motions: Vec<&'a Motion>,
    part: usize,
    steps: Vec<Step>,
    clock_known: Vec<bool>,
    wide: Option<&'a Motion>,
    beside: &'a [Terms],
    sensed: Option<&'a Sensed>,
}

/// Terms of one joint, each with its factor.
pub type Terms = Vec<(f64, Term)>;

impl<'a> From<&'a Motion> for History<'a> {
    /// A motion without known earlier ones.
    fn from(motion: &'a Motion) -> Self {
        Self::of(vec![motion], 0)
    }
}

impl<'a> History<'a> {
    /// Motion `part` of several of one session, whose clock the first defines.
    pub fn of(motions: Vec<&'a Motion>, part: usize) -> Self {
        let (mut steps, clock_known) = order(&motions, &[]);
        // What comes later, or stands on another clock, leaves nothing behind.
        let last = steps.iter().rposition(|s| s.part == part);
        steps.truncate(last.map_or(0, |l| l + 1));
        steps.retain(|s| s.part == part || (clock_known[part] && clock_known[s.part]));
        Self {
            motions,
            part,
            steps,
            clock_known,
            wide: None,
            beside: &[],
            sensed: None,
        }
    }

    /// History with the motion in the band of the rows, on the same grid, where it differs.
    pub fn with_wide(self, wide: Option<&'a Motion>) -> Self {
        Self { wide, ..self }
    }

    /// History under a model with terms that its robot does not hold: none, or one list per joint.
    pub fn with_beside(self, beside: &'a [Terms]) -> Self {
        Self { beside, ..self }
    }

    /// Terms of the model that its robot does not hold: none, or one list per joint.
    pub fn beside(&self) -> &'a [Terms] {
        self.beside
    }

    /// History of a part of the motion, for all but memory.
    pub fn part<'p>(&self, motion: &'p Motion) -> History<'p>
    where
        'a: 'p,
    {
        History {
            clock_known: vec![self.clock_known()],
            beside: self.beside,
            sensed: self.sensed,
            ..History::of(vec![motion], 0)
        }
    }

    /// The motion in the band of the rows, where it differs.
    pub fn wide(&self) -> Option<&'a Motion> {
        self.wide
    }

    /// History with the signals of further sensors.
    pub fn with_sensed(self, sensed: Option<&'a Sensed>) -> Self {
        Self { sensed, ..self }
    }

    /// Signals of further sensors.
    pub fn sensed(&self) -> Option<&'a Sensed> {
        self.sensed
    }

    /// Motion of the recording that is looked at.
    pub fn motion(&self) -> &'a Motion {
        self.motions[self.part]
    }

    /// Whether its time stamps belong to the session's clock.
    pub fn clock_known(&self) -> bool {
        self.clock_known[self.part]
    }

    /// All samples that memory passes through up to the end of the motion, in that order. Beside each, its row
    /// in the motion; none for samples of other motions.
    pub fn walked(&self) -> (Motion, Vec<Option<usize>>) {
        let own = self.motion();
        let len = self.steps.iter().map(|s| s.rows.len()).sum();
        let table = || Array2::zeros((len, own.dof()));
        let mut walked = Motion {
            time: Vec::with_capacity(len),
            q: table(),
            qd: table(),
            qdd: table(),
            segments: Vec::with_capacity(self.steps.len()),
        };
        let mut rows = Vec::with_capacity(len);
        for step in &self.steps {
            let motion = self.motions[step.part];
            let at = rows.len()..rows.len() + step.rows.len();
            walked.time.extend(&motion.time[step.rows.clone()]);
            for (to, from) in [
                (&mut walked.q, &motion.q),
                (&mut walked.qd, &motion.qd),
                (&mut walked.qdd, &motion.qdd),
            ] {
                to.slice_axis_mut(Axis(0), at.clone().into())
                    .assign(&from.slice_axis(Axis(0), step.rows.clone().into()));
            }
            let mine = step.part == self.part;
            rows.extend(step.rows.clone().map(|row| mine.then_some(row)));
            walked.segments.push(at);
        }
        (walked, rows)
    }

    /// Sum of terms of one joint over the motion, each with its factor. `load` gives the torque that the
    /// transmissions carry on a motion, N·m (N), shape (samples, joints). It is called only where a term
    /// depends on it.
    pub fn terms(
        &self,
        joint: usize,
        terms: &[(f64, Term)],
        load: impl Fn(&Motion) -> Array2<f64>,
    ) -> Array1<f64> {
        let mut bank = TermBank::new(joint, terms.iter().map(|t| t.1.clone()).collect());
        let mut values = vec![0.0; terms.len()];
        let mut out = Array1::zeros(self.motion().len());
        let remembers = terms.iter().any(|t| t.1.remembers());
        let sees_load = terms.iter().any(|t| t.1.sees_load());
        let wanted = |part: usize| part == self.part || remembers;
        let loads: Vec<Option<Array2<f64>>> = (0..self.motions.len())
            .map(|p| (wanted(p) && sees_load).then(|| load(self.motions[p])))
            .collect();
        let mut before = f64::NAN;
        for step in self.steps.iter().filter(|s| wanted(s.part)) {
            let motion = self.motions[step.part];
            let load = loads[step.part].as_ref().and_then(|l| l.as_slice());
            let table = |t: &'a Array2<f64>| t.as_slice().expect("tables are in standard layout");
            let (q, qd, qdd) = (table(&motion.q), table(&motion.qd), table(&motion.qdd));
            let dof = motion.dof();
            if step.start == Start::Neutral {
                bank.reset();
            }
            for row in step.rows.clone() {
                let time = motion.time[row];
                let fresh = row == step.rows.start && step.start == Start::Neutral;
                let dt = if fresh { 0.0 } else { time - before };
                before = time;
                let of = row * dof..(row + 1) * dof;
                let clock = self.clock_known[step.part].then_some(time);
                let sample = Sample {
                    clock,
                    dt,
                    q: &q[of.clone()],
                    qd: &qd[of.clone()],
                    qdd: &qdd[of.clone()],
                    load: load.map_or(&[], |l| &l[of]),
                };
                bank.step(&sample, &mut values);
                if step.part == self.part {
                    let each = values.iter().zip(terms);
                    out[row] = each.map(|(v, (factor, _))| factor * v).sum();
                }
            }
        }
        out
    }
}
