//! Curves as data, for a reader who zooms.

use serde::Serialize;

/// Panels over one horizontal axis.
#[derive(Serialize)]
pub(super) struct Curves<'a> {
    pub(super) title: &'a str,
    pub(super) x: &'a str,
    pub(super) panels: Vec<Axes<'a>>,
}

/// A panel: label of the vertical axis, height and curves.
#[derive(Serialize)]
pub(super) struct Axes<'a> {
    pub(super) label: &'a str,
    pub(super) height: f64,
    pub(super) layers: Vec<Curve<'a>>,
}

/// A curve: its name, its class, and horizontal and vertical coordinates of each piece.
#[derive(Serialize)]
pub(super) struct Curve<'a> {
    name: &'a str,
    ink: &'static str,
    pieces: Vec<[Vec<f64>; 2]>,
}

impl<'a> Curve<'a> {
    pub(super) fn new(name: &'a str, ink: &'static str, pieces: &[Vec<(f64, f64)>]) -> Self {
        let pieces = coordinates(pieces);
        Self { name, ink, pieces }
    }
}

impl Curves<'_> {
    /// The curves as JSON without `<`, so that it may stand in a page's script.
    pub(super) fn json(&self) -> String {
        let text = serde_json::to_string(self).expect("finite numbers and text are JSON");
        text.replace('<', "\\u003c")
    }
}

/// Coordinates rounded to five digits: more are not visible on any screen.
fn coordinates(pieces: &[Vec<(f64, f64)>]) -> Vec<[Vec<f64>; 2]> {
    let of = |piece: &Vec<(f64, f64)>| {
        let (x, y): (Vec<f64>, Vec<f64>) = piece.iter().copied().unzip();
        [rounded(x), rounded(y)]
    };
    pieces.iter().filter(|p| !p.is_empty()).map(of).collect()
}

/// Rounded to a 20,000th of their largest size.
fn rounded(values: Vec<f64>) -> Vec<f64> {
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    if largest == 0.0 {
        return values;
    }
    let scale = 10f64.powi(4 - largest.log10().floor() as i32);
    let round = |v: f64| (v * scale).round() / scale;
    values.into_iter().map(round).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_keep_their_numbers_and_text_no_markup() {
        let point = |k: u32| (f64::from(k), 0.123_456_78 * f64::from(k));
        let pieces = [(0..3).map(point).collect(), (3..6).map(point).collect()];
        let layers = vec![Curve::new("</script>", "km", &pieces)];
        let panels = vec![Axes {
            label: "torque",
            height: 100.0,
            layers,
        }];
        let text = Curves {
            title: "elbow",
            x: "time / s",
            panels,
        }
        .json();
        assert!(!text.contains('<'));
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        let layer = &value["panels"][0]["layers"][0];
        assert_eq!(layer["name"], "</script>");
        assert_eq!(layer["pieces"].as_array().unwrap().len(), 2);
        assert_eq!(layer["pieces"][1][0], serde_json::json!([3.0, 4.0, 5.0]));
        assert_eq!(layer["pieces"][0][1][2], 0.246_91);
    }
}
