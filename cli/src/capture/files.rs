//! Writes the files of a recording.

use super::{arguments::Arguments, comparison::PlanComparison};
use crate::output::{Out, Outputs};
use crate::{failure::Failure, quantity::Microseconds, scenario_file};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use stepscope_core::inspect::export::tables::{write_edges_head, write_edges_row};
use stepscope_core::inspect::export::vcd::VcdWriter;
use stepscope_core::inspect::recording::{loaded_capture::LoadedCapture, packets::Packets};
use stepscope_core::peripheral::signal::Sink;
use stepscope_core::peripheral::trace::{Step, write_record};
use stepscope_core::scenario::Scenario;

pub(super) fn write(
    arguments: &Arguments,
    outputs: &mut Outputs,
    recording: &LoadedCapture,
    comparison: Option<&PlanComparison>,
    planned: Option<&Scenario>,
) -> Result<(), Failure> {
    if arguments.vcd.is_some() {
        arguments.vcd_timescale.of_clock(recording.clock_hz).map_err(Failure::Timescale)?;
    }
    // Validate before a file is created.
    let channels = &recording.report.channels;
    if arguments.steps.is_some() && channels.iter().all(|report| report.channel != arguments.channel) {
        let others: Vec<String> = channels.iter().map(|report| report.channel.to_string()).collect();
        let remedy = match others.as_slice() {
            [] => "map a channel to STEP0, such as --map STEP0=CH1".to_owned(),
            [only] => format!("use {only}"),
            _ => format!("use one of {}", others.join(", ")),
        };
        return Err(arguments.invalid(format!("--channel: {} has no steps; {remedy}", arguments.channel)));
    }
    let text = arguments
        .write_scenario
        .as_ref()
        .map(|path| scenario(path, arguments, recording, planned))
        .transpose()?;
    let mut file = |path: &Option<PathBuf>, write: &dyn Fn(&mut Out) -> io::Result<()>| {
        let Some(path) = path else { return Ok(()) };
        let mut out = outputs.create(path)?;
        write(&mut out).and_then(|()| out.flush()).map_err(|error| Failure::File(path.clone(), error))
    };
    file(&arguments.write_scenario, &|out| {
        text.as_ref().map_or(Ok(()), |text| out.write_all(text.as_bytes()))
    })?;
    file(&arguments.late, &|out| comparison.map_or(Ok(()), |comparison| late(out, comparison)))?;
    file(&arguments.steps, &|out| steps(out, &recording.steps_of(arguments.channel)))?;
    file(&arguments.bytes, &|out| bytes(out, recording))?;
    file(&arguments.packets, &|out| {
        let addressed = planned.is_some_and(|planned| planned.line.address.is_some());
        let packets = Packets::of(&recording.report, recording.clock_hz, recording.channels, addressed);
        let mut text = String::new();
        packets.write_csv(&mut text).map_err(io::Error::other)?;
        out.write_all(text.as_bytes())
    })?;
    file(&arguments.trace, &|out| {
        let mut text = String::new();
        recording.records.iter().try_for_each(|record| {
            text.clear();
            write_record(&mut text, *record).map_err(io::Error::other)?;
            out.write_all(text.as_bytes())
        })
    })?;
    file(&arguments.csv, &|out| {
        let mut text = String::new();
        write_edges_head(&mut text, recording.channels).map_err(io::Error::other)?;
        for record in &recording.records {
            write_edges_row(&mut text, *record, recording.clock_hz, recording.channels)
                .map_err(io::Error::other)?;
            out.write_all(text.as_bytes())?;
            text.clear();
        }
        out.write_all(text.as_bytes())
    })?;
    file(&arguments.vcd, &|out| {
        let (clock_hz, channels) = (recording.clock_hz, recording.channels);
        let mut writer = VcdWriter::with_signals(out, arguments.vcd_timescale, clock_hz, channels, &[], [])?;
        recording.records.iter().for_each(|record| writer.record(*record));
        let end = (recording.end_s * f64::from(clock_hz)).ceil() as u64;
        writer.finish(end.max(recording.records.last().map_or(0, |record| record.cycle.0)))
    })
}

fn scenario(
    path: &Path,
    arguments: &Arguments,
    recording: &LoadedCapture,
    planned: Option<&Scenario>,
) -> Result<String, Failure> {
    let scenario = recording
        .scenario(
            &arguments.name(),
            arguments.of_steps,
            arguments.error_us.map_or(0.0, Microseconds::get),
            planned,
        )
        .map_err(|refused| {
            arguments.invalid(format!("cannot make a scenario from this recording: {refused}"))
        })?;
    scenario_file::text(path, &scenario, "use --error-us with a larger error, which needs fewer segments")
}

/// A missing or additional step has a row with one empty time.
fn late(out: &mut Out, comparison: &PlanComparison) -> io::Result<()> {
    let one = comparison.recorded.kind.singular();
    writeln!(out, "{one},recorded_{one},recorded_s,late_s,other_direction,event")?;
    let alignment = comparison.recorded.alignment(&comparison.planned, &comparison.result);
    let (mut step, mut recorded_step, mut index) = (0, 0, 0);
    let ends = [(comparison.planned.len(), comparison.recorded.len(), 0)];
    let runs = alignment.matching.runs().iter().map(|run| (run.model, run.recorded, run.count));
    for (model, recorded, count) in runs.chain(ends) {
        (step..model).try_for_each(|step| writeln!(out, "{step},,,,,missing"))?;
        for extra in recorded_step..recorded {
            writeln!(out, ",{extra},{},,,extra", comparison.recorded.at_s(extra).unwrap_or(0.0))?;
        }
        for off in (index..index + count).filter_map(|index| alignment.deviation(index)) {
            let (step, recorded, other) = (off.step, off.recorded_step, u8::from(off.other_direction));
            let event = if off.other_value { "value" } else { "" };
            writeln!(out, "{step},{recorded},{},{:e},{other},{event}", off.recorded_s, off.late_s)?;
        }
        (step, recorded_step, index) = (model + count, recorded + count, index + count);
    }
    Ok(())
}

fn steps(out: &mut Out, steps: &[Step]) -> io::Result<()> {
    writeln!(out, "cycle,dir")?;
    let rows = steps.iter().enumerate();
    rows.map(|(index, step)| (step.cycle, u8::from(Step::direction(steps, index) > 0)))
        .try_for_each(|(cycle, dir)| writeln!(out, "{cycle},{dir}"))
}

fn bytes(out: &mut Out, recording: &LoadedCapture) -> io::Result<()> {
    writeln!(out, "line,start_cycle,start_s,bytes")?;
    for line in &recording.report.lines {
        for decoded in &line.decoded.bytes {
            let cycle = decoded.start.0;
            let seconds = cycle as f64 / f64::from(recording.clock_hz);
            writeln!(out, "{},{cycle},{seconds},{:02x}", line.name, decoded.byte)?;
        }
    }
    Ok(())
}
