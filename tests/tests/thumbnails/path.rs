//! A short SVG path of whole pixels.

use std::fmt::Write as _;

/// Up to this distance in pixels, points between the ends of a line are left out.
const TOLERANCE: f64 = 0.8;
/// From this number on, neighboring columns with edges are drawn as one box.
const DENSE: usize = 4;

type Point = (i32, i32);

#[derive(Default)]
pub(crate) struct Path {
    text: String,
    at: Point,
}

impl Path {
    pub(crate) fn finish(self) -> String {
        self.text
    }

    fn go(&mut self, to: Point) {
        self.at = to;
        self.write(format_args!("M{} {}", to.0, to.1));
    }

    fn draw(&mut self, to: Point) {
        let (dx, dy) = (to.0 - self.at.0, to.1 - self.at.1);
        self.at = to;
        match (dx, dy) {
            (0, 0) => {}
            (0, _) => self.write(format_args!("v{dy}")),
            (_, 0) => self.write(format_args!("h{dx}")),
            _ if dy < 0 => self.write(format_args!("l{dx}{dy}")),
            _ => self.write(format_args!("l{dx} {dy}")),
        }
    }

    fn write(&mut self, part: std::fmt::Arguments<'_>) {
        self.text.write_fmt(part).expect("a string");
    }

    pub(crate) fn line(&mut self, from: Point, to: Point) {
        self.go(from);
        self.draw(to);
    }

    pub(crate) fn rectangle(&mut self, x: i32, y: i32, width: i32, height: i32) {
        self.go((x, y));
        self.write(format_args!("h{width}v{height}h-{width}z"));
    }

    /// A curve without the points that it does not need.
    pub(crate) fn curve(&mut self, points: &[(f64, f64)]) {
        let mut kept = vec![false; points.len()];
        keep(points, 0, points.len().saturating_sub(1), &mut kept);
        let mut is_first = true;
        for (&(x, y), _) in points.iter().zip(kept).filter(|(_, kept)| *kept) {
            let to = (x.round() as i32, y.round() as i32);
            if std::mem::take(&mut is_first) { self.go(to) } else { self.draw(to) }
        }
    }

    /// A signal: for each pixel whether it is high in a cycle, low in a cycle, and high at the end.
    pub(crate) fn levels(
        &mut self,
        columns: impl Iterator<Item = (bool, bool, bool)>,
        top: i32,
        height: i32,
    ) {
        let columns: Vec<_> = columns.collect();
        let y = |is_high: bool| if is_high { top } else { top + height };
        let changes = |&(high, low, _): &(bool, bool, bool)| high && low;
        let mut is_high =
            columns.first().is_some_and(|&(high, low, last)| if high && low { !last } else { last });
        self.go((0, y(is_high)));
        let mut at = 0;
        while let Some(column) = columns.get(at) {
            let x = at as i32;
            let dense = columns[at..].iter().take_while(|column| changes(column)).count();
            if dense >= DENSE {
                self.rectangle(x, top, dense as i32, height);
                at += dense;
                is_high = columns[at - 1].2;
                self.go((x + dense as i32, y(is_high)));
                continue;
            }
            let &(_, _, last) = column;
            if changes(column) || last != is_high {
                self.draw((x, y(is_high)));
                self.draw((x, y(!is_high)));
                self.draw((x, y(last)));
            }
            is_high = last;
            at += 1;
        }
        self.draw((columns.len() as i32, y(is_high)));
    }
}

/// Keeps the points that are far from the line between two others (Douglas and Peucker).
fn keep(points: &[(f64, f64)], first: usize, last: usize, kept: &mut [bool]) {
    let (Some(&from), Some(&to)) = (points.get(first), points.get(last)) else { return };
    (kept[first], kept[last]) = (true, true);
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = libm::hypot(dx, dy);
    let distance = |&(x, y): &(f64, f64)| {
        if length == 0.0 {
            libm::hypot(x - from.0, y - from.1)
        } else {
            ((x - from.0) * dy - (y - from.1) * dx).abs() / length
        }
    };
    let farthest = (first + 1..last).max_by(|&a, &b| distance(&points[a]).total_cmp(&distance(&points[b])));
    if let Some(index) = farthest.filter(|&index| distance(&points[index]) > TOLERANCE) {
        keep(points, first, index, kept);
        keep(points, index, last, kept);
    }
}
