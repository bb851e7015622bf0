//! A quantity that shrinks step by step.

use super::Figure;
use super::draw::{TITLE, fit, horizontal_axis, widest};
use super::scale::{Scale, range};
use super::svg::{Anchor, Svg};

/// Ladder of a diagnosis: the error left after each step, and the part that each step removed. Steps stand
/// below each other, the first at the top.
#[derive(Clone, Debug)]
pub struct Waterfall {
    title: String,
    value_label: String,
    decimals: usize,
    steps: Vec<(String, f64)>,
    floor: Option<(String, f64)>,
}

impl Waterfall {
    /// A ladder without steps; name the unit in the label.
    pub fn new(title: impl Into<String>, value_label: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            value_label: value_label.into(),
            decimals: 3,
            steps: Vec::new(),
            floor: None,
        }
    }

    /// Sets the number of digits after the point of the written values; default 3.
    pub fn decimals(mut self, decimals: usize) -> Self {
        self.decimals = decimals;
        self
    }

    /// Adds a step with the value left after it; a value that is not finite is left out.
    pub fn step(mut self, name: impl Into<String>, left: f64) -> Self {
        if left.is_finite() {
            self.steps.push((name.into(), left));
        }
        self
    }

    /// A line below which no model can come, as the repeatability.
    pub fn floor(mut self, name: impl Into<String>, value: f64) -> Self {
        self.floor = Some((name.into(), value)).filter(|f| f.1.is_finite());
        self
    }

    /// Figure of the ladder as SVG: one bar for each step, with the error left and the part removed or added.
    pub fn draw(&self, caption: impl Into<String>) -> Figure {
        const WIDTH: f64 = 960.0;
        const ROW: f64 = 30.0;
        let left = 14.0 + widest(self.steps.iter().map(|s| s.0.as_str())).min(300.0);
        let right = WIDTH - 130.0;
        let top = TITLE + if self.floor.is_some() { 22.0 } else { 6.0 };
        let bottom = top + ROW * self.steps.len() as f64;
        let height = bottom + 40.0;
        let floor = self.floor.iter().map(|f| f.1);
        let values = self.steps.iter().map(|s| s.1).chain(floor).chain([0.0]);
        let x = Scale::new(range(values, false), (left, right), false);

        let mut svg = Svg::new(WIDTH, height, &self.title);
        svg.text("ft", (2.0, 15.0), Anchor::Start, &self.title);
        horizontal_axis(&mut svg, &x, &x.ticks(8), (top, bottom), true);
        let number = |v: f64| format!("{v:.*}", self.decimals).replace('-', "−");
        let mut before: Option<f64> = None;
        for (i, (name, value)) in self.steps.iter().enumerate() {
            let y = top + ROW * i as f64;
            let (zero, end) = (x.at(0.0), x.at(*value));
            svg.text("t", (left - 8.0, y + 19.0), Anchor::End, &fit(name, 300.0));
            svg.rect("f kr", (zero.min(end), y + 6.0), ((end - zero).abs(), 18.0));
            let mut text = number(*value);
            let mut edge = zero.max(end);
            if let Some(before) = before {
                let start = x.at(before);
                let class = if *value <= before { "f kg" } else { "f kb" };
                svg.rect(
                    class,
                    (start.min(end), y + 6.0),
                    ((start - end).abs(), 18.0),
                );
                edge = edge.max(start);
                if before != 0.0 {
                    let change = 100.0 * (value - before) / before.abs();
                    let change = format!("{change:+.0} %").replace('-', "−");
                    text = format!("{text}  ({change})");
                }
            }
            if i + 1 < self.steps.len() {
                svg.line("m", (end, y + 24.0), (end, y + ROW + 6.0));
            }
            svg.text("t", (edge + 6.0, y + 19.0), Anchor::Start, &text);
            before = Some(*value);
        }
        svg.line("a", (x.at(0.0), top), (x.at(0.0), bottom));
        if let Some((name, value)) = &self.floor {
            let at = x.at(*value);
            svg.line("w", (at, top - 4.0), (at, bottom));
            let text = format!("{name} {}", number(*value));
            svg.text("t", (at, top - 8.0), Anchor::Middle, &text);
        }
        svg.text(
            "l",
            ((left + right) / 2.0, height - 4.0),
            Anchor::Middle,
            &self.value_label,
        );
        Figure {
            svg: svg.finish(),
            caption: caption.into(),
            curves: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_removed_and_what_is_added_are_told_apart() {
        let figure = Waterfall::new("Ladder", "NRMSE")
            .step("as_given", 1.0)
            .step("reidentified", 0.5)
            .step("odd", f64::NAN)
            .step("worse", 0.6)
            .floor("repeatability", 0.1)
            .draw("");
        assert_eq!(figure.svg.matches("f kg").count(), 1);
        assert_eq!(figure.svg.matches("f kb").count(), 1);
        assert!(figure.svg.contains("0.500  (−50 %)"));
        assert!(figure.svg.contains("0.600  (+20 %)"));
        assert!(figure.svg.contains("repeatability 0.100"));
    }
}
