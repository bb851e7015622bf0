//! Predictions for whole recordings: the same numbers as the streaming run-time, in large products.

use feedforward::network::{Unit, UnitStream, Weights};

use super::batches::{Gatherer, Layout};
use super::samples::Samples;
use crate::Error;
use crate::config::Training;
use crate::engine::{Network, Span};

/// Residual torque, N·m, of every sample in the given trajectories; 0 in the others.
///
/// Each trajectory starts from a reset. Windows are evaluated in batches; carried state, and weights in another form than
/// single precision, run through the streaming run-time itself.
///
/// # Errors
/// [`Error::Unit`] where the unit contradicts itself.
pub fn predict(unit: &Unit, samples: &Samples, trajectories: &[usize]) -> Result<Vec<f32>, Error> {
    unit.check(unit.joint + 1, samples.columns())
        .map_err(Error::Unit)?;
    let mut torque = vec![0.0; samples.rows()];
    if !unit.enabled {
        return Ok(torque);
    }
    match Layout::new(&unit.architecture, &Training::default()) {
        layout @ Layout::Windows(_) if unit.weights == Weights::F32 => {
            windows(unit, samples, trajectories, layout, &mut torque)?;
        }
        _ => {
            let mut stream =
                UnitStream::new(unit, unit.joint + 1, samples.columns()).map_err(Error::Unit)?;
            let all: Vec<usize> = (0..samples.columns()).collect();
            let mut row = vec![0.0; samples.columns()];
            for &t in trajectories {
                stream.reset();
                for i in samples.trajectories()[t].clone() {
                    samples.gather(i, &all, &mut row);
                    torque[i] = stream.step(&row);
                }
            }
        }
    }
    Ok(torque)
}

/// Writes the residual torque of every sample of the trajectories, N·m, to `torque`. Windows are evaluated in batches.
fn windows(
    unit: &Unit,
    samples: &Samples,
    trajectories: &[usize],
    layout: Layout,
    torque: &mut [f32],
) -> Result<(), Error> {
    let d = unit.columns.len();
    let mut network = Network::<f32>::new(&unit.architecture, d)
        .ok_or_else(|| Error::Unit("its architecture".into()))?;
    let gather = Gatherer {
        samples: *samples,
        columns: &unit.columns,
        input: &unit.input,
        target: &unit.target,
        bounds: &unit.bounds,
        layout,
    };
    let (mut raw, mut scratch) = (vec![0.0; d], vec![0.0; d]);
    let (mut outputs, mut sums) = (Vec::new(), Vec::new());
    for items in layout.every_row(samples, trajectories).chunks(512) {
        let span: Span = layout.span(items.len());
        network.begin(span);
        gather.inputs(items, &mut network);
        outputs.resize(span.outputs(), 0.0);
        sums.clear();
        sums.resize(span.outputs(), 0.0);
        for member in &unit.members {
            network.forward(member, None, &mut outputs);
            sums.iter_mut().zip(&outputs).for_each(|(s, y)| *s += y);
        }
        for (sum, (row, _, _)) in sums.iter().zip(gather.targets(items)) {
            samples.gather(row, &unit.columns, &mut raw);
            raw.iter_mut()
                .enumerate()
                .for_each(|(j, x)| *x = unit.input.apply(j, *x));
            let mean = unit.target.invert(0, sum / unit.members.len() as f32);
            torque[row] = unit.bounds.weight(&raw, &mut scratch) * unit.bounds.clamp(mean);
        }
    }
    Ok(())
}
