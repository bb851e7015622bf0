//! The compensator of a stored model as one ONNX graph, with a description of its inputs and outputs.

use super::ResidualError;
use crate::directory::{ModelFile, json};
use compensator::onnx::{
    CELL, HIDDEN, INPUT, NEXT_CELL, NEXT_HIDDEN, OPSET, OUTPUT, SAMPLE, export_all, export_steps,
    hidden_size, window,
};
use feedforward::inputs::{CompensatorRecord, Input, Signal};
use feedforward::network::{Architecture, Compensator, Fade, Memory, Recurrent, Unit};
use physics::robot::JointKind;
use serde::Serialize;

/// ONNX graph of a compensator, with its description.
pub struct Exported {
    /// Contents of the ONNX file.
    pub graph: Vec<u8>,
    /// Contents of the JSON file with the description of inputs and outputs.
    pub description: String,
}

/// Contents of the JSON file beside the graph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Description {
    /// Name and version of the format: `onnx/1`.
    pub schema: &'static str,
    /// Version of ONNX's operator set.
    pub opset: i64,
    /// Name of the graph's input, f32 of shape (batch, samples, columns), oldest sample first; before the start of
    /// a motion its first sample repeats.
    pub input: &'static str,
    /// Number of samples of a window.
    pub samples: usize,
    /// Time between the samples, s.
    pub period: f64,
    /// Columns of the graph's input, in order.
    pub columns: Vec<Column>,
    /// Name of the graph's output, f32 of shape (batch, joints): residual torque at the newest sample.
    pub output: &'static str,
    /// Columns of the graph's output: one per joint.
    pub joints: Vec<Column>,
    /// Networks behind the output; those of one joint add up.
    pub units: Vec<Trained>,
}

/// Contents of the JSON file beside a graph for one sample at a time, which are the graph's `metadata` as well.
///
/// Names of inputs and outputs, number of layers and size are under the keys that Newton's neural drives read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepDescription {
    /// Name and version of the format: `onnx-step/1`.
    pub schema: &'static str,
    /// Version of ONNX's operator set.
    pub opset: i64,
    /// Name of the input with the newest sample, f32 of shape (1, batch, columns).
    pub input_name: &'static str,
    /// Name of the input with the hidden state, f32 of shape (layers, batch, size); zeros before the first sample.
    pub hidden_in_name: &'static str,
    /// Name of the input with the cell state, of the same shape.
    pub cell_in_name: &'static str,
    /// Name of the output with the residual torque, f32 of shape (batch, joints).
    pub output_name: &'static str,
    /// Name of the output with the hidden state that goes in with the next sample.
    pub hidden_out_name: &'static str,
    /// Name of the output with the cell state that goes in with the next sample.
    pub cell_out_name: &'static str,
    /// Number of layers of the states: 1, for those of all networks lie side by side.
    pub num_layers: usize,
    /// Columns of the states.
    pub hidden_size: usize,
    /// Time between the samples, s.
    pub period: f64,
    /// Columns of a sample, in order.
    pub columns: Vec<Column>,
    /// Columns of the torque: one per joint, base first.
    pub joints: Vec<Column>,
    /// Networks behind the torque; those of one joint add up.
    pub units: Vec<Trained>,
}

/// Unit as it was trained. The graph scales, limits and fades by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trained {
    /// Name of the unit's joint.
    pub joint: String,
    /// Whether the unit is on; off, it gives zero.
    pub enabled: bool,
    /// Columns of the graph's input that the unit sees, by index.
    pub columns: Vec<usize>,
    /// Number of samples that an output looks back on, itself included; none where the state is carried on.
    pub history: Option<usize>,
    /// What is taken off each column before it is divided by `span`, in the column's unit.
    pub offset: Vec<f32>,
    /// What each column is divided by, in the column's unit; a column with zero counts as zero.
    pub span: Vec<f32>,
    /// Smallest value of each column in training, in the column's unit.
    pub low: Vec<f32>,
    /// Largest value of each column in training, in the column's unit.
    pub high: Vec<f32>,
    /// Excess over the training range, in parts of it, where the torque begins to fade, and where it is zero.
    pub fade: Fade,
    /// Size that the torque never exceeds, N·m (N): the largest that was trained on.
    pub limit: f32,
}

