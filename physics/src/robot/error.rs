//! Errors of a robot's description.

use std::path::PathBuf;

/// Reason why a robot cannot be used. Every message names the link or joint and ends with the remedy.
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
    /// The content of a file cannot be used.
    #[error("{}: {source}", path.display())]
    InFile {
        /// Path of the file.
        path: PathBuf,
        /// Error in its content.
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
    /// A file that is not well-formed XML.
    #[error("line {line}: it cannot be parsed: {reason}; {remedy}")]
    Syntax {
        /// Line, from 1.
        line: u32,
        /// Message of the parser.
        reason: String,
        /// Remedy.
        remedy: String,
    },
    /// An element that cannot be used.
    #[error("line {line}: {element} {problem}; {remedy}")]
    Element {
        /// Line, from 1.
        line: u32,
        /// The element, with its name where it has one.
        element: String,
        /// Problem of the element.
        problem: String,
        /// Remedy.
        remedy: String,
    },
    /// A macro file.
    #[error("this is a xacro file, whose macros are not expanded: expand it first: `xacro {}`", expansion(file.as_deref()))]
    Xacro {
        /// Name of the file, where there is one.
        file: Option<String>,
    },
    /// An MJCF that cannot be used.
    #[error("MJCF: {reason}")]
    Mjcf {
        /// Problem and remedy.
        reason: String,
    },
    /// Joints that make no robot.
    #[error("{reason}")]
    Joints {
        /// Reason and remedy.
        reason: String,
    },
    /// Several chains, of which none is meant more than another.
    #[error(
        "it holds more than one chain of driven joints (they begin at {starts}); name the joints of one, base first, or its \
         tool's frame by --joints a,b,c; a tree of moving arms is not supported"
    )]
    SeveralChains {
        /// Joints at which the chains begin.
        starts: String,
    },
    /// A joint of the chain follows another, so that their torques are one.
    #[error(
        "joint {joint:?} follows joint {of:?} (mimic) within the chain, so that the two have one drive, which is not supported; \
         choose the joints before it by --joints"
    )]
    Follows {
        /// Joint that follows.
        joint: String,
        /// Joint that leads.
        of: String,
    },
    /// A name is used twice.
    #[error(
        "line {}: two {what}s are called {name:?}, the first on line {}; names must be unique: rename one or take it out",
        lines[1], lines[0]
    )]
    Duplicate {
        /// `link` or `joint`.
        what: &'static str,
        /// The name that is used twice.
        name: String,
        /// Lines of both, from 1.
        lines: [u32; 2],
    },
    /// A joint refers to a link that does not exist.
    #[error(
        "line {line}: joint {joint:?} refers to link {link:?}, which does not exist; add the link or correct the name"
    )]
    UnknownLink {
        /// Line of the joint, from 1.
        line: u32,
        /// Joint with the reference.
        joint: String,
        /// Name of the missing link.
        link: String,
    },
    /// A link has two parent joints.
    #[error(
        "link {link:?} is the child of both {first:?} and {second:?}; closed loops are not supported"
    )]
    TwoParents {
        /// Link with two parents.
        link: String,
        /// Name of one of the joints.
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
        /// Names of the roots.
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
    /// A joint of a kind that is not supported.
    #[error(
        "joint {joint:?} is {kind}; only revolute, continuous, prismatic and fixed joints are supported"
    )]
    UnsupportedJoint {
        /// Name of the joint.
        joint: String,
        /// Kind of the joint.
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
        /// Name of the quantity.
        what: String,
        /// Value of the quantity.
        value: f64,
        /// Allowed range, in words.
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
        /// Link with the impossible inertia.
        link: String,
        /// Joint that moves it.
        joint: String,
        /// Property that no body has.
        reason: String,
    },
    /// A list has the wrong length.
    #[error("{what}: {found} values for a robot that needs {expected}")]
    WrongLength {
        /// Name of the list.
        what: &'static str,
        /// Number of values needed.
        expected: usize,
        /// Number of values found.
        found: usize,
    },
    /// The description to be changed does not belong to the robot.
    #[error(
        "the description has no {what} {name:?}, so it is not the one this robot was read from"
    )]
    Mismatch {
        /// `link` or `joint`.
        what: &'static str,
        /// The missing name.
        name: String,
    },
    /// The drive file is not usable.
    #[error("drive file: {reason}")]
    Drive {
        /// Problem and remedy.
        reason: String,
    },
}

/// Arguments that expand a macro file.
fn expansion(file: Option<&str>) -> String {
    let file = file.unwrap_or("arm.urdf.xacro");
    let stem = file.strip_suffix(".xacro");
    let out = match stem {
        Some(stem) if stem.ends_with(".urdf") => stem.to_owned(),
        Some(stem) => format!("{stem}.urdf"),
        None => format!("expanded.{file}"),
    };
    format!("{file} > {out}")
}
