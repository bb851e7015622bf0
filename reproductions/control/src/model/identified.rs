//! A machine as the softMC manual identifies it.

use super::Model;
use crate::ControlError;
use machines::Machine;
use machines::description::Description;
use machines::identification::{Settings, identify};
use machines::plant::{Options, simulate};
use plant::reference::Command;

/// A machine with the parameters found in a recording of its simulated self.
pub struct IdentifiedMachine {
    machine: Machine,
    /// All parameters, and the same without friction.
    values: Vec<f64>,
    frictionless: Vec<f64>,
}

/// Rate of the recording, Hz: the described sine waves are far slower.
const RATE: f64 = 250.0;

/// Commanded speed below which an axis stands, rad/s or m/s.
const STILL: f64 = 1e-6;

impl IdentifiedMachine {
    /// Records the described sine waves and identifies.
    ///
    /// # Errors
    /// A description that cannot be simulated or identified.
    pub fn of(description: &Description) -> Result<Self, ControlError> {
        let options = Options {
            rate: RATE,
            ..Options::default()
        };
        let [recording, _] = simulate(description, &options)?;
        let machine = Machine::new(description.clone())?;
        let found = identify(machine, &recording, &Settings::default())?;
        let values = found.estimate.values.clone();
        let mut frictionless = values.clone();
        frictionless[found.machine.model_parameters()..].fill(0.0);
        Ok(Self {
            machine: found.machine,
            values,
            frictionless,
        })
    }

    /// Torque with these parameters; as it was where the machine cannot take the positions.
    fn torque(&self, values: &[f64], [q, qd, qdd]: [&[f64]; 3], tau: &mut [f64]) {
        if let Ok(torque) = self.machine.torque(values, q, qd, qdd) {
            tau.copy_from_slice(&torque);
        }
    }
}

impl Model for IdentifiedMachine {
    fn dof(&self) -> usize {
        self.machine.dof()
    }

    fn rigid(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        self.torque(&self.frictionless, [q, qd, qdd], tau);
    }

    fn physics(&mut self, motion: &Command, tau: &mut [f64]) {
        // A commanded standstill is one although its spline's slope is rounding: friction has no sign there.
        let still = |v: &f64| if v.abs() < STILL { 0.0 } else { *v };
        let qd: Vec<f64> = motion.qd.iter().map(still).collect();
        self.torque(&self.values, [&motion.q, &qd, &motion.qdd], tau);
    }

    fn compensated(&mut self, motion: &Command, tau: &mut [f64]) {
        self.physics(motion, tau);
    }

    fn has_compensator(&self) -> bool {
        false
    }

    fn reset(&mut self) {}
}
