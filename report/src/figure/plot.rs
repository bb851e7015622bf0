//! Curves, points and bands over a shared horizontal axis.

use super::bins::Bins;
use super::curves::{Axes, Curve, Curves};
use super::decimate::{MAX_POINTS, ZOOMED_POINTS, extremes, thin};
use super::draw::{Legend, TITLE, horizontal_axis, vertical_axis, widest};
use super::scale::{Scale, padded, range};
use super::svg::{Anchor, Svg};
use super::{Figure, Ink};
use std::ops::Range;

/// One or several panels above each other over the same horizontal axis.
///
/// ```
/// use report::figure::{Ink, Panel, Plot};
/// let time: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
/// let torque: Vec<f64> = time.iter().map(|t| (6.0 * t).sin()).collect();
/// let figure = Plot::new("Elbow", "time / s")
///     .panel(Panel::new("torque / N·m").line("measured", Ink::Measured, &time, &torque))
///     .draw("One second of motion.");
/// assert!(figure.svg.starts_with("<svg"));
/// ```
#[derive(Clone, Debug)]
pub struct Plot {
    title: String,
    x_label: String,
    log_x: bool,
    width: f64,
    zoom: bool,
    panels: Vec<Panel>,
}

/// One pair of axes of a [`Plot`].
#[derive(Clone, Debug)]
pub struct Panel {
    y_label: String,
    log_y: bool,
    height: f64,
    layers: Vec<Layer>,
}

#[derive(Clone, Debug)]
struct Layer {
    name: String,
    ink: Ink,
    shape: Shape,
}

#[derive(Clone, Debug)]
enum Shape {
    /// Curves without a connection between them.
    Curves(Vec<Vec<(f64, f64)>>),
    Points(Vec<(f64, f64)>),
    /// Band between two curves: (x, low, high).
    Band(Vec<(f64, f64, f64)>),
}

impl Panel {
    /// An empty panel; name the unit in the label, as in `torque / N·m`.
    pub fn new(y_label: impl Into<String>) -> Self {
        Self {
            y_label: y_label.into(),
            log_y: false,
            height: 220.0,
            layers: Vec::new(),
        }
    }

    /// Height of the plot area in CSS pixels; default 220.
    pub fn height(mut self, pixels: f64) -> Self {
        self.height = pixels.clamp(40.0, 2000.0);
        self
    }

    /// Makes the vertical axis logarithmic; values that are not positive are left out.
    pub fn log(mut self) -> Self {
        self.log_y = true;
        self
    }

    /// A curve. It is interrupted where x or y is not finite; beyond [`MAX_POINTS`] it is thinned
    /// so that extremes survive.
    pub fn line(self, name: &str, ink: Ink, x: &[f64], y: &[f64]) -> Self {
        self.segments(name, ink, x, y, std::slice::from_ref(&(0..x.len())))
    }

    /// Curves over these row ranges (trajectories), without a connection between them.
    pub fn segments(
        mut self,
        name: &str,
        ink: Ink,
        x: &[f64],
        y: &[f64],
        rows: &[Range<usize>],
    ) -> Self {
        let rows = rows
            .iter()
            .map(|r| r.start.min(x.len().min(y.len()))..r.end.min(x.len().min(y.len())))
            .flat_map(|r| finite_runs(x, y, r))
            .collect::<Vec<_>>();
        let pieces = rows
            .into_iter()
            .map(|r| r.map(|i| (x[i], y[i])).collect())
            .collect();
        let pieces = thinned(pieces, ZOOMED_POINTS);
        self.layers.push(Layer {
            name: name.to_owned(),
            ink,
            shape: Shape::Curves(pieces),
        });
        self
    }

    /// A cloud of points; where many fall on one spot, one is drawn.
    pub fn points(mut self, name: &str, ink: Ink, x: &[f64], y: &[f64]) -> Self {
        let points = std::iter::zip(x, y)
            .map(|(&x, &y)| (x, y))
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .collect();
        self.layers.push(Layer {
            name: name.to_owned(),
            ink,
            shape: Shape::Points(points),
        });
        self
    }

    /// The area between `low` and `high`.
    pub fn band(mut self, name: &str, ink: Ink, x: &[f64], low: &[f64], high: &[f64]) -> Self {
        let edges = std::iter::zip(x, std::iter::zip(low, high))
            .map(|(&x, (&low, &high))| (x, low, high))
            .filter(|(x, low, high)| x.is_finite() && low.is_finite() && high.is_finite())
            .collect();
        self.layers.push(Layer {
            name: name.to_owned(),
            ink,
            shape: Shape::Band(edges),
        });
        self
    }

