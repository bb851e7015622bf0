//! The links and joints of a URDF, as its text has them.

use crate::robot::format::xml::{line, wrong};
use crate::robot::judgement::{Doubt, Finding};
use crate::robot::{Inertia, JointKind, Limits, RobotError};
use nalgebra::{Matrix3, Rotation3, Vector3};
use roxmltree::Node;

/// Length below which an axis has no direction.
const SHORTEST_AXIS: f64 = 1e-6;

/// Deviation from 1 of an axis's length up to which it counts as rounding: axes are written with at least six digits.
const AXIS_ROUNDING: f64 = 1e-5;

/// Limit from which a joint counts as unlimited (rad, m, rad/s, m/s, N·m or N). It is written where the format demands
/// a number.
pub(super) const UNLIMITED: f64 = 1e9;

/// Orientation and origin of a frame in its parent, m.
pub(super) type Pose = (Matrix3<f64>, Vector3<f64>);

/// A link of the description.
pub(super) struct LinkElement<'a> {
    pub name: &'a str,
    /// Inertia in the link's frame; none without an `<inertial>`.
    pub inertia: Option<Inertia>,
}

/// Kind of a joint's motion.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    Fixed,
    /// Motion about or along one axis.
    Axis(JointKind),
    /// Motion with several axes: `floating` or `planar`.
    Other,
}

/// Mimicked joint: position = `multiplier`·q + `offset`, with q the position of joint `of`.
pub(super) struct Mimic<'a> {
    pub of: &'a str,
    pub multiplier: f64,
    pub offset: f64,
}

/// A joint of the description.
pub(super) struct JointElement<'a> {
    pub name: &'a str,
    /// Text of the attribute `type`, as written.
    pub kind: &'a str,
    pub motion: Motion,
    pub parent: &'a str,
    pub child: &'a str,
    pub origin: Pose,
    /// Axis, of length one where the joint has one.
    pub axis: Vector3<f64>,
    pub limits: Limits,
    pub damping: f64,
    pub friction: f64,
    pub mimic: Option<Mimic<'a>>,
    /// Doubts about the joint's description.
    pub findings: Vec<Finding>,
}

/// The elements inside `node` with a tag.
pub(super) fn tagged<'a, 'd>(
    node: Node<'a, 'd>,
    tag: &'static str,
) -> impl Iterator<Item = Node<'a, 'd>> {
    node.children().filter(move |n| n.has_tag_name(tag))
}

/// Only child element with a tag; none where the tag does not occur.
fn one<'a, 'd>(node: Node<'a, 'd>, tag: &'static str) -> Result<Option<Node<'a, 'd>>, RobotError> {
    let mut found = tagged(node, tag);
    match (found.next(), found.next()) {
        (_, Some(second)) => {
            let problem = format!("holds a second <{tag}> on line {}", line(second));
            Err(wrong(node, problem, "keep one of them"))
        }
        (first, None) => Ok(first),
    }
}

/// The only element with a tag, which must be there.
fn needed<'a, 'd>(
    node: Node<'a, 'd>,
    tag: &'static str,
    remedy: &str,
) -> Result<Node<'a, 'd>, RobotError> {
    one(node, tag)?.ok_or_else(|| wrong(node, format!("has no <{tag}>"), remedy))
}

/// An attribute that must be there.
fn word<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, RobotError> {
    let found = node
        .attribute(name)
        .map(str::trim)
        .filter(|t| !t.is_empty());
    found.ok_or_else(|| {
        wrong(
            node,
            format!("has no attribute {name}"),
            &format!("add {name}=\"…\""),
        )
    })
}

/// Numbers of an attribute; none where it is missing or empty.
fn numbers<const N: usize>(node: Node<'_, '_>, name: &str) -> Result<Option<[f64; N]>, RobotError> {
    let Some(text) = node.attribute(name).filter(|t| !t.trim().is_empty()) else {
        return Ok(None);
    };
    let read: Option<Vec<f64>> = text.split_whitespace().map(|w| w.parse().ok()).collect();
    let read = read.and_then(|list| <[f64; N]>::try_from(list).ok());
    read.map(Some).ok_or_else(|| {
        let remedy = if N == 1 {
            "give one number".to_owned()
        } else {
            format!("give {N} numbers with blanks between them")
        };
        wrong(node, format!("has {name}={text:?}"), &remedy)
    })
}

fn number(node: Node<'_, '_>, name: &str) -> Result<Option<f64>, RobotError> {
    Ok(numbers::<1>(node, name)?.map(|[v]| v))
}

