//! Converts the values of a series to lines, without points within a twentieth of a pixel of a straight line.

/// Maximum error of a thinned curve, in pixels.
const TOLERANCE_PX: f64 = 0.05;

pub(super) struct Frame {
    pub(super) x: (f64, f64),
    pub(super) y: (f64, f64),
    /// Lower left corner, in pixels.
    pub(super) corner: Point,
    pub(super) width: f64,
    pub(super) height: f64,
}

pub(super) type Point = (f64, f64);

impl Frame {
    fn pixels(&self, x: f64, y: f64) -> Point {
        let y = y.clamp(self.y.0, self.y.1);
        (
            self.corner.0 + (x - self.x.0) / (self.x.1 - self.x.0) * self.width,
            self.corner.1 - (y - self.y.0) / (self.y.1 - self.y.0) * self.height,
        )
    }
}

/// Lines through points, separated by gaps.
pub(super) fn line(frame: &Frame, x: &[f64], y: &[f64]) -> Vec<Vec<Point>> {
    let points: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    let stretches = points.split(|(_, y)| !y.is_finite()).filter(|stretch| !stretch.is_empty());
    stretches
        .map(|stretch| thin(&stretch.iter().map(|(x, y)| frame.pixels(*x, *y)).collect::<Vec<Point>>()))
        .collect()
}

/// Lines through the minimum and maximum of each column, with gaps; one point if they differ by less than a pixel.
pub(super) fn band(frame: &Frame, x: &[f64], min: &[f64], max: &[f64]) -> Vec<Vec<Point>> {
    let mut lines: Vec<Vec<Point>> = vec![Vec::new()];
    for ((x, min), max) in x.iter().zip(min).zip(max) {
        let Some(line) = lines.last_mut() else { break };
        if !min.is_finite() || !max.is_finite() {
            if !line.is_empty() {
                lines.push(Vec::new());
            }
            continue;
        }
        let (low, high) = (frame.pixels(*x, *min), frame.pixels(*x, *max));
        if low.1 - high.1 <= 1.0 {
            line.push((low.0, f64::midpoint(low.1, high.1)));
        } else {
            let before = line.last().map_or(low.1, |point| point.1);
            let rising = (before - low.1).abs() <= (before - high.1).abs();
            line.extend(if rising { [low, high] } else { [high, low] });
        }
    }
    lines.retain(|line| !line.is_empty());
    lines.iter().map(|line| thin(line)).collect()
}

/// Cuts lines into dashes and gaps of `dash` pixels.
pub(super) fn dashes(lines: &[Vec<Point>], dash: f64) -> Vec<Vec<Point>> {
    let mut cut = Vec::new();
    for points in lines {
        let mut open: Vec<Point> = points.first().copied().into_iter().collect();
        // Remaining length of the current dash or gap.
        let (mut rest, mut drawn) = (dash, true);
        for pair in points.windows(2) {
            let [mut from, to] = [pair[0], pair[1]];
            let mut length = distance(from, to);
            while length > rest {
                let part = rest / length;
                from = (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part);
                length -= rest;
                if drawn {
                    open.push(from);
                    cut.push(core::mem::take(&mut open));
                } else {
                    open.push(from);
                }
                (rest, drawn) = (dash, !drawn);
            }
            rest -= length;
            if drawn {
                open.push(to);
            }
        }
        if open.len() > 1 {
            cut.push(open);
        }
    }
    cut
}

fn distance(a: Point, b: Point) -> f64 {
    ((b.0 - a.0) * (b.0 - a.0) + (b.1 - a.1) * (b.1 - a.1)).sqrt()
}

/// A line from the bottom to each value, `shift` pixels to the right.
pub(super) fn stems(frame: &Frame, x: &[f64], y: &[f64], shift: f64) -> Vec<Vec<Point>> {
    x.iter()
        .zip(y)
        .filter(|(_, y)| **y > frame.y.0)
        .map(|(x, y)| {
            let (across, up) = frame.pixels(*x, *y);
            vec![(across + shift, frame.corner.1), (across + shift, up)]
        })
        .collect()
}

