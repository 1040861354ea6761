//! Prints the report of `stepscope capture`.

use super::{advice, comparison::PlanComparison};
use crate::torque::{self, AxisDemand};
use crate::{failure::plural, json::Tables, terminal};
use serde_json::{Value, json};
use std::io::{self, Write};
use stepscope_core::inspect::recording::{loaded_capture::LoadedCapture, report::ChannelReport};

const MAX_SHOWN: usize = 10;

pub(super) fn print(
    recording: &LoadedCapture,
    is_proposed: bool,
    comparison: Option<&PlanComparison>,
    demands: &[AxisDemand],
) -> io::Result<()> {
    let mut out = terminal::out();
    let LoadedCapture { format, count, contents, end_s, .. } = recording;
    writeln!(out, "file      {format}, {count} {contents} in {end_s} s")?;
    if !recording.names.is_empty() {
        writeln!(out, "channels  {}", recording.names.join(", "))?;
    }
    if recording.has_levels() {
        let proposed = if is_proposed { "   (proposed; --map sets another)" } else { "" };
        writeln!(out, "map       {}{proposed}", recording.map)?;
    }
    for note in &recording.notes {
        writeln!(out, "note      {}", advice::note(note))?;
    }
    writeln!(out, "clock     {} Hz: {}", recording.clock_hz, recording.rounding)?;
    for channel in &recording.report.channels {
        print_figures(&mut out, channel)?;
    }
    for line in &recording.report.lines {
        writeln!(out, "{}", advice::line(line))?;
    }
    if recording.report.channels.is_empty() && recording.report.lines.is_empty() {
        writeln!(out, "no channel has steps, and no line has bytes")?;
    }
    if !demands.is_empty() {
        writeln!(out, "torque")?;
        demands.iter().try_for_each(|demand| torque::text::report(demand, &mut out))?;
    }
    comparison.map_or(Ok(()), |comparison| print_comparison(&mut out, comparison))
}

fn print_figures(out: &mut impl Write, ChannelReport { channel, figures }: &ChannelReport) -> io::Result<()> {
    let of = figures;
    writeln!(
        out,
        "channel {channel}  {} step{}: {} right, {} left, {} turn{}; position {} ({} to {})",
        of.steps,
        plural(of.steps),
        of.right,
        of.left,
        of.turns,
        plural(of.turns),
        of.position,
        of.least_position,
        of.greatest_position
    )?;
    writeln!(out, "  from {} s to {} s", of.first_s, of.last_s)?;
    if let (Some(greatest), Some(mean), Some(shortest), Some(at), Some(longest)) = (
        of.max_rate_steps_s,
        of.mean_rate_steps_s,
        of.shortest_interval_s,
        of.shortest_at_s,
        of.longest_interval_s,
    ) {
        writeln!(out, "  maximum rate {greatest:.1} steps/s, mean {mean:.1} steps/s")?;
        writeln!(out, "  intervals {:.3} us (at {at} s) to {:.3} us", shortest * 1e6, longest * 1e6)?;
    }
    if let Some(acceleration) = of.greatest_acceleration_steps_s2 {
        writeln!(out, "  maximum acceleration {acceleration:.0} steps/s^2, over 8 steps")?;
    }
    Ok(())
}

fn print_comparison(out: &mut impl Write, comparison: &PlanComparison) -> io::Result<()> {
    let found = &comparison.result.comparison;
    let (what, one) = (comparison.result.kind.plural(), comparison.result.kind.singular());
    writeln!(
        out,
        "compared with the plan: {} {what} recorded, {} planned, {} in both, {} missing, {} extra",
        found.recorded, found.model, found.compared, found.missing, found.extra
    )?;
    let us = |seconds: f64| seconds * 1e6;
    writeln!(
        out,
        "  late: maximum {:.3} us ({one} {}, at {} s), RMS {:.3} us, mean {:.3} us",
        us(found.largest.late_s),
        found.largest.step,
        found.largest.recorded_s,
        us(found.rms_s),
        us(found.mean_s)
    )?;
    writeln!(
        out,
        "  drift {:.2} ppm; jitter maximum {:.3} us, RMS {:.3} us{}",
        found.drift_ppm,
        us(found.largest_jitter_s),
        us(found.rms_jitter_s),
        match found.outliers {
            0 => String::new(),
            1 => " (1 outlier excluded)".to_owned(),
            more => format!(" ({more} outliers excluded)"),
        }
    )?;
    let within = us(comparison.tolerance.seconds());
    let (differing, compared) = (found.differing, found.compared);
    match (differing, found.other_values) {
        (0, _) => writeln!(out, "  no {one} is off by more than {within:.3} us")?,
        (1, 0) => writeln!(out, "  1 of {compared} matched {what} is off by more than {within:.3} us")?,
        (_, 0) => {
            writeln!(out, "  {differing} of {compared} matched {what} are off by more than {within:.3} us")?
        }
        _ => writeln!(
            out,
            "  {differing} of {compared} matched {what} have another value or are off by more than {within:.3} us"
        )?,
    }
    let differences = &comparison.result.differences;
    for difference in differences.listed.iter().take(MAX_SHOWN) {
        writeln!(out, "  {}", difference.to_text(comparison.result.kind))?;
    }
    match differences.count.saturating_sub(MAX_SHOWN) {
        0 => Ok(()),
        more => writeln!(out, "  and {more} more"),
    }
}

