//! Small builder over `onnx-rs`: names values, collects constants and nodes.

use onnx_rs::ast::{
    Attribute, AttributeType, DataType, Dimension, Graph as Proto, Model, Node, OpType,
    OperatorSetId, TensorProto, TensorShape, TensorShapeDimension, TensorTypeProto, TypeProto,
    TypeValue, ValueInfo,
};

/// Name of the graph's input.
pub const INPUT: &str = "window";
/// Name of the graph's output.
pub const OUTPUT: &str = "torque";
/// Version of the operators.
pub const OPSET: i64 = 17;

/// Node of the graph: an operator with its inputs and outputs by name.
struct Operation {
    /// Name of the operator.
    name: &'static str,
    /// Names of the inputs.
    inputs: Vec<String>,
    /// Names of the outputs.
    outputs: Vec<String>,
    /// Attributes of whole numbers.
    integers: Vec<(&'static str, Vec<i64>)>,
}

/// ONNX graph under construction.
#[derive(Default)]
pub(super) struct Graph {
    /// Nodes in the order of execution.
    operations: Vec<Operation>,
    /// Constants: name, shape and values.
    constants: Vec<(String, Vec<i64>, Vec<f32>)>,
    /// Constant index lists: name, shape and values.
    indices: Vec<(String, Vec<i64>, Vec<i64>)>,
    /// Number of names that were given out.
    values: usize,
}

impl Graph {
    /// New name of a value.
    fn fresh(&mut self) -> String {
        self.values += 1;
        format!("v{}", self.values)
    }

    /// Adds a constant of the given shape; returns its name.
    pub(super) fn constant(&mut self, shape: &[usize], values: Vec<f32>) -> String {
        let name = self.fresh();
        self.constants.push((
            name.clone(),
            shape.iter().map(|&n| n as i64).collect(),
            values,
        ));
        name
    }

    /// Adds an operator with one output; returns the output's name.
    pub(super) fn op(&mut self, name: &'static str, inputs: &[&str]) -> String {
        self.push(name, inputs, Vec::new(), 1).swap_remove(0)
    }

    /// Adds a concatenation along the columns; returns the output's name.
    pub(super) fn concatenate(&mut self, inputs: &[&str]) -> String {
        self.push("Concat", inputs, vec![("axis", vec![1])], 1)
            .swap_remove(0)
    }

    /// Adds a split into equal parts along the columns; returns the names of the parts.
    pub(super) fn split(&mut self, input: &str, parts: usize) -> Vec<String> {
        self.push("Split", &[input], vec![("axis", vec![1])], parts)
    }

    /// Adds a reduction over the columns, which leaves one column; returns the output's name. `name` is the operator.
    pub(super) fn reduce(&mut self, name: &'static str, input: &str) -> String {
        self.push(
            name,
            &[input],
            vec![("axes", vec![1]), ("keepdims", vec![1])],
            1,
        )
        .swap_remove(0)
    }

    /// Adds a softmax over the columns; returns the output's name.
    pub(super) fn softmax(&mut self, input: &str) -> String {
        self.push("Softmax", &[input], vec![("axis", vec![1])], 1)
            .swap_remove(0)
    }

    /// Adds the choice of sample `t` of the window, (batch × columns); returns its name.
    pub(super) fn step(&mut self, t: usize) -> String {
        self.gather(INPUT, Vec::new(), vec![t as i64])
    }

    /// Adds the choice of some columns of a sample, (batch × columns); returns the output's name.
    pub(super) fn select(&mut self, sample: &str, columns: &[usize]) -> String {
        let places: Vec<i64> = columns.iter().map(|&c| c as i64).collect();
        self.gather(sample, vec![places.len() as i64], places)
    }

    /// Adds the choice of the entries `places` along the second axis; returns the output's name.
    fn gather(&mut self, from: &str, shape: Vec<i64>, places: Vec<i64>) -> String {
        let index = self.fresh();
        self.indices.push((index.clone(), shape, places));
        self.push("Gather", &[from, &index], vec![("axis", vec![1])], 1)
            .swap_remove(0)
    }

