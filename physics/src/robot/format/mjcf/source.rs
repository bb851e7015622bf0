//! The files of an MJCF, seen as one tree: an `<include>` stands for what it includes.

use super::refusal::refused;
use crate::robot::RobotError;
use roxmltree::{Attribute, Document, Node};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Files that one model may consist of.
const MOST_FILES: usize = 1000;

/// One file.
#[derive(Clone, Debug)]
pub(super) struct File {
    /// Where it was found; empty for a text without a file.
    pub path: PathBuf,
    /// The file that includes it; none for the main one.
    pub parent: Option<usize>,
    /// What it holds.
    pub text: String,
}

/// All files of a model, the main one first.
#[derive(Clone, Debug)]
pub(super) struct Sources {
    pub files: Vec<File>,
}

impl Sources {
    /// Reads a file and what it includes. As in MuJoCo, the path of an included file is relative to the main file or, where
    /// there is none, to the file that includes it, and no file may be included twice.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        let mut files = vec![File {
            path: path.to_owned(),
            parent: None,
            text: text_of(path)?,
        }];
        let folder = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
        let main = folder(path);
        let mut next = 0;
        while next < files.len() {
            for name in included(&files[next])? {
                let near = [main.join(&name), folder(&files[next].path).join(&name)];
                let found = near.iter().find(|p| p.is_file()).unwrap_or(&near[0]);
                if files.iter().any(|f| f.path == *found) {
                    return Err(refused(format!(
                        "{} is included twice; include every file once",
                        found.display()
                    )));
                }
                if files.len() == MOST_FILES {
                    return Err(refused(format!(
                        "it consists of more than {MOST_FILES} files"
                    )));
                }
                files.push(File {
                    path: found.clone(),
                    parent: Some(next),
                    text: text_of(found)?,
                });
            }
            next += 1;
        }
        Ok(Self { files })
    }

    /// A text of its own, which cannot include anything.
    pub fn of_text(text: &str) -> Result<Self, RobotError> {
        let file = File {
            path: PathBuf::new(),
            parent: None,
            text: text.to_owned(),
        };
        match included(&file)?.first() {
            Some(name) => Err(refused(format!(
                "it includes {name:?}, but was not read from a file that this could lie beside"
            ))),
            None => Ok(Self { files: vec![file] }),
        }
    }

    /// Parses every file.
    pub fn documents(&self) -> Result<Documents<'_>, RobotError> {
        let documents: Vec<Document<'_>> =
            self.files.iter().map(parse).collect::<Result<_, _>>()?;
        let mut includes = HashMap::new();
        for (file, document) in documents.iter().enumerate() {
            let children = (0..self.files.len()).filter(|&k| self.files[k].parent == Some(file));
            let elements = document.descendants().filter(|n| n.has_tag_name("include"));
            for (element, child) in elements.zip(children) {
                includes.insert((file, element.range().start), child);
            }
        }
        Ok(Documents {
            documents,
            includes,
        })
    }
}

fn text_of(path: &Path) -> Result<String, RobotError> {
    std::fs::read_to_string(path).map_err(|source| RobotError::Read {
        path: path.to_owned(),
        source,
    })
}

fn parse(file: &File) -> Result<Document<'_>, RobotError> {
    Document::parse(&file.text).map_err(|e| {
        let place = match file.parent {
            Some(_) => format!("{}: ", file.path.display()),
            None => String::new(),
        };
        refused(format!(
            "{place}it cannot be parsed: {e}; load it in MuJoCo, which says more"
        ))
    })
}

/// What a file includes, in order.
fn included(file: &File) -> Result<Vec<String>, RobotError> {
    let document = parse(file)?;
    let elements = document.descendants();
    let elements = elements.filter(|n| n.has_tag_name("include"));
    elements
        .map(|node| match node.attribute("file") {
            Some(name) if !name.is_empty() => Ok(name.to_owned()),
            _ => Err(refused("an <include> names no file; add file=\"…\"")),
        })
        .collect()
}

/// Parsed files.
pub(super) struct Documents<'t> {
    documents: Vec<Document<'t>>,
    /// What the `<include>` that begins there in a file stands for.
    includes: HashMap<(usize, usize), usize>,
}

impl<'t> Documents<'t> {
    /// Root of the main file.
    pub fn root(&self) -> Element<'_, 't> {
        Element {
            documents: self,
            file: 0,
            node: self.documents[0].root_element(),
        }
    }

    /// The `<include>` elements of a file with the files that they stand for.
    pub fn includes(&self, file: usize) -> Vec<(Element<'_, 't>, usize)> {
        let nodes = self.documents[file].descendants();
        nodes
            .filter_map(|node| {
                let child = self.includes.get(&(file, node.range().start))?;
                let include = node.has_tag_name("include");
                include.then_some((
                    Element {
                        documents: self,
                        file,
                        node,
                    },
                    *child,
                ))
            })
            .collect()
    }
}

/// An element and the file in which it stands.
#[derive(Clone, Copy)]
pub(super) struct Element<'d, 't> {
    documents: &'d Documents<'t>,
    pub file: usize,
    pub node: Node<'d, 't>,
}

impl<'d, 't> Element<'d, 't> {
    /// Tag.
    pub fn tag(&self) -> &'t str {
        self.node.tag_name().name()
    }

    /// An attribute's text.
    pub fn get(&self, name: &str) -> Option<&'d str> {
        self.node.attribute(name)
    }

    /// An attribute with its place.
    pub fn attribute(&self, name: &str) -> Option<Attribute<'d, 't>> {
        self.node.attribute_node(name)
    }

    /// Elements inside, those of included files in the place of `<include>`.
    pub fn children(&self) -> Vec<Self> {
        let mut found = Vec::new();
        let mut open: Vec<Self> = self.own();
        open.reverse();
        while let Some(element) = open.pop() {
            let start = element.node.range().start;
            match self.documents.includes.get(&(element.file, start)) {
                Some(&file) if element.tag() == "include" => {
                    let root = Self {
                        documents: self.documents,
                        file,
                        node: self.documents.documents[file].root_element(),
                    };
                    open.extend(root.own().into_iter().rev());
                }
                _ => found.push(element),
            }
        }
        found
    }

    /// The children with a tag.
    pub fn tagged(&self, tag: &str) -> Vec<Self> {
        let mut children = self.children();
        children.retain(|c| c.tag() == tag);
        children
    }

    fn own(&self) -> Vec<Self> {
        let elements = self.node.children().filter(Node::is_element);
        elements.map(|node| Self { node, ..*self }).collect()
    }
}
