//! Files of an MJCF, seen as one tree: an `<include>` is replaced by the file's content.

use super::refusal::refused;
use crate::robot::RobotError;
use crate::robot::format::xml;
use roxmltree::{Attribute, Document, Node};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Largest number of files of one model.
const MOST_FILES: usize = 1000;

/// File of the model, with its text.
#[derive(Clone, Debug)]
pub(super) struct File {
    /// Path of the file; empty for a text without a file.
    pub path: PathBuf,
    /// Index of the file that includes the file; none for the main one.
    pub parent: Option<usize>,
    /// Text of this file alone, every byte as given: edits are made in it. Included files have their own.
    pub text: String,
    /// The text as a parser of XML accepts it, every byte in its place.
    readable: String,
}

impl File {
    fn new(path: &Path, parent: Option<usize>, text: String) -> Self {
        Self {
            path: path.to_owned(),
            parent,
            readable: xml::readable(&text).into_owned(),
            text,
        }
    }

    /// Same file with another text.
    pub fn with_text(&self, text: String) -> Self {
        Self::new(&self.path, self.parent, text)
    }
}

/// All files of a model, the main one first.
#[derive(Clone, Debug)]
pub(super) struct Sources {
    pub files: Vec<File>,
}

impl Sources {
    /// Reads a file and the files that it includes. As in MuJoCo, the path of an included file is relative to
    /// the main file or, if no such file exists, to the file that includes it. No file may be included twice.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        let mut files = vec![File::new(path, None, text_of(path)?)];
        let folder = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
        let main = folder(path);
        let mut next = 0;
        while next < files.len() {
            for refers in included(&files[next])? {
                let name = &refers.0;
                let near = [main.join(name), folder(&files[next].path).join(name)];
                let found = near.iter().find(|p| p.is_file()).unwrap_or(&near[0]);
                if !refers.1 && files.iter().any(|f| f.path == *found) {
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
                files.push(File::new(found, Some(next), text_of(found)?));
            }
            next += 1;
        }
        Ok(Self { files })
    }

    /// A text of its own, which cannot include anything.
    pub fn of_text(text: &str) -> Result<Self, RobotError> {
        let file = File::new(Path::new(""), None, text.to_owned());
        match included(&file)?.first() {
            Some((name, _)) => Err(refused(format!(
                "it includes {name:?}, but was not read from a file that this could lie beside"
            ))),
            None => Ok(Self { files: vec![file] }),
        }
    }

    /// Parses all files of the model.
    pub fn documents(&self) -> Result<Documents<'_>, RobotError> {
        let documents: Vec<Document<'_>> =
            self.files.iter().map(parse).collect::<Result<_, _>>()?;
        let mut includes = HashMap::new();
        for (file, document) in documents.iter().enumerate() {
            let children = (0..self.files.len()).filter(|&k| self.files[k].parent == Some(file));
            let elements = document.descendants().filter(refers);
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
    xml::parse(&file.readable).map_err(|error| match file.parent {
        Some(_) => RobotError::InFile {
            path: file.path.clone(),
            source: Box::new(error),
        },
        None => error,
    })
}

/// Whether an element refers to another file: an `<include>`, or a model to be attached.
fn refers(node: &Node<'_, '_>) -> bool {
    node.has_tag_name("include") || attaches(node)
}

fn attaches(node: &Node<'_, '_>) -> bool {
    let asset = node.parent().is_some_and(|p| p.has_tag_name("asset"));
    asset && node.has_tag_name("model") && node.has_attribute("file")
}

/// Files that a file refers to, in order, and whether each is a model to be attached, which may be named more than once.
fn included(file: &File) -> Result<Vec<(String, bool)>, RobotError> {
    let document = parse(file)?;
    let elements = document.descendants().filter(refers);
    elements
        .map(|node| match node.attribute("file") {
            Some(name) if !name.is_empty() => Ok((name.to_owned(), attaches(&node))),
            _ => Err(refused("an <include> names no file; add file=\"…\"")),
        })
        .collect()
}

/// Parsed files of a model, linked by their includes.
pub(super) struct Documents<'t> {
    documents: Vec<Document<'t>>,
    /// Index of the file that an element refers to, by the element's file and its position in the text.
    includes: HashMap<(usize, usize), usize>,
}

impl<'t> Documents<'t> {
    /// Root element of the main file.
    pub fn root(&self) -> Element<'_, 't> {
        Element {
            documents: self,
            file: 0,
            node: self.documents[0].root_element(),
        }
    }

    /// Elements of a file that refer to others, with the indices of those.
    pub fn includes(&self, file: usize) -> Vec<(Element<'_, 't>, usize)> {
        let nodes = self.documents[file].descendants();
        nodes
            .filter_map(|node| {
                let child = self.includes.get(&(file, node.range().start))?;
                refers(&node).then_some((
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
    /// Tag of the element, such as `joint`.
    pub fn tag(&self) -> &'t str {
        self.node.tag_name().name()
    }

    /// Text of an attribute, where the element has it.
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
            match element.file_root() {
                Some(root) if element.tag() == "include" => {
                    open.extend(root.own().into_iter().rev());
                }
                _ => found.push(element),
            }
        }
        found
    }

    /// Root of the file that the element refers to.
    pub fn file_root(&self) -> Option<Self> {
        let place = (self.file, self.node.range().start);
        let &file = self.documents.includes.get(&place)?;
        Some(Self {
            documents: self.documents,
            file,
            node: self.documents.documents[file].root_element(),
        })
    }

    /// Children of the element with this tag.
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
