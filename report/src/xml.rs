//! Text in XML.

/// Text as XML character data or attribute value for who looks at it: breaks become spaces, characters that XML cannot carry U+FFFD.
pub(crate) fn shown(text: &str) -> String {
    escaped(text, |_| " ".into())
}

/// Text as the value of an attribute that a program reads back: breaks stand as references, for a reader takes those that stand as they
/// are for spaces; characters that XML cannot carry become U+FFFD.
pub fn attribute(text: &str) -> String {
    escaped(text, |c| format!("&#{};", u32::from(c)))
}

fn escaped(text: &str, of_break: impl Fn(char) -> String) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push_str(&of_break(c)),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_text_is_escaped() {
        assert_eq!(
            shown("<a href='x'>&\"\n\u{1b}"),
            "&lt;a href=&#39;x&#39;&gt;&amp;&quot; \u{fffd}"
        );
    }

    #[test]
    fn a_reader_gets_the_name_back() {
        let name = "a<b> & \"c\"\t'd'\n\u{85}";
        let read = |name: &str| {
            let text = format!("<x name=\"{}\"/>", attribute(name));
            let parsed = roxmltree::Document::parse(&text).unwrap();
            parsed.root_element().attribute("name").map(str::to_owned)
        };
        assert_eq!(read(name).as_deref(), Some(name));
        assert_eq!(read("a\u{1b}b").as_deref(), Some("a\u{fffd}b"));
    }
}
