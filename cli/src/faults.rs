//! `stepscope faults`: runs a scenario with random line faults, one run per seed.

use crate::failure::{Failure, plural};
use crate::options::{Json, Work};
use crate::{
    json::Tables, output::STANDARD, parallel, progress::Progress, quantity::whole, scenario_file, scenarios,
    terminal,
};
use clap::{Args, ValueEnum};
use serde_json::json;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::{num::NonZero, ops::Range};
use stepscope_core::peripheral::config::Protocol;
use stepscope_core::scenario::{Problems, Scenario, link};
use stepscope_core::sim::fault_sweep::{FaultSweep, Tally};

const BATCH: u64 = 64;
/// Seeds have 32 bits.
const SEEDS: u64 = 1 << 32;
/// Maximum number of seeds with errors per printed line.
const MAX_PRINTED: usize = 8;
/// Maximum number of seeds with errors in JSON: 4 MB, however many seeds are run.
const MAX_LISTED: usize = 1_000_000;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    ///
    /// Without a scenario, two motors turn in opposite directions for 40 ticks.
    #[arg(value_name = "SCENARIO")]
    file: Option<PathBuf>,
    /// Number of seeds to run
    ///
    /// The seed determines the noise and the bit rates of the receivers.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole::<u32>(1..=u32::MAX.into()))]
    seeds: u32,
    /// First seed
    #[arg(long, value_name = "SEED", default_value_t = 0, value_parser = whole::<u32>(0..=u32::MAX.into()))]
    from: u32,
    /// Protocol of the line
    #[arg(long, value_enum, default_value_t = Which::Both)]
    protocol: Which,
    /// Run only this seed
    #[arg(long, value_name = "SEED", conflicts_with_all = ["seeds", "from"], value_parser = whole::<u32>(0..=u32::MAX.into()))]
    seed: Option<u32>,
    /// Write the scenario of --seed for `stepscope run`, without running it
    #[arg(short = 'o', long, value_name = "FILE", requires = "seed", conflicts_with_all = ["scenario", "link", "json"])]
    write_scenario: Option<PathBuf>,
    // The former name of --write-scenario -.
    #[arg(long, hide = true, requires = "seed", conflicts_with = "json")]
    scenario: bool,
    /// Print the share link of the scenario of --seed, without running it
    #[arg(long, requires = "seed", conflicts_with_all = ["scenario", "json"])]
    link: bool,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    work: Work,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Which {
    /// Packets without a checksum, as in patent RU 2704486
    Raw,
    /// Frames with a CRC, sequence numbers and replies
    Framed,
    /// One column per protocol
    Both,
}

impl Which {
    const fn protocols(self) -> &'static [Protocol] {
        match self {
            Self::Raw => &[Protocol::Raw],
            Self::Framed => &[Protocol::Framed],
            Self::Both => &[Protocol::Framed, Protocol::Raw],
        }
    }
}

#[derive(Default)]
struct Report {
    tally: Tally,
    /// Seeds with errors, rising after the last [`Report::join`]; the lowest [`MAX_LISTED`].
    wrong: Vec<u32>,
}

impl Report {
    fn add(&mut self, seed: u32, tally: Tally) {
        if tally.is_wrong() {
            self.wrong.push(seed);
        }
        self.tally += tally;
    }

    fn join(&mut self, mut other: Self) {
        self.tally += other.tally;
        self.wrong.append(&mut other.wrong);
        // Mostly rising already, which is fast.
        self.wrong.sort();
        self.wrong.truncate(MAX_LISTED);
    }
}

