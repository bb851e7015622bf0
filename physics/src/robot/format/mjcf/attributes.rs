//! Attributes of an element, completed from its default class.

use super::refusal::refused;
use super::source::Element;
use crate::robot::RobotError;
use std::collections::HashMap;

/// Attributes of which a shorter list of values changes only the first ones.
const PARTIAL: [&str; 5] = ["size", "gear", "gainprm", "biasprm", "dynprm"];

/// Ways to write an orientation beside `quat`; one displaces the other.
pub(super) const ORIENTATIONS: [&str; 4] = ["axisangle", "xyaxes", "zaxis", "euler"];

/// Elements of `<actuator>`, which share their defaults.
pub(super) const ACTUATORS: [&str; 13] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
    "pid",
    "orientation",
    "plugin",
];

/// Key under which a class keeps the tag of its actuators' defaults. Names of attributes have no blank, so it is free.
const ACTUATOR_TAG: &str = "actuator tag";

/// Attributes that a class gives to one kind of element.
pub(super) type Given = HashMap<String, String>;

/// Default classes with their attributes; nested classes include what they inherit.
#[derive(Default)]
pub(super) struct Classes {
    classes: HashMap<String, HashMap<&'static str, Given>>,
}

impl Classes {
    /// Reads all `<default>` sections. A class inherits the attributes that its parent has when the class is
    /// defined, as in MuJoCo.
    pub fn read(root: Element<'_, '_>) -> Result<Self, RobotError> {
        let mut found = Self::default();
        found.classes.insert("main".to_owned(), HashMap::new());
        let mut open: Vec<(Element<'_, '_>, Option<String>)> = Vec::new();
        for section in root.tagged("default") {
            open.push((section, None));
            while let Some((element, parent)) = open.pop() {
                let name = match (element.get("class"), &parent) {
                    (_, None) => "main".to_owned(),
                    (Some(name), _) => name.to_owned(),
                    (None, Some(parent)) => {
                        return Err(refused(format!(
                            "a <default> inside class {parent:?} has no class; add class=\"…\""
                        )));
                    }
                };
                if let Some(parent) = &parent {
                    let inherited = found.classes[parent].clone();
                    found.classes.insert(name.clone(), inherited);
                }
                let class = found.classes.entry(name.clone()).or_default();
                let children = element.children();
                for child in children.iter().filter(|c| c.tag() != "default") {
                    let given = class.entry(kind(child.tag())).or_default();
                    for attribute in child.node.attributes() {
                        overlay(given, attribute.name(), attribute.value());
                    }
                    if ACTUATORS.contains(&child.tag()) {
                        overlay(given, ACTUATOR_TAG, child.tag());
                    }
                }
                // The outermost class is the main one, whatever it is called.
                if let (None, Some(other)) = (&parent, element.get("class")) {
                    let main = class.clone();
                    found.classes.insert(other.to_owned(), main);
                }
                let nested = children.into_iter().filter(|c| c.tag() == "default");
                open.extend(nested_of(nested, &name));
            }
        }
        Ok(found)
    }

    /// The attributes of an element: its own, then those of its class, of the class that holds for children of the body, or
    /// of the main one.
    pub fn of<'c, 'd, 't>(
        &'c self,
        element: Element<'d, 't>,
        childclass: Option<&str>,
    ) -> Result<Attributes<'c, 'd, 't>, RobotError> {
        self.of_kind(kind(element.tag()), element, childclass)
    }

    /// Attributes of an element with the defaults of another kind of element.
    pub fn of_kind<'c, 'd, 't>(
        &'c self,
        kind: &str,
        element: Element<'d, 't>,
        childclass: Option<&str>,
    ) -> Result<Attributes<'c, 'd, 't>, RobotError> {
        let name = element.get("class").or(childclass).unwrap_or("main");
        let class = self.classes.get(name).ok_or_else(|| {
            refused(format!(
                "<{}> has the class {name:?}, which no <default> defines",
                element.tag()
            ))
        })?;
        Ok(Attributes {
            element,
            given: class.get(kind),
        })
    }
}

/// Nested classes, the last first: they are taken from the end.
fn nested_of<'d, 't>(
    nested: impl DoubleEndedIterator<Item = Element<'d, 't>>,
    parent: &str,
) -> Vec<(Element<'d, 't>, Option<String>)> {
    let list = nested.rev().map(|e| (e, Some(parent.to_owned())));
    list.collect()
}

/// Name under which the defaults of an element with this tag stand.
fn kind(tag: &str) -> &'static str {
    match tag {
        "joint" => "joint",
        "geom" => "geom",
        "connect" | "weld" | "equality" => "equality",
        "spatial" | "fixed" | "tendon" => "tendon",
        tag if ACTUATORS.contains(&tag) => "actuator",
        _ => "other",
    }
}

