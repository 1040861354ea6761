//! Distortion of a polyline that replaces a sine, and the d1 that minimizes it (Sonobe 2011; DESIGN B5).
//!
//! A quarter's vertices define the whole period, so even harmonics are 0. Only the bends of the line count:
//!
//! ```text
//! y |._                    s_i  slope from vertex i to i + 1, s_-1 = 0
//!   |  '-._                b_i  = s_(i-1) - s_i, the bend at vertex i
//!   |      '._             a_k  = 4/(pi*k^2) * sum over i of b_i*cos(k*angle_i)       k = 1, 3, 5, …
//! 0 +---------'- 90 deg    THD  = sqrt(a_3^2 + a_5^2 + …)/|a_1|
//! ```
//!
//! Nothing is sampled, so nothing aliases. Harmonics of the acceleration do not decrease, so its distortion grows with the
//! order, unless a sensor limits the bandwidth.

use alloc::vec::Vec;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use stepscope_motion::curves::polyline::{POINTS, QUARTER, breakpoints, cosine_at, next_deviation};

/// A vertex of a quarter: angle in rad from the extreme, height in parts of the amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    pub angle: f64,
    pub height: f64,
}

/// Limits of a distortion. Converts from an order, without a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Maximum harmonic, 1 to 65535.
    pub order: u16,
    /// Bandwidth (-3 dB) of the sensor over the frequency of the oscillation.
    pub sensor: Option<f64>,
}

impl From<u16> for Bounds {
    fn from(order: u16) -> Self {
        Self { order, sensor: None }
    }
}

/// |H| of a first-order low pass at a multiple of its bandwidth.
pub(crate) fn low_pass(part: f64) -> f64 {
    1.0 / libm::sqrt(1.0 + part * part)
}

/// THD_F of each quantity, as a ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distortion {
    pub position: f64,
    pub speed: f64,
    pub acceleration: f64,
    pub acceleration_filtered: Option<f64>,
}

/// Vertices for a maximum deviation `d1`, in parts of the amplitude.
pub fn vertices(d1: f64) -> Vec<Vertex> {
    on_points(&breakpoints(d1))
}

fn on_points(points: &[u16]) -> Vec<Vertex> {
    let vertex = |&point: &u16| {
        let angle = if point == QUARTER { FRAC_PI_2 } else { f64::from(point) * TAU / f64::from(POINTS) };
        Vertex { angle, height: cosine_at(point) }
    };
    points.iter().map(vertex).collect()
}

/// Signed harmonics 1, 3, 5, … up to `order`. Angles rise from 0 to pi/2.
pub fn odd_harmonics(vertices: &[Vertex], order: u16) -> Vec<f64> {
    let mut sums: Vec<f64> = (1..=order).step_by(2).map(|_| 0.0).collect();
    let mut before = 0.0;
    for (at, next) in vertices.iter().zip(vertices.iter().skip(1)) {
        let slope = (next.height - at.height) / (next.angle - at.angle);
        for (sum, cosine) in sums.iter_mut().zip(OddMultiples::cosines(at.angle)) {
            *sum += (before - slope) * cosine;
        }
        before = slope;
    }
    for (index, sum) in sums.iter_mut().enumerate() {
        *sum *= scale(index);
    }
    sums
}

/// 4/(pi*k^2) with k = 2*index + 1.
pub(crate) fn scale(index: usize) -> f64 {
    let k = (2 * index + 1) as f64;
    4.0 / (PI * k * k)
}

/// cos(k*angle) or sin(k*angle) for k = 1, 3, 5, …, by recurrence.
pub(crate) struct OddMultiples {
    now: f64,
    before: f64,
    twice: f64,
}

impl OddMultiples {
    pub(crate) fn cosines(angle: f64) -> Self {
        let now = libm::cos(angle);
        Self { now, before: now, twice: 2.0 * libm::cos(2.0 * angle) }
    }

    pub(crate) fn sines(angle: f64) -> Self {
        let now = libm::sin(angle);
        Self { now, before: -now, twice: 2.0 * libm::cos(2.0 * angle) }
    }
}

impl Iterator for OddMultiples {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        let now = self.now;
        (self.now, self.before) = (self.twice * now - self.before, now);
        Some(now)
    }
}

/// Distortion of a polyline over the harmonics up to the order.
pub fn distortion(vertices: &[Vertex], bounds: impl Into<Bounds>) -> Distortion {
    let Bounds { order, sensor } = bounds.into();
    let harmonics = odd_harmonics(vertices, order);
    let first = harmonics.first().copied().unwrap_or(0.0);
    let filtered = |k: f64| sensor.map_or(1.0, |sensor| low_pass(k / sensor));
    let (mut squares, mut filtered_square) = ([0.0; 3], 0.0);
    for (index, harmonic) in harmonics.iter().enumerate().skip(1) {
        let k = (2 * index + 1) as f64;
        let mut amplitude = *harmonic;
        for square in &mut squares {
            *square += amplitude * amplitude;
            amplitude *= k;
        }
        let amplitude = amplitude / k * filtered(k);
        filtered_square += amplitude * amplitude;
    }
    let over_first = |square: f64| libm::sqrt(square) / libm::fabs(first);
    let [position, speed, acceleration] = squares.map(over_first);
    let acceleration_filtered = sensor.map(|_| over_first(filtered_square) / filtered(1.0));
    Distortion { position, speed, acceleration, acceleration_filtered }
}

