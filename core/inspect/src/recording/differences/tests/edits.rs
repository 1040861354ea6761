//! Plans with known edits must report exactly these.

use crate::recording::alignment::Side;
use crate::recording::differences::*;
use crate::recording::test_random::Noise;
use alloc::{format, string::String, vec, vec::Vec};
use stepscope_peripheral::trace::Step;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Constant,
    Linear,
    SCurve,
    LinearUp,
    SCurveUp,
}

fn plan(shape: Shape, count: usize, slow: f64, fast: f64) -> Vec<f64> {
    let mut at = 0.0;
    let mut times = Vec::with_capacity(count);
    for k in 0..count {
        times.push(at);
        let done = (k as f64 + 0.5) / count as f64;
        let up = match shape {
            Shape::Constant => 0.0,
            Shape::Linear | Shape::SCurve => libm::fmin(libm::fmin(done, 1.0 - done) * 3.0, 1.0),
            Shape::LinearUp | Shape::SCurveUp => done,
        };
        let rate = match shape {
            // Over equal distances the square of the rate grows by the same amount.
            Shape::Linear | Shape::LinearUp => libm::sqrt(slow * slow + up * (fast * fast - slow * slow)),
            _ => slow + (fast - slow) * up * up * (3.0 - 2.0 * up),
        };
        at += 1.0 / rate;
    }
    times
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Edit {
    Missing(usize, usize),
    Extra(i64),
    Direction(usize),
}

struct Case {
    shape: Shape,
    slow: f64,
    fast: f64,
    count: usize,
    jitter: f64,
    clock_hz: u32,
    ppm: f64,
    edits: Vec<Edit>,
    seed: u64,
}

fn steps(rows: &[(f64, i32)], clock_hz: u32) -> Vec<Step> {
    let mut position = 0;
    rows.iter()
        .map(|(at, direction)| {
            position += direction;
            Step { cycle: libm::round(at * f64::from(clock_hz)) as u64, position }
        })
        .collect()
}

impl Case {
    fn recorded(&self, plan: &[f64]) -> Vec<(f64, i32)> {
        let mut noise = Noise(self.seed | 1);
        let offset = noise.between(0.01, 3.0);
        let mut rows: Vec<(f64, i32)> = Vec::new();
        let interval = |k: usize| {
            let k = k.min(plan.len() - 2);
            plan[k + 1] - plan[k]
        };
        for edit in &self.edits {
            if *edit == Edit::Extra(-1) {
                rows.push((-interval(0) * noise.between(0.5, 1.5), 1));
            }
        }
        for (k, at) in plan.iter().enumerate() {
            let missing = |edit: &Edit| matches!(edit, Edit::Missing(from, count) if (*from..from + count).contains(&k));
            if !self.edits.iter().any(missing) {
                let back = self.edits.contains(&Edit::Direction(k));
                rows.push((at + self.jitter * noise.between(-1.0, 1.0), if back { -1 } else { 1 }));
            }
            if self.edits.contains(&Edit::Extra(k as i64)) {
                rows.push((at + interval(k) * noise.between(0.3, 0.7), 1));
            }
        }
        for row in &mut rows {
            row.0 = offset + row.0 * (1.0 + self.ppm * 1e-6);
        }
        rows
    }

    fn expected(&self) -> Vec<String> {
        self.edits
            .iter()
            .map(|edit| match edit {
                Edit::Missing(from, count) => format!("-{from}x{count}"),
                Edit::Extra(after) => format!("+{after}x1"),
                Edit::Direction(step) => format!("~{step}x1"),
            })
            .collect()
    }

    fn found(&self) -> Vec<String> {
        let plan = plan(self.shape, self.count, self.slow, self.fast);
        let recorded = steps(&self.recorded(&plan), self.clock_hz);
        let rows: Vec<(f64, i32)> = plan.iter().map(|at| (*at, 1)).collect();
        let model = steps(&rows, 16_000_000);
        let side = |steps, clock_hz| Side { steps, clock_hz, values: &[] };
        let alignment = Alignment::of(side(&recorded, self.clock_hz), side(&model, 16_000_000), None);
        let Some(alignment) = alignment else { return vec!["none".into()] };
        let within = Tolerance::from_micros(1_000_000_000, 0).expect("a time");
        let found = Differences::of(&alignment, within);
        let row = |of: &Difference| {
            let step = of.step.map_or(-1, |step| step as i64);
            let sign = match of.kind {
                DifferenceKind::Missing => '-',
                DifferenceKind::Extra => '+',
                DifferenceKind::Direction => '~',
                DifferenceKind::Value | DifferenceKind::Late => '?',
            };
            format!("{sign}{step}x{}", of.count)
        };
        found.listed.iter().map(row).collect()
    }
}

/// One case per seed; `close` puts the edits within a dozen steps.
fn case(seed: u64, close: bool) -> Case {
    let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    for _ in 0..8 {
        noise.next();
    }
    let shapes = [Shape::Constant, Shape::Linear, Shape::SCurve, Shape::LinearUp, Shape::SCurveUp];
    let shape = shapes[noise.below(5)];
    let count = if noise.below(3) == 0 { 1000 + noise.below(4001) } else { 200 + noise.below(801) };
    let slow = noise.between(100.0, 1500.0);
    let fast = slow * noise.between(1.5, 10.0);
    let mut edits = Vec::new();
    let wanted = 1 + noise.below(5);
    let last = count - 1;
    let mut next = if close { 20 + noise.below(100) } else { 0 };
    // A constant rate does not show what is missing at its ends.
    let ends = shape != Shape::Constant;
    if ends && noise.below(3) == 0 {
        edits.push(if noise.below(3) == 0 { Edit::Extra(-1) } else { Edit::Missing(0, 1 + noise.below(8)) });
        next = next.max(10);
    }
    for _ in edits.len()..wanted {
        next += if close { 3 + noise.below(10) } else { 3 + noise.below(count / 5) };
        if next + 12 > last {
            break;
        }
        match noise.below(5) {
            0 | 1 => edits.push(Edit::Extra(next as i64)),
            2 => edits.push(Edit::Direction(next)),
            _ => {
                let many = 1 + if noise.below(3) == 0 { noise.below(3) } else { 0 };
                edits.push(Edit::Missing(next, many));
                next += many;
            }
        }
    }
    if noise.below(4) == 0 && edits.len() < 5 && ends {
        edits.push(if noise.below(3) == 0 {
            Edit::Extra(last as i64)
        } else {
            let many = 1 + noise.below(4);
            Edit::Missing(count - many, many)
        });
    }
    if edits.is_empty() {
        edits.push(Edit::Missing(count / 2, 1));
    }
    Case {
        shape,
        slow,
        fast,
        count,
        jitter: noise.between(0.0, 2e-6),
        clock_hz: 1_000_000 * (1 + noise.below(24)) as u32,
        ppm: noise.between(-200.0, 200.0),
        edits,
        seed: noise.next(),
    }
}

#[track_caller]
fn check(close: bool) {
    for seed in 1..=200 {
        let case = case(seed, close);
        assert_eq!(
            case.found(),
            case.expected(),
            "{close} {seed}: {:?}, {} steps, {:.0} to {:.0} steps/s, {:.2e} s of jitter, {} Hz, {:.0} ppm",
            case.shape,
            case.count,
            case.slow,
            case.fast,
            case.jitter,
            case.clock_hz,
            case.ppm
        );
    }
}

#[test]
fn all_edits_are_reported() {
    check(false);
}

#[test]
fn edits_within_a_dozen_steps_are_reported_apart() {
    check(true);
}