fn overlay(given: &mut Given, name: &str, value: &str) {
    if ORIENTATIONS.contains(&name) {
        given.retain(|known, _| !ORIENTATIONS.contains(&known.as_str()));
    }
    let value = match given.get(name) {
        Some(below) if PARTIAL.contains(&name) => over(below, value),
        _ => value.to_owned(),
    };
    given.insert(name.to_owned(), value);
}

/// The first values of `below` replaced by those of `above`.
fn over(below: &str, above: &str) -> String {
    let own: Vec<&str> = above.split_whitespace().collect();
    let rest = below.split_whitespace().skip(own.len());
    own.iter()
        .copied()
        .chain(rest)
        .collect::<Vec<_>>()
        .join(" ")
}

/// Attributes of one element.
#[derive(Clone, Copy)]
pub(super) struct Attributes<'c, 'd, 't> {
    /// Element whose attributes they are.
    pub element: Element<'d, 't>,
    given: Option<&'c Given>,
}

impl<'d, 't> Attributes<'_, 'd, 't> {
    /// Attributes of an element without default class.
    pub fn alone(element: Element<'d, 't>) -> Self {
        Self {
            element,
            given: None,
        }
    }

    /// Text of an attribute: the element's own, else the default.
    pub fn get(&self, name: &str) -> Option<String> {
        let own = self.element.get(name);
        let below = self.given.and_then(|g| g.get(name));
        match (own, below) {
            (Some(own), Some(below)) if PARTIAL.contains(&name) => Some(over(below, own)),
            (Some(own), _) => Some(own.to_owned()),
            (None, below) => below.cloned(),
        }
    }

    /// The tag under which the defaults of an actuator stand, where there are any.
    pub fn default_tag(&self) -> Option<&str> {
        self.given?.get(ACTUATOR_TAG).map(String::as_str)
    }

    /// Whether the element itself has it.
    pub fn own(&self, name: &str) -> bool {
        self.element.get(name).is_some()
    }

    /// All numbers of an attribute; none where it is missing.
    ///
    /// # Errors
    /// Something else than finite numbers.
    pub fn list(&self, name: &str) -> Result<Option<Vec<f64>>, RobotError> {
        let Some(text) = self.get(name) else {
            return Ok(None);
        };
        let numbers = text.split_whitespace().map(|word| {
            let number = word.parse::<f64>().ok().filter(|v| v.is_finite());
            number.ok_or_else(|| self.wrong(name, &text, "finite numbers are needed"))
        });
        numbers.collect::<Result<_, _>>().map(Some)
    }

    /// Exactly N numbers.
    ///
    /// # Errors
    /// Another number of them, or something else.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, RobotError> {
        let Some(list) = self.list(name)? else {
            return Ok(None);
        };
        let text = self.get(name).unwrap_or_default();
        list.try_into()
            .map(Some)
            .map_err(|_| self.wrong(name, &text, &format!("it needs {N} numbers")))
    }

    /// An attribute as one number.
    ///
    /// # Errors
    /// Not one number.
    pub fn number(&self, name: &str) -> Result<Option<f64>, RobotError> {
        Ok(self.numbers::<1>(name)?.map(|[v]| v))
    }

    /// `true` or `false`; none where it is missing or `auto`.
    ///
    /// # Errors
    /// Another word.
    pub fn flag(&self, name: &str) -> Result<Option<bool>, RobotError> {
        match self.get(name).as_deref() {
            None | Some("auto") => Ok(None),
            Some("true") => Ok(Some(true)),
            Some("false") => Ok(Some(false)),
            Some(other) => Err(self.wrong(name, other, "it is true, false or auto")),
        }
    }

    /// A range in force: where the flag `limited` is on or, without the flag, as `auto` decides.
    ///
    /// # Errors
    /// Not two numbers, or not a flag.
    pub fn range(
        &self,
        limited: &str,
        range: &str,
        auto: bool,
    ) -> Result<Option<[f64; 2]>, RobotError> {
        let given = self.numbers::<2>(range)?;
        let on = self.flag(limited)?.unwrap_or(auto && given.is_some());
        Ok(given.filter(|[low, high]| on && low < high))
    }

    fn wrong(&self, name: &str, text: &str, need: &str) -> RobotError {
        let tag = self.element.tag();
        let owner = match self.element.get("name") {
            Some(own) => format!("{tag} {own:?}"),
            None => format!("<{tag}>"),
        };
        refused(format!("{owner}: {name} is {text:?}; {need}"))
    }
}
