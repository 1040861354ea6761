//! Tick labels: numbers with an SI prefix, a unit, and no more digits than the ticks need.

use super::Axis;

/// How the labels of one axis print their numbers: one prefix and one number of digits for all.
pub(super) struct Ticks<'a> {
    scale: f64,
    digits: usize,
    space: &'static str,
    prefix: &'static str,
    unit: &'a str,
}

impl<'a> Ticks<'a> {
    pub(super) fn new(axis: &'a Axis, count: usize) -> Self {
        const PREFIXES: [(f64, &str); 7] =
            [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];
        let largest = axis.min.abs().max(axis.max.abs());
        let (scale, prefix) = PREFIXES
            .into_iter()
            .find(|(scale, _)| axis.prefix && largest >= *scale * 0.9999)
            // A part of a step is 0.2, not 200m.
            .filter(|(scale, _)| *scale >= 1.0 || !axis.unit.is_empty())
            .unwrap_or((1.0, ""));
        // Ticks lie 1, 2 or 5 times a power of ten apart, and there may be one more than asked for.
        let mut step = (axis.max - axis.min) / scale / (count + 1) as f64;
        let mut digits = 0;
        while step <= 0.5001 && digits < 9 {
            step *= 10.0;
            digits += 1;
        }
        let space = if axis.unit.is_empty() { "" } else { " " };
        Self { scale, digits, space, prefix, unit: &axis.unit }
    }

    pub(super) fn print(&self, value: f64) -> String {
        // Adding zero makes a plain zero of a negative one.
        let number = value / self.scale + 0.0;
        let text = format!("{number:.*}", self.digits);
        let zero = text.chars().all(|c| matches!(c, '0' | '.' | '-'));
        let text = if zero { "0" } else { &text };
        let prefix = if zero && self.unit.is_empty() { "" } else { self.prefix };
        format!("{text}{}{prefix}{}", self.space, self.unit).replace('-', "\u{2212}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tick_labels_share_one_prefix_and_one_number_of_digits() {
        let rows = [
            (0.0, 32_000.0, "", 10_000.0, "10k"),
            (0.0, 32_000.0, "", 0.0, "0"),
            (0.0, 0.4, "s", 0.05, "50 ms"),
            (0.4, 0.4001, "s", 0.40005, "400.05 ms"),
            (-1.0, 1.0, "", -0.5, "\u{2212}0.5"),
            (0.0, 1e-6, "s", 5e-7, "0.5 µs"),
            (0.0, 0.4, "", 0.1, "0.1"),
            (0.0, 2_700.0, "", 500.0, "0.5k"),
        ];
        for (min, max, unit, value, expected) in rows {
            let axis = Axis { min, max, unit: unit.into(), prefix: true, label_px: 40.0 };
            let printed = Ticks::new(&axis, 5).print(value);
            assert_eq!(printed, expected, "{min}..{max} {unit}: {value}");
        }
    }
}
