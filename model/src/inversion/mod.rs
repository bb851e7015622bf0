//! The identified model solved for the motion: positions from torque alone, the forward task of the KR300 benchmark.
//!
//! Simulating forwards from torque drifts: a joint without gravity is two integrators, and friction at rest
//! holds torque that moves nothing. Here the torque of a whole trajectory is explained at once. The motion is a
//! sum of shapes learned from the training trajectories ([`MotionPrior`]). `solve.rs` finds the coefficients
//! whose torque is nearest to the recorded one, from the first position on. So it is no simulation sample by
//! sample: every position depends on all torque of its trajectory.

mod error;
mod law;
mod prior;
mod solve;
mod store;

pub use error::InversionError;
pub use law::JointFriction;
pub use prior::MotionPrior;

use crate::loaded::Loaded;
use crate::session::Session;
use datasets::Recording;
use law::Law;
use ndarray::{Array2, Axis, Slice};
use physics::torque_model::TorqueModel;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use signal::Motion;
use solve::{Solved, Trajectory};
use std::sync::atomic::{AtomicBool, Ordering};

/// Name of the scores of positions that were found from torque by the identified model.
pub const PHYSICS_FORWARD: &str = "physics_forward";

/// Inversion of an identified model, from torque to positions: the prior and the friction that it needs besides the
/// model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inversion {
    /// Prior on motions, learned from the training trajectories.
    pub prior: MotionPrior,
    /// Friction of each joint as a function of velocity.
    pub friction: Vec<JointFriction>,
}

impl Inversion {
    /// Learns prior and friction from recordings and their motion at the samples.
    ///
    /// # Errors
    /// Recordings without torque, too few motions, or a joint that hardly moves.
    pub fn learn(
        model: &TorqueModel,
        data: &[(&Recording, &Motion)],
    ) -> Result<Self, InversionError> {
        let with_speed: Vec<_> = data.iter().map(|(r, m)| (*r, &m.qd)).collect();
        let prior = MotionPrior::learn(&with_speed)?;
        let mut tables: [Vec<_>; 4] = Default::default();
        for (recording, motion) in data {
            let no_torque = || InversionError::NoTorque(recording.source.clone());
            let tau = recording.tau.as_ref().ok_or_else(no_torque)?;
            for (table, of) in tables
                .iter_mut()
                .zip([&motion.q, &motion.qd, &motion.qdd, tau])
            {
                table.push(of.view());
            }
        }
        let [q, qd, qdd, tau] = tables.map(|views| {
            ndarray::concatenate(Axis(0), &views)
                .unwrap_or_else(|e| unreachable!("one robot's tables: {e}"))
        });
        let law = Law::fit(model, &q, &qd, &qdd, &tau)?;
        Ok(Self {
            prior,
            friction: law.friction,
        })
    }

    /// Positions of a recording from its torque and the first position of each trajectory, rad (m), shape (samples,
    /// joints).
    ///
    /// The motion is first found with the smooth law alone. The difference between the whole model and that law on this
    /// motion is then subtracted from the recorded torque, and the motion is found again. Raising `cancel` ends the
    /// search.
    ///
    /// # Errors
    /// Recording without torque, of another rate, or with longer trajectories than the learned ones; cancellation.
    pub fn positions(
        &self,
        whole: &Loaded,
        recording: &Recording,
        cancel: &AtomicBool,
    ) -> Result<Array2<f64>, InversionError> {
        let Some(tau) = &recording.tau else {
            return Err(InversionError::NoTorque(recording.source.clone()));
        };
        if !self.prior.covers(recording) {
            return Err(InversionError::Other(recording.source.clone()));
        }
        let law = Law::new(whole.model, self.friction.clone());
        let first = self.each(&law, recording, tau, cancel, |t, _| t.solve())?;
        let beyond = torque_at(whole, recording, &first.q)? - &first.torque;
        let known = tau - &beyond;
        let found = self.each(&law, recording, &known, cancel, |t, k| {
            t.refine(first.coefficients[k].clone())
        })?;
        Ok(found.q)
    }

    /// Motion of every trajectory, found by `find`.
    fn each(
        &self,
        law: &Law,
        recording: &Recording,
        torque: &Array2<f64>,
        cancel: &AtomicBool,
        find: impl Fn(&Trajectory, usize) -> Solved + Sync,
    ) -> Result<Found, InversionError> {
        let shapes = self.prior.sampled()?;
        let segments = recording.segments();
        let solved: Vec<Solved> = (segments.par_iter().enumerate())
            .map(|(k, rows)| {
                let trajectory = Trajectory {
                    law,
                    prior: &self.prior,
                    shapes: &shapes,
                    torque: torque.slice_axis(Axis(0), Slice::from(rows.clone())),
                    start: &recording.q.row(rows.start).to_vec(),
                    cancel,
                };
                find(&trajectory, k)
            })
            .collect();
        if cancel.load(Ordering::SeqCst) {
            return Err(InversionError::Interrupted);
        }
        let mut found = Found {
            q: Array2::zeros(torque.dim()),
            torque: Array2::zeros(torque.dim()),
            coefficients: Vec::new(),
        };
        for (rows, solved) in segments.into_iter().zip(solved) {
            found
                .q
                .slice_axis_mut(Axis(0), Slice::from(rows.clone()))
                .assign(&solved.q);
            found
                .torque
                .slice_axis_mut(Axis(0), Slice::from(rows))
                .assign(&solved.torque);
            found.coefficients.push(solved.coefficients);
        }
        Ok(found)
    }
}

/// Motion found for a recording.
struct Found {
    /// Positions, rad (m), shape (samples, joints).
    q: Array2<f64>,
    /// Torque of the smooth law, N·m (N), shape (samples, joints).
    torque: Array2<f64>,
    /// Coefficients of the shapes, for each trajectory.
    coefficients: Vec<Vec<f64>>,
}

/// Torque of the whole model, N·m (N), for a recording with the positions `q` in place of its own.
fn torque_at(
    whole: &Loaded,
    recording: &Recording,
    q: &Array2<f64>,
) -> Result<Array2<f64>, InversionError> {
    let moved = Recording {
        q: q.clone(),
        ql: None,
        qd: None,
        qdd: None,
        ..recording.clone()
    };
    let prepared = whole.file.preprocessing.prepare(&moved, None)?;
    let session = Session::new(vec![prepared], &whole.file.clock);
    let [_, torque] = whole.torque(&session)?;
    Ok(torque)
}

#[cfg(test)]
mod tests;
