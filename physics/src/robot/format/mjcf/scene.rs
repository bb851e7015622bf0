//! The bodies and joints of a model, as its text has them.

use super::attributes::Attributes;
use super::models::{Instance, Model, Models};
use super::pose::{Pose, compose};
use super::refusal::refused;
use super::settings::{Settings, direction};
use super::shapes::{self, Geom};
use super::source::Element;
use crate::robot::{Inertia, RobotError};
use nalgebra::{Matrix3, Vector3};
use std::collections::{HashMap, HashSet};

/// Largest depth to which bodies and frames may nest.
const DEEPEST: usize = 256;

/// Elements in a body that bring bodies, joints or forces of their own.
const UNSUPPORTED: [&str; 3] = ["composite", "flexcomp", "plugin"];

/// Largest number of copies that a `<replicate>` makes, and of bodies that a scene has.
const MOST: usize = 100_000;

/// A body; the first one is the world.
pub(super) struct Body<'c, 'd, 't> {
    pub name: String,
    /// Element of the body; none for the world.
    pub element: Option<Element<'d, 't>>,
    /// Index of the body that carries the body; the world's own is 0.
    pub parent: usize,
    /// The model in which it stands.
    model: usize,
    /// Orientation and origin in that body where every joint is at its reference.
    pub pose: Pose,
    /// Origin of the body as written, m.
    written: Vector3<f64>,
    pub inertial: Option<Attributes<'c, 'd, 't>>,
    pub geoms: Vec<Geom<'c, 'd, 't>>,
    /// Part of its weight that MuJoCo holds.
    pub gravcomp: f64,
    /// Tags inside that are not supported.
    pub unsupported: Vec<&'t str>,
}

/// Gives unnamed elements a unique name, by their place.
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

/// Kind of a joint's motion.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Hinge,
    Slide,
    /// Ball or free: more than one degree of freedom.
    Other,
}

/// Joint of the scene, as an MJCF has it.
pub(super) struct Joint<'c, 'd, 't> {
    pub name: String,
    /// Index of the body that the joint moves.
    pub body: usize,
    /// Radians per unit of angle in the joint's model; in `autolimits`, whether a range alone makes a limit there.
    pub angle: f64,
    pub autolimits: bool,
    pub kind: Kind,
    /// Point of the axis in the body.
    pub anchor: Vector3<f64>,
    /// Axis of the joint in the body's frame.
    pub axis: Vector3<f64>,
    pub attributes: Attributes<'c, 'd, 't>,
}

/// Content of a model that torque depends on.
pub(super) struct Scene<'c, 'd, 't> {
    pub name: String,
    pub root: Element<'d, 't>,
    /// Settings of the main model, whose options hold for all.
    pub settings: &'c Settings,
    models: &'c Models<'d, 't>,
    /// Main model, and each model that was attached.
    instances: Vec<Instance>,
    /// Bodies of the scene, parents before children.
    pub bodies: Vec<Body<'c, 'd, 't>>,
    /// Joints; those of one body in the order in which they act.
    pub joints: Vec<Joint<'c, 'd, 't>>,
    /// Index of the body that holds each site, by the site's name.
    pub sites: HashMap<String, usize>,
}