/// Removes points within the tolerance of the line between their remaining neighbors. From an anchor, the slopes that
/// pass all points form a cone; the point before the first one outside is the next anchor.
fn thin(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
    let Some(mut anchor) = kept.first().copied() else { return kept };
    let mut last = anchor;
    let mut cone = (f64::NEG_INFINITY, f64::INFINITY);
    for &point in &points[1..] {
        let inside = |anchor: Point, cone: (f64, f64)| {
            let slope = (point.1 - anchor.1) / (point.0 - anchor.0);
            point.0 > anchor.0 && cone.0 <= slope && slope <= cone.1
        };
        if !inside(anchor, cone) {
            if last != anchor {
                kept.push(last);
            }
            anchor = last;
            cone = (f64::NEG_INFINITY, f64::INFINITY);
            // A vertical line cannot be replaced.
            if !inside(anchor, cone) {
                kept.push(point);
                anchor = point;
            }
        }
        if point.0 > anchor.0 {
            let slope = |y: f64| (y - anchor.1) / (point.0 - anchor.0);
            cone = (cone.0.max(slope(point.1 - TOLERANCE_PX)), cone.1.min(slope(point.1 + TOLERANCE_PX)));
        }
        last = point;
    }
    if last != anchor {
        kept.push(last);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Height of a line at x, unless it is vertical.
    fn height(line: &[Point], x: f64) -> f64 {
        let after = line.iter().position(|point| point.0 >= x).unwrap_or(line.len() - 1).max(1);
        let (a, b) = (line[after - 1], line[after]);
        a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0)
    }

    #[test]
    fn a_thinned_curve_stays_within_the_tolerance_and_needs_few_points() {
        let curve: Vec<Point> =
            (0..1000).map(|i| (f64::from(i), 80.0 + 80.0 * wave(f64::from(i) / 150.0))).collect();
        let thinned = thin(&curve);
        assert!(thinned.len() < 150, "{}", thinned.len());
        assert_eq!((thinned.first(), thinned.last()), (curve.first(), curve.last()));
        for &(x, y) in &curve {
            assert!((height(&thinned, x) - y).abs() <= TOLERANCE_PX + 1e-9, "at {x}");
        }
    }

    /// Consecutive parabolas, without transcendental functions.
    fn wave(x: f64) -> f64 {
        let turn = (x / core::f64::consts::TAU).fract() * 2.0 - 1.0;
        4.0 * turn * (1.0 - turn.abs())
    }

    #[test]
    fn a_thinned_staircase_keeps_its_corners_and_a_spike_its_tip() {
        let rows: &[(&[Point], &[Point])] = &[
            (&[], &[]),
            (&[(0.0, 1.0)], &[(0.0, 1.0)]),
            (
                &[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 9.0), (3.0, 9.0), (4.0, 9.0)],
                &[(0.0, 0.0), (2.0, 0.0), (2.0, 9.0), (4.0, 9.0)],
            ),
            (
                &[(0.0, 0.0), (1.0, 0.0), (1.0, 9.0), (2.0, 0.0), (3.0, 0.0)],
                &[(0.0, 0.0), (1.0, 0.0), (1.0, 9.0), (2.0, 0.0), (3.0, 0.0)],
            ),
            (&[(0.0, 0.0), (0.0, 5.0), (0.0, 2.0)], &[(0.0, 0.0), (0.0, 5.0), (0.0, 2.0)]),
        ];
        for (given, expected) in rows {
            assert_eq!(thin(given), *expected, "{given:?}");
        }
    }

    #[test]
    fn dashes_are_as_long_as_their_gaps_and_continue_at_corners() {
        let line = vec![(0.0, 0.0), (10.0, 0.0), (10.0, 11.0)];
        let cut = dashes(&[line, vec![(20.0, 5.0)]], 4.0);
        let expected = [
            vec![(0.0, 0.0), (4.0, 0.0)],
            vec![(8.0, 0.0), (10.0, 0.0), (10.0, 2.0)],
            vec![(10.0, 6.0), (10.0, 10.0)],
        ];
        assert_eq!(cut, expected);
    }

    #[test]
    fn a_dense_column_is_drawn_as_a_band_and_a_gap_ends_the_line() {
        let frame =
            Frame { x: (0.0, 4.0), y: (0.0, 128.0), corner: (5.0, 130.0), width: 40.0, height: 128.0 };
        let (x, nan) = ([0.0, 1.0, 2.0, 3.0], f64::NAN);
        let lines = band(&frame, &x, &[5.0, 10.0, nan, 7.0], &[5.0, 90.0, 1.0, 7.5]);
        assert_eq!(lines, [vec![(5.0, 125.0), (15.0, 120.0), (15.0, 40.0)], vec![(35.0, 122.75)]]);
    }

    #[test]
    fn a_line_is_within_a_fraction_of_a_pixel_of_its_values() {
        let frame = Frame { x: (0.0, 4.0), y: (0.0, 10.0), corner: (5.0, 130.0), width: 40.0, height: 100.0 };
        let lines = line(&frame, &[0.0, 0.5, 1.0, 2.0, 3.0], &[0.01, 0.02, 0.05, f64::NAN, 77.0]);
        assert_eq!(lines, [vec![(5.0, 129.9), (10.0, 129.8), (15.0, 129.5)], vec![(35.0, 30.0)]]);
    }
}
