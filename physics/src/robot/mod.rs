//! Description of a serial robot: joints, links, gravity, and where they come from.
//!
//! A [`Robot`] is immutable. It comes from a URDF or an MJCF ([`Description`]), a Denavit–Hartenberg table ([`dh`]), or is
//! built in ([`Robot::builtin`]).

mod builtin;
mod chain;
mod checks;
mod counterbalance;
pub mod dh;
pub mod drive;
mod error;
mod format;
mod inertia;
mod joint;
mod judgement;
mod passive;

pub use builtin::Builtin;
pub(crate) use chain::{Chain, ChainJoint};
pub use counterbalance::Counterbalance;
pub use error::RobotError;
pub use format::{
    Actuator, ActuatorKind, Chains, Changed, Description, DriveEdit, Edited, Load, MACHINES, Mjcf,
    Urdf, to_urdf, urdf_with,
};
pub use inertia::{Inertia, PARAMETER_NAMES, PARAMETERS_PER_LINK};
pub use joint::{Joint, JointKind, Limits, Link};
pub use judgement::{Doubt, Finding, Masses};
pub use passive::{Passive, Spring};

use checks::{check_inertia, check_joint};
use nalgebra::Vector3;

/// Standard gravity in the base frame, m/s².
pub const STANDARD_GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// A serial chain of moving joints on a fixed base.
#[derive(Debug, Clone)]
pub struct Robot {
    name: String,
    gravity: Vector3<f64>,
    joints: Vec<Joint>,
    passive: Vec<Passive>,
    gravity_compensation: Vec<f64>,
    findings: Vec<Finding>,
    masses: Masses,
    notes: Vec<String>,
    chain: Chain,
    builtin: Option<Builtin>,
}

impl Robot {
    /// A robot from its joints, base first, under standard gravity.
    ///
    /// # Errors
    /// No joint, numbers that are not finite, axes without direction, links without mass or with an
    /// inertia that would make the mass matrix indefinite. What is only implausible becomes a warning.
    pub fn new(name: impl Into<String>, joints: Vec<Joint>) -> Result<Self, RobotError> {
        let name = name.into();
        if joints.is_empty() {
            return Err(RobotError::NoJoints { name });
        }
        let mut findings = Vec::new();
        for joint in &joints {
            check_joint(joint)?;
            findings.extend(check_inertia(joint)?);
        }
        let chain = Chain::new(&joints, &[]);
        Ok(Self {
            name,
            gravity: STANDARD_GRAVITY,
            joints,
            passive: Vec::new(),
            gravity_compensation: Vec::new(),
            findings,
            masses: Masses::Described,
            notes: Vec::new(),
            chain,
            builtin: None,
        })
    }

    /// A robot from a description: judged with its `bodies` as they are written and with the `findings` of its
    /// reader. Where no link has a mass, bodies of 1 kg are substituted.
    pub(in crate::robot) fn described(
        name: impl Into<String>,
        mut joints: Vec<Joint>,
        bodies: &[judgement::Body],
        mut findings: Vec<Finding>,
    ) -> Result<Self, RobotError> {
        let massless = !joints.is_empty() && joints.iter().all(|j| j.link.inertia.mass == 0.0);
        if massless {
            findings.insert(
                0,
                Finding {
                    doubt: Doubt::NoMasses,
                    names: joints.iter().map(|j| j.link.name.clone()).collect(),
                    joints: joints.iter().map(|j| j.name.clone()).collect(),
                },
            );
            let bodies = judgement::stand_ins(&joints);
            for (joint, body) in joints.iter_mut().zip(bodies) {
                joint.link.inertia = body;
            }
        }
        let mut robot = Self::new(name, joints)?;
        if !massless {
            findings.extend(judgement::judge(&robot.joints, bodies, &STANDARD_GRAVITY));
        }
        for finding in findings {
            // One doubt about several joints is said once.
            match robot.findings.iter_mut().find(|f| f.doubt == finding.doubt) {
                Some(known) => {
                    known.names.extend(finding.names);
                    known.joints.extend(finding.joints);
                }
                None => robot.findings.push(finding),
            }
        }
        robot.masses = judgement::masses(&robot.findings, &robot.joints);
        Ok(robot)
    }

    /// A built-in robot by name: see [`Builtin`].
    pub fn builtin(name: &str) -> Option<Self> {
        Builtin::named(name).map(Builtin::robot)
    }

    /// Built-in robot that this is; none for a description from elsewhere, whatever it is called.
    pub fn which_builtin(&self) -> Option<Builtin> {
        self.builtin
    }

    /// Same robot, marked as the built-in one or as not built in. It is meant for a stored robot that is read back.
    pub fn known_as(mut self, builtin: Option<Builtin>) -> Self {
        self.builtin = builtin;
        self
    }

    /// Name of the robot in its description.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of moving joints, N.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Gravity in the base frame, m/s².
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// The moving joints, base first.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Names of the moving joints, base first.
    pub fn joint_names(&self) -> Vec<String> {
        self.joints.iter().map(|j| j.name.clone()).collect()
    }

    /// Known torques that depend on a joint's own position: counterbalance, springs. Not part of the rigid-body
    /// functions.
    pub fn passive(&self) -> &[Passive] {
        &self.passive
    }

    /// Part of each link's weight that something outside the drives holds (N values; 1: all of it); empty where nothing
    /// is. Part of the rigid-body functions: gravity acts on link i with (1 − part) of its mass.
    pub fn gravity_compensation(&self) -> &[f64] {
        &self.gravity_compensation
    }

    /// Doubts about a description that can nevertheless be used.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// State of the masses in the description.
    pub fn masses(&self) -> Masses {
        self.masses
    }

