//! Curves as data, for a reader who zooms.

use super::plot::{Layer, Plot, Shape};
use serde::Serialize;

#[derive(Serialize)]
struct Curves<'a> {
    title: &'a str,
    x: &'a str,
    panels: Vec<Axes<'a>>,
}

#[derive(Serialize)]
struct Axes<'a> {
    label: &'a str,
    height: f64,
    layers: Vec<Curve<'a>>,
}

#[derive(Serialize)]
struct Curve<'a> {
    name: &'a str,
    ink: &'static str,
    /// Horizontal and vertical coordinates of each piece.
    pieces: Vec<[Vec<f64>; 2]>,
}

/// The curves of a plot as JSON without `<`, so that it may stand in a page's script.
pub(super) fn json(plot: &Plot) -> String {
    let panels = plot.panels.iter().map(|panel| Axes {
        label: &panel.y_label,
        height: panel.height,
        layers: panel.layers.iter().filter_map(curve).collect(),
    });
    let curves = Curves {
        title: &plot.title,
        x: &plot.x_label,
        panels: panels.collect(),
    };
    let text = serde_json::to_string(&curves).expect("finite numbers and text are JSON");
    text.replace('<', "\\u003c")
}

/// A layer's curves; none of points and bands.
fn curve(layer: &Layer) -> Option<Curve<'_>> {
    let Shape::Curves(pieces) = &layer.shape else {
        return None;
    };
    Some(Curve {
        name: &layer.name,
        ink: layer.ink.class(),
        pieces: coordinates(pieces),
    })
}

/// Five digits of each coordinate: what no screen shows is not stored.
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
    use crate::figure::{Ink, Panel};

    #[test]
    fn pieces_keep_their_numbers_and_text_no_markup() {
        let x: Vec<f64> = (0..6).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| 0.123_456_78 * x).collect();
        let panel =
            Panel::new("torque").segments("</script>", Ink::Measured, &x, &y, &[0..3, 3..6]);
        let text = json(&Plot::new("elbow", "time / s").panel(panel));
        assert!(!text.contains('<'));
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        let layer = &value["panels"][0]["layers"][0];
        assert_eq!(layer["name"], "</script>");
        assert_eq!(layer["pieces"].as_array().unwrap().len(), 2);
        assert_eq!(layer["pieces"][1][0], serde_json::json!([3.0, 4.0, 5.0]));
        assert_eq!(layer["pieces"][0][1][2], 0.246_91);
    }
}
