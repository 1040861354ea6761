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
/// The protocol that must never cause wrong steps.
const FRAMED: &str = "framed";
const MAX_NAMED: usize = 8;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    ///
    /// The seed determines the noise and the bit rates of the receivers. By default, two motors turn in opposite
    /// directions for 40 ticks.
    #[arg(value_name = "SCENARIO")]
    file: Option<PathBuf>,
    /// Number of seeds to run
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
        self.wrong.sort_unstable();
        self.wrong.truncate(MAX_NAMED);
    }
}

pub(crate) fn faults(arguments: &Arguments) -> Result<(), Failure> {
    let base = arguments.file.as_deref().map(scenarios::read).transpose()?;
    let path = arguments.file.clone().unwrap_or_else(|| PathBuf::from("the default scenario"));
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
        let (name, sweep) = (if protocol == Protocol::Framed { FRAMED } else { "raw" }, sweep(protocol)?);
        let threads = arguments.work.threads;
        let report = run(&sweep, &seeds, threads, &mut progress).map_err(Failure::threads)?;
        progress.next_part();
        reports.push((name, report.map_err(|problems| Failure::Scenario(path.clone(), problems))?));
    }
    progress.end(format_args!("{} seeds", seeds.end - seeds.start), &[]);
    if arguments.json.json {
        tables(&reports).print()?;
    } else {
        print(&reports).map_err(Failure::output)?;
    }
    // Raw lines are expected to have wrong steps.
    match reports.iter().find(|(name, report)| *name == FRAMED && report.tally.is_wrong()) {
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

/// Name in JSON, text, whether it applies to raw lines, value.
type Row = (&'static str, &'static str, bool, fn(&Tally) -> u64);
const ROWS: &[Row] = &[
    ("seeds", "seeds", true, |tally| tally.seeds),
    ("seeds_with_errors", "seeds with errors", true, |tally| tally.wrong_seeds),
    ("sent", "frames or packets sent", true, |tally| tally.frames),
    ("repeated", "  repeated", false, |tally| tally.repeated),
    ("rejected_crc", "  rejected: CRC", false, |tally| tally.bad_check),
    ("rejected_short_packet", "  rejected: SHORT_PACKET", true, |tally| tally.short),
    ("rejected_overlong", "  rejected: OVERLONG", false, |tally| tally.overlong),
    ("refused", "  refused", true, |tally| tally.refused),
    ("acknowledged_again", "  acknowledged again", false, |tally| tally.acknowledged_again),
    ("bytes_lost_framing", "bytes lost: FRAMING", true, |tally| tally.framing),
    ("replies", "replies sent", false, |tally| tally.replies),
    ("replies_lost", "  lost or damaged", false, |tally| tally.replies_lost),
    ("host_crashes", "crashes of the host", false, |tally| tally.crashes),
    ("ticks_commanded", "ticks commanded", true, |tally| tally.commanded),
    ("ticks_executed", "  executed", true, |tally| tally.executed),
    ("ticks_not_reached", "  not reached: host gave up", false, |tally| tally.unreached),
    ("ticks_missing", "  missing", true, |tally| tally.missing),
    ("ticks_wrong", "  wrong", true, |tally| tally.wrong),
    ("ticks_duplicated", "  duplicated or not commanded", true, |tally| tally.duplicated),
    ("wrong_steps", "wrong steps", true, |tally| tally.wrong_steps),
    ("missing_steps", "steps of missing ticks", true, |tally| tally.missing_steps),
    ("position_error_steps", "error of final positions, steps", true, |tally| tally.position_error),
    ("given_up_no_reply", "given up: no reply", false, |tally| tally.given_up),
    ("given_up_in_reach", "  although bit rates differ by up to 4 %", false, |tally| tally.given_up_in_reach),
    ("given_up_other", "given up: other reasons", false, |tally| tally.stuck),
];

fn tables(reports: &[(&str, Report)]) -> Tables {
    let counts = reports.iter().flat_map(|(protocol, report)| {
        let shown = ROWS.iter().filter(move |(_, _, everywhere, _)| *everywhere || *protocol == FRAMED);
        shown.map(move |(name, _, _, value)| {
            json!({ "protocol": protocol, "count": name, "value": value(&report.tally) })
        })
    });
    let wrong = reports.iter().flat_map(|(protocol, report)| {
        report.wrong.iter().map(move |seed| json!({ "protocol": protocol, "seed": seed }))
    });
    Tables::of("faults").with("counts", counts).with("wrong_seeds", wrong)
}

fn print(reports: &[(&str, Report)]) -> io::Result<()> {
    let mut out = terminal::out();
    write!(out, "{:42}", "")?;
    reports.iter().try_for_each(|(name, _)| write!(out, "{name:>14}"))?;
    writeln!(out)?;
    for (_, text, everywhere, value) in ROWS {
        write!(out, "{text:42}")?;
        for (protocol, report) in reports {
            let shown = *everywhere || *protocol == FRAMED;
            let value = if shown { value(&report.tally).to_string() } else { "-".to_owned() };
            write!(out, "{value:>14}")?;
        }
        writeln!(out)?;
    }
    for (name, report) in reports.iter().filter(|(_, report)| !report.wrong.is_empty()) {
        let seeds: Vec<String> = report.wrong.iter().map(u32::to_string).collect();
        let more = if report.tally.wrong_seeds > seeds.len() as u64 { " …" } else { "" };
        writeln!(out, "{name}: errors with seeds {}{more}", seeds.join(" "))?;
    }
    Ok(())
}