fn number_needed(node: Node<'_, '_>, name: &str) -> Result<f64, RobotError> {
    number(node, name)?.ok_or_else(|| {
        wrong(
            node,
            format!("has no number {name}"),
            &format!("add {name}=\"…\""),
        )
    })
}

/// The `<origin>` of an element: fixed-axis roll, pitch, yaw.
fn origin(node: Node<'_, '_>) -> Result<Pose, RobotError> {
    let Some(origin) = one(node, "origin")? else {
        return Ok((Matrix3::identity(), Vector3::zeros()));
    };
    let [roll, pitch, yaw] = match numbers::<3>(origin, "rpy")? {
        Some(_) => {
            let text = origin.attribute("rpy").unwrap_or_default();
            let mut words = text.split_whitespace().map(angle);
            [0; 3].map(|_| words.next().unwrap_or(0.0))
        }
        None => [0.0; 3],
    };
    let place: [f64; 3] = numbers(origin, "xyz")?.unwrap_or_default();
    let rotation = Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
    Ok((rotation, place.into()))
}

/// An angle as it is meant: a number that equals an eighth of a turn, or a multiple of it, rounded to the
/// digits written, is taken as that exactly. Axes that are parallel but for a rounded angle would make
/// parameters look identifiable that no motion tells apart.
fn angle(word: &str) -> f64 {
    const EIGHTH: f64 = std::f64::consts::FRAC_PI_4;
    let written: f64 = word.parse().unwrap_or(0.0);
    let digits = word.split_once('.').map_or(0, |(_, d)| d.len());
    let plain = word
        .bytes()
        .all(|b| b.is_ascii_digit() || b"+-.".contains(&b));
    let meant = (written / EIGHTH).round() * EIGHTH;
    let rounded = 0.5 * 0.1_f64.powi(digits.min(300) as i32) * (1.0 + 1e-9);
    if plain && digits >= 2 && (written - meant).abs() <= rounded {
        meant
    } else {
        written
    }
}

impl<'a> LinkElement<'a> {
    pub fn read(node: Node<'a, '_>) -> Result<Self, RobotError> {
        let name = word(node, "name")?;
        let inertia = one(node, "inertial")?
            .map(|i| inertia(name, i))
            .transpose()?;
        Ok(Self { name, inertia })
    }
}

/// Inertia of one link in its own frame.
fn inertia(link: &str, inertial: Node<'_, '_>) -> Result<Inertia, RobotError> {
    let of_link = |error: RobotError| match error {
        RobotError::Element {
            line,
            problem,
            remedy,
            ..
        } if !problem.is_empty() => RobotError::Element {
            line,
            element: format!("<inertial> of link {link:?}"),
            problem,
            remedy,
        },
        other => other,
    };
    let mass_element = needed(
        inertial,
        "mass",
        "give its mass in kg, <mass value=\"…\"/>, or take the <inertial> out",
    )
    .map_err(of_link)?;
    let mass = number_needed(mass_element, "value")?;
    if mass < 0.0 || !mass.is_finite() {
        return Err(RobotError::BadNumber {
            owner: link.to_owned(),
            what: "mass".to_owned(),
            value: mass,
            hint: "it must be finite and not negative".to_owned(),
        });
    }
    let (rotation, com) = origin(inertial)?;
    let Some(element) = one(inertial, "inertia").map_err(of_link)? else {
        if mass == 0.0 {
            return Ok(Inertia::default());
        }
        return Err(of_link(wrong(
            inertial,
            "has no <inertia>".to_owned(),
            "give ixx, iyy and izz about the centre of mass in kg·m², or take the <inertial> out",
        )));
    };
    let main = |name| number_needed(element, name);
    let cross = |name| Ok::<f64, RobotError>(number(element, name)?.unwrap_or(0.0));
    let (xx, yy, zz) = (main("ixx")?, main("iyy")?, main("izz")?);
    let (xy, xz, yz) = (cross("ixy")?, cross("ixz")?, cross("iyz")?);
    let about_com = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let about_com = rotation * about_com * rotation.transpose();
    Ok(Inertia::from_com(mass, com, about_com))
}

