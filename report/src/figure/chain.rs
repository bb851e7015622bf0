//! An arm from the side, with the joints that a cause lies on.

use super::Figure;
use super::draw::{TITLE, wrap};
use super::svg::{Anchor, Svg};

/// Radius of a joint, and least distance between two of them, px.
const RADIUS: f64 = 9.0;
const APART: f64 = 2.0 * RADIUS + 3.0;
/// Width of the drawing and of the arm in it, least distance of the list beside it, and height of the arm and of a row, px.
const WIDTH: f64 = 960.0;
const ARM: f64 = 380.0;
const LIST: f64 = 140.0;
const HEIGHT: f64 = 190.0;
const ROW: f64 = 23.0;
/// Least extent of an arm, m: a shorter one is not enlarged to the whole drawing.
const LEAST: f64 = 0.05;

/// Side elevation of a serial chain: every joint's frame at one pose, in the vertical plane in which the arm reaches farthest.
/// Joints with a cause are filled, and the list beside the arm says which cause.
#[derive(Clone, Debug)]
pub struct Chain {
    title: String,
    up: [f64; 3],
    joints: Vec<Joint>,
    whole: Vec<String>,
}

#[derive(Clone, Debug)]
struct Joint {
    name: String,
    origin: [f64; 3],
    slides: bool,
    causes: Vec<String>,
}

impl Chain {
    /// An arm without joints on a base whose upward direction is `up`, against gravity; any length.
    pub fn new(title: impl Into<String>, up: [f64; 3]) -> Self {
        Self {
            title: title.into(),
            up,
            joints: Vec::new(),
            whole: Vec::new(),
        }
    }

    /// Adds the next joint: its name, the origin of its frame in the base frame, m, and whether it slides.
    pub fn joint(mut self, name: impl Into<String>, origin: [f64; 3], slides: bool) -> Self {
        self.joints.push(Joint {
            name: name.into(),
            origin,
            slides,
            causes: Vec::new(),
        });
        self
    }

    /// Marks the joints of these names with a cause; one on every joint of several is said of the whole arm.
    pub fn cause(mut self, words: impl Into<String>, joints: &[String]) -> Self {
        let words = words.into();
        let named = |joint: &Joint| joints.contains(&joint.name);
        if self.joints.len() > 1 && self.joints.iter().all(named) {
            self.whole.push(words);
            return self;
        }
        for joint in self.joints.iter_mut().filter(|j| named(j)) {
            if !joint.causes.contains(&words) {
                joint.causes.push(words.clone());
            }
        }
        self
    }

    /// Figure of the arm as SVG; the same bytes for the same arm and causes.
    pub fn draw(&self, caption: impl Into<String>) -> Figure {
        let points = self.points(HEIGHT.max(ROW * self.joints.len() as f64));
        // The list stands beside the arm, however far that reaches.
        let list = points.iter().map(|p| p.0).fold(LIST, f64::max) + 60.0;
        let beside = list + 18.0;
        let (named, rows) = self.list(WIDTH - beside);
        let height = TITLE + HEIGHT.max(ROW * rows as f64) + 16.0;
        let mut svg = Svg::new(WIDTH, height, &self.title);
        svg.text("ft", (2.0, 15.0), Anchor::Start, &self.title);
        if let Some(&(x, y)) = points.first() {
            svg.line("a", (x - 26.0, y + 1.0), (x + 26.0, y + 1.0));
            svg.polylines("p km", std::slice::from_ref(&points));
        }
        let middle = |row: usize| TITLE + ROW * (row as f64 + 0.5);
        let mut row = 0;
        for (k, (joint, lines)) in
            std::iter::zip(self.joints.iter().map(Some).chain([None]), &named).enumerate()
        {
            let class = if joint.is_some_and(|j| j.causes.is_empty()) {
                "t"
            } else {
                "v"
            };
            if let Some(joint) = joint {
                joint.draw(&mut svg, k, points[k + 1]);
                joint.draw(&mut svg, k, (list, middle(row)));
            }
            for line in lines {
                svg.text(class, (beside, middle(row) + 4.0), Anchor::Start, line);
                row += 1;
            }
        }
        Figure {
            svg: svg.finish(),
            caption: caption.into(),
            curves: None,
        }
    }

    /// Lines of the list beside the arm, for each joint and at the end for the whole arm, none wider than `width`; and their number.
    fn list(&self, width: f64) -> (Vec<Vec<String>>, usize) {
        let text = |name: &str, causes: &[String]| match causes {
            [] => name.to_owned(),
            causes => format!("{name}: {}", causes.join(", ")),
        };
        let joints = self.joints.iter().map(|j| text(&j.name, &j.causes));
        let whole = (!self.whole.is_empty()).then(|| text("The whole arm", &self.whole));
        let list: Vec<_> = joints.chain(whole).map(|t| wrap(&t, width)).collect();
        let rows = list.iter().map(Vec::len).sum();
        (list, rows)
    }

