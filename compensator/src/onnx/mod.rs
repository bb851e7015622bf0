//! ONNX export of a trained unit, or of the units of all joints.
//!
//! The graph over a window takes `window` (batch × T × columns, SI units, oldest sample first) and gives `torque` (batch, or
//! batch × joints, N·m). The graph of [`export_steps`] takes one sample and what the networks remember. Scaling, network,
//! averaging over members, limit and fade are all inside, so the output equals the run-time's prediction for finite samples.

mod graph;
mod network;
mod state;
mod step;

pub use graph::{CELL, HIDDEN, INPUT, NEXT_CELL, NEXT_HIDDEN, OPSET, OUTPUT, SAMPLE};
pub use state::hidden_size;
pub use step::export_steps;

use feedforward::network::{Architecture, Compensator, Memory, Recurrent, Unit};

use crate::Error;
use graph::{Graph, Port};

/// Serialised ONNX model (operator set [`OPSET`]) of a unit on windows of its own columns; output (batch).
///
/// A unit that is off gives zero torque, as everywhere.
///
/// # Errors
/// [`Error::Unit`] for carried state, which has no window to start from, and for a unit that contradicts
/// itself.
pub fn export(unit: &Unit) -> Result<Vec<u8>, Error> {
    let timestep = unit.architecture.timestep();
    let mut g = Graph::default();
    let samples: Vec<String> = (0..timestep).map(|t| g.step(t)).collect();
    let torque = torque(&mut g, unit, &samples)?;
    g.reshape(&torque, None, OUTPUT);
    let (input, output) = windowed(timestep, unit.columns.len(), None);
    Ok(g.encode("unit", &[input], &[output], ""))
}

/// Serialised ONNX model (operator set [`OPSET`]) of a whole compensator; output (batch × joints).
///
/// The window has all input columns in the order of [`Compensator::inputs`] and [`window`] samples; a unit on
/// shorter windows takes the newest ones.
///
/// # Errors
/// As [`export`].
pub fn export_all(compensator: &Compensator) -> Result<Vec<u8>, Error> {
    let (joints, columns) = (compensator.joints.len(), compensator.inputs.len());
    let timestep = window(compensator);
    let mut g = Graph::default();
    let samples: Vec<String> = (0..timestep).map(|t| g.step(t)).collect();
    let mut sums: Vec<Option<String>> = vec![None; joints];
    for unit in &compensator.units {
        unit.check(joints, columns).map_err(Error::Unit)?;
        if !unit.enabled {
            continue;
        }
        let own = &samples[timestep - unit.architecture.timestep()..];
        let own: Vec<String> = own.iter().map(|x| g.select(x, &unit.columns)).collect();
        let torque = torque(&mut g, unit, &own)?;
        let sum = &mut sums[unit.joint];
        *sum = Some(match sum.take() {
            None => torque,
            Some(before) => g.op("Add", &[&before, &torque]),
        });
    }
    let newest = &samples[timestep - 1];
    let parts: Vec<String> = sums
        .into_iter()
        .map(|sum| sum.unwrap_or_else(|| network::zeros(&mut g, newest, columns, 1)))
        .collect();
    let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
    let torque = g.concatenate(&parts);
    g.reshape(&torque, Some(joints), OUTPUT);
    let (input, output) = windowed(timestep, columns, Some(joints));
    Ok(g.encode("compensator", &[input], &[output], ""))
}

/// Input and output of a graph over a window.
fn windowed(samples: usize, columns: usize, joints: Option<usize>) -> (Port, Port) {
    let input = Port {
        name: INPUT,
        shape: vec![None, Some(samples), Some(columns)],
    };
    let output = Port {
        name: OUTPUT,
        shape: std::iter::once(None).chain(joints.map(Some)).collect(),
    };
    (input, output)
}

/// Samples of the window that [`export_all`]'s graph takes: the longest of the units that are on.
pub fn window(compensator: &Compensator) -> usize {
    let on = compensator.units.iter().filter(|u| u.enabled);
    on.map(|u| u.architecture.timestep()).max().unwrap_or(1)
}

