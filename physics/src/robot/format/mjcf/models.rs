//! The models that one scene is made of: the main file's, and those that it attaches.

use super::attributes::{Attributes, Classes};
use super::refusal::refused;
use super::settings::Settings;
use super::source::Element;
use crate::robot::RobotError;

/// Largest depth to which attached models may attach others.
const DEEPEST: usize = 16;

/// A model with its own defaults and compiler settings.
pub(super) struct Model<'d, 't> {
    pub root: Element<'d, 't>,
    pub classes: Classes,
    pub settings: Settings,
    /// Names of the models that it may attach, with their places among all.
    assets: Vec<(String, usize)>,
}

/// All models, the main one first.
pub(super) struct Models<'d, 't> {
    pub all: Vec<Model<'d, 't>>,
}

/// A model as it stands in the scene: attached under a prefix, or the main one under none.
#[derive(Clone)]
pub(super) struct Instance {
    pub model: usize,
    pub prefix: String,
}

impl<'d, 't> Models<'d, 't> {
    pub fn read(root: Element<'d, 't>) -> Result<Self, RobotError> {
        let mut models = Self { all: Vec::new() };
        models.add(root, 0)?;
        Ok(models)
    }

    fn add(&mut self, root: Element<'d, 't>, depth: usize) -> Result<usize, RobotError> {
        if depth > DEEPEST {
            return Err(refused(format!(
                "models are attached to each other deeper than {DEEPEST}"
            )));
        }
        let index = self.all.len();
        self.all.push(Model {
            root,
            classes: Classes::read(root)?,
            settings: Settings::read(root)?,
            assets: Vec::new(),
        });
        for section in root.tagged("asset") {
            for asset in section.tagged("model") {
                let Some(own) = asset.file_root() else {
                    continue;
                };
                let name = asset.get("name").or(own.get("model")).unwrap_or_default();
                let place = self.add(own, depth + 1)?;
                self.all[index].assets.push((name.to_owned(), place));
            }
        }
        Ok(index)
    }

    /// The model that an `<attach>` of model `of` names, and its body; the whole world where none is named.
    pub fn attached(
        &self,
        of: usize,
        attach: Element<'d, 't>,
    ) -> Result<(usize, Vec<Element<'d, 't>>, &'d str), RobotError> {
        let name = attach.get("model").unwrap_or_default();
        let assets = &self.all[of].assets;
        let Some((_, model)) = assets.iter().find(|(own, _)| own == name) else {
            return Err(refused(format!(
                "<attach> names the model {name:?}, which no <asset> holds; add <model name={name:?} file=\"…\"/> to <asset>"
            )));
        };
        let worlds = self.all[*model].root.tagged("worldbody");
        let prefix = attach.get("prefix").unwrap_or_default();
        let Some(body) = attach.get("body") else {
            return Ok((*model, worlds, prefix));
        };
        let mut open = worlds;
        while let Some(element) = open.pop() {
            if element.tag() == "body" && element.get("name") == Some(body) {
                return Ok((*model, vec![element], prefix));
            }
            open.extend(element.children());
        }
        Err(refused(format!(
            "<attach> names the body {body:?}, which the model {name:?} does not hold; correct the name"
        )))
    }
}

impl Model<'_, '_> {
    /// Attributes of an element with this model's defaults.
    pub fn of<'c, 'd, 't>(
        &'c self,
        element: Element<'d, 't>,
        childclass: Option<&str>,
    ) -> Result<Attributes<'c, 'd, 't>, RobotError> {
        self.classes.of(element, childclass)
    }
}