impl<'c, 'd, 't> Scene<'c, 'd, 't> {
    pub fn read(models: &'c Models<'d, 't>) -> Result<Self, RobotError> {
        let root = models.all[0].root;
        let mut scene = Self {
            name: root.get("model").unwrap_or("MuJoCo Model").to_owned(),
            root,
            settings: &models.all[0].settings,
            models,
            instances: vec![Instance {
                model: 0,
                prefix: String::new(),
            }],
            bodies: vec![Body {
                name: "world".to_owned(),
                element: None,
                parent: 0,
                model: 0,
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
            let place = Place {
                model: 0,
                prefix: String::new(),
                suffix: String::new(),
                class: None,
                depth: 0,
            };
            scene.inside(world, 0, &scene.bodies[0].pose.clone(), &place)?;
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

    /// Reads the content of a body, or of a frame of it whose pose in the body is `frame`.
    fn inside(
        &mut self,
        element: Element<'d, 't>,
        body: usize,
        frame: &Pose,
        place: &Place<'d>,
    ) -> Result<(), RobotError> {
        for child in element.children() {
            self.child(child, body, frame, place)?;
        }
        Ok(())
    }

    fn child(
        &mut self,
        child: Element<'d, 't>,
        body: usize,
        frame: &Pose,
        place: &Place<'d>,
    ) -> Result<(), RobotError> {
        if place.depth > DEEPEST || self.bodies.len() > MOST {
            return Err(refused(format!(
                "bodies are nested deeper than {DEEPEST}, or are more than {MOST}"
            )));
        }
        let inner = Place {
            class: child.get("childclass").or(place.class),
            depth: place.depth + 1,
            ..place.clone()
        };
        let model = &self.models.all[place.model];
        match child.tag() {
            "body" => self.body(child, body, frame, &inner)?,
            "frame" => {
                let own = place_of(&model.settings, child)?;
                self.inside(child, body, &compose(frame, &own), &inner)?;
            }
            "joint" | "freejoint" => self.joint(child, body, frame, &inner)?,
            "inertial" => self.bodies[body].inertial = Some(Attributes::alone(child)),
            "geom" => {
                let geom = Geom {
                    attributes: model.of(child, inner.class)?,
                    frame: *frame,
                };
                self.bodies[body].geoms.push(geom);
            }
            "site" => {
                if let Some(name) = child.get("name") {
                    self.sites.insert(inner.named(name), body);
                }
            }
            "replicate" => self.replicate(child, body, frame, &inner)?,
            "attach" => self.attach(child, body, frame, &inner)?,
            tag if UNSUPPORTED.contains(&tag) => self.bodies[body].unsupported.push(tag),
            _ => {}
        }
        Ok(())
    }

    /// Reads copies of an element's content, each displaced and turned against the one before. Copies with
    /// joints are not supported: they have no text of their own for new numbers.
    fn replicate(
        &mut self,
        element: Element<'d, 't>,
        body: usize,
        frame: &Pose,
        place: &Place<'d>,
    ) -> Result<(), RobotError> {
        let moves =
            |n: roxmltree::Node<'_, '_>| n.has_tag_name("joint") || n.has_tag_name("freejoint");
        if element.node.descendants().any(moves) {
            self.bodies[body].unsupported.push("replicate");
            return Ok(());
        }
        let a = Attributes::alone(element);
        let count = a.number("count")?.unwrap_or(0.0);
        let count = if (0.0..MOST as f64).contains(&count) {
            count as usize
        } else {
            MOST
        };
        let settings = &self.models.all[place.model].settings;
        let step = (
            settings.orientation(&a)?,
            a.numbers::<3>("offset")?.unwrap_or_default().into(),
        );
        let separator = element.get("sep").unwrap_or_default();
        let digits = count.saturating_sub(1).to_string().len();
        let mut own = *frame;
        for copy in 0..count {
            let copied = Place {
                suffix: format!("{separator}{copy:0digits$}{}", place.suffix),
                ..place.clone()
            };
            self.inside(element, body, &own, &copied)?;
            own = compose(&own, &step);
        }
        Ok(())
    }

    /// The body of another model, or all that its world holds.
    fn attach(
        &mut self,
        element: Element<'d, 't>,
        body: usize,
        frame: &Pose,
        place: &Place<'d>,
    ) -> Result<(), RobotError> {
        let (model, elements, prefix) = self.models.attached(place.model, element)?;
        let inner = Place {
            model,
            prefix: format!("{}{prefix}", place.prefix),
            suffix: String::new(),
            class: None,
            depth: place.depth,
        };
        for element in elements {
            match element.tag() {
                "body" => self.child(element, body, frame, &inner)?,
                _ => self.inside(element, body, frame, &inner)?,
            }
        }
        self.instances.push(Instance {
            model,
            prefix: inner.prefix,
        });
        Ok(())
    }

    fn body(
        &mut self,
        element: Element<'d, 't>,
        parent: usize,
        frame: &Pose,
        place: &Place<'d>,
    ) -> Result<(), RobotError> {
        let own = place_of(&self.models.all[place.model].settings, element)?;
        let index = self.bodies.len();
        let a = Attributes::alone(element);
        self.bodies.push(Body {
            name: place.named(element.get("name").unwrap_or_default()),
            element: Some(element),
            parent,
            model: place.model,
            pose: compose(frame, &own),
            written: own.1,
            inertial: None,
            geoms: Vec::new(),
            gravcomp: a.number("gravcomp")?.unwrap_or(0.0),
            unsupported: Vec::new(),
        });
        let identity = (Matrix3::identity(), Vector3::zeros());
        self.inside(element, index, &identity, place)
    }

    fn joint(
        &mut self,
        element: Element<'d, 't>,
        body: usize,
        frame: &Pose,
        place: &Place<'d>,
    ) -> Result<(), RobotError> {
        let name = place.named(element.get("name").unwrap_or_default());
        let model = &self.models.all[place.model];
        let settings = &model.settings;
        if body == 0 {
            return Err(refused(format!(
                "joint {name:?} stands in <worldbody>, which does not move; put it into a <body>"
            )));
        }
        if element.tag() == "freejoint" {
            self.joints.push(Joint {
                name,
                body,
                angle: settings.angle,
                autolimits: settings.autolimits,
                kind: Kind::Other,
                anchor: Vector3::zeros(),
                axis: Vector3::z(),
                attributes: Attributes::alone(element),
            });
            return Ok(());
        }
        let a = model.of(element, place.class)?;
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
            angle: settings.angle,
            autolimits: settings.autolimits,
            kind,
            anchor: frame.0 * settings.position(&a)? + frame.1,
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
            &self.models.all[body.model].settings,
        )
    }

    /// Settings that hold for a body.
    pub fn settings_of(&self, body: usize) -> &'c Settings {
        &self.models.all[self.bodies[body].model].settings
    }

    /// The elements of all sections with a tag, in every model, with the model that they stand in.
    pub fn sections(&self, tag: &str) -> Vec<(Element<'d, 't>, &Instance)> {
        let mut found = Vec::new();
        for instance in &self.instances {
            for section in self.model(instance).root.tagged(tag) {
                found.extend(section.children().into_iter().map(|e| (e, instance)));
            }
        }
        found
    }

    /// The model of an instance.
    pub fn model(&self, instance: &Instance) -> &'c Model<'d, 't> {
        &self.models.all[instance.model]
    }

    /// Index of a joint by the name that it has in an instance.
    pub fn joint_in(&self, instance: &Instance, name: &str) -> Option<usize> {
        let name = format!("{}{name}", instance.prefix);
        self.joints.iter().position(|j| j.name == name)
    }

    /// Index of a body by the name that it has in an instance.
    pub fn body_in(&self, instance: &Instance, name: &str) -> Option<usize> {
        let name = format!("{}{name}", instance.prefix);
        self.bodies.iter().position(|b| b.name == name)
    }

    /// Body of a site by the name that it has in an instance.
    pub fn site_in(&self, instance: &Instance, name: &str) -> Option<usize> {
        self.sites
            .get(&format!("{}{name}", instance.prefix))
            .copied()
    }
}

/// Context of an element: its model, prefix and suffix of its names, default class in force, depth.
#[derive(Clone)]
struct Place<'d> {
    model: usize,
    prefix: String,
    suffix: String,
    class: Option<&'d str>,
    depth: usize,
}

impl Place<'_> {
    /// A name as the whole scene has it; none stays none.
    fn named(&self, name: &str) -> String {
        match name {
            "" => String::new(),
            name => format!("{}{name}{}", self.prefix, self.suffix),
        }
    }
}

/// Pose of a body or frame in its parent.
fn place_of(settings: &Settings, element: Element<'_, '_>) -> Result<Pose, RobotError> {
    let a = Attributes::alone(element);
    Ok((settings.orientation(&a)?, settings.position(&a)?))
}