/// Torque (batch × 1) of a unit for its samples (batch × its columns), oldest first.
fn torque(g: &mut Graph, unit: &Unit, samples: &[String]) -> Result<String, Error> {
    let highest = unit.columns.iter().max().map_or(0, |c| c + 1);
    unit.check(unit.joint + 1, highest).map_err(Error::Unit)?;
    if let Architecture::Recurrent(Recurrent {
        memory: Memory::Carried { .. },
        ..
    }) = unit.architecture
    {
        return Err(Error::Unit(
            "carried state cannot be exported as a graph over one window".into(),
        ));
    }
    let d = unit.columns.len();
    let scaled: Vec<String> = samples.iter().map(|x| scale(g, unit, x)).collect();
    let held: Vec<String> = scaled.iter().map(|x| hold(g, unit, x)).collect();
    let Some(newest) = scaled.last() else {
        return Err(Error::Unit("no samples".into()));
    };
    let outputs = unit.members.iter();
    let outputs = outputs.map(|m| network::output(g, &unit.architecture, d, m, &held));
    let outputs = outputs.collect();
    Ok(bounded(g, unit, outputs, newest))
}

/// Torque (… × 1) from the normalised outputs of the unit's members, limited and faded; `newest` is the newest scaled sample.
fn bounded(g: &mut Graph, unit: &Unit, outputs: Vec<String>, newest: &str) -> String {
    let sum = g.sum(outputs);
    let span = g.constant(
        &[1],
        vec![unit.target.span()[0] / unit.members.len() as f32],
    );
    let offset = g.constant(&[1], unit.target.offset().to_vec());
    let torque = g.op("Mul", &[&sum, &span]);
    let torque = g.op("Add", &[&torque, &offset]);
    let torque = limit(g, unit, &torque);
    let weight = fade(g, unit, newest);
    let torque = g.op("Mul", &[&torque, &weight]);
    let on = g.constant(&[1], vec![if unit.enabled { 1.0 } else { 0.0 }]);
    g.op("Mul", &[&torque, &on])
}

/// (x − offset)/span; a column that never varied gives 0.
fn scale(g: &mut Graph, unit: &Unit, x: &str) -> String {
    let d = unit.columns.len();
    let offset = g.constant(&[1, d], unit.input.offset().to_vec());
    let inverse = unit
        .input
        .span()
        .iter()
        .map(|&s| if s > 0.0 { 1.0 / s } else { 0.0 })
        .collect();
    let inverse = g.constant(&[1, d], inverse);
    let x = g.op("Sub", &[x, &offset]);
    g.op("Mul", &[&x, &inverse])
}

/// Inputs held within the range of the training data, as [`feedforward::network::Bounds::hold`] does it.
fn hold(g: &mut Graph, unit: &Unit, x: &str) -> String {
    let d = unit.columns.len();
    let ends = |far: f32| (0..d).map(|j| unit.bounds.hold(j, far)).collect();
    let low = g.constant(&[1, d], ends(f32::MIN));
    let high = g.constant(&[1, d], ends(f32::MAX));
    let x = g.op("Max", &[x, &low]);
    g.op("Min", &[&x, &high])
}

/// Torque limited smoothly to the largest training torque, as [`feedforward::network::Bounds::clamp`] does it.
fn limit(g: &mut Graph, unit: &Unit, torque: &str) -> String {
    let limit = unit.bounds.limit();
    let knee_value = 0.9 * limit;
    let room_value = limit - knee_value;
    let knee = g.constant(&[1], vec![knee_value]);
    let room = g.constant(&[1], vec![room_value]);
    let inverse = g.constant(
        &[1],
        vec![if room_value > 0.0 {
            1.0 / room_value
        } else {
            0.0
        }],
    );
    let size = g.op("Abs", &[torque]);
    let sign = g.op("Sign", &[torque]);
    let above = g.op("Sub", &[&size, &knee]);
    let above = g.op("Relu", &[&above]);
    let bent = g.op("Mul", &[&above, &inverse]);
    let bent = g.op("Tanh", &[&bent]);
    let bent = g.op("Mul", &[&bent, &room]);
    let below = g.op("Min", &[&size, &knee]);
    let size = g.op("Add", &[&below, &bent]);
    g.op("Mul", &[&size, &sign])
}

