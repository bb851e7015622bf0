//! Candidates of the catalogue: hypotheses with their columns.

use super::effect::Effect;
use super::unit::Unit;
use crate::motion::scene::Scene;
use ndarray::Array1;
use physics::effects::Term;
use physics::robot::PARAMETERS_PER_LINK;
use serde::Serialize;
use std::sync::Arc;

/// Column: torque per unit of one parameter, on the rows of some joints. Clones are the same column.
#[derive(Clone)]
pub struct Column {
    /// Indices of the joints whose torque the column changes.
    pub joints: Vec<usize>,
    /// Computation of its torque at the fine rate, one vector per joint of `joints`.
    pub torque: ColumnTorque,
    /// Whether the column is torque as recorded, to which no delay is added.
    pub recorded: bool,
}

/// Function that computes a column from a scene: one vector per joint that it touches.
pub type Maker = dyn Fn(&Scene) -> Vec<Array1<f64>> + Send + Sync;

/// Computation of a column's torque.
#[derive(Clone)]
pub enum ColumnTorque {
    /// Column of the base, by number: inertial parameters, then viscous, then Coulomb friction.
    Base(usize),
    /// Change of a link's inertial parameters by a multiple of the given ones: (index of the link, its parameters).
    Link(usize, [f64; PARAMETERS_PER_LINK]),
    /// Terms of the torque model, each with its factor, which a control loop can compute as well.
    Terms(Vec<(f64, Term)>),
    /// Function of the scene: for torque that no control loop can compute, or that belongs to the rigid body or
    /// the torque channel.
    Made(Arc<Maker>),
}

/// Bound of a candidate's coefficient in the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// No bound: the coefficient may have either sign.
    Free,
    /// Coefficient that must be positive.
    Positive,
    /// Coefficient between two values, for a shape on a grid whose size the coefficient only corrects.
    Between(f64, f64),
}

/// Name, unit and conversion of a reported parameter.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Name of the parameter, as in docs/formats.md where it has one.
    pub name: &'static str,
    /// Unit of the reported value.
    pub unit: Unit,
    /// Index of the joint that the quantity belongs to.
    pub joint: Option<usize>,
    /// Reported value = `offset` + `factor`·coefficient.
    pub offset: f64,
    /// Factor of the coefficient in the reported value: see `offset`.
    pub factor: f64,
}

impl Quantity {
    /// Quantity that is the coefficient itself.
    pub fn plain(name: &'static str, unit: Unit, joint: Option<usize>) -> Self {
        Self {
            name,
            unit,
            joint,
            offset: 0.0,
            factor: 1.0,
        }
    }

    /// Quantity that is a shape parameter on a grid, corrected by the coefficient.
    pub fn scaled(name: &'static str, unit: Unit, joint: Option<usize>, factor: f64) -> Self {
        Self {
            name,
            unit,
            joint,
            offset: 0.0,
            factor,
        }
    }
}

/// A size that a separate sensor measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Name of the size, as in docs/formats.md.
    pub name: &'static str,
    /// Value of the size that the sensor measured, in `unit`.
    pub value: f64,
    /// Standard deviation of the measured value, in `unit`.
    pub std: f64,
    /// Unit of the measured value.
    pub unit: Unit,
}

/// A shape parameter of a candidate, which lies on a grid and is not fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// Name of the shape parameter, as in docs/formats.md.
    pub name: &'static str,
    /// Value of the shape parameter.
    pub value: f64,
    /// Unit of the shape parameter.
    pub unit: Unit,
}

impl Shape {
    /// Shape parameter with a name, value and unit.
    pub(super) fn new(name: &'static str, value: f64, unit: Unit) -> Self {
        Self { name, value, unit }
    }
}

/// A hypothesis: an effect at one place with fixed shape parameters.
#[derive(Clone)]
pub struct Candidate {
    /// Effect of the catalogue that the candidate is of.
    pub effect: Effect,
    /// Joints that the report names.
    pub joints: Vec<usize>,
    /// Index of the driving joint; none but for a coupling.
    pub driver: Option<usize>,
    /// Columns of the candidate.
    pub columns: Vec<Column>,
    /// Bound of each coefficient.
    pub bounds: Vec<Bound>,
    /// Reported quantity of each coefficient.
    pub quantities: Vec<Quantity>,
    /// Change of the link's parameters per unit of the only coefficient, for a candidate that is such a change alone.
    pub change: Option<[f64; PARAMETERS_PER_LINK]>,
    /// Shape parameters of the candidate, which are not fitted.
    pub shape: Vec<Shape>,
    /// Sizes that a separate sensor measured.
    pub sizes: Vec<Size>,
    /// Prior mean and standard deviation of its coefficients where the recording shows them directly, whatever
    /// the residual beside its columns.
    pub known: Option<(f64, f64)>,
    /// Evidence for the candidate beside the error that it removes, nats.
    pub evidence: f64,
    /// Chance of a trace as clear as the one in the recording, where that names the candidate by itself,
    /// whatever error its columns remove.
    pub shown: Option<f64>,
}

