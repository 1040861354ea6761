//! `stepscope capture`: a recording of your own firmware or host, analyzed like a run.
//!
//! ```text
//! file -> read -> channel map, clock -> records -> report, timing, comparison with a scenario's run, files
//! ```

mod advice;
mod arguments;
mod comparison;
mod files;
mod text;

use crate::output::{Outputs, STANDARD};
use crate::timing::{self, TimeUnit};
use crate::torque::{self, AxisDemand};
use crate::{failure::Failure, json::Tables, pipe, progress::Progress, scenarios, suggest};
pub(crate) use arguments::Arguments;
use comparison::PlanComparison;
use std::io::{self, BufReader, Cursor, Read};
use std::path::Path;
use stepscope_core::capture::ChannelMap;
use stepscope_core::capture::read::{self, Limits, ReadOptions, Reading};
use stepscope_core::capture::samples::{SAMPLES, sample};
use stepscope_core::inspect::{
    motion::torque::Machine, recording::loaded_capture::LoadedCapture, trace::timing::TimingCheck,
};
use stepscope_core::peripheral::signal::Sink;
use stepscope_core::scenario::{Scenario, SegmentLists, Source, TimingRules};

/// Maximum bytes of a recording from a pipe, which is kept in memory because it cannot be read twice.
const MAX_PIPED: u64 = 1 << 30;

pub(crate) fn capture(arguments: &Arguments) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    let mut progress = Progress::new("capture", arguments.show.progress);
    let Reading { capture, error } = read(arguments, &mut progress)?;
    if let Some(error) = error.as_ref().filter(|_| capture.is_empty()) {
        return Err(arguments.invalid(error));
    }
    // A pipe can be read only once.
    let against = arguments.against.as_deref().map(scenarios::validated).transpose()?;
    let planned = against.as_ref().map(|(scenario, _)| &**scenario);
    let rules = arguments.timing.rules(&arguments.file, &planned.cloned().unwrap_or_default())?;
    let max_violations = arguments.timing.max_violations();
    // In the file's ticks if they are no whole cycles, because rounding could hide a short pulse. It comes before
    // `LoadedCapture`, which reuses the capture's memory.
    let in_ticks = rules.as_ref().map(|rules| {
        LoadedCapture::timing_in_ticks(&capture, &arguments.open_options(), rules, max_violations)
    });
    let in_ticks = in_ticks.transpose().map_err(|error| arguments.open_failure(&error))?.flatten();
    let recording = LoadedCapture::new(capture, &arguments.open_options())
        .map_err(|error| arguments.open_failure(&error))?;
    // A proposed line may be invalid, but not one that the user mapped.
    let invalid_line = recording.report.lines.iter().find(|line| line.problem.is_some());
    if let Some(line) = invalid_line.filter(|_| arguments.map.is_some()) {
        return Err(arguments.invalid(advice::line(line)));
    }
    let comparison = match (&arguments.against, &against) {
        (Some(path), Some(plan)) => Some(PlanComparison::new(arguments, &recording, path, plan)?),
        _ => None,
    };
    let timing = match in_ticks {
        Some((check, base)) => Some((check, TimeUnit::of_ticks(base, recording.clock_hz))),
        None => rules.and_then(|rules| {
            let check = timing_in_cycles(&recording, &rules, max_violations)?;
            Some((check, TimeUnit::of_cycles(recording.clock_hz)))
        }),
    };
    files::write(arguments, &mut outputs, &recording, comparison.as_ref(), planned)?;
    if let (Some(path), Some((check, unit))) = (&arguments.timing.violations, &timing) {
        let written = timing::write_violations(outputs.create(path)?, check, *unit);
        written.map_err(|error| Failure::File(path.clone(), error))?;
    }
    progress.end(format_args!("{} {}", recording.count, recording.contents), &outputs.commit()?);
    let demands = torque_demands(arguments, &recording, planned);
    report(arguments, &recording, comparison.as_ref(), &demands, timing.as_ref())?;
    if let Some(error) = error {
        return Err(Failure::Truncated(arguments.file.clone(), error.to_string()));
    }
    if let Some(comparison) = comparison.filter(|comparison| !comparison.result.is_same()) {
        return Err(Failure::Check(text::difference(&comparison)));
    }
    arguments.timing.needs_steps(!recording.report.channels.is_empty())?;
    timing.map_or(Ok(()), |(check, _)| arguments.timing.result(&check))
}

