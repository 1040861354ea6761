//! One axis of a chart, as the page asks for it.

use serde::Deserialize;

/// Range and labels of one axis.
#[derive(Deserialize)]
pub(crate) struct Axis {
    /// Least value shown.
    pub(crate) min: f64,
    /// Greatest value shown.
    pub(crate) max: f64,
    /// Unit behind the tick labels; takes an SI prefix. Empty for a plain number, which takes the
    /// prefix alone.
    pub(crate) unit: String,
    /// False for units that take no prefix, such as dB, and for counts.
    pub(crate) prefix: bool,
    /// Space for the tick labels in CSS pixels; 0 for none.
    pub(crate) label_px: f64,
    /// Ticks where these are not to be found here, but come with their labels: those of an axis of logarithms.
    #[serde(default)]
    pub(crate) ticks: Vec<f64>,
    /// A line a label.
    #[serde(default)]
    pub(crate) labels: String,
}

/// An axis for tests, whose unit takes prefixes.
#[cfg(test)]
pub(super) fn axis(min: f64, max: f64, unit: &str) -> Axis {
    Axis {
        min,
        max,
        unit: unit.into(),
        prefix: true,
        label_px: 40.0,
        ticks: Vec::new(),
        labels: String::new(),
    }
}