pub(super) fn difference(comparison: &PlanComparison) -> String {
    let found = &comparison.result.differences;
    let first = found.listed.first().map_or_else(String::new, |first| first.to_text(comparison.result.kind));
    let more = match found.count {
        0 | 1 => String::new(),
        count => format!("; {count} differences in all"),
    };
    format!("the recording differs from the plan: {first}{more}")
}

pub(super) fn tables(
    tables: Tables,
    recording: &LoadedCapture,
    is_proposed: bool,
    comparison: Option<&PlanComparison>,
) -> Tables {
    let file = json!({
        "format": recording.format,
        "holds": recording.contents,
        "count": recording.count,
        "end_s": recording.end_s,
        "clock_hz": recording.clock_hz,
        "map": recording.map,
        "map_proposed": is_proposed,
        "rounding": recording.rounding,
    });
    let channels = recording.names.iter().map(|name| json!({ "channel": name }));
    let notes = recording.notes.iter().map(|note| json!({ "note": advice::note(note) }));
    let steps = recording.report.channels.iter().map(|channel| {
        let mut row = serde_json::to_value(channel.figures).unwrap_or_default();
        row["channel"] = channel.channel.into();
        row
    });
    let lines = recording.report.lines.iter().map(|line| -> Value {
        json!({
            "line": line.name,
            "baud": (line.baud > 0).then_some(line.baud),
            "uart": line.format,
            "measured_baud": line.measured.map(|measured| measured.baud),
            "bytes": line.decoded.bytes.len(),
            "framing_errors": line.decoded.framing_errors.len(),
            "parity_errors": line.decoded.parity_errors.len(),
            "packets": line.guess_text(),
            "problem": line.problem.as_ref().map(|text| advice::of_line(text, line)),
            "hint": line.hint.as_ref().map(|text| advice::of_line(text, line)),
        })
    });
    let summary = comparison.map(|comparison| {
        let found = &comparison.result.comparison;
        json!({
            "compares": comparison.result.kind.plural(),
            "other_values": found.other_values,
            "missing": found.missing,
            "extra": found.extra,
            "recorded": found.recorded,
            "model": found.model,
            "compared": found.compared,
            "differing": found.differing,
            "allowed_s": comparison.tolerance,
            "offset_s": found.offset_s,
            "largest_late_s": found.largest.late_s,
            "largest_index": found.largest.step,
            "rms_s": found.rms_s,
            "mean_s": found.mean_s,
            "drift_ppm": found.drift_ppm,
            "largest_jitter_s": found.largest_jitter_s,
            "rms_jitter_s": found.rms_jitter_s,
            "outliers": found.outliers,
            "first_difference_index": found.first_difference.map(|first| first.step),
            "first_difference_s": found.first_difference.map(|first| first.recorded_s),
        })
    });
    let events = comparison.into_iter().flat_map(|comparison| {
        let kind = comparison.result.kind;
        comparison.result.differences.listed.iter().map(move |difference| {
            let mut row = serde_json::to_value(difference).unwrap_or_default();
            row["text"] = difference.to_text(kind).into();
            row
        })
    });
    tables
        .with("recording", [file])
        .with("channels", channels)
        .with("notes", notes)
        .with("steps", steps)
        .with("lines", lines)
        .with("comparison", summary)
        .with("events", events)
}