/// `None` for pulses made from positions, which have no width.
fn timing_in_cycles(
    recording: &LoadedCapture,
    rules: &TimingRules,
    max_violations: usize,
) -> Option<TimingCheck> {
    if !recording.has_levels() {
        return None;
    }
    let new = if recording.is_rounded { TimingCheck::of_rounded } else { TimingCheck::new };
    let mut check = new(rules, recording.clock_hz, max_violations);
    recording.unchecked().for_each(|(channel, rule)| check.exclude(channel, rule));
    recording.records.iter().for_each(|record| check.record(*record));
    Some(check)
}

fn report(
    arguments: &Arguments,
    recording: &LoadedCapture,
    comparison: Option<&PlanComparison>,
    demands: &[AxisDemand],
    timing: Option<&(TimingCheck, TimeUnit)>,
) -> Result<(), Failure> {
    let is_proposed = arguments.map.is_none();
    if arguments.json.json {
        let mut tables = text::tables(Tables::of("capture"), recording, is_proposed, comparison);
        if let Some((check, unit)) = timing {
            tables = timing::tables(tables, check, *unit);
        }
        if !demands.is_empty() {
            let shortages = torque::tables::shortages(demands);
            tables = tables.with("torque", torque::tables::axes(demands)).with("shortages", shortages);
        }
        return tables.print();
    }
    // Text must not be mixed with a file on standard output.
    if arguments.outputs().all(|path| path != Path::new(STANDARD)) {
        text::print(recording, is_proposed, comparison, demands).map_err(Failure::output)?;
    }
    timing.map_or(Ok(()), |(check, unit)| arguments.timing.report(check, *unit))
}

/// The torque that the steps demand of the scenario's motors, or of the named one.
fn torque_demands(
    arguments: &Arguments,
    recording: &LoadedCapture,
    planned: Option<&Scenario>,
) -> Vec<AxisDemand> {
    let none = Scenario { source: Source::Segments(SegmentLists::default()), ..Scenario::default() };
    let scenario = arguments.named.applied_to(planned.unwrap_or(&none));
    let demand = |channel: u8| {
        let machine = Machine::of_channel(&scenario, 0, channel.into())?;
        Some(AxisDemand::of_steps(channel, machine, &recording.steps_of(channel), recording.clock_hz))
    };
    recording.report.channels.iter().filter_map(|report| demand(report.channel)).collect()
}

fn read(arguments: &Arguments, progress: &mut Progress) -> Result<Reading, Failure> {
    let path = &arguments.file;
    let failed = |error: io::Error| Failure::File(path.clone(), error);
    let limits = Limits::default();
    let channels = arguments.map.as_deref().map(ChannelMap::channel_names).unwrap_or_default();
    let wanted = ReadOptions { channels, base: arguments.base };
    let mut piped = |input: &mut dyn Read| {
        let mut bytes = Vec::new();
        input.take(MAX_PIPED + 1).read_to_end(&mut bytes).map_err(failed)?;
        let all = bytes.len() as u64;
        if all > MAX_PIPED {
            return Err(Failure::TooLong(path.clone(), MAX_PIPED));
        }
        Ok(read::read_with_options(Cursor::new(bytes), &limits, &wanted, &mut |read| {
            progress.update(read, all);
            true
        }))
    };
    if path == Path::new(STANDARD) {
        return piped(&mut io::stdin());
    }
    let mut file = match pipe::to_read(path) {
        Ok(file) => file,
        // If there is no such file, it may be a sample's name.
        Err(error) => {
            let sample = path.to_str().and_then(sample).ok_or_else(|| {
                let hint = suggest::hint(&path.to_string_lossy(), SAMPLES.iter().map(|sample| sample.id));
                if hint.is_empty() {
                    return failed(error);
                }
                let why = format!("no file or recording of this name{hint}");
                Failure::Unusable(path.display().to_string(), why)
            })?;
            return Ok(read::read(Cursor::new(sample.bytes), &limits, &mut |_| true));
        }
    };
    let known = file.metadata().map_err(failed)?;
    if known.is_dir() {
        return Err(failed(io::ErrorKind::IsADirectory.into()));
    }
    if !known.is_file() {
        return piped(&mut file);
    }
    let all = known.len();
    Ok(read::read_with_options(BufReader::with_capacity(1 << 16, file), &limits, &wanted, &mut |read| {
        progress.update(read, all);
        true
    }))
}
