//! Parts that the figures share: title, legend, axes.

use super::Ink;
use super::scale::Scale;
use super::svg::{Anchor, Svg, text_width};

/// Height of the title line, px.
pub(super) const TITLE: f64 = 24.0;

/// Height of a line of the legend, px.
const LEGEND_LINE: f64 = 18.0;

/// Width of a legend's colour sample and the gap behind it, px.
const SWATCH: f64 = 22.0;

/// Names with their inks, flowed into lines of `width`; returns the entries' corners and the height.
pub(super) struct Legend<'a> {
    entries: Vec<(f64, f64, &'a str, Ink)>,
    /// Height of all lines of the legend, px.
    pub(super) height: f64,
}

impl<'a> Legend<'a> {
    /// Legend of the given names; names that repeat count once. A single name needs none: the title names it.
    pub(super) fn new(names: impl Iterator<Item = (&'a str, Ink)>, width: f64) -> Self {
        let mut unique: Vec<(&str, Ink)> = Vec::new();
        for entry in names.filter(|(name, _)| !name.is_empty()) {
            if !unique.contains(&entry) {
                unique.push(entry);
            }
        }
        if unique.len() < 2 {
            return Self {
                entries: Vec::new(),
                height: 0.0,
            };
        }
        let (mut x, mut y) = (0.0, 0.0);
        let mut entries = Vec::new();
        for (name, ink) in unique {
            let needed = SWATCH + text_width(name) + 14.0;
            if x > 0.0 && x + needed > width {
                (x, y) = (0.0, y + LEGEND_LINE);
            }
            entries.push((x, y, name, ink));
            x += needed;
        }
        Self {
            entries,
            height: y + LEGEND_LINE + 4.0,
        }
    }

    pub(super) fn draw(&self, svg: &mut Svg, left: f64, top: f64) {
        for (x, y, name, ink) in &self.entries {
            let (x, y) = (left + x, top + y);
            svg.rect(&format!("f {}", ink.class()), (x, y + 3.0), (14.0, 8.0));
            svg.text("t", (x + SWATCH - 4.0, y + 11.0), Anchor::Start, name);
        }
    }
}

/// Ticks, grid lines and numbers of a vertical axis at `left`, over a plot area that ends at `right`.
pub(super) fn vertical_axis(
    svg: &mut Svg,
    scale: &Scale,
    ticks: &[(f64, String)],
    left: f64,
    right: f64,
) {
    for (value, text) in ticks {
        let y = scale.at(*value);
        svg.line("g", (left, y), (right, y));
        svg.text("t", (left - 6.0, y + 4.0), Anchor::End, text);
    }
}

/// Ticks and grid lines of a horizontal axis between `top` and `bottom`; numbers where `labelled`.
pub(super) fn horizontal_axis(
    svg: &mut Svg,
    scale: &Scale,
    ticks: &[(f64, String)],
    (top, bottom): (f64, f64),
    labelled: bool,
) {
    for (value, text) in ticks {
        let x = scale.at(*value);
        svg.line("g", (x, top), (x, bottom));
        if labelled {
            svg.text("t", (x, bottom + 16.0), Anchor::Middle, text);
        }
    }
}

/// Width that the widest of the texts takes.
pub(super) fn widest<'a>(texts: impl Iterator<Item = &'a str>) -> f64 {
    texts.map(text_width).fold(0.0, f64::max)
}

/// A text in lines of at most a width, broken after commas; a longer part is cut.
pub(super) fn wrap(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for part in text.split_inclusive(", ") {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line}{part}")) <= width => line.push_str(part),
            _ => lines.push(part.to_owned()),
        }
    }
    lines
        .iter()
        .map(|line| fit(line.trim_end(), width))
        .collect()
}

/// A text cut to a width, with an ellipsis where something is left out.
pub(super) fn fit(text: &str, width: f64) -> String {
    if text_width(text) <= width {
        return text.to_owned();
    }
    let mut kept = String::new();
    for c in text.chars() {
        if text_width(&kept) + 2.0 * text_width("…") > width {
            break;
        }
        kept.push(c);
    }
    kept + "…"
}