/// A maximum deviation with its polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Maximum deviation in parts of the amplitude.
    pub d1: f64,
    pub segments: usize,
    pub distortion: Distortion,
    /// Euclidean distance of line and cosine over 512 points, in parts of the amplitude.
    pub euclidean: f64,
}

impl Row {
    pub fn of(d1: f64, bounds: impl Into<Bounds>) -> Self {
        Measure::new(bounds).row(d1)
    }
}

/// Computes rows with the same bounds.
#[derive(Clone, Debug)]
pub struct Measure {
    bounds: Bounds,
    cosines: Vec<f64>,
}

impl Measure {
    pub fn new(bounds: impl Into<Bounds>) -> Self {
        Self { bounds: bounds.into(), cosines: cosines() }
    }

    pub fn row(&self, d1: f64) -> Row {
        self.of_points(d1, &breakpoints(d1))
    }

    fn of_points(&self, d1: f64, points: &[u16]) -> Row {
        let distortion = distortion(&on_points(points), self.bounds);
        let square: f64 = differences(points, &self.cosines).map(|(_, off)| off * off).sum();
        Row { d1, segments: points.len() - 1, distortion, euclidean: libm::sqrt(square) }
    }
}

pub(crate) fn cosines() -> Vec<f64> {
    (0..=QUARTER).map(cosine_at).collect()
}

/// The cosine at a quarter's 512 points, and the line's deviation there, in parts of the amplitude.
pub(crate) fn differences<'p>(
    points: &'p [u16],
    cosines: &'p [f64],
) -> impl Iterator<Item = (f64, f64)> + 'p {
    points.iter().zip(points.iter().skip(1)).flat_map(|(&from, &to)| {
        let chord = cosines.get(from.into()..=to.into()).unwrap_or_default();
        let (near, far) = (chord.first().copied().unwrap_or(0.0), chord.last().copied().unwrap_or(0.0));
        (0..to - from).zip(chord).map(move |(point, cosine)| {
            let line = near + (far - near) * f64::from(point) / f64::from(to - from);
            (*cosine, line - cosine)
        })
    })
}

/// `count` rows of d1 evenly from `from` to `to`, computed one per `next`.
pub fn sweep(
    from: f64,
    to: f64,
    count: u32,
    bounds: impl Into<Bounds>,
) -> impl ExactSizeIterator<Item = Row> {
    let measure = Measure::new(bounds);
    (0..count).map(move |index| measure.row(swept(from, to, count, index)))
}

/// The d1 of row `index` of a sweep, so that several workers can share it.
pub fn swept(from: f64, to: f64, count: u32, index: u32) -> f64 {
    from + (to - from) * (f64::from(index) / f64::from(count.max(2) - 1))
}

/// Each polyline within a range of d1 once, with its minimum d1. A polyline changes where the next point of a
/// chord comes within d1, so the steps are found and not sampled.
#[derive(Clone, Debug)]
pub struct Distinct {
    next: Option<f64>,
    to: f64,
    measure: Measure,
}

impl Distinct {
    pub fn new(from: f64, to: f64, bounds: impl Into<Bounds>) -> Self {
        Self { next: Some(from), to, measure: Measure::new(bounds) }
    }
}

impl Iterator for Distinct {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        let d1 = self.next.take().filter(|d1| *d1 <= self.to)?;
        let points = breakpoints(d1);
        self.next = next_deviation(&points);
        Some(self.measure.of_points(d1, &points))
    }
}

/// The row with minimum distortion of the position; the first of equals.
pub fn best(rows: impl IntoIterator<Item = Row>) -> Option<Row> {
    rows.into_iter().reduce(
        |best, row| {
            if row.distortion.position < best.distortion.position { row } else { best }
        },
    )
}

