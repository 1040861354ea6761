//! `stepscope capture`: a recording of your own firmware or host, analyzed like a run.
//!
//! ```text
//! file -> read -> channel map, clock -> records -> report, timing, comparison with a scenario's run, files
//! ```

mod advice;
mod arguments;
mod beside;
mod files;
mod text;

use crate::{
    failure::Failure,
    json::Tables,
    output::{Outputs, STANDARD},
    pipe,
    progress::Progress,
    scenarios, suggest,
    timing::{self, TimeUnit},
    torque::{self, Driven},
};
pub(crate) use arguments::Arguments;
use beside::Beside;
use std::{
    io::{self, BufReader, Cursor, Read},
    path::Path,
};
use stepscope_core::{
    capture::{
        ChannelMap,
        read::{self, Limits, Reading, Wanted},
        samples::{SAMPLES, sample},
    },
    inspect::{
        motion::torque::Machine, recording::loaded_capture::LoadedCapture, trace::timing::TimingCheck,
    },
    peripheral::signal::Sink,
    scenario::{Scenario, SegmentLists, Source},
};

/// A pipe's recording is kept in memory, because it cannot be read twice.
const MAX_PIPED: u64 = 1 << 30;

pub(crate) fn capture(arguments: &Arguments) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    let mut progress = Progress::new("capture", arguments.show.progress);
    let Reading { capture, error } = read(arguments, &mut progress)?;
    if let Some(error) = error.as_ref().filter(|_| capture.is_empty()) {
        return Err(arguments.wrong(error));
    }
    // A pipe can be read only once.
    let against = arguments.against.as_deref().map(scenarios::validated).transpose()?;
    let base = against.as_ref().map(|(scenario, _)| &**scenario);
    let rules = arguments.timing.rules(&arguments.file, &base.cloned().unwrap_or_default())?;
    let max_violations = arguments.timing.max_violations();
    // Uses the file's ticks: rounded to cycles, a short pulse might pass. Runs before the capture's memory is reused.
    let in_ticks = rules.as_ref().map(|rules| {
        LoadedCapture::timing_in_ticks(&capture, &arguments.open_options(), rules, max_violations)
            .map_err(|error| arguments.cannot_open(&error))
    });
    let in_ticks = in_ticks.transpose()?.flatten();
    let recording = LoadedCapture::new(capture, &arguments.open_options())
        .map_err(|error| arguments.cannot_open(&error))?;
    // Only a line that the user mapped has to be one.
    let problem = recording.report.lines.iter().find(|line| line.problem.is_some());
    if let Some(line) = problem.filter(|_| arguments.map.is_some()) {
        return Err(arguments.wrong(advice::line(line)));
    }
    let plan = arguments.against.as_deref().zip(against.as_ref());
    let beside = plan.map(|(path, plan)| Beside::of(arguments, &recording, path, plan)).transpose()?;
    let unit = in_ticks.as_ref().map_or(TimeUnit::of_cycles(recording.clock_hz), |(_, base)| {
        TimeUnit::of_ticks(*base, recording.clock_hz)
    });
    // Pulses made from positions have no width.
    let rules = rules.filter(|_| recording.has_levels());
    let check = in_ticks.map(|(check, _)| check).or_else(|| {
        let new = if recording.is_rounded { TimingCheck::of_rounded } else { TimingCheck::new };
        let mut check = new(rules.as_ref()?, recording.clock_hz, max_violations);
        recording.unchecked().for_each(|(channel, rule)| check.leave_out(channel, rule));
        recording.records.iter().for_each(|record| check.record(*record));
        Some(check)
    });
    let driven = driven(arguments, &recording, base);
    files::write(arguments, &mut outputs, &recording, beside.as_ref(), base)?;
    if let (Some(path), Some(check)) = (&arguments.timing.violations, &check) {
        let written = timing::write_violations(outputs.create(path)?, check, unit);
        written.map_err(|error| Failure::File(path.clone(), error))?;
    }
    progress.end(format_args!("{} {}", recording.count, recording.what), &outputs.commit()?);

    if arguments.json.json {
        let mut tables =
            text::tables(Tables::of("capture"), &recording, arguments.map.is_none(), beside.as_ref());
        if let Some(check) = &check {
            tables = timing::tables(tables, check, unit);
        }
        if !driven.is_empty() {
            let shortages = torque::tables::shortages(&driven);
            tables = tables.with("torque", torque::tables::axes(&driven)).with("shortages", shortages);
        }
        tables.print()?;
    } else {
        // Text must not be mixed with a file on standard output.
        if arguments.outputs().all(|path| path != Path::new(STANDARD)) {
            text::print(&recording, arguments.map.is_none(), beside.as_ref(), &driven)
                .map_err(Failure::output)?;
        }
        if let Some(check) = &check {
            arguments.timing.report(check, unit)?;
        }
    }
    if let Some(error) = error {
        return Err(Failure::PartOnly(arguments.file.clone(), error.to_string()));
    }
    if let Some(beside) = beside.filter(|beside| !beside.found.is_same()) {
        return Err(Failure::NotThePlan(text::difference(&beside)));
    }
    arguments.timing.needs_steps(recording.report.channels.is_empty())?;
    check.map_or(Ok(()), |check| arguments.timing.result(&check))
}

/// The demand of the steps on their motors: those of the scenario, or the named one.
fn driven(arguments: &Arguments, recording: &LoadedCapture, base: Option<&Scenario>) -> Vec<Driven> {
    let none = Scenario { source: Source::Segments(SegmentLists::default()), ..Scenario::default() };
    let named = arguments.named.named(base.unwrap_or(&none));
    let channel = |number: u8| {
        let machine = Machine::of_channel(&named, 0, number.into())?;
        Some(Driven::of_steps(number, machine, &recording.steps_of(number), recording.clock_hz))
    };
    recording.report.channels.iter().filter_map(|found| channel(found.channel)).collect()
}

fn read(arguments: &Arguments, progress: &mut Progress) -> Result<Reading, Failure> {
    let path = &arguments.file;
    let failed = |error: io::Error| Failure::File(path.clone(), error);
    let limits = Limits::default();
    let channels = arguments.map.as_deref().map(ChannelMap::channel_names).unwrap_or_default();
    let wanted = Wanted { channels, base: arguments.base };
    let mut piped = |input: &mut dyn Read| {
        let mut bytes = Vec::new();
        input.take(MAX_PIPED + 1).read_to_end(&mut bytes).map_err(failed)?;
        let all = bytes.len() as u64;
        if all > MAX_PIPED {
            return Err(Failure::TooLong(path.clone(), MAX_PIPED));
        }
        Ok(read::read_wanted(Cursor::new(bytes), &limits, &wanted, &mut |read| {
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
                if hint.is_empty() { failed(error) } else { Failure::NoRecording(path.clone(), hint) }
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
    Ok(read::read_wanted(BufReader::with_capacity(1 << 16, file), &limits, &wanted, &mut |read| {
        progress.update(read, all);
        true
    }))
}
