//! Prints measures as text and CSV.

use crate::{json::Tables, measures::distortion::Distortion};
use serde_json::json;
use std::io::{self, Write};
use stepscope_core::inspect::motion::measures::{CurveMetrics, Measures, PulseErrors};

/// A figure with a value per column of its group.
struct Row {
    /// In snake_case; the text has spaces instead.
    measure: &'static str,
    unit: &'static str,
    values: Vec<Option<f64>>,
}

struct Group {
    name: &'static str,
    title: String,
    /// As the measures.
    columns: &'static [&'static str],
    rows: Vec<Row>,
}

impl Group {
    fn new(name: &'static str, title: impl Into<String>, columns: &'static [&'static str]) -> Self {
        Self { name, title: title.into(), columns, rows: Vec::new() }
    }

    fn row(&mut self, measure: &'static str, unit: &'static str, values: Vec<Option<f64>>) {
        self.rows.push(Row { measure, unit, values });
    }
}

type Getter<T> = fn(&T) -> Option<f64>;

const ONE: &[&str] = &[""];

pub(super) fn text(
    axis: usize,
    found: &Measures,
    distortion: Option<&Distortion>,
    out: &mut impl Write,
) -> io::Result<()> {
    writeln!(out, "axis {axis}")?;
    for group in groups(found, distortion) {
        let headings: String = group.columns.iter().map(|name| format!(" {:>18}", words(name))).collect();
        writeln!(out, "\n{}", format!("{:40}{headings}", group.title).trim_end())?;
        for Row { measure, unit, values } in group.rows {
            write!(out, "  {:28} {unit:9}", words(measure))?;
            values
                .iter()
                .try_for_each(|value| write!(out, " {:>18}", value.map_or_else(|| "-".into(), six_digits)))?;
            writeln!(out)?;
        }
    }
    Ok(())
}

pub(super) fn csv(found: &Measures, distortion: Option<&Distortion>, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "group,measure,of,value,unit")?;
    for Group { name, columns, rows, .. } in groups(found, distortion) {
        for Row { measure, unit, values } in &rows {
            for (of, value) in columns.iter().zip(values) {
                let value = value.map_or_else(String::new, |value| value.to_string());
                writeln!(out, "{name},{measure},{of},{value},{unit}")?;
            }
        }
    }
    Ok(())
}

pub(super) fn tables(axis: usize, found: &Measures, distortion: Option<&Distortion>) -> Tables {
    let mut figures = Vec::new();
    for Group { name, columns, rows, .. } in groups(found, distortion) {
        for Row { measure, unit, values } in &rows {
            for (of, value) in columns.iter().zip(values) {
                let row = json!({ "axis": axis, "group": name, "measure": measure, "of": of, "value": value, "unit": unit });
                figures.push(row);
            }
        }
    }
    Tables::of("measures").with("figures", figures)
}

fn words(name: &str) -> String {
    name.replace('_', " ")
}

fn groups(found: &Measures, distortion: Option<&Distortion>) -> Vec<Group> {
    let mut groups = vec![deviation(found), errors(found), duration(found), peaks(found)];
    groups.extend(distortion.map(harmonics));
    groups.extend(sine(found));
    groups
}

fn deviation(found: &Measures) -> Group {
    let title = format!("deviation over {} s ({} points)", found.length_s, found.steps.points);
    let columns = &["ideal_to_steps", "steps_to_pulses", "ideal_to_pulses"];
    let mut group = Group::new("deviation", title, columns);
    add_curve_metrics(&mut group, &[&found.steps, &found.ticks, &found.pulses]);
    group
}

fn add_curve_metrics(group: &mut Group, pairs: &[&CurveMetrics]) {
    let rows: [(_, _, Getter<CurveMetrics>); 9] = [
        ("largest", "steps", |pair| Some(pair.largest_steps)),
        ("time_of_largest", "s", |pair| Some(pair.largest_at_s)),
        ("rms", "steps", |pair| Some(pair.rms_steps)),
        ("area_between", "steps*s", |pair| Some(pair.area_steps_s)),
        ("difference_of_areas", "steps*s", |pair| Some(pair.area_difference_steps_s)),
        ("sum_of_squares", "steps^2", |pair| Some(pair.sum_of_squares_steps2)),
        ("euclidean_distance", "steps", |pair| Some(pair.euclidean_steps)),
        ("correlation", "", |pair| pair.correlation),
        ("one_minus_correlation", "", |pair| pair.uncorrelated),
    ];
    for (measure, unit, of) in rows {
        group.row(measure, unit, pairs.iter().map(|pair| of(pair)).collect());
    }
}

