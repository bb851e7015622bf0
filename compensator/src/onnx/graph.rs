//! Small builder over `onnx-rs`: names values, collects constants and nodes.

use onnx_rs::ast::{
    Attribute, AttributeType, DataType, Dimension, Graph as Proto, Model, Node, OpType,
    OperatorSetId, StringStringEntry, TensorProto, TensorShape, TensorShapeDimension,
    TensorTypeProto, TypeProto, TypeValue, ValueInfo,
};

/// Name of the input of a graph over a window.
pub const INPUT: &str = "window";
/// Name of the output with the torque.
pub const OUTPUT: &str = "torque";
/// Name of the input with the newest sample, f32 (1 × batch × columns).
pub const SAMPLE: &str = "sample";
/// Name of the input with the hidden state before the sample.
pub const HIDDEN: &str = "h";
/// Name of the input with the cell state before the sample.
pub const CELL: &str = "c";
/// Name of the output with the hidden state after the sample.
pub const NEXT_HIDDEN: &str = "h_next";
/// Name of the output with the cell state after the sample.
pub const NEXT_CELL: &str = "c_next";
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
    integers: Vec<(&'static str, i64)>,
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
        self.push("Concat", inputs, vec![("axis", 1)], 1)
            .swap_remove(0)
    }

    /// Adds a split into equal parts along the columns; returns the names of the parts.
    pub(super) fn split(&mut self, input: &str, parts: usize) -> Vec<String> {
        self.push("Split", &[input], vec![("axis", 1)], parts)
    }

    /// Adds a softmax over the columns; returns the output's name.
    pub(super) fn softmax(&mut self, input: &str) -> String {
        self.push("Softmax", &[input], vec![("axis", -1)], 1)
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

    /// Adds the choice of the columns `places` of x, which has `width`, one of them as often as it is named, by a product with zeros and ones: not every reader of
    /// graphs can gather. Returns the output's name.
    pub(super) fn pick(&mut self, x: &str, width: usize, places: &[usize]) -> String {
        let mut matrix = vec![0.0; width * places.len()];
        for (column, row) in places.iter().enumerate() {
            matrix[row * places.len() + column] = 1.0;
        }
        let matrix = self.constant(&[width, places.len()], matrix);
        self.op("MatMul", &[x, &matrix])
    }

    /// Adds x, which has `columns` columns, as the columns from `start` on of `width` that are zero elsewhere; returns the
    /// output's name.
    pub(super) fn place(&mut self, x: &str, columns: usize, start: usize, width: usize) -> String {
        let mut matrix = vec![0.0; columns * width];
        for row in 0..columns {
            matrix[row * width + start + row] = 1.0;
        }
        let matrix = self.constant(&[columns, width], matrix);
        self.op("MatMul", &[x, &matrix])
    }

    /// Adds the sum of `values`, of which there is at least one; returns the output's name.
    pub(super) fn sum(&mut self, values: Vec<String>) -> String {
        let folded = values
            .into_iter()
            .reduce(|sum, next| self.op("Add", &[&sum, &next]));
        folded.unwrap_or_default()
    }

    /// Adds a step of an LSTM layer on x (1 × batch × columns), from zero or from `state`: hidden and cell state (1 × batch ×
    /// width). `layer` has the operator's weights W and R and biases. Returns the names of hidden and cell state after it.
    pub(super) fn lstm(
        &mut self,
        x: &str,
        layer: &[String; 3],
        width: usize,
        state: Option<&(String, String)>,
    ) -> (String, String) {
        let mut inputs = vec![x, &layer[0], &layer[1], &layer[2]];
        if let Some((hidden, cell)) = state {
            // The lengths of sequences are left out.
            inputs.extend(["", hidden, cell]);
        }
        let size = vec![("hidden_size", width as i64)];
        let mut outputs = self.push("LSTM", &inputs, size, 3);
        let cell = outputs.pop().unwrap_or_default();
        (outputs.pop().unwrap_or_default(), cell)
    }

    /// Gives `value` the name `output`.
    pub(super) fn name(&mut self, value: &str, output: &'static str) {
        self.finish("Identity", vec![value.to_owned()], output);
    }

    /// Adds `x` (1 × batch × columns) without its first axis as `output`.
    pub(super) fn squeeze(&mut self, x: &str, output: &'static str) {
        let axes = self.fresh();
        self.indices.push((axes.clone(), vec![1], vec![0]));
        self.finish("Squeeze", vec![x.to_owned(), axes], output);
    }

    /// Adds (batch × 1) flattened to (batch), or (batch × `joints`), as `output`.
    pub(super) fn reshape(&mut self, x: &str, joints: Option<usize>, output: &'static str) {
        let flat: Vec<i64> = std::iter::once(-1)
            .chain(joints.map(|n| n as i64))
            .collect();
        let shape = self.fresh();
        self.indices
            .push((shape.clone(), vec![flat.len() as i64], flat));
        self.finish("Reshape", vec![x.to_owned(), shape], output);
    }

    /// Adds an operator whose output has a given name.
    fn finish(&mut self, name: &'static str, inputs: Vec<String>, output: &'static str) {
        self.operations.push(Operation {
            name,
            inputs,
            outputs: vec![output.to_owned()],
            integers: Vec::new(),
        });
    }

    /// Adds the choice of the entries `places` along the second axis; returns the output's name.
    fn gather(&mut self, from: &str, shape: Vec<i64>, places: Vec<i64>) -> String {
        let index = self.fresh();
        self.indices.push((index.clone(), shape, places));
        self.push("Gather", &[from, &index], vec![("axis", 1)], 1)
            .swap_remove(0)
    }

    /// Adds an operator with a number of outputs; returns their names.
    fn push(
        &mut self,
        name: &'static str,
        inputs: &[&str],
        integers: Vec<(&'static str, i64)>,
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

    /// The model's bytes: a graph called `name` from `inputs` to `outputs`. `metadata` is one property by that name, where it is
    /// not empty.
    pub(super) fn encode(
        &self,
        name: &str,
        inputs: &[Port],
        outputs: &[Port],
        metadata: &str,
    ) -> Vec<u8> {
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
            name,
            node: self.operations.iter().map(node).collect(),
            initializer,
            input: inputs.iter().map(Port::value).collect(),
            output: outputs.iter().map(Port::value).collect(),
            ..Proto::default()
        };
        let property = StringStringEntry {
            key: "metadata",
            value: metadata,
        };
        onnx_rs::encode(&Model {
            ir_version: 8,
            producer_name: "residyn",
            opset_import: vec![OperatorSetId {
                domain: "",
                version: OPSET,
            }],
            graph: Some(graph),
            metadata_props: Some(property)
                .filter(|p| !p.value.is_empty())
                .into_iter()
                .collect(),
            ..Model::default()
        })
    }
}

fn node(o: &Operation) -> Node<'_> {
    let attribute = o.integers.iter().map(|&(name, i)| Attribute {
        name,
        r#type: AttributeType::Int,
        i,
        ..Attribute::default()
    });
    Node {
        input: o.inputs.iter().map(String::as_str).collect(),
        output: o.outputs.iter().map(String::as_str).collect(),
        op_type: OpType::from(o.name),
        attribute: attribute.collect(),
        ..Node::default()
    }
}

/// Input or output of a graph: a float tensor.
pub(super) struct Port {
    /// Name of the value.
    pub(super) name: &'static str,
    /// Length of each axis; none for the batch, which is free.
    pub(super) shape: Vec<Option<usize>>,
}

impl Port {
    fn value(&self) -> ValueInfo<'_> {
        let dim = self.shape.iter().map(|length| TensorShapeDimension {
            value: length.map_or(Dimension::Param("batch"), |n| Dimension::Value(n as i64)),
            ..TensorShapeDimension::default()
        });
        let tensor = TensorTypeProto {
            elem_type: DataType::Float,
            shape: Some(TensorShape { dim: dim.collect() }),
        };
        let r#type = Some(TypeProto {
            value: Some(TypeValue::Tensor(tensor)),
            ..TypeProto::default()
        });
        ValueInfo {
            name: self.name,
            r#type,
            ..ValueInfo::default()
        }
    }
}
