//! The bodies and joints of a model, as its text has them.

use super::attributes::{Attributes, Classes};
use super::pose::{Pose, compose};
use super::refusal::refused;
use super::settings::{Settings, direction};
use super::shapes::{self, Geom};
use super::source::Element;
use crate::robot::{Inertia, RobotError};
use nalgebra::{Matrix3, Vector3};
use std::collections::{HashMap, HashSet};

/// Deepest nesting of bodies and frames.
const DEEPEST: usize = 256;

/// Elements in a body that bring bodies, joints or forces of their own.
const UNSUPPORTED: [&str; 5] = ["replicate", "attach", "composite", "flexcomp", "plugin"];

/// A body; the first one is the world.
pub(super) struct Body<'c, 'd, 't> {
    pub name: String,
    /// None for the world.
    pub element: Option<Element<'d, 't>>,
    /// Index of the body that carries it; the world's own is 0.
    pub parent: usize,
    /// Orientation and origin in that body where every joint is at its reference.
    pub pose: Pose,
    /// Origin as written.
    written: Vector3<f64>,
    pub inertial: Option<Attributes<'c, 'd, 't>>,
    pub geoms: Vec<Geom<'c, 'd, 't>>,
    /// Part of its weight that MuJoCo holds.
    pub gravcomp: f64,
    /// Tags inside that are not supported.
    pub unsupported: Vec<&'t str>,
}

/// Gives what has no name one by its place, which nothing else has.
fn name_others(what: &str, mut names: Vec<&mut String>) {
    let mut known: HashSet<String> = names.iter().map(|n| (**n).clone()).collect();
    for (i, name) in names.iter_mut().enumerate() {
        if name.is_empty() {
            let mut own = format!("{what}_{i}");
            while !known.insert(own.clone()) {
                own.push('_');
            }
            **name = own;
        }
    }
}

/// How a joint moves.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Hinge,
    Slide,
    /// Ball or free: more than one degree of freedom.
    Other,
}

/// A joint.
pub(super) struct Joint<'c, 'd, 't> {
    pub name: String,
    /// What it moves.
    pub body: usize,
    pub kind: Kind,
    /// Point of the axis in the body.
    pub anchor: Vector3<f64>,
    /// Axis in the body.
    pub axis: Vector3<f64>,
    pub attributes: Attributes<'c, 'd, 't>,
}

/// Everything of a model that torque depends on.
pub(super) struct Scene<'c, 'd, 't> {
    pub name: String,
    pub root: Element<'d, 't>,
    pub settings: Settings,
    pub classes: &'c Classes,
    /// Parents before children.
    pub bodies: Vec<Body<'c, 'd, 't>>,
    /// Within a body in the order in which they act.
    pub joints: Vec<Joint<'c, 'd, 't>>,
    /// Body of each site.
    pub sites: HashMap<String, usize>,
}

impl<'c, 'd, 't> Scene<'c, 'd, 't> {
    pub fn read(root: Element<'d, 't>, classes: &'c Classes) -> Result<Self, RobotError> {
        let mut scene = Self {
            name: root.get("model").unwrap_or("MuJoCo Model").to_owned(),
            root,
            settings: Settings::read(root)?,
            classes,
            bodies: vec![Body {
                name: "world".to_owned(),
                element: None,
                parent: 0,
                pose: (Matrix3::identity(), Vector3::zeros()),
                written: Vector3::zeros(),
                inertial: None,
                geoms: Vec::new(),
                gravcomp: 0.0,
                unsupported: Vec::new(),
            }],
            joints: Vec::new(),
            sites: HashMap::new(),
        };
        for world in root.tagged("worldbody") {
            scene.inside(world, 0, &scene.bodies[0].pose.clone(), None, 0)?;
        }
        // A joint may stand behind the bodies that its own carries.
        scene.joints.sort_by_key(|joint| joint.body);
        scene.unique()?;
        name_others(
            "body",
            scene.bodies.iter_mut().map(|b| &mut b.name).collect(),
        );
        name_others(
            "joint",
            scene.joints.iter_mut().map(|j| &mut j.name).collect(),
        );
        Ok(scene)
    }

