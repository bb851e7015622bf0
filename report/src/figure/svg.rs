//! A writer of SVG elements.

use crate::xml::shown;
use std::fmt::Write;

/// Collects elements; numbers are written with two decimals at most, text is escaped.
pub(super) struct Svg {
    body: String,
    width: f64,
    height: f64,
    label: String,
}

/// Horizontal anchor of a text.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Svg {
    /// An empty drawing in units of one CSS pixel; `label` is read to those who cannot see it.
    pub(super) fn new(width: f64, height: f64, label: &str) -> Self {
        Self {
            body: String::new(),
            width,
            height,
            label: label.to_owned(),
        }
    }

    pub(super) fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64)) {
        self.body.push_str("<line class=\"");
        self.body.push_str(class);
        for (name, value) in [("x1", from.0), ("y1", from.1), ("x2", to.0), ("y2", to.1)] {
            let _ = write!(self.body, "\" {name}=\"{}", Number(value));
        }
        self.body.push_str("\"/>");
    }

    pub(super) fn circle(&mut self, class: &str, (x, y): (f64, f64), radius: f64) {
        let (x, y, radius) = (Number(x), Number(y), Number(radius));
        let _ = write!(
            self.body,
            "<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>"
        );
    }

    pub(super) fn rect(&mut self, class: &str, corner: (f64, f64), size: (f64, f64)) {
        self.rect_with_opacity(class, corner, size, None);
    }

    pub(super) fn rect_with_opacity(
        &mut self,
        class: &str,
        (x, y): (f64, f64),
        (width, height): (f64, f64),
        opacity: Option<f64>,
    ) {
        let _ = write!(
            self.body,
            "<rect class=\"{class}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"",
            Number(x),
            Number(y),
            Number(width.max(0.0)),
            Number(height.max(0.0)),
        );
        if let Some(opacity) = opacity {
            let _ = write!(self.body, " fill-opacity=\"{}\"", Number(opacity));
        }
        self.body.push_str("/>");
    }

    /// Curves through points; a piece of one point is drawn as a dot by its round cap.
    pub(super) fn polylines(&mut self, class: &str, pieces: &[Vec<(f64, f64)>]) {
        let _ = write!(self.body, "<path class=\"{class}\" d=\"");
        for piece in pieces {
            for (i, &(x, y)) in piece.iter().enumerate() {
                let command = if i == 0 { 'M' } else { 'L' };
                let _ = write!(self.body, "{command}{} {}", Number(x), Number(y));
            }
            if let [(x, y)] = piece[..] {
                let _ = write!(self.body, "L{} {}", Number(x), Number(y));
            }
        }
        self.body.push_str("\"/>");
    }

    /// Draws a filled outline.
    pub(super) fn area(&mut self, class: &str, outline: &[(f64, f64)]) {
        let _ = write!(self.body, "<path class=\"{class}\" d=\"");
        for (i, &(x, y)) in outline.iter().enumerate() {
            let command = if i == 0 { 'M' } else { 'L' };
            let _ = write!(self.body, "{command}{} {}", Number(x), Number(y));
        }
        self.body.push_str("Z\"/>");
    }

    /// Dots: zero-length strokes with round caps, a tenth of the bytes of circles.
    pub(super) fn dots(&mut self, class: &str, points: &[(f64, f64)]) {
        let _ = write!(self.body, "<path class=\"{class}\" d=\"");
        for &(x, y) in points {
            let _ = write!(self.body, "M{} {}h0", Number(x), Number(y));
        }
        self.body.push_str("\"/>");
    }

    pub(super) fn text(&mut self, class: &str, (x, y): (f64, f64), anchor: Anchor, text: &str) {
        self.open_text(class, (x, y), anchor);
        let _ = write!(self.body, ">{}</text>", shown(text));
    }

    /// Text read from bottom to top, around its middle.
    pub(super) fn upward_text(&mut self, class: &str, (x, y): (f64, f64), text: &str) {
        self.open_text(class, (x, y), Anchor::Middle);
        let (x, y) = (Number(x), Number(y));
        let _ = write!(
            self.body,
            " transform=\"rotate(-90 {x} {y})\">{}</text>",
            shown(text)
        );
    }

    fn open_text(&mut self, class: &str, (x, y): (f64, f64), anchor: Anchor) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let _ = write!(
            self.body,
            "<text class=\"{class}\" x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\"",
            Number(x),
            Number(y)
        );
    }

    pub(super) fn finish(self) -> String {
        let (width, height) = (Number(self.width), Number(self.height));
        let label = shown(&self.label);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{label}\">{}</svg>",
            self.body
        )
    }
}

/// A number with two decimals, without trailing zeros; a value that is not finite becomes 0, so that a drawing never breaks.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hundredths = (self.0 * 100.0).round();
        if !hundredths.is_finite() || hundredths == 0.0 {
            return f.write_str("0");
        }
        // f64's own Display is the shortest text that reads back, so at most two decimals here.
        write!(f, "{}", hundredths / 100.0)
    }
}

/// Width of a text in px at the figures' font size of 12 px: a proportional font's average, rounded up.
pub(super) fn text_width(text: &str) -> f64 {
    use unicode_width::UnicodeWidthStr;
    6.8 * text.width() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_never_break_the_drawing() {
        let shown = |x: f64| Number(x).to_string();
        assert_eq!(shown(12.0), "12");
        assert_eq!(shown(12.3456), "12.35");
        assert_eq!(shown(-0.001), "0");
        assert_eq!(shown(f64::NAN), "0");
        assert_eq!(shown(1e9), "1000000000");
    }
}
