//! Evaluation sample by sample, without allocation after construction.

use pulp::Arch;

use super::perceptron::Perceptron;
use super::recurrent::RecurrentNet;
use super::{Architecture, Bounds, Compensator, Error, Inside, Normaliser, Unit};

#[derive(Debug, Clone)]
enum Net {
    Recurrent(Box<RecurrentNet>),
    Perceptron(Perceptron),
}

/// One unit at run-time: packed weights, the window of recent samples, and carried states.
#[derive(Debug, Clone)]
pub struct UnitStream {
    joint: usize,
    enabled: bool,
    columns: Vec<usize>,
    input: Normaliser,
    target: Normaliser,
    bounds: Bounds,
    inside: Inside,
    nets: Vec<Net>,
    arch: Arch,
    /// Normalised samples, oldest first.
    window: Vec<f32>,
    empty: bool,
    sample: Vec<f32>,
    scratch: Vec<f32>,
}

impl UnitStream {
    /// Packs the weights of a unit that passed [`Unit::check`] in `joints` joints and `inputs` columns.
    ///
    /// # Errors
    /// The sentence of [`Unit::check`].
    pub fn new(unit: &Unit, joints: usize, inputs: usize) -> Result<Self, String> {
        unit.check(joints, inputs)?;
        let d = unit.columns.len();
        let tensors = unit.architecture.tensors(d).unwrap_or_default();
        let nets = unit
            .members
            .iter()
            .map(|parameters| match &unit.architecture {
                Architecture::Recurrent(shape) => Net::Recurrent(Box::new(RecurrentNet::new(
                    shape,
                    &tensors,
                    parameters,
                    unit.architecture.attended(),
                    unit.weights,
                ))),
                Architecture::Perceptron { .. } => {
                    Net::Perceptron(Perceptron::new(&tensors, parameters))
                }
            });
        Ok(Self {
            joint: unit.joint,
            enabled: unit.enabled,
            columns: unit.columns.clone(),
            input: unit.input.clone(),
            target: unit.target.clone(),
            bounds: unit.bounds.clone(),
            inside: Inside::NOTHING_LEARNED,
            nets: nets.collect(),
            arch: Arch::new(),
            window: vec![0.0; d * unit.architecture.timestep()],
            empty: true,
            sample: vec![0.0; d],
            scratch: vec![0.0; d],
        })
    }

    /// Index of the joint whose torque this unit predicts.
    pub fn joint(&self) -> usize {
        self.joint
    }

    /// Position of the last sample relative to the training samples.
    pub fn inside(&self) -> Inside {
        self.inside
    }

    /// Forgets every sample: the next one starts a trajectory.
    pub fn reset(&mut self) {
        self.empty = true;
        for net in &mut self.nets {
            if let Net::Recurrent(net) = net {
                net.reset();
            }
        }
    }

    /// Residual torque, N·m, after the sample `inputs` (all columns of the compensator, in their units).
    ///
    /// Within the bounds this is the mean over the members; away from them it fades to zero, and its magnitude
    /// never exceeds the largest of training. A sample that is not finite gives 0 and does not change the
    /// state. A unit that is off gives 0.
    ///
    /// # Panics
    /// Where `inputs` is shorter than the columns the unit was checked against.
    pub fn step(&mut self, inputs: &[f32]) -> f32 {
        if !self.enabled {
            return 0.0;
        }
        for (j, (&c, x)) in self.columns.iter().zip(&mut self.sample).enumerate() {
            *x = self.input.apply(j, inputs[c]);
        }
        if !self.sample.iter().all(|x| x.is_finite()) {
            return 0.0;
        }
        self.inside = self.bounds.inside(&self.sample, &mut self.scratch);
        for (j, x) in self.sample.iter_mut().enumerate() {
            *x = self.bounds.hold(j, *x);
        }
        let d = self.sample.len();
        if self.empty {
            self.window
                .chunks_exact_mut(d)
                .for_each(|row| row.copy_from_slice(&self.sample));
            self.empty = false;
        } else {
            self.window.copy_within(d.., 0);
            let newest = self.window.len() - d;
            self.window[newest..].copy_from_slice(&self.sample);
        }
        let (arch, window) = (self.arch, &self.window[..]);
        let sum: f32 = self
            .nets
            .iter_mut()
            .map(|net| match net {
                Net::Recurrent(net) => net.evaluate(arch, window),
                Net::Perceptron(net) => net.evaluate(arch, window),
            })
            .sum();
        let torque = self.target.invert(0, sum / self.nets.len() as f32);
        self.inside.weight * self.bounds.clamp(torque)
    }
}

