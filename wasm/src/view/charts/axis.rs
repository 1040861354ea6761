//! One axis of a chart.

use serde::Deserialize;

#[derive(Deserialize)]
pub(crate) struct Axis {
    pub(crate) min: f64,
    pub(crate) max: f64,
    /// Unit of the labels; empty for a plain number.
    pub(crate) unit: String,
    /// Whether labels have an SI prefix.
    pub(crate) prefix: bool,
    /// Space for the tick labels in CSS pixels; 0 for none.
    pub(crate) label_px: f64,
    /// Given ticks, for a logarithmic axis.
    #[serde(default)]
    pub(crate) ticks: Vec<f64>,
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
