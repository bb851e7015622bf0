//! Changed attributes in the text of the files that hold them.

use super::refusal::refused;
use super::source::{Element, Sources};
use crate::robot::RobotError;
use std::collections::HashSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Changes of a model's files.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    /// Edits: index of the file, range in its text, and replacement.
    edits: Vec<(usize, Range<usize>, String)>,
    /// Changes that have no place in the files.
    pub left_out: Vec<String>,
}

impl Changes {
    /// Gives an element's attribute a value.
    pub fn set(&mut self, element: Element<'_, '_>, name: &str, value: &str) {
        match element.attribute(name) {
            Some(old) => self.put(element.file, old.range_value(), value.to_owned()),
            None => {
                let at = after_attributes(element);
                self.put(element.file, at..at, format!(" {name}=\"{value}\""));
            }
        }
    }

    /// Gives an attribute another name and value.
    pub fn replace(&mut self, element: Element<'_, '_>, old: &str, name: &str, value: &str) {
        if let Some(old) = element.attribute(old) {
            self.put(element.file, old.range(), format!("{name}=\"{value}\""));
        }
    }

    /// Takes an attribute away, with the space before it.
    pub fn remove(&mut self, element: Element<'_, '_>, name: &str) {
        if let Some(old) = element.attribute(name) {
            let text = element.node.document().input_text();
            let before = text[..old.range().start].trim_end().len();
            self.put(element.file, before..old.range().end, String::new());
        }
    }

    /// Puts a new element in front of an element's children.
    pub fn add_first(&mut self, element: Element<'_, '_>, new: &str) {
        match element.node.first_child() {
            Some(first) => {
                let space = first
                    .text()
                    .filter(|t| first.is_text() && t.trim().is_empty());
                let at = first.range().start;
                let indent = space.unwrap_or_default();
                self.put(element.file, at..at, format!("{indent}{new}"));
            }
            None => {
                let (tag, range) = (element.tag(), element.node.range());
                let at = after_attributes(element);
                self.put(element.file, at..range.end, format!(">{new}</{tag}>"));
            }
        }
    }

    /// Puts a new element behind an element's children.
    pub fn add_last(&mut self, element: Element<'_, '_>, new: &str) {
        match element.node.last_element_child() {
            Some(last) => {
                let at = last.range().end;
                let space = last.prev_sibling().and_then(|n| n.text());
                let indent = space.filter(|t| t.trim().is_empty()).unwrap_or_default();
                self.put(element.file, at..at, format!("{indent}{new}"));
            }
            None => self.add_first(element, new),
        }
    }

    /// Copies of one element change it once.
    fn put(&mut self, file: usize, range: Range<usize>, text: String) {
        let edit = (file, range, text);
        if edit.1.is_empty() || !self.edits.contains(&edit) {
            self.edits.push(edit);
        }
    }
}

/// Position in the text at which a further attribute is inserted.
fn after_attributes(element: Element<'_, '_>) -> usize {
    let last = element.node.attributes().next_back();
    last.map_or_else(
        || element.node.range().start + 1 + element.tag().len(),
        |a| a.range().end,
    )
}

/// A model's files with changed attributes.
#[derive(Clone, Debug)]
pub struct Edited {
    sources: Sources,
    changes: Changes,
}

impl Edited {
    pub(super) fn new(sources: Sources, changes: Changes) -> Self {
        Self { sources, changes }
    }

    /// The changed files under the names of the given ones.
    pub(super) fn sources(&self) -> Result<Sources, RobotError> {
        let mut sources = self.sources.clone();
        for (k, file) in sources.files.iter_mut().enumerate() {
            let edits = self.changes.edits.iter().filter(|e| e.0 == k);
            let edits = edits.map(|e| (&e.1, &e.2)).collect();
            *file = file.with_text(applied(&file.text, edits)?);
        }
        Ok(sources)
    }

    /// Changes that have no place in the files; one line each.
    pub fn left_out(&self) -> &[String] {
        &self.changes.left_out
    }

    /// Files to write when the main one is to be `out`, that one first. A changed included file goes beside it,
    /// its name behind the main one's. An unchanged file is included from where it is, so that `out` should lie
    /// in the folder of the model.
    ///
    /// # Errors
    /// Files that no longer parse.
    pub fn files(&self, out: &Path) -> Result<Vec<(PathBuf, String)>, RobotError> {
        let files = &self.sources.files;
        let mut changed: HashSet<usize> = self.changes.edits.iter().map(|e| e.0).collect();
        changed.insert(0);
        // What includes a changed file changes too; included files come after.
        for file in (1..files.len()).rev() {
            if changed.contains(&file) {
                changed.extend(files[file].parent);
            }
        }
        let names = self.names(out, &changed);
        let folder = files[0].path.parent().unwrap_or(Path::new(""));
        let documents = self.sources.documents()?;
        let mut written = Vec::new();
        for (file, name) in names.iter().enumerate() {
            let Some(name) = name else { continue };
            let mut own = Changes::default();
            for (element, child) in documents.includes(file) {
                match &names[child] {
                    Some(new) => own.set(element, "file", new),
                    // It may have been found beside the file that moves.
                    None if file > 0 => {
                        if let Ok(place) = files[child].path.strip_prefix(folder) {
                            own.set(element, "file", &place.to_string_lossy());
                        }
                    }
                    None => {}
                }
            }
            let edits = self.changes.edits.iter().chain(&own.edits);
            let edits = edits.filter(|e| e.0 == file);
            let text = applied(&files[file].text, edits.map(|e| (&e.1, &e.2)).collect())?;
            let path = if file == 0 {
                out.to_owned()
            } else {
                out.with_file_name(name)
            };
            written.push((path, text));
        }
        Ok(written)
    }

    /// Name of each changed file in the output; none for a file that is unchanged.
    fn names(&self, out: &Path, changed: &HashSet<usize>) -> Vec<Option<String>> {
        let stem = out.file_stem().map(|s| s.to_string_lossy().into_owned());
        let stem = stem.unwrap_or_default();
        let mut names: Vec<Option<String>> = Vec::new();
        for (i, file) in self.sources.files.iter().enumerate() {
            let own = file.path.file_name().map(|n| n.to_string_lossy());
            let mut name = format!("{stem}.{}", own.unwrap_or_default());
            if names.iter().flatten().any(|n| *n == name) {
                name = format!("{stem}.{i}.{}", file.path.display()).replace(['/', '\\'], "_");
            }
            names.push(changed.contains(&i).then_some(name));
        }
        names
    }
}

/// A text with some places replaced; of several insertions at one place the first comes first.
fn applied(text: &str, mut edits: Vec<(&Range<usize>, &String)>) -> Result<String, RobotError> {
    edits.sort_by_key(|(range, _)| range.start);
    let (mut out, mut at) = (String::with_capacity(text.len()), 0);
    for (range, new) in edits {
        let kept = text.get(at..range.start).ok_or_else(|| {
            refused("two changes fall into one place; report the model to the authors")
        })?;
        out.push_str(kept);
        out.push_str(new);
        at = range.end;
    }
    out.push_str(text.get(at..).unwrap_or_default());
    Ok(out)
}
