//! Errors of a robot's description.

use std::path::PathBuf;

/// Reason why a robot cannot be used. Every message names the link or joint and ends with the remedy.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// File of a description that cannot be read.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Read {
        /// Path of the file that was asked for.
        path: PathBuf,
        /// Reason given by the operating system.
        source: std::io::Error,
    },
    /// The content of a file cannot be used.
    #[error("{}: {source}", path.display())]
    InFile {
        /// Path of the file that cannot be used.
        path: PathBuf,
        /// Error in the file's content.
        source: Box<RobotError>,
    },
    /// Name that is neither a built-in robot nor a file.
    #[error("no built-in robot and no file is called {name:?}; the built-in robots are {builtins}")]
    UnknownRobot {
        /// Name that was asked for.
        name: String,
        /// Names of the built-in robots.
        builtins: String,
    },
    /// Machine that is not a chain of described bodies.
    #[error(
        "{name:?} is a machine with a torque model of its own, not a chain of described links; use `machine identify --robot {name}`"
    )]
    Machine {
        /// Name of the machine that was asked for.
        name: String,
    },
    /// A file that is not well-formed XML.
    #[error("line {line}: it cannot be parsed: {reason}; {remedy}")]
    Syntax {
        /// Line of the mistake, from 1.
        line: u32,
        /// Message of the XML parser.
        reason: String,
        /// Remedy, as the end of the message.
        remedy: String,
    },
    /// An element that cannot be used.
    #[error("line {line}: {element} {problem}; {remedy}")]
    Element {
        /// Line of the element, from 1.
        line: u32,
        /// The element, with its name where it has one.
        element: String,
        /// Problem of the element, in words.
        problem: String,
        /// Remedy, as the end of the message.
        remedy: String,
    },
    /// Macro file (xacro) that is not expanded.
    #[error("this is a xacro file, whose macros are not expanded: expand it first: `xacro {}`", expansion(file.as_deref()))]
    Xacro {
        /// Name of the file, where there is one.
        file: Option<String>,
    },
    /// An MJCF that cannot be used.
    #[error("MJCF: {reason}")]
    Mjcf {
        /// Problem of the MJCF and its remedy.
        reason: String,
    },
    /// Joints that make no robot.
    #[error("{reason}")]
    Joints {
        /// Reason why the joints make no robot, and remedy.
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
        /// Name of the joint that follows another.
        joint: String,
        /// Name of the joint that leads.
        of: String,
    },
    /// Name that two links or two joints have.
    #[error(
        "line {}: two {what}s are called {name:?}, the first on line {}; names must be unique: rename one or take it out",
        lines[1], lines[0]
    )]
    Duplicate {
        /// Kind of the elements: `link` or `joint`.
        what: &'static str,
        /// The name that is used twice.
        name: String,
        /// Lines of both elements, from 1.
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
        /// Name of the link with two parents.
        link: String,
        /// Name of one of the joints.
        first: String,
        /// Name of the other joint that carries it.
        second: String,
    },
    /// URDF with no root link, or with several links without a parent.
    #[error(
        "the URDF needs one root link and has {count} ({names}); connect the links with joints"
    )]
    Roots {
        /// Number of root links found.
        count: usize,
        /// Names of the root links.
        names: String,
    },
    /// Robot in which no joint moves.
    #[error(
        "the robot {name:?} has no moving joint; at least one revolute, continuous or prismatic joint is needed"
    )]
    NoJoints {
        /// Name of the robot without moving joints.
        name: String,
    },
    /// A joint of a kind that is not supported.
    #[error(
        "joint {joint:?} is {kind}; only revolute, continuous, prismatic and fixed joints are supported"
    )]
    UnsupportedJoint {
        /// Name of the unsupported joint.
        joint: String,
        /// Kind of the joint in the URDF.
        kind: String,
    },
    /// The axis has no direction.
    #[error(
        "joint {joint:?} has axis {axis:?}, which has no direction; give a vector of length one"
    )]
    BadAxis {
        /// Name of the joint with the bad axis.
        joint: String,
        /// Axis of the joint, as given.
        axis: [f64; 3],
    },
    /// A number that is NaN, infinite or out of its range.
    #[error("{owner:?}: {what} is {value}; {hint}")]
    BadNumber {
        /// Name of the link or joint that the number belongs to.
        owner: String,
        /// Name of the quantity that has the bad number.
        what: String,
        /// Value of the quantity, as given.
        value: f64,
        /// Range that is allowed, in words.
        hint: String,
    },
    /// A moving joint carries no mass.
    #[error(
        "link {link:?} is moved by joint {joint:?} but has no mass, and nothing with mass is fixed to it; \
         give it an <inertial> element, or make the joint fixed"
    )]
    Massless {
        /// Name of the link without mass.
        link: String,
        /// Name of the joint that moves the link.
        joint: String,
    },
    /// Link whose inertial parameters no rigid body can have.
    #[error(
        "link {link:?} (moved by joint {joint:?}) has an impossible inertia: {reason}; \
         the inertia belongs to the centre of mass, in kg·m²"
    )]
    ImpossibleInertia {
        /// Link with the impossible inertia.
        link: String,
        /// Name of the joint that moves the link.
        joint: String,
        /// Property of the inertia that no body has.
        reason: String,
    },
    /// A list has the wrong length.
    #[error("{what}: {found} values for a robot that needs {expected}")]
    WrongLength {
        /// Name of the list with the wrong length.
        what: &'static str,
        /// Number of values that are needed.
        expected: usize,
        /// Number of values in the list.
        found: usize,
    },
    /// The description to be changed does not belong to the robot.
    #[error(
        "the description has no {what} {name:?}, so it is not the one this robot was read from"
    )]
    Mismatch {
        /// Kind of the missing element: `link` or `joint`.
        what: &'static str,
        /// Name that is missing.
        name: String,
    },
    /// The drive file is not usable.
    #[error("drive file: {reason}")]
    Drive {
        /// Problem of the drive file and its remedy.
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