pub(crate) fn faults(arguments: &Arguments) -> Result<(), Failure> {
    let base = arguments.file.as_deref().map(scenarios::read).transpose()?;
    let path = arguments.file.clone().unwrap_or_else(|| PathBuf::from(scenarios::DEFAULT));
    let sweep = |protocol| {
        let mut base = base.clone().unwrap_or_else(|| FaultSweep::small(protocol));
        base.line.protocol = protocol;
        FaultSweep::new(base).map_err(|problems| Failure::Scenario(path.clone(), problems))
    };
    let protocols = arguments.protocol.protocols();
    let standard = arguments.scenario.then(|| PathBuf::from(STANDARD));
    let out = arguments.write_scenario.as_ref().or(standard.as_ref());
    if let Some(seed) = arguments.seed.filter(|_| out.is_some() || arguments.link) {
        let scenarios: Result<Vec<_>, _> =
            protocols.iter().map(|&protocol| Ok(sweep(protocol)?.scenario(seed))).collect();
        return write(&path, &scenarios?, arguments.write_scenario.is_some(), out.map(PathBuf::as_path));
    }
    let seeds = seed_range(arguments)?;
    let mut reports = Vec::new();
    let mut progress = Progress::new("faults", arguments.work.show.progress).with_parts(protocols.len());
    for &protocol in protocols {
        let report = run(&sweep(protocol)?, &seeds, arguments.work.threads, &mut progress);
        let report = report.map_err(Failure::threads)?;
        progress.next_part();
        reports.push((protocol, report.map_err(|problems| Failure::Scenario(path.clone(), problems))?));
    }
    progress.end(format_args!("{} seeds", seeds.end - seeds.start), &[]);
    if arguments.json.json {
        tables(&reports).print()?;
    } else {
        print(&reports).map_err(Failure::output)?;
    }
    // Raw lines are expected to have wrong steps.
    let is_failure =
        |protocol: Protocol, report: &Report| protocol == Protocol::Framed && report.tally.is_wrong();
    match reports.iter().find(|(protocol, report)| is_failure(*protocol, report)) {
        Some((_, report)) => {
            let count = report.tally.wrong_seeds;
            let s = plural(count);
            Err(Failure::Check(format!(
                "framed line: wrong, duplicated or missing ticks with {count} seed{s}; run one with --seed"
            )))
        }
        None => Ok(()),
    }
}

fn seed_range(arguments: &Arguments) -> Result<Range<u64>, Failure> {
    let first = u64::from(arguments.seed.unwrap_or(arguments.from));
    let count = if arguments.seed.is_some() { 1 } else { u64::from(arguments.seeds) };
    let max = SEEDS - first;
    if count > max {
        return Err(Failure::Option(format!(
            "--from {first} with --seeds {count}: the last seed is {}; use --seeds 1 to {max}, or a lower --from",
            SEEDS - 1
        )));
    }
    Ok(first..first + count)
}

fn run(
    sweep: &FaultSweep,
    seeds: &Range<u64>,
    threads: Option<NonZero<usize>>,
    progress: &mut Progress,
) -> io::Result<Result<Report, Problems>> {
    let batches = (seeds.end - seeds.start).div_ceil(BATCH);
    let make = |index| {
        let from = seeds.start + index * BATCH;
        batch(sweep, from..seeds.end.min(from + BATCH))
    };
    parallel::sum(batches, threads, progress, make, |whole: Result<Report, Problems>, report| {
        let mut whole = whole?;
        whole.join(report?);
        Ok(whole)
    })
}

fn batch(sweep: &FaultSweep, seeds: Range<u64>) -> Result<Report, Problems> {
    let mut report = Report::default();
    for seed in seeds {
        report.add(seed as u32, sweep.run(seed as u32)?);
    }
    Ok(report)
}

/// Writes the scenarios to `out`, or prints their links. A file has one scenario.
fn write(path: &Path, scenarios: &[Scenario], is_file: bool, out: Option<&Path>) -> Result<(), Failure> {
    if is_file && scenarios.len() > 1 {
        let why = "--protocol: both gives two scenarios, but --write-scenario takes one; use raw or framed";
        return Err(Failure::Option(why.to_owned()));
    }
    scenarios.iter().try_for_each(|scenario| {
        if let Some(out) = out {
            return scenario_file::write(out, path, scenario, "use a shorter scenario");
        }
        let link = link::encode(scenario).map_err(Failure::Link)?;
        writeln!(terminal::out(), "#{link}").map_err(Failure::output)
    })
}

/// A count of the report.
struct Row {
    /// In JSON.
    name: &'static str,
    text: &'static str,
    is_framed_only: bool,
    value: fn(&Tally) -> u64,
}

impl Row {
    const fn all(name: &'static str, text: &'static str, value: fn(&Tally) -> u64) -> Self {
        Self { name, text, is_framed_only: false, value }
    }

    /// Only of framed lines.
    const fn framed(name: &'static str, text: &'static str, value: fn(&Tally) -> u64) -> Self {
        Self { name, text, is_framed_only: true, value }
    }