    /// Places of the base and of every joint in a drawing of this height. A joint that would cover an earlier one stands
    /// to its right.
    fn points(&self, height: f64) -> Vec<(f64, f64)> {
        let flat = self.side();
        let extent = |of: fn(&(f64, f64)) -> f64| {
            let values = flat.iter().map(of);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
                (a.min(v), b.max(v))
            });
            (low, (high - low).max(LEAST))
        };
        let ((left, width), (low, tall)) = (extent(|p| p.0), extent(|p| p.1));
        let room = (ARM - 4.0 * APART, height - 2.0 * APART);
        let scale = (room.0 / width).min(room.1 / tall);
        let mut placed: Vec<(f64, f64)> = Vec::new();
        for (k, &(x, y)) in flat.iter().enumerate() {
            let mut at = (
                APART + scale * (x - left),
                TITLE + height - APART - scale * (y - low),
            );
            let covers = |at: &(f64, f64)| {
                let joints = placed.iter().skip(1);
                let mut near = joints.map(|p| (p.0 - at.0).hypot(p.1 - at.1));
                near.any(|distance| distance < APART)
            };
            while k > 0 && covers(&at) {
                at.0 += 1.0;
            }
            placed.push(at);
        }
        placed
    }

    /// Base and joints in the vertical plane through the base in which the joints lie farthest out: distance and height, m.
    fn side(&self) -> Vec<(f64, f64)> {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            let of = |i: usize, k: usize| a[i] * b[k] - a[k] * b[i];
            [of(1, 2), of(2, 0), of(0, 1)]
        };
        let unit = |a: [f64; 3]| {
            let length = dot(a, a).sqrt();
            (length > 0.0).then(|| a.map(|v| v / length))
        };
        let up = unit(self.up).unwrap_or([0.0, 0.0, 1.0]);
        let across = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let start = across.into_iter().min_by(|a, b| {
            let along = |v: &[f64; 3]| dot(*v, up).abs();
            along(a).total_cmp(&along(b))
        });
        let second = unit(cross(up, start.unwrap_or(across[0]))).unwrap_or(across[1]);
        let first = cross(second, up);
        let level = |j: &Joint| [dot(j.origin, first), dot(j.origin, second)];
        let sum = |of: fn([f64; 2]) -> f64| self.joints.iter().map(|j| of(level(j))).sum::<f64>();
        let angle = 0.5 * (2.0 * sum(|p| p[0] * p[1])).atan2(sum(|p| p[0] * p[0] - p[1] * p[1]));
        let (sin, cos) = angle.sin_cos();
        let out = |j: &Joint| level(j)[0] * cos + level(j)[1] * sin;
        let sign = self.joints.last().map_or(1.0, |j| 1_f64.copysign(out(j)));
        let joints = self.joints.iter();
        let joints = joints.map(|j| (sign * out(j), dot(j.origin, up)));
        std::iter::once((0.0, 0.0)).chain(joints).collect()
    }
}

impl Joint {
    /// Draws the joint with its number in the chain.
    fn draw(&self, svg: &mut Svg, index: usize, (x, y): (f64, f64)) {
        let [class, number] = if self.causes.is_empty() {
            ["jt", "jn"]
        } else {
            ["jt jg", "jn jf"]
        };
        if self.slides {
            let corner = (x - RADIUS, y - RADIUS);
            svg.rect(class, corner, (2.0 * RADIUS, 2.0 * RADIUS));
        } else {
            svg.circle(class, (x, y), RADIUS);
        }
        let text = (index + 1).to_string();
        svg.text(number, (x, y + 4.0), Anchor::Middle, &text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arm that reaches along y, with two joints in one place, on a base that hangs from the ceiling or not.
    fn arm(up: f64) -> Chain {
        let chain = Chain::new("arm", [0.0, 0.0, up])
            .joint("a", [0.0, 0.0, 0.2], false)
            .joint("b", [0.0, -0.5, 0.2], false)
            .joint("c", [0.0, -0.5, 0.2], true);
        chain.cause("Stribeck friction", &["b".to_owned()])
    }

    #[test]
    fn the_side_shows_the_reach_and_the_height() {
        let flat = arm(9.81).side();
        assert!((flat[2].0 - 0.5).abs() < 1e-12 && (flat[2].1 - 0.2).abs() < 1e-12);
        assert!((arm(-1.0).side()[2].1 + 0.2).abs() < 1e-12);
        let points = arm(1.0).points(190.0);
        assert!(points[1].1 < points[0].1 && points[2].0 > points[1].0);
        assert!(points[3].0 - points[2].0 >= APART - 1.0, "{points:?}");
    }

    #[test]
    fn joints_with_a_cause_are_filled_and_named() {
        let figure = arm(1.0).draw("caption");
        assert_eq!(figure.svg.matches("jg").count(), 2);
        assert!(figure.svg.contains("b: Stribeck friction"));
        assert_eq!(figure, arm(1.0).draw("caption"));
        let all = ["a", "b", "c"].map(str::to_owned);
        let whole = arm(1.0).cause("base tilt", &all).draw("caption");
        assert!(whole.svg.contains("The whole arm: base tilt"));
        assert_eq!(whole.svg.matches("jg").count(), 2);
        // A long list goes on in further lines.
        let long = (0..40).fold(arm(1.0), |arm, k| arm.cause(format!("cause {k}"), &all));
        let drawn = long.draw("caption").svg;
        assert!(drawn.contains("cause 39") && !drawn.contains('…'));
        // Nothing to draw, and an arm without extent.
        Chain::new("none", [0.0; 3]).draw("");
        let point = Chain::new("point", [f64::NAN; 3]).joint("a", [0.0; 3], false);
        assert!(!point.draw("").svg.contains("NaN"));
    }
}
