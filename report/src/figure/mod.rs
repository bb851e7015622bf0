//! Figures as SVG, drawn with class names that the page's style sheet colours.
//!
//! | figure | shows |
//! |---|---|
//! | [`Plot`] | curves, points and bands over a shared horizontal axis, in one or several panels: time series, residual against velocity, spectra |
//! | [`Bars`] | values by category, one or several series, with intervals |
//! | [`Waterfall`] | how a quantity shrinks step by step |
//! | [`Chain`] | an arm from the side, with the joints that a cause lies on |
//! | [`HeatMap`] | a table of values as shades |

mod bars;
mod bins;
mod chain;
mod curves;
mod decimate;
mod draw;
mod heat;
mod plot;
mod scale;
mod svg;
mod waterfall;

pub use bars::Bars;
pub use chain::Chain;
pub use decimate::MAX_POINTS;
pub use heat::HeatMap;
pub use plot::{Panel, Plot};
pub use waterfall::Waterfall;

/// A drawn figure with its caption.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Drawing as one `<svg>` element.
    pub svg: String,
    /// Explanation of the figure and how to read it; plain text.
    pub caption: String,
    /// The curves as JSON, where a reader can zoom them.
    pub(crate) curves: Option<String>,
}

/// Colour of a curve or bar, by meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Colour of measured values.
    Measured,
    /// Colour of a model's predictions.
    Predicted,
    /// Colour of residuals: measured minus predicted.
    Residual,
    /// Colour of a reference that should not draw attention.
    Muted,
    /// Colour of the n-th of several equals; six colours, then again from the first.
    Series(usize),
}

impl Ink {
    fn class(self) -> &'static str {
        const SERIES: [&str; 6] = ["k0", "k1", "k2", "k3", "k4", "k5"];
        match self {
            Self::Measured => "km",
            Self::Predicted => "k0",
            Self::Residual => "k1",
            Self::Muted => "kx",
            Self::Series(n) => SERIES[n % SERIES.len()],
        }
    }
}
