//! A table of values as shades.

use super::Figure;
use super::draw::{TITLE, fit, widest};
use super::scale::range;
use super::svg::{Anchor, Svg};

/// Values by row and column, as joint by region; the larger, the stronger the shade. Every cell
/// carries its number, so that colour is not needed to read it.
#[derive(Clone, Debug)]
pub struct HeatMap {
    title: String,
    decimals: usize,
    columns: Vec<String>,
    rows: Vec<(String, Vec<Option<f64>>)>,
}

impl HeatMap {
    /// Heat map without any row.
    pub fn new(
        title: impl Into<String>,
        columns: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        Self {
            title: title.into(),
            decimals: 2,
            columns: columns.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Sets the number of digits after the point; default 2.
    pub fn decimals(mut self, decimals: usize) -> Self {
        self.decimals = decimals;
        self
    }

    /// Adds a row with one value per column; `None` for a column without a value.
    pub fn row(mut self, name: impl Into<String>, values: &[Option<f64>]) -> Self {
        self.rows.push((name.into(), values.to_vec()));
        self
    }

    /// Draws it. Shades run from zero (or the smallest value, where it is negative) to the largest.
    pub fn draw(&self, caption: impl Into<String>) -> Figure {
        const WIDTH: f64 = 960.0;
        const ROW: f64 = 28.0;
        const STRONGEST: f64 = 0.6;
        let left = 14.0 + widest(self.rows.iter().map(|r| r.0.as_str())).min(260.0);
        let top = TITLE + 26.0;
        let cell = (WIDTH - left - 2.0) / self.columns.len().max(1) as f64;
        let height = top + ROW * self.rows.len() as f64 + 6.0;
        let values = || self.rows.iter().flat_map(|r| r.1.iter().flatten().copied());
        let (low, high) = range(values().chain([0.0]), false);

        let mut svg = Svg::new(WIDTH, height, &self.title);
        svg.text("ft", (2.0, 15.0), Anchor::Start, &self.title);
        for (c, name) in self.columns.iter().enumerate() {
            let x = left + cell * (c as f64 + 0.5);
            svg.text("t", (x, top - 8.0), Anchor::Middle, &fit(name, cell - 4.0));
        }
        for (r, (name, row)) in self.rows.iter().enumerate() {
            let y = top + ROW * r as f64;
            svg.text("t", (left - 8.0, y + 18.0), Anchor::End, &fit(name, 260.0));
            for c in 0..self.columns.len() {
                let x = left + cell * c as f64;
                let value = row.get(c).copied().flatten().filter(|v| v.is_finite());
                let (class, shade, text) = match value {
                    Some(v) => {
                        let part = if high > low {
                            (v - low) / (high - low)
                        } else {
                            0.0
                        };
                        let text = format!("{v:.*}", self.decimals).replace('-', "−");
                        ("f kh", 0.04 + (STRONGEST - 0.04) * part, text)
                    }
                    None => ("f kx", 0.08, "–".to_owned()),
                };
                svg.rect_with_opacity(
                    class,
                    (x + 1.0, y + 1.0),
                    (cell - 2.0, ROW - 2.0),
                    Some(shade),
                );
                svg.text("v", (x + cell / 2.0, y + 18.0), Anchor::Middle, &text);
            }
        }
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
    fn shades_run_from_zero_to_the_largest_value() {
        let svg = HeatMap::new("Where", ["slow", "fast", "reversal"])
            .row("joint_1", &[Some(0.0), Some(0.5), None])
            .row("joint_2", &[Some(1.0), Some(f64::NAN)])
            .draw("")
            .svg;
        for shade in ["0.04", "0.32", "0.6"] {
            let cell = format!("fill-opacity=\"{shade}\"");
            assert_eq!(svg.matches(&cell).count(), 1, "{shade}");
        }
        assert_eq!(svg.matches(">–<").count(), 3);
    }
}
