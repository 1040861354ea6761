//! Finds the polyline with minimum distortion of a sine for a number of segments (DESIGN B5).
//!
//! Levenberg-Marquardt minimizes the sum of squares of r_k = a_k/a_1 over the odd harmonics from several first
//! guesses. Sums go in one order and functions come from `libm`, so the result has the same bits on every target. The
//! minimum found may be local.

use crate::motion::sine_polyline::{Distortion, OddMultiples, Vertex, distortion, odd_harmonics, scale};
use alloc::{vec, vec::Vec};
use core::f64::consts::FRAC_PI_2;

/// Maximum segments per quarter.
pub const MAX_SEGMENTS: usize = 32;
const MAX_STEPS: u32 = 200;
/// Exponents of cos(angle), the density of breakpoints of a first guess.
const GUESSES: [f64; 4] = [0.4, 0.0, 0.7, 1.0];

/// Where vertices may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    OnCurve,
    Free,
}

/// The polyline of a sine with the minimum distortion.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// From angle 0 to pi/2, scaled so that free vertices have a first harmonic of 1.
    pub vertices: Vec<Vertex>,
    pub distortion: Distortion,
}

/// `None` unless `segments` (per quarter) is 1 to [`MAX_SEGMENTS`]; harmonics count up to `order`.
pub fn optimum(segments: usize, freedom: Freedom, order: u16) -> Option<Optimum> {
    if !(1..=MAX_SEGMENTS).contains(&segments) {
        return None;
    }
    let found = GUESSES.iter().map(|power| Search::new(segments, freedom, order, *power).run());
    let best = found.reduce(|best, other| if other.cost < best.cost { other } else { best })?;
    let mut vertices = best.vertices;
    if freedom == Freedom::Free {
        let first = odd_harmonics(&vertices, 1).first().copied().unwrap_or(1.0);
        for vertex in &mut vertices {
            vertex.height /= first;
        }
    }
    Some(Optimum { distortion: distortion(&vertices, order), vertices })
}

struct Search {
    freedom: Freedom,
    order: u16,
    vertices: Vec<Vertex>,
    cost: f64,
}

impl Search {
    fn new(segments: usize, freedom: Freedom, order: u16, power: f64) -> Self {
        let vertices = guess(segments, power);
        let cost = cost(&vertices, order);
        Self { freedom, order, vertices, cost }
    }

    fn run(mut self) -> Self {
        let mut damping = 1e-3;
        for _ in 0..MAX_STEPS {
            let (matrix, slope) = self.normal_equations();
            let before = self.cost;
            while damping < 1e12 {
                let step = solve(damped(&matrix, damping), &slope);
                if step.is_some_and(|step| self.try_step(&step)) {
                    damping /= 10.0;
                    break;
                }
                damping *= 4.0;
            }
            if before - self.cost <= 1e-12 * before {
                break;
            }
        }
        self
    }

    /// Moves the vertices if that lowers the cost; returns whether it does.
    fn try_step(&mut self, step: &[f64]) -> bool {
        let inner = self.vertices.len() - 2;
        let mut moved = self.vertices.clone();
        for (index, vertex) in moved.iter_mut().skip(1).take(inner).enumerate() {
            vertex.angle += step.get(index).copied().unwrap_or(0.0);
            match self.freedom {
                Freedom::OnCurve => vertex.height = libm::cos(vertex.angle),
                Freedom::Free => vertex.height += step.get(inner + index).copied().unwrap_or(0.0),
            }
        }
        let rises = moved.iter().zip(moved.iter().skip(1)).all(|(a, b)| b.angle - a.angle > 1e-6);
        let cost = if rises { cost(&moved, self.order) } else { f64::INFINITY };
        if cost < self.cost {
            (self.vertices, self.cost) = (moved, cost);
            true
        } else {
            false
        }
    }