impl Candidate {
    /// A candidate on one joint with one coefficient.
    pub(crate) fn single(
        effect: Effect,
        joint: usize,
        quantity: Quantity,
        bound: Bound,
        column: Column,
    ) -> Self {
        Self {
            effect,
            joints: vec![joint],
            driver: None,
            columns: vec![column],
            bounds: vec![bound],
            quantities: vec![quantity],
            change: None,
            shape: Vec::new(),
            sizes: Vec::new(),
            known: None,
            evidence: 0.0,
            shown: None,
        }
    }

    /// Value of the shape parameter `name`.
    pub fn shape(&self, name: &str) -> Option<f64> {
        let mut all = self.shape.iter();
        all.find(|s| s.name == name).map(|s| s.value)
    }

    /// Whether the candidate changes the torque of a joint for which another candidate is named.
    pub fn touches(&self, other: &Self) -> bool {
        let mut touched = self.columns.iter().flat_map(|c| &c.joints);
        touched.any(|j| other.joints.contains(j))
    }

    pub(super) fn with_shape(mut self, name: &'static str, value: f64, unit: Unit) -> Self {
        self.shape.push(Shape::new(name, value, unit));
        self
    }

    pub(super) fn and(mut self, quantity: Quantity, bound: Bound, column: Column) -> Self {
        self.columns.push(column);
        self.bounds.push(bound);
        self.quantities.push(quantity);
        self
    }
}

impl Column {
    /// Whether both are the same column.
    pub fn is(&self, other: &Self) -> bool {
        self.joints == other.joints
            && match (&self.torque, &other.torque) {
                (ColumnTorque::Base(a), ColumnTorque::Base(b)) => a == b,
                (ColumnTorque::Link(a, x), ColumnTorque::Link(b, y)) => a == b && x == y,
                (ColumnTorque::Terms(a), ColumnTorque::Terms(b)) => a == b,
                (ColumnTorque::Made(a), ColumnTorque::Made(b)) => Arc::ptr_eq(a, b),
                _ => false,
            }
    }

    /// A column on the rows of one joint.
    pub(crate) fn own(
        joint: usize,
        make: impl Fn(&Scene) -> Array1<f64> + Send + Sync + 'static,
    ) -> Self {
        Self {
            joints: vec![joint],
            torque: ColumnTorque::Made(Arc::new(move |s| vec![make(s)])),
            recorded: false,
        }
    }

    /// A column on the rows of some joints, one vector for each.
    pub(super) fn several(
        joints: Vec<usize>,
        make: impl Fn(&Scene) -> Vec<Array1<f64>> + Send + Sync + 'static,
    ) -> Self {
        Self {
            joints,
            torque: ColumnTorque::Made(Arc::new(make)),
            recorded: false,
        }
    }

    /// Column of a term of the torque model on one joint.
    pub(super) fn term(joint: usize, term: Term) -> Self {
        Self::terms(joint, vec![(1.0, term)])
    }

    /// Column of several terms of the torque model on one joint, each with its factor.
    pub(super) fn terms(joint: usize, terms: Vec<(f64, Term)>) -> Self {
        Self {
            joints: vec![joint],
            torque: ColumnTorque::Terms(terms),
            recorded: false,
        }
    }

    /// A column on the rows of all joints, from a table of shape (samples, joints).
    pub(super) fn whole(
        dof: usize,
        make: impl Fn(&Scene) -> ndarray::Array2<f64> + Send + Sync + 'static,
    ) -> Self {
        Self {
            joints: (0..dof).collect(),
            torque: ColumnTorque::Made(Arc::new(move |s| {
                make(s)
                    .columns()
                    .into_iter()
                    .map(|c| c.to_owned())
                    .collect()
            })),
            recorded: false,
        }
    }

    /// The column marked as torque as recorded, to which no delay is added.
    pub(super) fn late_already(self) -> Self {
        Self {
            recorded: true,
            ..self
        }
    }
}