fn errors(found: &Measures) -> Group {
    let columns = &["ideal_to_steps", "steps_to_pulses"];
    let mut group = Group::new("pulses", "time and position errors of pulses", columns);
    let rows: [(_, _, Getter<PulseErrors>); 7] = [
        ("largest_time_error", "us", |errors| Some(errors.largest_s * 1e6)),
        ("time_of_largest", "s", |errors| Some(errors.largest_at_s)),
        ("mean_time_error", "us", |errors| Some(errors.mean_s * 1e6)),
        ("rms_time_error", "us", |errors| Some(errors.rms_s * 1e6)),
        ("largest_position_error", "steps", |errors| Some(errors.largest_steps)),
        ("rms_position_error", "steps", |errors| Some(errors.rms_steps)),
        ("pulses", "", |errors| Some(errors.pulses as f64)),
    ];
    for (measure, unit, of) in rows {
        group.row(measure, unit, vec![of(&found.step_errors), of(&found.tick_errors)]);
    }
    group.row("pulses_without_a_step", "", vec![Some(0.0), Some(found.counts.stray as f64)]);
    group
}

fn duration(found: &Measures) -> Group {
    let mut group = Group::new("duration", "duration", ONE);
    let times = &found.duration;
    let rows = [
        ("requested", "s", times.requested_s),
        ("planned", "s", Some(times.planned_s)),
        ("planned_minus_requested", "s", times.plan_error_s),
        ("last_step_due", "s", times.last_due_s),
        ("last_pulse", "s", times.last_pulse_s),
        ("delay_of_last_pulse", "us", times.end_error_s.map(|late_s| late_s * 1e6)),
        ("steps_due", "", Some(found.counts.due as f64)),
        ("actual_pulses", "", Some(found.counts.actual as f64)),
    ];
    rows.into_iter().for_each(|(measure, unit, value)| group.row(measure, unit, vec![value]));
    group
}

fn peaks(found: &Measures) -> Group {
    let mut group = Group::new("peaks", "peaks of the ideal curve", ONE);
    let peaks = &found.peaks;
    let rows = [
        ("speed", "steps/s", peaks.speed_steps_s),
        ("acceleration", "steps/s^2", peaks.acceleration_steps_s2),
        ("jerk", "steps/s^3", peaks.jerk_steps_s3),
        ("jump_of_speed", "steps/s", peaks.speed_jump_steps_s),
        ("jump_of_acceleration", "steps/s^2", peaks.acceleration_jump_steps_s2),
        ("start_stop_rate", "steps/s", peaks.start_stop_steps_s),
    ];
    rows.into_iter().for_each(|(measure, unit, value)| group.row(measure, unit, vec![Some(value)]));
    group
}

fn harmonics(distortion: &Distortion) -> Group {
    let title = format!("THD to harmonic {}", distortion.ideal.order);
    let mut group = Group::new("distortion", title, &["ideal", "pulses"]);
    for (name, ratios) in distortion.rows() {
        let percents = ratios.iter().map(|ratio| ratio.map(|ratio| ratio * 100.0)).collect();
        group.row(name, "%", percents);
    }
    group
}

fn sine(found: &Measures) -> Option<Group> {
    let sine = found.sine.as_ref()?;
    let title = format!("a quarter of the sine by segments ({} points)", sine.quarter.points);
    let mut group = Group::new("sine", title, &["sine_to_segments"]);
    group.row("segments", "", vec![Some(sine.segments as f64)]);
    group.row("euclidean_per_amplitude", "", vec![Some(sine.euclidean)]);
    add_curve_metrics(&mut group, &[&sine.quarter]);
    Some(group)
}

/// Six significant digits; whole numbers, and digits before the point up to 10^9, completely.
fn six_digits(value: f64) -> String {
    if value == value.trunc() && value.abs() < 1e15 {
        // Prints -0 as 0.
        return format!("{}", value + 0.0);
    }
    // After rounding: 9.999999 is 10.
    let power: i32 =
        format!("{value:.5e}").rsplit('e').next().and_then(|power| power.parse().ok()).unwrap_or(0);
    if !(-5..9).contains(&power) {
        return format!("{value:.5e}");
    }
    format!("{value:.*}", usize::try_from(5 - power).unwrap_or(0))
}