/// The row with minimum distortion of the position for each number of segments.
pub fn best_of_each(rows: impl IntoIterator<Item = Row>) -> Vec<Row> {
    let mut all: Vec<Row> = Vec::new();
    for row in rows {
        match all.iter_mut().find(|best| best.segments == row.segments) {
            Some(best) if row.distortion.position < best.distortion.position => *best = row,
            Some(_) => {}
            None => all.push(row),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_figures_are_reproduced() {
        // Its transform of 2048 samples folds back what lies beyond harmonic 1023: half a thousandth of the figure.
        let rows = [(0.0054, 6, 0.269_13), (0.006, 6, 0.267_10)];
        for (d1, segments, percent) in rows {
            let row = Row::of(d1, 1023);
            assert_eq!(row.segments, segments);
            let found = row.distortion.position * 100.0;
            assert!((found - percent).abs() < 1e-3 * percent, "{d1}: {found}");
        }
        let seventh = |d1: f64| odd_harmonics(&vertices(d1), 7)[3];
        let ratio = seventh(0.0054) / seventh(0.006);
        let power = ratio * ratio;
        assert!(power > 22.0 && power < 25.0, "{power}");
        assert_eq!([0.015, 0.002].map(|d1| Row::of(d1, 9).segments), [4, 10]);
    }

    #[test]
    fn harmonics_in_closed_form_are_those_of_the_integral() {
        let vertices = vertices(0.006);
        let found = odd_harmonics(&vertices, 41);
        // 4/pi times the integral over the quarter, by the midpoint rule.
        let parts = 200_000;
        let line = |angle: f64| {
            let after = vertices.iter().position(|vertex| vertex.angle > angle).unwrap();
            let (from, to) = (vertices[after - 1], vertices[after]);
            from.height + (to.height - from.height) * (angle - from.angle) / (to.angle - from.angle)
        };
        for (index, harmonic) in found.iter().enumerate() {
            let k = (2 * index + 1) as f64;
            let sum: f64 = (0..parts)
                .map(|i| (f64::from(i) + 0.5) * FRAC_PI_2 / f64::from(parts))
                .map(|angle| line(angle) * libm::cos(k * angle))
                .sum();
            let expected = 4.0 / PI * sum * FRAC_PI_2 / f64::from(parts);
            assert!((harmonic - expected).abs() < 1e-9, "{k}: {harmonic} {expected}");
        }
    }

    #[test]
    fn filtered_acceleration_does_not_grow_with_the_order() {
        let of = |order: u16, sensor: Option<f64>| Row::of(0.006, Bounds { order, sensor }).distortion;
        let [low, high] = [999, 9999].map(|order| of(order, Some(20.0)));
        assert!(high.acceleration > 3.0 * low.acceleration, "{low:?} {high:?}");
        let [low, high] = [low, high].map(|found| found.acceleration_filtered.unwrap());
        assert!(high > low && high < 1.01 * low, "{low} {high}");
        // By the definition, over the harmonics themselves.
        let vertices = vertices(0.006);
        let squares: Vec<f64> = (1..)
            .step_by(2)
            .zip(odd_harmonics(&vertices, 999))
            .map(|(k, harmonic)| {
                let k = f64::from(k);
                let filtered = harmonic * k * k / libm::sqrt(1.0 + k * k / 400.0);
                filtered * filtered
            })
            .collect();
        let expected = libm::sqrt(squares[1..].iter().sum::<f64>() / squares[0]);
        assert!((low - expected).abs() < 1e-9 * expected, "{low} {expected}");
        // A sensor without bounds passes all of it; without a sensor nothing is filtered.
        let all = of(99, Some(1e9));
        assert!((all.acceleration_filtered.unwrap() - all.acceleration).abs() < 1e-9);
        assert_eq!(of(99, None), Row::of(0.006, 99).distortion);
        assert_eq!(of(99, None).acceleration_filtered, None);
    }

    #[test]
    fn no_row_of_a_sweep_is_better_than_the_best_distinct_polyline() {
        let (from, to) = (0.004, 0.02);
        let distinct: Vec<Row> = Distinct::new(from, to, 399).collect();
        assert!(distinct.windows(2).all(|pair| pair[0].d1 < pair[1].d1));
        let best = best(distinct.iter().copied()).unwrap();
        for row in sweep(from, to, 500, 399) {
            let same = distinct.iter().rev().find(|other| other.d1 <= row.d1).unwrap();
            assert_eq!(
                (row.distortion, row.segments, row.euclidean),
                (same.distortion, same.segments, same.euclidean)
            );
            assert!(row.distortion.position >= best.distortion.position);
        }
        assert_eq!(sweep(from, to, 500, 9).len(), 500);
    }

    #[test]
    fn a_sweep_covers_its_range() {
        let rows: Vec<Row> = sweep(0.001, 0.06, 60, 99).collect();
        assert_eq!((rows[0].d1, rows[59].d1), (0.001, 0.06));
        assert!(rows[59].euclidean > 10.0 * rows[0].euclidean);
        // 512 points, none further off than d1.
        assert!(rows.iter().all(|row| row.euclidean <= row.d1 * libm::sqrt(512.0) && row.euclidean > 0.0));
        assert_eq!(sweep(0.006, 1.0, 1, 9).next().map(|row| row.d1), Some(0.006));
        let fine = Row::of(0.0, 9);
        assert_eq!((fine.segments, fine.euclidean), (512, 0.0));
    }
}