    /// Whether each link's inertial numbers are doubtful, base first.
    pub fn doubtful_links(&self) -> Vec<bool> {
        self.doubted(Doubt::is_of_masses)
    }

    /// Whether each joint's damping and friction are doubtful, base first.
    pub fn doubtful_friction(&self) -> Vec<bool> {
        self.doubted(Doubt::is_of_friction)
    }

    fn doubted(&self, what: impl Fn(&Doubt) -> bool) -> Vec<bool> {
        let of = |joint: &Joint| {
            let mut all = self.findings.iter().filter(|f| what(&f.doubt));
            all.any(|f| f.joints.contains(&joint.name))
        };
        self.joints.iter().map(of).collect()
    }

    /// Parts of the description that the robot does not hold, or holds otherwise: joints taken as fixed, effects left out.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    pub(in crate::robot) fn with_notes(mut self, notes: Vec<String>) -> Self {
        self.notes = notes;
        self
    }

    /// Standard inertial parameters of all links, base first: 10 N values in the order of
    /// [`PARAMETER_NAMES`].
    pub fn parameters(&self) -> Vec<f64> {
        self.joints
            .iter()
            .flat_map(|j| j.link.inertia.parameters())
            .collect()
    }

    /// Names of the standard parameters, e.g. `Ixx3` for link 3.
    pub fn parameter_names(&self) -> Vec<String> {
        (1..=self.dof())
            .flat_map(|link| PARAMETER_NAMES.iter().map(move |p| format!("{p}{link}")))
            .collect()
    }

    /// Same robot with other inertial parameters (10 N values). They are taken as they are: an estimate need
    /// not be physically consistent.
    ///
    /// # Errors
    /// Wrong number of values.
    pub fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RobotError> {
        let (links, rest) = parameters.as_chunks::<PARAMETERS_PER_LINK>();
        if links.len() != self.dof() || !rest.is_empty() {
            return Err(RobotError::WrongLength {
                what: "inertial parameters",
                expected: PARAMETERS_PER_LINK * self.dof(),
                found: parameters.len(),
            });
        }
        let mut robot = self.clone();
        for (joint, p) in robot.joints.iter_mut().zip(links) {
            joint.link.inertia = Inertia::from_parameters(p);
        }
        robot.chain = Chain::new(&robot.joints, &robot.gravity_compensation);
        Ok(robot)
    }

    /// Same robot under another gravity (base frame, m/s²).
    pub fn with_gravity(mut self, gravity: Vector3<f64>) -> Self {
        self.gravity = gravity;
        self
    }

    /// Same robot with other damping and Coulomb friction (N values each).
    ///
    /// # Errors
    /// Wrong number of values.
    pub fn with_friction(mut self, damping: &[f64], friction: &[f64]) -> Result<Self, RobotError> {
        self.each_joint("damping", damping, |j, v| j.damping = v)?;
        self.each_joint("friction", friction, |j, v| j.friction = v)?;
        Ok(self)
    }

    /// Same robot with rotor inertias seen from the links, kg·m² (N values).
    ///
    /// # Errors
    /// Wrong number of values.
    pub fn with_rotor_inertia(mut self, rotor_inertia: &[f64]) -> Result<Self, RobotError> {
        self.each_joint("rotor inertia", rotor_inertia, |j, v| j.rotor_inertia = v)?;
        Ok(self)
    }

    /// Same robot with one more known torque that depends on a joint's position.
    ///
    /// # Errors
    /// Its joint does not exist.
    pub fn with_passive(mut self, passive: Passive) -> Result<Self, RobotError> {
        if passive.joint() >= self.dof() {
            return Err(RobotError::WrongLength {
                what: "joint index of a spring or counterbalance",
                expected: self.dof(),
                found: passive.joint() + 1,
            });
        }
        self.passive.push(passive);
        Ok(self)
    }

    /// Same robot with a part of each link's weight held from outside: see [`Robot::gravity_compensation`]. N values,
    /// or none.
    ///
    /// # Errors
    /// Wrong number of values, or one that is not finite.
    pub fn with_gravity_compensation(mut self, parts: &[f64]) -> Result<Self, RobotError> {
        if !parts.is_empty() && parts.len() != self.dof() {
            return Err(RobotError::WrongLength {
                what: "gravity compensation",
                expected: self.dof(),
                found: parts.len(),
            });
        }
        for (joint, &value) in self.joints.iter().zip(parts) {
            if !value.is_finite() {
                return Err(RobotError::BadNumber {
                    owner: joint.link.name.clone(),
                    what: "gravity compensation".to_owned(),
                    value,
                    hint: "it must be finite".to_owned(),
                });
            }
        }
        let none = parts.iter().all(|&part| part == 0.0);
        self.gravity_compensation = if none { Vec::new() } else { parts.to_vec() };
        self.chain = Chain::new(&self.joints, &self.gravity_compensation);
        Ok(self)
    }

    /// Rotor inertias seen from the links, kg·m² (N values).
    pub fn rotor_inertia(&self) -> Vec<f64> {
        self.joints.iter().map(|j| j.rotor_inertia).collect()
    }

    pub(crate) fn chain(&self) -> &Chain {
        &self.chain
    }

    fn each_joint(
        &mut self,
        what: &'static str,
        values: &[f64],
        set: impl Fn(&mut Joint, f64),
    ) -> Result<(), RobotError> {
        if values.len() != self.dof() {
            return Err(RobotError::WrongLength {
                what,
                expected: self.dof(),
                found: values.len(),
            });
        }
        for (joint, &value) in self.joints.iter_mut().zip(values) {
            set(joint, value);
        }
        Ok(())
    }
}