    /// Reads what stands in a body, or in a frame of it whose pose in the body is `frame`.
    fn inside(
        &mut self,
        element: Element<'d, 't>,
        body: usize,
        frame: &Pose,
        class: Option<&'d str>,
        depth: usize,
    ) -> Result<(), RobotError> {
        if depth > DEEPEST {
            return Err(refused(format!("bodies are nested deeper than {DEEPEST}")));
        }
        for child in element.children() {
            let class = child.get("childclass").or(class);
            match child.tag() {
                "body" => self.body(child, body, frame, class, depth)?,
                "frame" => {
                    let a = Attributes::alone(child);
                    let own = (self.settings.orientation(&a)?, self.settings.position(&a)?);
                    self.inside(child, body, &compose(frame, &own), class, depth + 1)?;
                }
                "joint" | "freejoint" => self.joint(child, body, frame, class)?,
                "inertial" => self.bodies[body].inertial = Some(Attributes::alone(child)),
                "geom" => self.bodies[body].geoms.push(Geom {
                    attributes: self.classes.of(child, class)?,
                    frame: *frame,
                }),
                "site" => {
                    if let Some(name) = child.get("name") {
                        self.sites.insert(name.to_owned(), body);
                    }
                }
                tag if UNSUPPORTED.contains(&tag) => self.bodies[body].unsupported.push(tag),
                _ => {}
            }
        }
        Ok(())
    }

    fn body(
        &mut self,
        element: Element<'d, 't>,
        parent: usize,
        frame: &Pose,
        class: Option<&'d str>,
        depth: usize,
    ) -> Result<(), RobotError> {
        let a = Attributes::alone(element);
        let own = (self.settings.orientation(&a)?, self.settings.position(&a)?);
        let index = self.bodies.len();
        self.bodies.push(Body {
            name: element.get("name").unwrap_or_default().to_owned(),
            element: Some(element),
            parent,
            pose: compose(frame, &own),
            written: own.1,
            inertial: None,
            geoms: Vec::new(),
            gravcomp: a.number("gravcomp")?.unwrap_or(0.0),
            unsupported: Vec::new(),
        });
        let identity = (Matrix3::identity(), Vector3::zeros());
        self.inside(element, index, &identity, class, depth + 1)
    }

    fn joint(
        &mut self,
        element: Element<'d, 't>,
        body: usize,
        frame: &Pose,
        class: Option<&'d str>,
    ) -> Result<(), RobotError> {
        let name = element.get("name").unwrap_or_default().to_owned();
        if body == 0 {
            return Err(refused(format!(
                "joint {name:?} stands in <worldbody>, which does not move; put it into a <body>"
            )));
        }
        if element.tag() == "freejoint" {
            self.joints.push(Joint {
                name,
                body,
                kind: Kind::Other,
                anchor: Vector3::zeros(),
                axis: Vector3::z(),
                attributes: Attributes::alone(element),
            });
            return Ok(());
        }
        let a = self.classes.of(element, class)?;
        let kind = match a.get("type").as_deref() {
            None | Some("hinge") => Kind::Hinge,
            Some("slide") => Kind::Slide,
            Some("ball" | "free") => Kind::Other,
            Some(other) => {
                return Err(refused(format!(
                    "joint {name:?} has type {other:?}; it is hinge, slide, ball or free"
                )));
            }
        };
        let axis: Vector3<f64> = a.numbers("axis")?.unwrap_or([0.0, 0.0, 1.0]).into();
        let axis = if kind == Kind::Other {
            Vector3::z()
        } else {
            frame.0 * direction(&a, "axis", axis)?.into_inner()
        };
        self.joints.push(Joint {
            name,
            body,
            kind,
            anchor: frame.0 * self.settings.position(&a)? + frame.1,
            axis,
            attributes: a,
        });
        Ok(())
    }

    /// Refuses names that are used twice.
    fn unique(&self) -> Result<(), RobotError> {
        fn twice<'n>(names: impl Iterator<Item = &'n String>) -> Option<&'n String> {
            let mut seen = HashSet::new();
            let mut given = names.filter(|name| !name.is_empty());
            given.find(|name| !seen.insert(*name))
        }
        let body = twice(self.bodies.iter().map(|b| &b.name)).map(|n| ("bodies", n));
        let joint = || twice(self.joints.iter().map(|j| &j.name)).map(|n| ("joints", n));
        match body.or_else(joint) {
            Some((what, name)) => Err(refused(format!(
                "two {what} are called {name:?}; names must be unique"
            ))),
            None => Ok(()),
        }
    }

    /// Inertia of a body in its own frame.
    pub fn inertia(&self, body: usize) -> Result<Inertia, RobotError> {
        let body = &self.bodies[body];
        shapes::inertia(
            &body.name,
            body.inertial.as_ref(),
            &body.geoms,
            body.written,
            &self.settings,
        )
    }

    /// Index of a joint by its name.
    pub fn joint_named(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }
}
