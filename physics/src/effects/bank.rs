//! Terms of one joint with their memory, stepped sample by sample.

use super::Term;
use ndarray::Array2;
use signal::Motion;

/// Quantities of one instant that a joint's terms depend on; slices have one entry per joint, base first.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Session clock in s; None where the recording continues no known clock.
    pub clock: Option<f64>,
    /// Time since the previous sample, s.
    pub dt: f64,
    /// Joint positions, rad (m).
    pub q: &'a [f64],
    /// Joint velocities, rad/s (m/s).
    pub qd: &'a [f64],
    /// Joint accelerations, rad/s² (m/s²).
    pub qdd: &'a [f64],
    /// Rigid-body torque of each joint, N·m (N).
    pub load: &'a [f64],
}

/// Memory of a [`TermBank`], the terms of one joint, after a sample: to be stored and restored.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BankState {
    /// State of each term; zero for terms without memory.
    pub states: Vec<f64>,
    /// Position of the joint at the last sample, rad (m).
    pub q: f64,
}

/// The terms of one joint and their states.
#[derive(Clone, Debug)]
pub struct TermBank {
    joint: usize,
    terms: Vec<Term>,
    states: Vec<f64>,
    last_q: Option<f64>,
}

impl TermBank {
    /// A bank for joint `joint` (index, base first) in the neutral state.
    pub fn new(joint: usize, terms: Vec<Term>) -> Self {
        let states = vec![0.0; terms.len()];
        Self {
            joint,
            terms,
            states,
            last_q: None,
        }
    }

    /// The terms, in the order of the columns.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Forgets all memory: states are zero and the next sample has no displacement.
    pub fn reset(&mut self) {
        self.states.fill(0.0);
        self.last_q = None;
    }

    /// Memory of the terms; None before the first sample.
    pub fn state(&self) -> Option<BankState> {
        let q = self.last_q?;
        Some(BankState {
            states: self.states.clone(),
            q,
        })
    }

    /// Goes on from a stored memory; one of another number of terms is ignored and the bank is reset.
    pub fn restore(&mut self, state: &BankState) {
        self.reset();
        if state.states.len() == self.states.len() {
            self.states.copy_from_slice(&state.states);
            self.last_q = Some(state.q);
        }
    }

    /// Advances by one sample and writes each term's column value; `out` has one entry per term.
    pub fn step(&mut self, sample: &Sample, out: &mut [f64]) {
        let q = sample.q[self.joint];
        let dq = self.last_q.map_or(0.0, |last| q - last);
        self.last_q = Some(q);
        for ((term, state), out) in self.terms.iter().zip(&mut self.states).zip(out) {
            *out = value(term, state, self.joint, dq, sample);
        }
    }
}

fn value(term: &Term, z: &mut f64, joint: usize, dq: f64, s: &Sample) -> f64 {
    match term {
        Term::Offset => 1.0,
        Term::RotorInertia => s.qdd[joint],
        Term::Sliding(f) => f.at(s.qd[joint]),
        Term::EarlySign(e) => e.at(s.qd[joint], s.qdd[joint]),
        Term::Stop(stop) => {
            *z = stop.next(*z, dq);
            *z
        }
        Term::Dahl(dahl) => {
            *z = dahl.next(*z, dq);
            *z
        }
        Term::DahlRate(dahl) => {
            let before = *z;
            *z = dahl.next(*z, dq);
            if s.dt > 0.0 {
                (*z - before) / s.dt
            } else {
                0.0
            }
        }
        Term::LaggedSign(lag) => {
            *z = lag.next(*z, s.qd[joint], s.dt);
            *z
        }
        Term::Load(load) => load.factor(s.load[joint]) * load.friction.step(z, s.qd[joint], dq),
        Term::Position(p) => p.harmonic.at(s.q[joint]) * p.friction.step(z, s.qd[joint], dq),
        Term::Polynomial(p) => p.at(s.q[joint]),
        Term::Harmonic(h) => h.at(s.q[joint]),
        Term::Coupling(c) => c.at(joint, s.q, s.qd, s.qdd),
        Term::Counterbalance(c) => c.torque(s.q[joint]),
        Term::Spring(spring) => spring.torque(s.q[joint]),
        Term::WarmUp(w) => w.factor(s.clock) * value(&w.term, z, joint, dq, s),
        Term::Drift(d) => d.factor(s.clock) * value(&d.term, z, joint, dq, s),
    }
}

/// Columns of one joint's terms over a whole motion, shape (samples, terms).
///
/// `load` has shape (samples, joints). Memory starts neutral at the first sample and runs on over the breaks
/// between segments. `clock_known`: whether `motion.time` is the session clock.
pub fn columns(
    joint: usize,
    terms: &[Term],
    motion: &Motion,
    load: &Array2<f64>,
    clock_known: bool,
) -> Array2<f64> {
    let mut bank = TermBank::new(joint, terms.to_vec());
    let mut out = Array2::zeros((motion.len(), terms.len()));
    let mut last = motion.time.first().copied().unwrap_or(0.0);
    let rows = motion
        .q
        .rows()
        .into_iter()
        .zip(motion.qd.rows())
        .zip(motion.qdd.rows())
        .zip(load.rows());
    for ((k, (((q, qd), qdd), load)), mut row) in rows.enumerate().zip(out.rows_mut()) {
        let time = motion.time[k];
        let (Some(q), Some(qd), Some(qdd), Some(load), Some(row)) = (
            q.to_slice(),
            qd.to_slice(),
            qdd.to_slice(),
            load.to_slice(),
            row.as_slice_mut(),
        ) else {
            unreachable!("tables of a Motion are in standard layout");
        };
        // A clock that restarts says nothing about the pause before it.
        let dt = (time - last).max(0.0);
        last = time;
        bank.step(
            &Sample {
                clock: clock_known.then_some(time),
                dt,
                q,
                qd,
                qdd,
                load,
            },
            row,
        );
    }
    out
}
