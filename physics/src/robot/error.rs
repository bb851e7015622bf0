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
    /// Not XML.
    #[error("line {line}: it cannot be parsed: {reason}; {remedy}")]
    Syntax {
        /// Line, from 1.
        line: u32,
        /// Message of the parser.
        reason: String,
        /// What to do.
        remedy: String,
    },
    /// An element that cannot be used.
    #[error("line {line}: {element} {problem}; {remedy}")]
    Element {
        /// Line, from 1.
        line: u32,
        /// The element, with its name where it has one.
        element: String,
        /// What is wrong with it.
        problem: String,
        /// What to do.
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
        /// What is wrong, and what to do.
        reason: String,
    },
    /// Joints that make no robot.
    #[error("{reason}")]
    Joints {
        /// Why, and what to do.
        reason: String,
    },
    /// Several chains, of which none is meant more than another.
    #[error(
        "it holds more than one chain of driven joints (they begin at {starts}); name the joints of one, base first, or its \
         tool's frame by --joints a,b,c; a tree of moving arms is not supported"
    )]
    SeveralChains {
        /// Where they begin.
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
        /// The name.
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