impl<'a> JointElement<'a> {
    pub fn read(node: Node<'a, '_>) -> Result<Self, RobotError> {
        let name = word(node, "name")?;
        let kind = word(node, "type")?;
        let motion = match kind {
            "fixed" => Motion::Fixed,
            "revolute" => Motion::Axis(JointKind::Revolute),
            "continuous" => Motion::Axis(JointKind::Continuous),
            "prismatic" => Motion::Axis(JointKind::Prismatic),
            "floating" | "planar" => Motion::Other,
            _ => {
                return Err(wrong(
                    node,
                    format!("has the type {kind:?}"),
                    "the types are revolute, continuous, prismatic, fixed, floating and planar",
                ));
            }
        };
        let link = |tag| word(needed(node, tag, "name the link")?, "link");
        let mut joint = Self {
            name,
            kind,
            motion,
            parent: link("parent")?,
            child: link("child")?,
            origin: origin(node)?,
            axis: Vector3::x(),
            limits: Limits::NONE,
            damping: 0.0,
            friction: 0.0,
            mimic: None,
            findings: Vec::new(),
        };
        if let Motion::Axis(kind) = motion {
            joint.moving(node, kind)?;
        }
        Ok(joint)
    }

    /// Reads the elements of a joint with an axis beside its origin.
    fn moving(&mut self, node: Node<'a, '_>, kind: JointKind) -> Result<(), RobotError> {
        if let Some(axis) = one(node, "axis")? {
            let given: [f64; 3] = numbers(axis, "xyz")?.unwrap_or([1.0, 0.0, 0.0]);
            let axis = Vector3::from(given);
            let length = axis.norm();
            // A NaN axis fails this comparison too.
            if !(length > SHORTEST_AXIS && length.is_finite()) {
                return Err(RobotError::BadAxis {
                    joint: self.name.to_owned(),
                    axis: given,
                });
            }
            self.axis = axis / length;
            if (length - 1.0).abs() > AXIS_ROUNDING {
                self.doubt(Doubt::AxisLength(length));
            }
        }
        if let Some(limit) = one(node, "limit")? {
            self.limits = limits(kind, limit)?;
            if number(limit, "effort")?.is_some_and(|effort| effort <= 0.0) {
                self.doubt(Doubt::NoEffort);
            }
        }
        if let Some(dynamics) = one(node, "dynamics")? {
            let mut coefficient = |what| -> Result<f64, RobotError> {
                let value = number(dynamics, what)?.unwrap_or(0.0);
                if value < 0.0 {
                    self.doubt(Doubt::NegativeFriction(what, value));
                    return Ok(0.0);
                }
                Ok(value)
            };
            (self.damping, self.friction) = (coefficient("damping")?, coefficient("friction")?);
        }
        if let Some(mimic) = one(node, "mimic")? {
            self.mimic = Some(Mimic {
                of: word(mimic, "joint")?,
                multiplier: number(mimic, "multiplier")?.unwrap_or(1.0),
                offset: number(mimic, "offset")?.unwrap_or(0.0),
            });
        }
        Ok(())
    }

    fn doubt(&mut self, doubt: Doubt) {
        self.findings.push(Finding::of_joint(doubt, self.name));
    }
}

/// A missing attribute reads as zero, and zero limits nothing.
fn limits(kind: JointKind, limit: Node<'_, '_>) -> Result<Limits, RobotError> {
    let value = |name| Ok::<f64, RobotError>(number(limit, name)?.unwrap_or(0.0));
    let (low, high) = (value("lower")?, value("upper")?);
    let bounded = kind != JointKind::Continuous && high > low;
    let (lower, upper) = if bounded {
        (open(low), open(high))
    } else {
        (f64::NEG_INFINITY, f64::INFINITY)
    };
    let positive = |v: f64| if v > 0.0 { open(v) } else { f64::INFINITY };
    Ok(Limits {
        lower,
        upper,
        velocity: positive(value("velocity")?),
        effort: positive(value("effort")?),
    })
}

fn open(limit: f64) -> f64 {
    if limit.abs() >= UNLIMITED {
        f64::INFINITY.copysign(limit)
    } else {
        limit
    }
}

#[cfg(test)]
mod tests {
    use super::angle;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    #[test]
    fn rounded_eighths_of_a_turn_are_meant() {
        for (word, meant) in [
            ("1.571", FRAC_PI_2),
            ("-1.5707963", -FRAC_PI_2),
            ("1.57", FRAC_PI_2),
            ("3.14159", PI),
            ("0.7854", FRAC_PI_4),
            ("0.00", 0.0),
            ("1.572", 1.572),
            ("1.5", 1.5),
            ("2", 2.0),
            ("1.5e0", 1.5),
        ] {
            assert_eq!(angle(word), meant, "{word}");
        }
    }
}
