//! Horizontal bars by category.

use super::draw::{Legend, TITLE, fit, horizontal_axis, widest};
use super::scale::{Scale, range};
use super::svg::{Anchor, Svg};
use super::{Figure, Ink};

/// Values by category; several series stand beside each other. Horizontal, so that long names
/// stay readable.
#[derive(Clone, Debug)]
pub struct Bars {
    title: String,
    value_label: String,
    decimals: usize,
    categories: Vec<String>,
    series: Vec<Series>,
}

#[derive(Clone, Debug)]
struct Series {
    name: String,
    ink: Ink,
    bars: Vec<Bar>,
}

#[derive(Clone, Debug)]
struct Bar {
    value: Option<f64>,
    interval: Option<(f64, f64)>,
}

impl Bar {
    const MISSING: Self = Self {
        value: None,
        interval: None,
    };
}

impl Bars {
    /// A chart without series; name the unit in the label.
    pub fn new(
        title: impl Into<String>,
        value_label: impl Into<String>,
        categories: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        Self {
            title: title.into(),
            value_label: value_label.into(),
            decimals: 2,
            categories: categories.into_iter().map(Into::into).collect(),
            series: Vec::new(),
        }
    }

    /// Sets the number of digits after the point of the written values; default 2.
    pub fn decimals(mut self, decimals: usize) -> Self {
        self.decimals = decimals;
        self
    }

    /// Adds a value for each category; `None` for a category without a value.
    pub fn series(mut self, name: &str, ink: Ink, values: &[Option<f64>]) -> Self {
        let bars = values.iter().map(|&value| Bar {
            value: value.filter(|v| v.is_finite()),
            interval: None,
        });
        self.series.push(Series {
            name: name.to_owned(),
            ink,
            bars: bars.collect(),
        });
        self
    }

    /// A value with its interval for each category.
    pub fn series_with_intervals(
        mut self,
        name: &str,
        ink: Ink,
        values: &[(f64, [f64; 2])],
    ) -> Self {
        let bars = values.iter().map(|&(value, [low, high])| Bar {
            value: Some(value).filter(|v| v.is_finite()),
            interval: Some((low, high)).filter(|_| low.is_finite() && high.is_finite()),
        });
        self.series.push(Series {
            name: name.to_owned(),
            ink,
            bars: bars.collect(),
        });
        self
    }

    /// Draws the bars as a figure.
    pub fn draw(&self, caption: impl Into<String>) -> Figure {
        const WIDTH: f64 = 960.0;
        const BAR: f64 = 14.0;
        let left = 14.0 + widest(self.categories.iter().map(String::as_str)).min(280.0);
        let right = WIDTH - 70.0;
        let legend = Legend::new(
            self.series.iter().map(|s| (s.name.as_str(), s.ink)),
            right - left,
        );
        let top = TITLE + legend.height + 2.0;
        let group = BAR * self.series.len().max(1) as f64 + 10.0;
        let bottom = top + group * self.categories.len() as f64;
        let height = bottom + 40.0;

        let bars = self.series.iter().flat_map(|s| &s.bars);
        let values = bars.flat_map(|b| {
            let (low, high) = b.interval.unzip();
            [b.value, low, high].into_iter().flatten()
        });
        let x = Scale::new(range(values.chain([0.0]), false), (left, right), false);

        let mut svg = Svg::new(WIDTH, height, &self.title);
        svg.text("ft", (2.0, 15.0), Anchor::Start, &self.title);
        legend.draw(&mut svg, left, TITLE);
        horizontal_axis(&mut svg, &x, &x.ticks(8), (top, bottom), true);
        for (c, category) in self.categories.iter().enumerate() {
            let upper = top + group * c as f64 + 5.0;
            let middle = upper + (group - 10.0) / 2.0;
            svg.text(
                "t",
                (left - 8.0, middle + 4.0),
                Anchor::End,
                &fit(category, 280.0),
            );
            for (s, series) in self.series.iter().enumerate() {
                let bar = series.bars.get(c).unwrap_or(&Bar::MISSING);
                let y = upper + BAR * s as f64;
                self.draw_bar(&mut svg, &x, y, series.ink, bar);
            }
        }
        svg.line("a", (x.at(0.0), top), (x.at(0.0), bottom));
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

    fn draw_bar(&self, svg: &mut Svg, x: &Scale, y: f64, ink: Ink, bar: &Bar) {
        let Some(value) = bar.value else {
            svg.text("t", (x.at(0.0) + 5.0, y + 11.0), Anchor::Start, "–");
            return;
        };
        let (zero, end) = (x.at(0.0), x.at(value));
        let class = format!("f {}", ink.class());
        svg.rect(&class, (zero.min(end), y + 1.0), ((end - zero).abs(), 12.0));
        let mut edge = zero.max(end);
        if let Some((low, high)) = bar.interval {
            let (low, high) = (x.at(low), x.at(high));
            svg.line("e", (low, y + 7.0), (high, y + 7.0));
            for at in [low, high] {
                svg.line("e", (at, y + 3.5), (at, y + 10.5));
            }
            edge = edge.max(high);
        }
        // Adding zero takes the sign off a rounded minus zero.
        let scale = 10_f64.powi(self.decimals as i32);
        let text = format!(
            "{:.*}",
            self.decimals,
            (value * scale).round() / scale + 0.0
        );
        let text = text.replace('-', "−");
        svg.text("t", (edge + 5.0, y + 11.0), Anchor::Start, &text);
    }
}