    /// `None` if the protocol has no such count.
    fn value(&self, protocol: Protocol, report: &Report) -> Option<u64> {
        (protocol == Protocol::Framed || !self.is_framed_only).then(|| (self.value)(&report.tally))
    }
}

const ROWS: &[Row] = &[
    Row::all("seeds", "seeds", |tally| tally.seeds),
    Row::all("seeds_with_errors", "seeds with errors", |tally| tally.wrong_seeds),
    Row::all("sent", "frames or packets sent", |tally| tally.frames),
    Row::framed("repeated", "  repeated", |tally| tally.repeated),
    Row::framed("rejected_crc", "  rejected: CRC", |tally| tally.bad_check),
    Row::all("rejected_short_packet", "  rejected: SHORT_PACKET", |tally| tally.short),
    Row::framed("rejected_overlong", "  rejected: OVERLONG", |tally| tally.overlong),
    Row::all("refused", "  refused", |tally| tally.refused),
    Row::framed("acknowledged_again", "  acknowledged again", |tally| tally.acknowledged_again),
    Row::all("bytes_lost_framing", "bytes lost: FRAMING", |tally| tally.framing),
    Row::framed("replies", "replies sent", |tally| tally.replies),
    Row::framed("replies_lost", "  lost or damaged", |tally| tally.replies_lost),
    Row::framed("host_crashes", "crashes of the host", |tally| tally.crashes),
    Row::all("ticks_commanded", "ticks commanded", |tally| tally.commanded),
    Row::all("ticks_executed", "  executed", |tally| tally.executed),
    Row::framed("ticks_not_reached", "  not reached: host gave up", |tally| tally.unreached),
    Row::all("ticks_missing", "  missing", |tally| tally.missing),
    Row::all("ticks_wrong", "  wrong", |tally| tally.wrong),
    Row::all("ticks_duplicated", "  duplicated or not commanded", |tally| tally.duplicated),
    Row::all("wrong_steps", "wrong steps", |tally| tally.wrong_steps),
    Row::all("missing_steps", "steps of missing ticks", |tally| tally.missing_steps),
    Row::all("position_error_steps", "error of final positions, steps", |tally| tally.position_error),
    Row::framed("given_up_no_reply", "given up: no reply", |tally| tally.given_up),
    Row::framed("given_up_in_reach", "  although bit rates differ by up to 4 %", |tally| {
        tally.given_up_in_reach
    }),
    Row::framed("given_up_other", "given up: other reasons", |tally| tally.stuck),
];

const fn protocol_name(protocol: Protocol) -> &'static str {
    match protocol {
        Protocol::Raw => "raw",
        Protocol::Framed => "framed",
    }
}

fn tables(reports: &[(Protocol, Report)]) -> Tables {
    let counts = reports.iter().flat_map(|(protocol, report)| {
        let values = ROWS.iter().filter_map(|row| Some((row.name, row.value(*protocol, report)?)));
        values.map(
            |(name, value)| json!({ "protocol": protocol_name(*protocol), "count": name, "value": value }),
        )
    });
    let wrong = reports.iter().flat_map(|(protocol, report)| {
        let protocol = protocol_name(*protocol);
        report.wrong.iter().map(move |seed| json!({ "protocol": protocol, "seed": seed }))
    });
    Tables::of("faults").with("counts", counts).with("wrong_seeds", wrong)
}

fn print(reports: &[(Protocol, Report)]) -> io::Result<()> {
    let mut out = terminal::out();
    write!(out, "{:42}", "")?;
    reports.iter().try_for_each(|(protocol, _)| write!(out, "{:>14}", protocol_name(*protocol)))?;
    writeln!(out)?;
    for row in ROWS {
        write!(out, "{:42}", row.text)?;
        for (protocol, report) in reports {
            let value =
                row.value(*protocol, report).map_or_else(|| "-".to_owned(), |value| value.to_string());
            write!(out, "{value:>14}")?;
        }
        writeln!(out)?;
    }
    for (protocol, report) in reports.iter().filter(|(_, report)| !report.wrong.is_empty()) {
        let seeds: Vec<String> = report.wrong.iter().take(MAX_PRINTED).map(u32::to_string).collect();
        let more = if report.tally.wrong_seeds > seeds.len() as u64 { " …" } else { "" };
        writeln!(out, "{}: errors with seeds {}{more}", protocol_name(*protocol), seeds.join(" "))?;
    }
    Ok(())
}
