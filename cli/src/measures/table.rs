//! Prints measures as text and CSV.

use crate::{json::Tables, measures::distortion::Distortion};
use serde_json::json;
use std::io::{self, Write};
use stepscope_core::inspect::motion::measures::{CurveMetrics, Measures, PulseErrors};

/// A figure with a value per column of its group.
struct Row {
    measure: String,
    unit: &'static str,
    values: Vec<Option<f64>>,
}

struct Group {
    name: &'static str,
    title: String,
    /// Name in CSV, and heading in text.
    columns: Vec<(&'static str, &'static str)>,
    rows: Vec<Row>,
}

impl Group {
    fn new(name: &'static str, title: impl Into<String>, columns: &[(&'static str, &'static str)]) -> Self {
        Self { name, title: title.into(), columns: columns.to_vec(), rows: Vec::new() }
    }

    fn row(&mut self, measure: impl Into<String>, unit: &'static str, values: Vec<Option<f64>>) {
        self.rows.push(Row { measure: measure.into(), unit, values });
    }
}

type Figure<T> = fn(&T) -> Option<f64>;

const ONE: &[(&str, &str)] = &[("", "")];

pub(super) fn text(
    axis: usize,
    found: &Measures,
    distortion: Option<&Distortion>,
    out: &mut impl Write,
) -> io::Result<()> {
    writeln!(out, "axis {axis}")?;
    for group in groups(found, distortion) {
        let headings: String = group.columns.iter().map(|(_, heading)| format!(" {heading:>18}")).collect();
        writeln!(out, "\n{}", format!("{:40}{headings}", group.title).trim_end())?;
        for Row { measure, unit, values } in group.rows {
            write!(out, "  {measure:28} {unit:9}")?;
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
            for ((of, _), value) in columns.iter().zip(values) {
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
            for ((of, _), value) in columns.iter().zip(values) {
                let row = json!({ "axis": axis, "group": name, "measure": measure, "of": of, "value": value, "unit": unit });
                figures.push(row);
            }
        }
    }
    Tables::of("measures").with("figures", figures)
}

fn groups(found: &Measures, distortion: Option<&Distortion>) -> Vec<Group> {
    let mut groups = vec![deviation(found), errors(found), duration(found), peaks(found)];
    groups.extend(distortion.map(harmonics));
    groups.extend(sine(found));
    groups
}

fn deviation(found: &Measures) -> Group {
    let columns = [("steps", "ideal to steps"), ("ticks", "steps to pulses"), ("pulses", "ideal to pulses")];
    let title = format!("deviation over {} s", found.length_s);
    let mut group = Group::new("deviation", title, &columns);
    add_curve_metrics(&mut group, &[&found.steps, &found.ticks, &found.pulses]);
    group
}

fn add_curve_metrics(group: &mut Group, pairs: &[&CurveMetrics]) {
    let points = pairs.first().map_or(0, |pair| pair.points);
    let rows: [(String, _, Figure<CurveMetrics>); 9] = [
        ("largest".into(), "steps", |pair| Some(pair.largest_steps)),
        ("largest at".into(), "s", |pair| Some(pair.largest_at_s)),
        ("r.m.s.".into(), "steps", |pair| Some(pair.rms_steps)),
        ("area between".into(), "steps*s", |pair| Some(pair.area_steps_s)),
        ("difference of areas".into(), "steps*s", |pair| Some(pair.area_difference_steps_s)),
        (format!("sum of squares ({points} points)"), "steps^2", |pair| Some(pair.sum_of_squares_steps2)),
        (format!("Euclidean ({points} points)"), "steps", |pair| Some(pair.euclidean_steps)),
        ("correlation".into(), "", |pair| pair.correlation),
        ("1 - correlation".into(), "", |pair| pair.uncorrelated),
    ];
    for (measure, unit, of) in rows {
        group.row(measure, unit, pairs.iter().map(|pair| of(pair)).collect());
    }
}

fn errors(found: &Measures) -> Group {
    let columns = [("steps", "whole cycles"), ("ticks", "ticks and link")];
    let mut group = Group::new("pulses", "time and position errors of pulses", &columns);
    let rows: [(_, _, Figure<PulseErrors>); 7] = [
        ("largest time error", "us", |errors| Some(errors.largest_s * 1e6)),
        ("largest at", "s", |errors| Some(errors.largest_at_s)),
        ("mean time error", "us", |errors| Some(errors.mean_s * 1e6)),
        ("r.m.s. time error", "us", |errors| Some(errors.rms_s * 1e6)),
        ("largest position error", "steps", |errors| Some(errors.largest_steps)),
        ("r.m.s. position error", "steps", |errors| Some(errors.rms_steps)),
        ("pulses", "", |errors| Some(errors.pulses as f64)),
    ];
    for (measure, unit, of) in rows {
        group.row(measure, unit, vec![of(&found.step_errors), of(&found.tick_errors)]);
    }
    group.row("pulses without a step", "", vec![Some(0.0), Some(found.counts.stray as f64)]);
    group
}

fn duration(found: &Measures) -> Group {
    let mut group = Group::new("duration", "duration", ONE);
    let times = &found.duration;
    let rows = [
        ("requested", "s", times.requested_s),
        ("planned", "s", Some(times.planned_s)),
        ("planned minus requested", "s", times.plan_error_s),
        ("last step due", "s", times.last_due_s),
        ("last pulse", "s", times.last_pulse_s),
        ("last pulse late by", "us", times.end_error_s.map(|late_s| late_s * 1e6)),
        ("steps due", "", Some(found.counts.due as f64)),
        ("actual pulses", "", Some(found.counts.actual as f64)),
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
        ("jump of speed", "steps/s", peaks.speed_jump_steps_s),
        ("jump of acceleration", "steps/s^2", peaks.acceleration_jump_steps_s2),
        ("start-stop rate", "steps/s", peaks.start_stop_steps_s),
    ];
    rows.into_iter().for_each(|(measure, unit, value)| group.row(measure, unit, vec![Some(value)]));
    group
}

fn harmonics(distortion: &Distortion) -> Group {
    let title = format!("THD to harmonic {}", distortion.ideal.order);
    let mut group = Group::new("distortion", title, &[("ideal", "ideal"), ("pulses", "pulses")]);
    for (name, ratios) in distortion.rows() {
        let percents = ratios.iter().map(|ratio| ratio.map(|ratio| ratio * 100.0)).collect();
        group.row(name.replace('_', " "), "%", percents);
    }
    group
}

fn sine(found: &Measures) -> Option<Group> {
    let sine = found.sine.as_ref()?;
    let columns = [("sine", "sine to segments")];
    let mut group = Group::new("sine", "a quarter of the sine by segments", &columns);
    group.row("segments", "", vec![Some(sine.segments as f64)]);
    group.row("Ev in parts of the amplitude", "", vec![Some(sine.euclidean)]);
    add_curve_metrics(&mut group, &[&sine.quarter]);
    Some(group)
}

fn six_digits(value: f64) -> String {
    if value == value.trunc() && value.abs() < 1e15 {
        // Prints -0 as 0.
        return format!("{}", value + 0.0);
    }
    let power: i32 =
        format!("{value:.5e}").rsplit('e').next().and_then(|power| power.parse().ok()).unwrap_or(0);
    if !(-5..9).contains(&power) {
        return format!("{value:.5e}");
    }
    format!("{value:.*}", usize::try_from(5 - power).unwrap_or(0))
}
