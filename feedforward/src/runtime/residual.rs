//! The compensator in the loop: its input columns, its windows, its share of the torque.

use super::error::LoadError;
use crate::clock::{LONGEST_PERIOD, stride};
use crate::inputs::{CompensatorRecord, Signal};
use crate::network::{Compensator, Inside, Stream};
use physics::effects::{BankState, Sample, Term, TermBank};

/// Largest number of control periods within the period of a network; each has windows and states of its own.
const MOST_STREAMS: usize = 2000;

#[derive(Debug, Clone)]
pub(super) struct Residual {
    /// Source of each input column.
    sources: Vec<Source>,
    /// Terms among the inputs, one bank per joint.
    banks: Vec<TermBank>,
    columns: Vec<Vec<f64>>,
    inputs: Vec<f32>,
    /// Streams, one per control period within the network's own period, taking turns. Each is fed samples as
    /// far apart as in training, and the torque is smooth at the control rate.
    streams: Vec<Stream>,
    turn: usize,
    /// Residual torque at the last sample, N·m, by joint.
    share: Vec<f64>,
    /// Position of the last sample relative to the training samples, by joint.
    inside: Vec<Inside>,
}

#[derive(Debug, Clone, Copy)]
enum Source {
    Position(usize),
    Velocity(usize),
    Acceleration(usize),
    Load(usize),
    Term { joint: usize, index: usize },
}

impl Residual {
    pub(super) fn new(
        record: &CompensatorRecord,
        compensator: &Compensator,
        joints: usize,
        period: f64,
    ) -> Result<Self, LoadError> {
        let mut terms: Vec<Vec<Term>> = vec![Vec::new(); joints];
        let mut sources = Vec::with_capacity(record.inputs.len());
        for input in &record.inputs {
            let joint = input.joint;
            sources.push(match &input.signal {
                Signal::Position => Source::Position(joint),
                Signal::Velocity => Source::Velocity(joint),
                Signal::Acceleration => Source::Acceleration(joint),
                Signal::Load => Source::Load(joint),
                Signal::Term(term) => {
                    terms[joint].push(term.clone());
                    Source::Term {
                        joint,
                        index: terms[joint].len() - 1,
                    }
                }
            });
        }
        let turns = stride(record.period / period)
            .filter(|turns| *turns <= MOST_STREAMS)
            .ok_or(LoadError::Windows {
                period,
                trained: record.period,
                shortest: record.period / MOST_STREAMS as f64,
                longest: record.period * LONGEST_PERIOD,
            })?;
        let stream = compensator.stream()?;
        Ok(Self {
            columns: terms.iter().map(|t| vec![0.0; t.len()]).collect(),
            banks: terms
                .into_iter()
                .enumerate()
                .map(|(joint, t)| TermBank::new(joint, t))
                .collect(),
            inputs: vec![0.0; sources.len()],
            sources,
            streams: vec![stream; turns],
            turn: 0,
            share: vec![0.0; joints],
            inside: vec![Inside::NOTHING_LEARNED; joints],
        })
    }

    /// Takes over stored memory, one state per joint; neutral for joints without one.
    pub(super) fn restore(&mut self, memory: &[BankState]) {
        self.banks.iter_mut().for_each(TermBank::reset);
        for (bank, state) in self.banks.iter_mut().zip(memory) {
            bank.restore(state);
        }
        self.rewind();
    }

    /// Empties the windows of the compensator.
    pub(super) fn rewind(&mut self) {
        self.streams.iter_mut().for_each(Stream::reset);
        self.turn = 0;
    }

    pub(super) fn add(&mut self, sample: &Sample, tau: &mut [f64]) {
        for (bank, columns) in self.banks.iter_mut().zip(&mut self.columns) {
            bank.step(sample, columns);
        }
        for (input, source) in self.inputs.iter_mut().zip(&self.sources) {
            *input = match *source {
                Source::Position(j) => sample.q[j],
                Source::Velocity(j) => sample.qd[j],
                Source::Acceleration(j) => sample.qdd[j],
                Source::Load(j) => sample.load[j].abs(),
                Source::Term { joint, index } => self.columns[joint][index],
            } as f32;
        }
        let stream = &mut self.streams[self.turn];
        self.share.fill(0.0);
        stream.step(&self.inputs, &mut self.share);
        for (joint, (tau, share)) in tau.iter_mut().zip(&self.share).enumerate() {
            *tau += share;
            self.inside[joint] = stream.inside(joint);
        }
        self.turn = (self.turn + 1) % self.streams.len();
    }

    /// Lets control periods pass without a sample.
    pub(super) fn miss(&mut self, periods: usize) {
        if periods > self.streams.len() {
            self.rewind();
        } else {
            self.turn = (self.turn + periods) % self.streams.len();
        }
    }

    /// Residual torque at the last sample, N·m, by joint.
    pub(super) fn share(&self) -> &[f64] {
        &self.share
    }

    /// Position of the last sample relative to the training samples.
    pub(super) fn inside(&self, joint: usize) -> Inside {
        self.inside[joint]
    }
}