    /// Adds the mean of `y` in `bins` equal bins of `x` as a curve, with a band of one standard deviation. Bins
    /// of fewer than five samples are left out, and where two or more of them follow each other the curve is
    /// interrupted.
    pub fn binned(self, name: &str, ink: Ink, x: &[f64], y: &[f64], bins: usize) -> Self {
        let b = Bins::of(x, y, bins);
        let edge = |sign: f64| -> Vec<f64> {
            std::iter::zip(&b.mean, &b.std)
                .map(|(m, s)| m + sign * s)
                .collect()
        };
        let (low, high) = (edge(-1.0), edge(1.0));
        let banded = b.runs.iter().fold(self, |panel, run| {
            let r = run.clone();
            panel.band(name, ink, &b.center[r.clone()], &low[r.clone()], &high[r])
        });
        banded.segments(name, ink, &b.center, &b.mean, &b.runs)
    }

    /// All coordinates of one kind: x, or y.
    fn values(&self, x: bool) -> impl Iterator<Item = f64> + '_ {
        self.layers.iter().flat_map(move |layer| {
            let values: Vec<f64> = match &layer.shape {
                Shape::Curves(pieces) => pieces
                    .iter()
                    .flatten()
                    .map(|p| if x { p.0 } else { p.1 })
                    .collect(),
                Shape::Points(points) => points.iter().map(|p| if x { p.0 } else { p.1 }).collect(),
                Shape::Band(edges) if x => edges.iter().map(|e| e.0).collect(),
                Shape::Band(edges) => edges.iter().flat_map(|e| [e.1, e.2]).collect(),
            };
            values
        })
    }

    /// Curves of the panel as data.
    fn axes(&self) -> Axes<'_> {
        Axes {
            label: &self.y_label,
            height: self.height,
            layers: self.layers.iter().filter_map(Layer::curve).collect(),
        }
    }

    fn y_scale(&self, top: f64) -> Scale {
        let found = range(self.values(false), self.log_y);
        let found = if self.log_y {
            found
        } else {
            padded(found, 0.06)
        };
        Scale::new(found, (top + self.height, top), self.log_y)
    }
}

impl Plot {
    /// A plot without panels; name the unit in the label, as in `time / s`.
    pub fn new(title: impl Into<String>, x_label: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            log_x: false,
            width: 960.0,
            zoom: false,
            panels: Vec::new(),
        }
    }

    /// Makes the curves zoomable where the browser runs scripts; plots with the same horizontal axis share the
    /// range shown. Panels may have curves alone, on linear axes.
    pub fn zoomable(mut self) -> Self {
        self.zoom = true;
        self
    }

    /// Half the page's width, for figures side by side.
    pub fn half_width(mut self) -> Self {
        self.width = 470.0;
        self
    }

    /// Makes the horizontal axis logarithmic.
    pub fn log_x(mut self) -> Self {
        self.log_x = true;
        self
    }

    /// Adds a panel below the others.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// Curves of the plot as data.
    fn curves(&self) -> Curves<'_> {
        Curves {
            title: &self.title,
            x: &self.x_label,
            panels: self.panels.iter().map(Panel::axes).collect(),
        }
    }

    /// Draws the plot as a figure.
    pub fn draw(&self, caption: impl Into<String>) -> Figure {
        let names = self.panels.iter().flat_map(|p| &p.layers);
        let legend = Legend::new(names.map(|l| (l.name.as_str(), l.ink)), self.width - 60.0);
        let mut top = TITLE + legend.height + 4.0;
        let height = top + self.panels.iter().map(|p| p.height + 14.0).sum::<f64>() + 32.0;

        let scales: Vec<(Scale, Vec<(f64, String)>)> = self
            .panels
            .iter()
            .map(|panel| {
                let scale = panel.y_scale(top);
                top += panel.height + 14.0;
                let ticks = scale.ticks((panel.height / 36.0) as usize);
                (scale, ticks)
            })
            .collect();
        let numbers = scales.iter().flat_map(|s| s.1.iter().map(|t| t.1.as_str()));
        let left = 30.0 + widest(numbers).max(20.0);
        let right = self.width - 12.0;
        let x_range = range(self.panels.iter().flat_map(|p| p.values(true)), self.log_x);
        let x = Scale::new(x_range, (left, right), self.log_x);
        let x_ticks = x.ticks(((right - left) / 90.0) as usize);

        let mut svg = Svg::new(self.width, height, &self.title);
        svg.text("ft", (2.0, 15.0), Anchor::Start, &self.title);
        legend.draw(&mut svg, left, TITLE);
        for (index, (panel, (y, ticks))) in self.panels.iter().zip(&scales).enumerate() {
            let (upper, lower) = (y.at(f64::INFINITY), y.at(f64::NEG_INFINITY));
            let last = index + 1 == self.panels.len();
            horizontal_axis(&mut svg, &x, &x_ticks, (upper, lower), last);
            vertical_axis(&mut svg, y, ticks, left, right);
            if y.contains(0.0) && !panel.log_y {
                svg.line("z", (left, y.at(0.0)), (right, y.at(0.0)));
            }
            svg.upward_text("l", (11.0, (upper + lower) / 2.0), &panel.y_label);
            for layer in &panel.layers {
                layer.draw(&mut svg, &x, y, panel.log_y);
            }
            svg.line("a", (left, lower), (right, lower));
        }
        svg.text(
            "l",
            ((left + right) / 2.0, height - 4.0),
            Anchor::Middle,
            &self.x_label,
        );
        Figure {
            svg: svg.finish(),
            caption: caption.into(),
            curves: self.zoom.then(|| self.curves().json()),
        }
    }
}

