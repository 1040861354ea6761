//! Ticks of an axis and their labels.

use crate::view::charts::axis::Axis;

/// Ticks at 1, 2 or 5 times a power of ten, with one prefix and one number of digits; or the given ticks of the axis.
pub(super) struct Ticks<'a> {
    pub(super) values: Vec<f64>,
    scale: f64,
    digits: usize,
    space: &'static str,
    prefix: &'static str,
    axis: &'a Axis,
}

impl<'a> Ticks<'a> {
    /// At most `target` ticks, but at least two if `max_count` allows.
    pub(super) fn new(axis: &'a Axis, target: usize, max_count: usize) -> Self {
        const PREFIXES: [(f64, &str); 7] =
            [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];
        let step = step(axis, target, max_count);
        let mut values: Vec<f64> =
            (0..count(axis, step)).map(|k| (first(axis, step) + k as f64) * step).collect();
        if values.len() > max_count.max(2) {
            // Only the outer ones fit.
            values = values.first().into_iter().chain(values.last()).copied().collect();
        }
        if !axis.ticks.is_empty() {
            values.clone_from(&axis.ticks);
        }
        let max_value = axis.min.abs().max(axis.max.abs());
        let (scale, prefix) = PREFIXES
            .into_iter()
            .find(|(scale, _)| axis.prefix && max_value >= *scale * 0.9999)
            // Without a unit 0.2 is better than 200m.
            .filter(|(scale, _)| *scale >= 1.0 || !axis.unit.is_empty())
            .unwrap_or((1.0, ""));
        let mut shown = step / scale;
        let mut digits = 0;
        while shown < 0.9999 && digits < 9 {
            shown *= 10.0;
            digits += 1;
        }
        let space = if axis.unit.is_empty() { "" } else { " " };
        Self { values, scale, digits, space, prefix, axis }
    }

    pub(super) fn print(&self, value: f64) -> String {
        if let Some(index) = self.axis.ticks.iter().position(|tick| *tick == value) {
            return self.axis.labels.lines().nth(index).unwrap_or_default().to_owned();
        }
        // Adding zero removes the sign of -0.0.
        let number = value / self.scale + 0.0;
        let text = format!("{number:.*}", self.digits);
        let zero = text.chars().all(|c| matches!(c, '0' | '.' | '-'));
        let text = if zero { "0" } else { &text };
        let prefix = if zero && self.axis.unit.is_empty() { "" } else { self.prefix };
        format!("{text}{}{prefix}{}", self.space, self.axis.unit).replace('-', "\u{2212}")
    }
}

/// Distance of the ticks: the smallest with at most `target` ticks, or a smaller one if that leaves a single tick.
fn step(axis: &Axis, target: usize, max_count: usize) -> f64 {
    let span = axis.max - axis.min;
    let mut power = 1.0;
    while power > span {
        power /= 10.0;
    }
    while power * 10.0 <= span {
        power *= 10.0;
    }
    let finer = (0..20).flat_map(|k| {
        let power = (0..k).fold(power, |power, _| power / 10.0);
        [5.0, 2.0, 1.0].map(|times| times * power)
    });
    let mut chosen = None;
    for step in finer {
        let count = count(axis, step);
        let is_single = chosen.is_none_or(|chosen| self::count(axis, chosen) < 2);
        if count <= target || (is_single && count <= max_count.max(5)) {
            chosen = Some(step);
        } else {
            break;
        }
    }
    chosen.unwrap_or(power)
}

/// The first tick as a multiple of the distance.
fn first(axis: &Axis, step: f64) -> f64 {
    // Rounding must not remove a tick at the edge.
    (axis.min / step - 1e-9).ceil()
}

fn count(axis: &Axis, step: f64) -> usize {
    ((axis.max / step + 1e-9).floor() - first(axis, step) + 1.0).max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::charts::axis::axis;

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
            let printed = Ticks::new(&axis(min, max, unit), 6, 6).print(value);
            assert_eq!(printed, expected, "{min}..{max} {unit}: {value}");
        }
    }

    #[test]
    fn every_axis_has_at_least_two_and_not_too_many_ticks() {
        for (target, max_count) in [(2, 2), (3, 6), (5, 8), (12, 15)] {
            for mantissa in 1..1000 {
                let size = f64::from(mantissa) * 37.0;
                for (min, max) in
                    [(0.0, size), (-1.08 * size, 1.08 * size), (-0.08 * size, size), (3.3 * size, 4.4 * size)]
                {
                    let axis = axis(min, max, "");
                    let ticks = Ticks::new(&axis, target, max_count);
                    let count = ticks.values.len();
                    assert!((2..=max_count).contains(&count), "{min}..{max}, {target}: {:?}", ticks.values);
                    assert!(
                        ticks.values.iter().all(|value| (min..=max).contains(value)),
                        "{:?}",
                        ticks.values
                    );
                    let labels: Vec<String> = ticks.values.iter().map(|value| ticks.print(*value)).collect();
                    assert!(labels.windows(2).all(|pair| pair[0] != pair[1]), "{labels:?}");
                }
            }
        }
    }

    #[test]
    fn an_axis_with_own_ticks_uses_them_and_their_labels() {
        let axis = Axis { ticks: vec![-1.0, 0.5], labels: "100 mHz\n3.2 Hz".into(), ..axis(-1.2, 1.4, "Hz") };
        let found = Ticks::new(&axis, 6, 6);
        assert_eq!(found.values, [-1.0, 0.5]);
        assert_eq!(
            found.values.iter().map(|value| found.print(*value)).collect::<Vec<_>>(),
            ["100 mHz", "3.2 Hz"]
        );
    }
}
