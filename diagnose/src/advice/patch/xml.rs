//! Text in XML.

/// A name as the value of an attribute: a reader takes line ends and tabs that stand as they are for spaces.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push_str(&format!("&#{};", u32::from(c))),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_reader_gets_the_name_back() {
        let name = "a<b & \"c\"\td";
        let text = format!("<x name=\"{}\"/>", super::escape(name));
        let parsed = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(parsed.root_element().attribute("name"), Some(name));
    }
}
