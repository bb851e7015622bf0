//! XML as descriptions of robots are written, which is looser than its grammar.

use crate::robot::RobotError;
use roxmltree::{Document, Error, Node};
use std::borrow::Cow;

/// The text as a parser of XML takes it, every byte in its place: two dashes within a comment, which the parsers of ROS and
/// MuJoCo read over, become blanks.
pub(super) fn readable(text: &str) -> Cow<'_, str> {
    let mut clean = Cow::Borrowed(text);
    let mut at = 0;
    while let Some(start) = text[at..].find("<!") {
        let start = at + start;
        let (opening, closing) = if text[start..].starts_with("<!--") {
            ("<!--", "-->")
        } else if text[start..].starts_with("<![CDATA[") {
            ("<![CDATA[", "]]>")
        } else {
            at = start + 2;
            continue;
        };
        let inside = start + opening.len();
        let Some(length) = text[inside..].find(closing) else {
            break;
        };
        let end = inside + length;
        let comment = &text[inside..end];
        if opening == "<!--" && (comment.contains("--") || comment.ends_with('-')) {
            let blank = comment.replace('-', " ");
            clean.to_mut().replace_range(inside..end, &blank);
        }
        at = end + closing.len();
    }
    clean
}

/// Parses a text that is [`readable`].
///
/// # Errors
/// [`RobotError::Syntax`] with the line and what to do.
pub(super) fn parse(text: &str) -> Result<Document<'_>, RobotError> {
    Document::parse(text).map_err(|error| {
        let remedy = match &error {
            Error::UnknownNamespace(prefix, _) if prefix == "xacro" => {
                return RobotError::Xacro { file: None };
            }
            Error::UnknownNamespace(prefix, _) => format!(
                "declare the prefix in the outermost element, xmlns:{prefix}=\"{prefix}\", or take its elements out"
            ),
            Error::DuplicatedAttribute(..) => "keep one of the two attributes".to_owned(),
            Error::UnclosedRootNode | Error::NoRootNode | Error::UnexpectedEndOfStream => {
                "the file is empty or cut off: copy it again".to_owned()
            }
            Error::UnexpectedCloseTag(expected, ..) => {
                format!("close <{expected}> first")
            }
            _ => "correct the line".to_owned(),
        };
        RobotError::Syntax {
            line: error.pos().row,
            reason: error.to_string(),
            remedy,
        }
    })
}

/// Line on which an element begins, from 1.
pub(super) fn line(node: Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

/// An element as a message names it: its tag, and its name where it has one.
pub(super) fn label(node: Node<'_, '_>) -> String {
    let tag = node.tag_name().name();
    match node.attribute("name") {
        Some(name) => format!("<{tag} name={name:?}>"),
        None => format!("<{tag}>"),
    }
}

/// Error of an element: problem and remedy.
pub(super) fn wrong(node: Node<'_, '_>, problem: String, remedy: &str) -> RobotError {
    RobotError::Element {
        line: line(node),
        element: label(node),
        problem,
        remedy: remedy.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_in_comments_are_read_over_in_place() {
        let text = "<a><!-- x -- y --><b/><!----- c ---><![CDATA[<!-- -- -->]]><!-- fine --></a>";
        let clean = readable(text);
        assert_eq!(clean.len(), text.len());
        assert_eq!(clean.find("<b/>"), text.find("<b/>"));
        assert!(clean.contains("<![CDATA[<!-- -- -->]]>"));
        assert!(parse(&clean).is_ok());
        assert!(matches!(readable("<a><!-- fine --></a>"), Cow::Borrowed(_)));
    }

    #[test]
    fn a_broken_text_is_named_by_its_line() {
        for (text, expected) in [
            ("<robot>\n<gz:plugin/></robot>", "line 2"),
            ("<robot>\n<a x=\"1\" x=\"2\"/></robot>", "keep one"),
            ("<robot>\n<link>\n</robot>", "close <link> first"),
            ("", "cut off"),
        ] {
            let error = parse(text).map(|_| ()).expect_err(text).to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
