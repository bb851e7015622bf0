//! The compensator of a stored model as one ONNX graph, with a description of its inputs and outputs.

use super::ResidualError;
use crate::directory::ModelFile;
use compensator::onnx::{INPUT, OPSET, OUTPUT, export_all, window};
use feedforward::inputs::{CompensatorRecord, Input, Signal};
use feedforward::network::Compensator;
use physics::robot::JointKind;
use serde::Serialize;

/// ONNX graph of a compensator, with its description.
pub struct Exported {
    /// Contents of the ONNX file.
    pub graph: Vec<u8>,
    /// Description of inputs and outputs.
    pub description: Description,
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
}

/// Column of the graph's input or output, in the unit of its values: scaling and bounds are inside the graph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Name of the column, for a reader.
    pub name: String,
    /// Unit of the column's values.
    pub unit: String,
}

/// Exports the compensator of all joints.
///
/// # Errors
/// A unit that carries its state from sample to sample, or contradicts itself.
pub fn export(
    compensator: &Compensator,
    record: &CompensatorRecord,
    file: &ModelFile,
) -> Result<Exported, ResidualError> {
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
    Ok(Exported {
        graph: export_all(compensator)?,
        description: Description {
            schema: "onnx/1",
            opset: OPSET,
            input: INPUT,
            samples: window(compensator),
            period: record.period,
            columns: columns.collect(),
            output: OUTPUT,
            joints: joints.collect(),
        },
    })
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
