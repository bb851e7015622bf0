//! What can be wrong with a description of a robot.

use std::path::PathBuf;

/// Why a robot cannot be used. Every message names the link or joint and ends with what to do.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// File asked for.
        path: PathBuf,
        /// Reason given by the operating system.
        source: std::io::Error,
    },
    /// What a file holds cannot be used.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<RobotError>,
    },
    /// Neither a built-in robot nor a file.
    #[error("no built-in robot and no file is called {name:?}; the built-in robots are {builtins}")]
    UnknownRobot {
        /// Name asked for.
        name: String,
        /// Names that exist.
        builtins: String,
    },
    /// A machine that is no chain of described bodies.
    #[error(
        "{name:?} is a machine with a torque model of its own, not a chain of described links; use `machine identify --robot {name}`"
    )]
    Machine {
        /// Name asked for.
        name: String,
    },
    /// Not a URDF.
    #[error(
        "the URDF cannot be parsed: {reason}; check it with `check_urdf`, and expand xacro first"
    )]
    Syntax {
        /// Message of the parser.
        reason: String,
    },
    /// An MJCF that cannot be used.
    #[error("MJCF: {reason}")]
    Mjcf {
        /// What is wrong, and what to do.
        reason: String,
    },
    /// Joints are chosen where there is nothing to choose.
    #[error(
        "joints can be chosen from an MJCF alone, and {name} is none: it is one chain as it stands; leave --joints out"
    )]
    Joints {
        /// Robot asked for.
        name: String,
    },
    /// A name is used twice.
    #[error("two {what}s are called {name:?}; names must be unique")]
    Duplicate {
        /// `link` or `joint`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A joint refers to a link that does not exist.
    #[error(
        "joint {joint:?} refers to link {link:?}, which does not exist; add the link or correct the name"
    )]
    UnknownLink {
        /// Joint with the reference.
        joint: String,
        /// Missing link.
        link: String,
    },
    /// A link has two parent joints.
    #[error(
        "link {link:?} is the child of both {first:?} and {second:?}; closed loops are not supported"
    )]
    TwoParents {
        /// Link with two parents.
        link: String,
        /// One of the joints.
        first: String,
        /// The other joint.
        second: String,
    },
    /// Not exactly one link without a parent.
    #[error(
        "the URDF needs one root link and has {count} ({names}); connect the links with joints"
    )]
    Roots {
        /// Number of roots found.
        count: usize,
        /// Their names.
        names: String,
    },
    /// No joint moves.
    #[error(
        "the robot {name:?} has no moving joint; at least one revolute, continuous or prismatic joint is needed"
    )]
    NoJoints {
        /// Name of the robot.
        name: String,
    },
    /// The moving joints form a tree.
    #[error(
        "the moving joints do not form one serial chain: link {link:?} carries both {first:?} and {second:?}; \
         keep one of them and make the other fixed"
    )]
    Branch {
        /// Link (with what is fixed to it) at which the chain splits.
        link: String,
        /// One moving joint.
        first: String,
        /// Another moving joint.
        second: String,
    },
    /// A joint of a kind that is not supported.
    #[error(
        "joint {joint:?} is {kind}; only revolute, continuous, prismatic and fixed joints are supported"
    )]
    UnsupportedJoint {
        /// Name of the joint.
        joint: String,
        /// Its kind.
        kind: String,
    },
    /// The axis has no direction.
    #[error(
        "joint {joint:?} has axis {axis:?}, which has no direction; give a vector of length one"
    )]
    BadAxis {
        /// Name of the joint.
        joint: String,
        /// The axis as given.
        axis: [f64; 3],
    },
    /// A number that is NaN, infinite or out of its range.
    #[error("{owner:?}: {what} is {value}; {hint}")]
    BadNumber {
        /// Link or joint it belongs to.
        owner: String,
        /// Which number.
        what: String,
        /// Its value.
        value: f64,
        /// What is allowed.
        hint: String,
    },
    /// A moving joint carries no mass.
    #[error(
        "link {link:?} is moved by joint {joint:?} but has no mass, and nothing with mass is fixed to it; \
         give it an <inertial> element, or make the joint fixed"
    )]
    Massless {
        /// Link without mass.
        link: String,
        /// Joint that moves it.
        joint: String,
    },
    /// No rigid body has these inertial parameters.
    #[error(
        "link {link:?} (moved by joint {joint:?}) has an impossible inertia: {reason}; \
         the inertia belongs to the centre of mass, in kg·m²"
    )]
    ImpossibleInertia {
        /// Link concerned.
        link: String,
        /// Joint that moves it.
        joint: String,
        /// What is impossible about it.
        reason: String,
    },
    /// A list has the wrong length.
    #[error("{what}: {found} values for a robot that needs {expected}")]
    WrongLength {
        /// Which list.
        what: &'static str,
        /// Length needed.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// The description to be changed does not belong to the robot.
    #[error(
        "the description has no {what} {name:?}, so it is not the one this robot was read from"
    )]
    Mismatch {
        /// `link` or `joint`.
        what: &'static str,
        /// Missing name.
        name: String,
    },
    /// The drive file is not usable.
    #[error("drive file: {reason}")]
    Drive {
        /// What is wrong, and what to do.
        reason: String,
    },
}