impl Layer {
    /// Curve of the layer as data; none for points and bands.
    fn curve(&self) -> Option<Curve<'_>> {
        match &self.shape {
            Shape::Curves(pieces) => Some(Curve::new(&self.name, self.ink.class(), pieces)),
            _ => None,
        }
    }

    fn draw(&self, svg: &mut Svg, x: &Scale, y: &Scale, log_y: bool) {
        let ink = self.ink.class();
        let seen = |v: f64| !log_y || v > 0.0;
        match &self.shape {
            Shape::Curves(pieces) => {
                let pieces: Vec<Vec<(f64, f64)>> = thinned(pieces.clone(), MAX_POINTS)
                    .iter()
                    .map(|piece| {
                        let visible = piece.iter().filter(|p| seen(p.1));
                        visible.map(|p| (x.at(p.0), y.at(p.1))).collect()
                    })
                    .collect();
                svg.polylines(&format!("c {ink}"), &pieces);
            }
            Shape::Points(points) => {
                let visible = points.iter().filter(|p| seen(p.1));
                let pixels: Vec<(f64, f64)> = visible.map(|p| (x.at(p.0), y.at(p.1))).collect();
                svg.dots(&format!("p {ink}"), &thin(&pixels, 2.0));
            }
            Shape::Band(edges) => {
                let low = edges.iter().map(|e| (x.at(e.0), y.at(e.1)));
                let high = edges.iter().map(|e| (x.at(e.0), y.at(e.2)));
                let outline: Vec<(f64, f64)> = high.chain(low.rev()).collect();
                svg.area(&format!("b {ink}"), &outline);
            }
        }
    }
}

/// The pieces with at most `most` points together, but for two of each, so that extremes survive.
fn thinned(pieces: Vec<Vec<(f64, f64)>>, most: usize) -> Vec<Vec<(f64, f64)>> {
    let total: usize = pieces.iter().map(Vec::len).sum();
    if total <= most {
        return pieces;
    }
    let thin = |piece: Vec<(f64, f64)>| {
        let share = (most * piece.len()).div_ceil(total).max(2);
        let y: Vec<f64> = piece.iter().map(|p| p.1).collect();
        let kept = extremes(&y, share).into_iter();
        kept.map(|i| piece[i]).collect()
    };
    pieces.into_iter().map(thin).collect()
}

/// Runs of rows where both coordinates are finite.
fn finite_runs(x: &[f64], y: &[f64], rows: Range<usize>) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut start = None;
    for i in rows.clone() {
        match (x[i].is_finite() && y[i].is_finite(), start) {
            (true, None) => start = Some(i),
            (false, Some(from)) => {
                runs.push(from..i);
                start = None;
            }
            _ => {}
        }
    }
    if let Some(from) = start {
        runs.push(from..rows.end);
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_interrupted_at_gaps_and_breaks() {
        let x: Vec<f64> = (0..8).map(f64::from).collect();
        let mut y = x.clone();
        y[2] = f64::NAN;
        let panel = Panel::new("y").segments("s", Ink::Measured, &x, &y, &[0..5, 5..8]);
        let Shape::Curves(pieces) = &panel.layers[0].shape else {
            panic!("a curve was added");
        };
        let lengths: Vec<usize> = pieces.iter().map(Vec::len).collect();
        assert_eq!(lengths, [2, 2, 3]);
        let svg = Plot::new("t", "x").panel(panel).draw("").svg;
        let curve = svg.split("class=\"c km\" d=\"").nth(1).unwrap();
        assert_eq!(curve.split('"').next().unwrap().matches('M').count(), 3);
    }

    #[test]
    fn long_curves_are_thinned_and_keep_their_extremes() {
        let n = 100_000;
        let x: Vec<f64> = (0..n).map(f64::from).collect();
        let mut y = vec![0.0; n as usize];
        y[54_321] = 7.0;
        let panel = Panel::new("y").line("s", Ink::Residual, &x, &y);
        let Shape::Curves(pieces) = &panel.layers[0].shape else {
            panic!("a curve was added");
        };
        assert!(pieces[0].len() <= ZOOMED_POINTS);
        let drawn = thinned(pieces.clone(), MAX_POINTS);
        assert!(drawn[0].len() <= MAX_POINTS);
        assert!(drawn[0].contains(&(54_321.0, 7.0)));
    }

    #[test]
    fn empty_and_odd_data_are_drawn_as_empty_axes() {
        let nan = [f64::NAN, f64::INFINITY];
        let plot = Plot::new("t", "x")
            .log_x()
            .panel(Panel::new("y").log().line("a", Ink::Muted, &nan, &nan))
            .panel(Panel::new("y").points("b", Ink::Series(9), &[], &[]))
            .panel(Panel::new("y").binned("c", Ink::Series(1), &[1.0], &[1.0], 0));
        let svg = plot.draw("").svg;
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