/// All units of a compensator at run-time.
#[derive(Debug, Clone)]
pub struct Stream {
    units: Vec<UnitStream>,
    inputs: usize,
    joints: usize,
}

impl Stream {
    pub(super) fn new(compensator: &Compensator) -> Result<Self, Error> {
        let (joints, inputs) = (compensator.joints.len(), compensator.inputs.len());
        let units = compensator
            .units
            .iter()
            .enumerate()
            .map(|(unit, u)| {
                UnitStream::new(u, joints, inputs).map_err(|problem| Error::Unit { unit, problem })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            units,
            inputs,
            joints,
        })
    }

    /// Number of input columns that [`Self::step`] expects.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of joints of the robot.
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Forgets every sample: the next one starts a trajectory.
    pub fn reset(&mut self) {
        self.units.iter_mut().for_each(UnitStream::reset);
    }

    /// Position of the last sample relative to the training samples: the worst of the units of `joint`.
    pub fn inside(&self, joint: usize) -> Inside {
        let units = self.units.iter().filter(|unit| unit.joint == joint);
        units.fold(Inside::NOTHING_LEARNED, |all, unit| all.worse(unit.inside))
    }

    /// Adds the residual torque of every joint, N·m, after the sample `inputs` to `torque`.
    ///
    /// # Panics
    /// Where `inputs` or `torque` do not have one element per column and joint.
    pub fn step(&mut self, inputs: &[f32], torque: &mut [f64]) {
        assert_eq!(
            (inputs.len(), torque.len()),
            (self.inputs, self.joints),
            "columns and joints of the compensator"
        );
        for unit in &mut self.units {
            torque[unit.joint] += f64::from(unit.step(inputs));
        }
    }
}

impl Compensator {
    /// Streaming evaluation from neutral states.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn stream(&self) -> Result<Stream, Error> {
        Stream::new(self)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Weights;
    use super::super::fixture::{compensator, samples};
    use super::*;

    #[test]
    fn a_window_forgets_what_lies_before_it() {
        let c = compensator();
        for unit in c.units.iter().filter(|u| u.architecture.timestep() > 1) {
            let mut long = UnitStream::new(unit, 2, 3).unwrap();
            let mut short = long.clone();
            let all = samples(20);
            let last = all.iter().map(|x| long.step(x)).last();
            let recent = &all[all.len() - unit.architecture.timestep()..];
            assert_eq!(
                last,
                recent.iter().map(|x| short.step(x)).last(),
                "{:?}",
                unit.architecture
            );
        }
    }

    #[test]
    fn carried_state_remembers_until_it_is_reset() {
        let c = compensator();
        let mut stream = UnitStream::new(&c.units[2], 2, 3).unwrap();
        let all = samples(11);
        let run = |stream: &mut UnitStream| all.iter().map(|x| stream.step(x)).collect::<Vec<_>>();
        let first = run(&mut stream);
        assert_ne!(first, run(&mut stream));
        stream.reset();
        assert_eq!(first, run(&mut stream));
    }

    #[test]
    fn units_of_one_joint_add_up_and_a_unit_that_is_off_is_silent() {
        let mut c = compensator();
        c.units[1].enabled = false;
        let mut stream = c.stream().unwrap();
        let mut units: Vec<_> = c
            .units
            .iter()
            .map(|u| UnitStream::new(u, 2, 3).unwrap())
            .collect();
        for x in samples(8) {
            let mut torque = [1.0, -1.0];
            stream.step(&x, &mut torque);
            let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|i| f64::from(units[i].step(&x)));
            assert_eq!(b, 0.0);
            assert_eq!(torque, [1.0 + a + c + e, -1.0 + d]);
        }
    }

    #[test]
    fn narrow_weights_change_the_torque_little() {
        let c = compensator();
        let all = samples(40);
        for unit in &c.units {
            let torques = |weights| {
                let unit = Unit {
                    weights,
                    ..unit.clone()
                };
                let mut stream = UnitStream::new(&unit, 2, 3).unwrap();
                all.iter().map(|x| stream.step(x)).collect::<Vec<_>>()
            };
            let whole = torques(Weights::F32);
            let size = whole.iter().fold(0.0_f32, |m, t| m.max(t.abs()));
            for form in [Weights::Bf16, Weights::Int8] {
                let narrow = torques(form);
                let pairs = whole.iter().zip(&narrow);
                let worst = pairs.fold(0.0_f32, |m, (a, b)| m.max((a - b).abs()));
                assert!(worst < 0.02 * size, "{form:?}: {worst} of {size}");
                let stays = matches!(unit.architecture, Architecture::Perceptron { .. });
                assert_eq!(worst == 0.0, stays, "{form:?}, {:?}", unit.architecture);
            }
        }
    }
}