/// Weight of the torque, (… × 1), which fades to 0 outside the training data; see
/// [`feedforward::network::Bounds::weight`].
fn fade(g: &mut Graph, unit: &Unit, x: &str) -> String {
    let d = unit.columns.len();
    let b = &unit.bounds;
    let low = g.constant(&[1, d], b.low().to_vec());
    let high = g.constant(&[1, d], b.high().to_vec());
    let spans = b
        .high()
        .iter()
        .zip(b.low())
        .map(|(h, l)| if h > l { 1.0 / (h - l) } else { 0.0 });
    let spans = g.constant(&[1, d], spans.collect());
    let above = g.op("Sub", &[x, &high]);
    let below = g.op("Sub", &[&low, x]);
    let excess = g.op("Max", &[&above, &below]);
    let excess = g.op("Mul", &[&excess, &spans]);
    let per_column = smooth(g, unit, &excess);
    let range = (0..d)
        .map(|j| g.pick(&per_column, d, &[j]))
        .collect::<Vec<_>>();
    let range = range
        .into_iter()
        .reduce(|product, next| g.op("Mul", &[&product, &next]))
        .unwrap_or_default();

    let mean = g.constant(&[1, d], b.mean().to_vec());
    let whitener = g.constant(&[d, d], inverse_transposed(b.factor(), d));
    let radius = g.constant(&[1], vec![1.0 / b.radius()]);
    let one = g.constant(&[1], vec![1.0]);
    let centred = g.op("Sub", &[x, &mean]);
    let white = g.op("MatMul", &[&centred, &whitener]);
    let squares = g.op("Mul", &[&white, &white]);
    let ones = g.constant(&[d, 1], vec![1.0; d]);
    let distance = g.op("MatMul", &[&squares, &ones]);
    let distance = g.op("Sqrt", &[&distance]);
    let distance = g.op("Mul", &[&distance, &radius]);
    let excess = g.op("Sub", &[&distance, &one]);
    let ellipsoid = smooth(g, unit, &excess);
    g.op("Mul", &[&range, &ellipsoid])
}

/// Smooth step from 1 to 0 as `excess` goes from the fade's start to its end: 1 − s³(6s² − 15s + 10).
fn smooth(g: &mut Graph, unit: &Unit, excess: &str) -> String {
    let fade = unit.bounds.fade();
    let number = |g: &mut Graph, v: f32| g.constant(&[1], vec![v]);
    let start = number(g, fade.start);
    let inverse = number(g, 1.0 / (fade.end - fade.start));
    let (zero, one, six, ten, fifteen) = (
        number(g, 0.0),
        number(g, 1.0),
        number(g, 6.0),
        number(g, 10.0),
        number(g, 15.0),
    );
    let s = g.op("Sub", &[excess, &start]);
    let s = g.op("Mul", &[&s, &inverse]);
    let s = g.op("Max", &[&s, &zero]);
    let s = g.op("Min", &[&s, &one]);
    let p = g.op("Mul", &[&s, &six]);
    let p = g.op("Sub", &[&p, &fifteen]);
    let p = g.op("Mul", &[&p, &s]);
    let p = g.op("Add", &[&p, &ten]);
    let cube = g.op("Mul", &[&s, &s]);
    let cube = g.op("Mul", &[&cube, &s]);
    let p = g.op("Mul", &[&p, &cube]);
    g.op("Sub", &[&one, &p])
}

/// Matrix L⁻ᵀ, d × d, of the lower Cholesky factor `l`. The norm of (x − mean)·L⁻ᵀ is the Mahalanobis distance.
fn inverse_transposed(l: &[f32], d: usize) -> Vec<f32> {
    let mut out = vec![0.0; d * d];
    for column in 0..d {
        let mut y = vec![0.0_f64; d];
        for j in column..d {
            let inner: f64 = (column..j).map(|k| f64::from(l[j * d + k]) * y[k]).sum();
            let unit = if j == column { 1.0 } else { 0.0 };
            y[j] = (unit - inner) / f64::from(l[j * d + j]);
            out[column * d + j] = y[j] as f32;
        }
    }
    out
}