    /// Adds an operator with a number of outputs; returns their names.
    fn push(
        &mut self,
        name: &'static str,
        inputs: &[&str],
        integers: Vec<(&'static str, Vec<i64>)>,
        outputs: usize,
    ) -> Vec<String> {
        let outputs: Vec<String> = (0..outputs).map(|_| self.fresh()).collect();
        let inputs = inputs.iter().map(|s| s.to_string()).collect();
        self.operations.push(Operation {
            name,
            inputs,
            outputs: outputs.clone(),
            integers,
        });
        outputs
    }

    /// The model's bytes; `torque` becomes the output: (batch × 1) flattened to (batch), or (batch × `joints`).
    pub(super) fn encode(
        &mut self,
        torque: &str,
        joints: Option<usize>,
        (timestep, columns): (usize, usize),
    ) -> Vec<u8> {
        let (shape, rest) = (self.fresh(), joints.map_or(Vec::new(), |n| vec![n as i64]));
        let flat: Vec<i64> = std::iter::once(-1).chain(rest.iter().copied()).collect();
        self.indices
            .push((shape.clone(), vec![flat.len() as i64], flat));
        self.operations.push(Operation {
            name: "Reshape",
            inputs: vec![torque.to_owned(), shape],
            outputs: vec![OUTPUT.to_owned()],
            integers: Vec::new(),
        });
        let mut initializer: Vec<TensorProto> = self
            .constants
            .iter()
            .map(|(name, dims, v)| TensorProto::from_f32(name, dims.clone(), v.clone()))
            .collect();
        initializer.extend(
            self.indices
                .iter()
                .map(|(name, dims, v)| TensorProto::from_i64(name, dims.clone(), v.clone())),
        );
        let graph = Proto {
            name: if joints.is_some() {
                "compensator"
            } else {
                "unit"
            },
            node: self.operations.iter().map(node).collect(),
            initializer,
            input: vec![value(
                INPUT,
                vec![
                    Dimension::Value(timestep as i64),
                    Dimension::Value(columns as i64),
                ],
            )],
            output: vec![value(
                OUTPUT,
                rest.into_iter().map(Dimension::Value).collect(),
            )],
            ..Proto::default()
        };
        onnx_rs::encode(&Model {
            ir_version: 8,
            producer_name: "residyn",
            opset_import: vec![OperatorSetId {
                domain: "",
                version: OPSET,
            }],
            graph: Some(graph),
            ..Model::default()
        })
    }
}

fn node(o: &Operation) -> Node<'_> {
    let attribute = o.integers.iter().map(|(name, values)| {
        // `axes` is a list even when it has one entry; the others are plain integers.
        let list = *name == "axes";
        Attribute {
            name,
            r#type: if list {
                AttributeType::Ints
            } else {
                AttributeType::Int
            },
            i: if list { 0 } else { values[0] },
            ints: if list { values.clone() } else { Vec::new() },
            ..Attribute::default()
        }
    });
    Node {
        input: o.inputs.iter().map(String::as_str).collect(),
        output: o.outputs.iter().map(String::as_str).collect(),
        op_type: OpType::from(o.name),
        attribute: attribute.collect(),
        ..Node::default()
    }
}

/// Description of a float tensor with a free batch dimension in front.
fn value<'a>(name: &'a str, rest: Vec<Dimension<'a>>) -> ValueInfo<'a> {
    let dim = std::iter::once(Dimension::Param("batch"))
        .chain(rest)
        .map(|value| TensorShapeDimension {
            value,
            ..TensorShapeDimension::default()
        })
        .collect();
    let tensor = TensorTypeProto {
        elem_type: DataType::Float,
        shape: Some(TensorShape { dim }),
    };
    let r#type = Some(TypeProto {
        value: Some(TypeValue::Tensor(tensor)),
        ..TypeProto::default()
    });
    ValueInfo {
        name,
        r#type,
        ..ValueInfo::default()
    }
}