impl Trained {
    fn new(unit: &Unit, joints: &[String]) -> Self {
        let carried = carries(unit);
        let (offset, span) = (unit.input.offset(), unit.input.span());
        let within = |scaled: &[f32]| {
            let columns = scaled.iter().zip(offset.iter().zip(span));
            columns
                .map(|(x, (offset, span))| offset + span * x)
                .collect()
        };
        Self {
            joint: joints.get(unit.joint).cloned().unwrap_or_default(),
            enabled: unit.enabled,
            columns: unit.columns.clone(),
            history: Some(unit.architecture.timestep()).filter(|_| !carried),
            offset: offset.to_vec(),
            span: span.to_vec(),
            low: within(unit.bounds.low()),
            high: within(unit.bounds.high()),
            fade: unit.bounds.fade(),
            limit: unit.bounds.limit(),
        }
    }
}

/// Column of the graph's input or output, in the unit of its values: scaling and bounds are inside the graph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Name of the column, for a reader.
    pub name: String,
    /// Unit of the column's values.
    pub unit: String,
}

/// Whether a unit that is on carries its state from sample to sample.
pub fn carries_state(compensator: &Compensator) -> bool {
    let mut units = compensator.units.iter();
    units.any(|unit| unit.enabled && carries(unit))
}

fn carries(unit: &Unit) -> bool {
    matches!(
        unit.architecture,
        Architecture::Recurrent(Recurrent {
            memory: Memory::Carried { .. },
            ..
        })
    )
}

/// Exports the compensator of all joints as a graph over a window.
///
/// # Errors
/// A unit that carries its state from sample to sample, or contradicts itself.
pub fn export(
    compensator: &Compensator,
    record: &CompensatorRecord,
    file: &ModelFile,
) -> Result<Exported, ResidualError> {
    let (columns, joints) = columns(record, file)?;
    let description = Description {
        schema: "onnx/1",
        opset: OPSET,
        input: INPUT,
        samples: window(compensator),
        period: record.period,
        columns,
        output: OUTPUT,
        joints,
        units: trained(compensator),
    };
    Ok(Exported {
        graph: export_all(compensator)?,
        description: json(&description),
    })
}

/// Exports the compensator of all joints as a graph for one sample at a time.
///
/// # Errors
/// A unit that contradicts itself.
pub fn export_stepwise(
    compensator: &Compensator,
    record: &CompensatorRecord,
    file: &ModelFile,
) -> Result<Exported, ResidualError> {
    let (columns, joints) = columns(record, file)?;
    let description = json(&StepDescription {
        schema: "onnx-step/1",
        opset: OPSET,
        input_name: SAMPLE,
        hidden_in_name: HIDDEN,
        cell_in_name: CELL,
        output_name: OUTPUT,
        hidden_out_name: NEXT_HIDDEN,
        cell_out_name: NEXT_CELL,
        num_layers: 1,
        hidden_size: hidden_size(compensator),
        period: record.period,
        columns,
        joints,
        units: trained(compensator),
    });
    Ok(Exported {
        graph: export_steps(compensator, &description)?,
        description,
    })
}

/// Columns of a graph's input and of its output.
fn columns(
    record: &CompensatorRecord,
    file: &ModelFile,
) -> Result<(Vec<Column>, Vec<Column>), ResidualError> {
    let robot = file.physics.nominal()?;
    let slides = |joint: usize| {
        let joint = robot.joints().get(joint);
        joint.is_some_and(|j| j.kind == JointKind::Prismatic)
    };
    let torque = |joint: usize| if slides(joint) { "N" } else { "N·m" };
    let columns = record.inputs.iter().map(|input| Column {
        name: input.name(),
        unit: unit(input, slides(input.joint)),
    });
    let joints = file.joints.iter().enumerate().map(|(joint, name)| Column {
        name: name.clone(),
        unit: torque(joint).to_owned(),
    });
    Ok((columns.collect(), joints.collect()))
}

fn trained(compensator: &Compensator) -> Vec<Trained> {
    let units = compensator.units.iter();
    units
        .map(|unit| Trained::new(unit, &compensator.joints))
        .collect()
}

/// Unit of an input column of a joint that turns or slides.
fn unit(input: &Input, slides: bool) -> String {
    let (way, torque) = if slides { ("m", "N") } else { ("rad", "N·m") };
    match &input.signal {
        Signal::Position => way.to_owned(),
        Signal::Velocity => format!("{way}/s"),
        Signal::Acceleration => format!("{way}/s²"),
        Signal::Load => torque.to_owned(),
        // Column times parameter is a torque.
        Signal::Term(term) => match term.unit() {
            unit if unit == torque => "1".to_owned(),
            unit => format!("{torque} / ({unit})"),
        },
    }
}