    /// Matrix and right-hand side: J'J and -J'r.
    fn normal_equations(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let harmonics = odd_harmonics(&self.vertices, self.order);
        let first = harmonics.first().copied().unwrap_or(1.0);
        let columns = self.derivatives();
        // dr_k = (da_k - r_k*da_1)/a_1; the first harmonic has none.
        let ratios: Vec<f64> = harmonics.iter().skip(1).map(|a| a / first).collect();
        let columns: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| {
                let of_first = column.first().copied().unwrap_or(0.0);
                column.iter().skip(1).zip(&ratios).map(|(d, r)| (d - r * of_first) / first).collect()
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let matrix = columns.iter().map(|a| columns.iter().map(|b| dot(a, b)).collect()).collect();
        let slope = columns.iter().map(|column| -dot(column, &ratios)).collect();
        (matrix, slope)
    }

    /// Derivatives of the harmonics by each inner angle and, if free, each inner height.
    fn derivatives(&self) -> Vec<Vec<f64>> {
        let inner = self.vertices.len() - 2;
        let by_angle = (1..=inner).map(|index| self.derivative(index, true));
        let by_height = (1..=inner).map(|index| self.derivative(index, false));
        match self.freedom {
            Freedom::Free => by_angle.chain(by_height).collect(),
            Freedom::OnCurve => by_angle
                .zip(by_height)
                .zip(self.vertices.iter().skip(1))
                .map(|((angle, height), vertex)| {
                    // On the curve the height falls with sin(angle).
                    let falls = libm::sin(vertex.angle);
                    angle.iter().zip(&height).map(|(a, h)| a - falls * h).collect()
                })
                .collect(),
        }
    }

    /// Derivatives of the harmonics by the angle or the height of one vertex.
    fn derivative(&self, index: usize, by_angle: bool) -> Vec<f64> {
        let at =
            |index: usize| self.vertices.get(index).copied().unwrap_or(Vertex { angle: 0.0, height: 0.0 });
        let (before, this, after) = (at(index - 1), at(index), at(index + 1));
        let (left, right) = (this.angle - before.angle, after.angle - this.angle);
        let (slope_left, slope_right) =
            ((this.height - before.height) / left, (after.height - this.height) / right);
        let (gain_left, gain_right) =
            if by_angle { (-slope_left / left, slope_right / right) } else { (1.0 / left, -1.0 / right) };
        let bend = slope_left - slope_right;
        let cosines = OddMultiples::cosines(before.angle)
            .zip(OddMultiples::cosines(this.angle))
            .zip(OddMultiples::cosines(after.angle));
        let count = usize::from(self.order).div_ceil(2);
        // The last vertex's cosine is 0 for every odd k, but not after rounding.
        let last = index + 2 == self.vertices.len();
        cosines
            .take(count)
            .zip(OddMultiples::sines(this.angle))
            .enumerate()
            .map(|(harmonic, (((before, this), after), sine))| {
                let after = if last { 0.0 } else { after };
                let k = (2 * harmonic + 1) as f64;
                let turn = if by_angle { bend * k * sine } else { 0.0 };
                scale(harmonic)
                    * (-gain_left * before + (gain_left - gain_right) * this + gain_right * after - turn)
            })
            .collect()
    }
}

fn guess(segments: usize, power: f64) -> Vec<Vertex> {
    const PARTS: u16 = 4096;
    let angle = |part: u16| f64::from(part) * FRAC_PI_2 / f64::from(PARTS);
    let weight = |part: u16| libm::pow(libm::cos(angle(part) + FRAC_PI_2 / f64::from(2 * PARTS)), power);
    let all: f64 = (0..PARTS).map(weight).sum();
    let (mut vertices, mut sum) = (vec![Vertex { angle: 0.0, height: 1.0 }], 0.0);
    for part in 0..PARTS {
        if vertices.len() < segments && sum >= all * vertices.len() as f64 / segments as f64 {
            vertices.push(Vertex { angle: angle(part), height: libm::cos(angle(part)) });
        }
        sum += weight(part);
    }
    vertices.push(Vertex { angle: FRAC_PI_2, height: 0.0 });
    vertices
}

fn cost(vertices: &[Vertex], order: u16) -> f64 {
    let position = distortion(vertices, order).position;
    position * position
}

fn damped(matrix: &[Vec<f64>], damping: f64) -> Vec<Vec<f64>> {
    let mut matrix = matrix.to_vec();
    for (index, row) in matrix.iter_mut().enumerate() {
        if let Some(diagonal) = row.get_mut(index) {
            *diagonal *= 1.0 + damping;
        }
    }
    matrix
}

/// Gaussian elimination; `None` if the matrix is not positive definite.
fn solve(mut rows: Vec<Vec<f64>>, right: &[f64]) -> Option<Vec<f64>> {
    for (row, value) in rows.iter_mut().zip(right) {
        row.push(*value);
    }
    let count = rows.len();
    for pivot in 0..count {
        let (done, below) = rows.split_at_mut(pivot + 1);
        let row = done.last()?;
        let head = *row.get(pivot)?;
        if head.is_nan() || head <= 0.0 {
            return None;
        }
        for other in below {
            let factor = *other.get(pivot)? / head;
            for (a, b) in other.iter_mut().zip(row).skip(pivot) {
                *a -= factor * b;
            }
        }
    }
    let mut found = vec![0.0; count];
    for pivot in (0..count).rev() {
        let row = rows.get(pivot)?;
        let known: f64 = row.iter().zip(&found).skip(pivot + 1).map(|(a, x)| a * x).sum();
        let value = (row.get(count)? - known) / row.get(pivot)?;
        *found.get_mut(pivot)? = value;
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_optima_of_3_to_6_segments_are_reached() {
        let rows = [
            (3, Freedom::Free, 0.951),
            (4, Freedom::Free, 0.515),
            (5, Freedom::Free, 0.322),
            (6, Freedom::Free, 0.221),
            (3, Freedom::OnCurve, 0.977),
            (4, Freedom::OnCurve, 0.535),
            (5, Freedom::OnCurve, 0.338),
            (6, Freedom::OnCurve, 0.233),
        ];
        for (segments, freedom, percent) in rows {
            let found = optimum(segments, freedom, 399).unwrap();
            assert_eq!(found.vertices.len(), segments + 1);
            let reached = found.distortion.position * 100.0;
            // Their last digit is rounded.
            assert!(
                reached <= percent * 1.01 && reached >= percent - 0.001,
                "{segments} {freedom:?}: {reached}"
            );
        }
    }

    #[test]
    fn more_segments_or_freedom_reduce_the_distortion() {
        let mut before = [f64::INFINITY; 2];
        for segments in 1..=12 {
            let found = [Freedom::OnCurve, Freedom::Free].map(|freedom| {
                let optimum = optimum(segments, freedom, 399).unwrap();
                let rises = optimum.vertices.windows(2).all(|pair| pair[0].angle < pair[1].angle);
                assert!(rises, "{optimum:?}");
                optimum.distortion.position
            });
            assert!(found[1] <= found[0] * (1.0 + 1e-9), "{segments}: {found:?}");
            assert!(found[0] < before[0] && found[1] < before[1], "{segments}: {found:?}");
            before = found;
        }
        assert_eq!((optimum(0, Freedom::Free, 399), optimum(33, Freedom::Free, 399)), (None, None));
    }

    #[test]
    fn an_optimum_is_better_than_its_neighbors() {
        for freedom in [Freedom::OnCurve, Freedom::Free] {
            let found = optimum(5, freedom, 399).unwrap();
            let min = found.distortion.position;
            for index in 1..5 {
                for (turn, lift) in [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3)] {
                    let mut vertices = found.vertices.clone();
                    vertices[index].angle += turn;
                    if freedom == Freedom::OnCurve {
                        vertices[index].height = libm::cos(vertices[index].angle);
                    } else {
                        vertices[index].height += lift;
                    }
                    let other = distortion(&vertices, 399).position;
                    assert!(other >= min, "{freedom:?} {index} {turn} {lift}: {other} {min}");
                }
            }
        }
    }
}
