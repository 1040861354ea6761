//! `stepscope faults`: runs a scenario with random line faults, one run per seed.

use crate::{
    failure::Failure, json::Tables, parallel, progress::Progress, quantity::whole, scenario_file, scenarios,
    terminal,
};
use clap::{Args, ValueEnum};
use serde_json::json;
use std::{
    io::{self, Write},
    num::NonZero,
    ops::Range,
    path::{Path, PathBuf},
};
use stepscope_core::{
    peripheral::config::Protocol,
    scenario::{Problem, Scenario, link},
    sim::fault_sweep::{FaultSweep, Tally},
};

/// Seeds per batch of a thread.
const BATCH: u64 = 64;
/// Seeds have 32 bits.
const SEEDS: u64 = 1 << 32;
/// The protocol that must never give wrong steps.
const FRAMED: &str = "framed";
/// Maximum seeds that are listed.
const MAX_NAMED: usize = 8;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario to send: a JSON file or a preset's name; `-` reads standard input
    ///
    /// Each seed has its own noise and receivers' rates. Without a file two motors turn against each other for 40
    /// ticks.
    file: Option<PathBuf>,
    /// Number of seeds to run
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole::<u32>(1..=u32::MAX.into()))]
    seeds: u32,
    /// First seed
    #[arg(long, value_name = "SEED", default_value_t = 0, value_parser = whole::<u32>(0..=u32::MAX.into()))]
    from: u32,
    /// Framing protocol
    #[arg(long, value_enum, default_value_t = Which::Both)]
    protocol: Which,
    /// Number of threads (default: one per processor); the result is the same
    #[arg(long, value_name = "N", value_parser = whole::<NonZero<usize>>(1..=u64::MAX))]
    threads: Option<NonZero<usize>>,
    /// Run only this seed
    #[arg(long, value_name = "SEED", conflicts_with_all = ["seeds", "from"], value_parser = whole::<u32>(0..=u32::MAX.into()))]
    seed: Option<u32>,
    /// Write the scenario of `--seed` as JSON and run nothing; `stepscope run` runs it
    #[arg(long, requires = "seed")]
    scenario: bool,
    /// Print the share link of the scenario of `--seed` and run nothing
    #[arg(long, requires = "seed", conflicts_with = "scenario")]
    link: bool,
    /// Print the counts as JSON: one object of tables (docs/command.md)
    #[arg(long, conflicts_with_all = ["scenario", "link"])]
    json: bool,
    /// Show the progress even if standard error is not a terminal
    #[arg(long)]
    progress: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Which {
    /// Packets without a check, as in RU 2704486.
    Raw,
    /// Frames with a check, sequence numbers and replies.
    Framed,
    /// One after the other, side by side in the table.
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
    let path = arguments.file.clone().unwrap_or_else(|| PathBuf::from("the small scenario"));
    let sweep = |protocol| {
        let mut base = base.clone().unwrap_or_else(|| FaultSweep::small(protocol));
        base.line.protocol = protocol;
        FaultSweep::new(base).map_err(|problems| Failure::Scenario(path.clone(), problems))
    };
    let protocols = arguments.protocol.protocols();
    if let Some(seed) = arguments.seed.filter(|_| arguments.scenario || arguments.link) {
        let scenarios: Result<Vec<_>, _> =
            protocols.iter().map(|&protocol| Ok(sweep(protocol)?.scenario(seed))).collect();
        return write(&path, &scenarios?, arguments.link);
    }
    let seeds = match arguments.seed {
        Some(seed) => u64::from(seed)..u64::from(seed) + 1,
        None => u64::from(arguments.from)..u64::from(arguments.from) + u64::from(arguments.seeds),
    };
    if seeds.end > SEEDS {
        let (from, count, most) = (arguments.from, arguments.seeds, SEEDS - seeds.start);
        return Err(Failure::Option(format!(
            "--from {from} with --seeds {count}: the last seed is {}; use --seeds 1 to {most}, or a lower --from",
            SEEDS - 1
        )));
    }
    let mut reports = Vec::new();
    for &protocol in protocols {
        let (name, sweep) = (if protocol == Protocol::Framed { FRAMED } else { "raw" }, sweep(protocol)?);
        let progress = Progress::new(name, arguments.progress);
        let report = run(&sweep, &seeds, arguments.threads, progress).map_err(Failure::threads)?;
        reports.push((name, report.map_err(|problems| Failure::Scenario(path.clone(), problems))?));
    }
    if arguments.json {
        tables(&reports).print()?;
    } else {
        print(&reports).map_err(Failure::output)?;
    }
    // On a raw line wrong steps are expected.
    match reports.iter().find(|(name, report)| *name == FRAMED && report.tally.is_wrong()) {
        Some((_, report)) => Err(Failure::WrongSteps(report.tally.wrong_seeds)),
        None => Ok(()),
    }
}

fn run(
    sweep: &FaultSweep,
    seeds: &Range<u64>,
    threads: Option<NonZero<usize>>,
    progress: Progress,
) -> io::Result<Result<Report, Vec<Problem>>> {
    let batches = (seeds.end - seeds.start).div_ceil(BATCH);
    let make = |index| {
        let from = seeds.start + index * BATCH;
        batch(sweep, from..seeds.end.min(from + BATCH))
    };
    parallel::sum(batches, threads, progress, make, |whole: Result<Report, Vec<Problem>>, report| {
        let mut whole = whole?;
        whole.join(report?);
        Ok(whole)
    })
}

fn batch(sweep: &FaultSweep, seeds: Range<u64>) -> Result<Report, Vec<Problem>> {
    let mut report = Report::default();
    for seed in seeds {
        report.add(seed as u32, sweep.run(seed as u32)?);
    }
    Ok(report)
}

fn write(path: &Path, scenarios: &[Scenario], as_links: bool) -> Result<(), Failure> {
    scenarios.iter().try_for_each(|scenario| {
        if !as_links {
            return scenario_file::print(path, scenario, "give a shorter scenario");
        }
        let link = link::encode(scenario).map_err(Failure::Link)?;
        writeln!(terminal::out(), "#{link}").map_err(Failure::output)
    })
}

/// Name, whether it applies to raw lines, figure.
type Row = (&'static str, bool, fn(&Tally) -> u64);
const ROWS: &[Row] = &[
    ("seeds", true, |tally| tally.seeds),
    ("seeds with something wrong", true, |tally| tally.wrong_seeds),
    ("frames or packets sent", true, |tally| tally.frames),
    ("  repeated", false, |tally| tally.repeated),
    ("  rejected: CRC", false, |tally| tally.bad_check),
    ("  rejected: SHORT_PACKET", true, |tally| tally.short),
    ("  rejected: OVERLONG", false, |tally| tally.overlong),
    ("  refused", true, |tally| tally.refused),
    ("  acknowledged again", false, |tally| tally.acknowledged_again),
    ("bytes lost: FRAMING", true, |tally| tally.framing),
    ("replies sent", false, |tally| tally.replies),
    ("  lost or spoiled", false, |tally| tally.replies_lost),
    ("crashes of the host", false, |tally| tally.crashes),
    ("ticks ordered", true, |tally| tally.ordered),
    ("  executed", true, |tally| tally.executed),
    ("  not reached: host gave up", false, |tally| tally.unreached),
    ("  missing", true, |tally| tally.missing),
    ("  wrong", true, |tally| tally.wrong),
    ("  duplicated or not ordered", true, |tally| tally.duplicated),
    ("wrong steps", true, |tally| tally.wrong_steps),
    ("steps of missing ticks", true, |tally| tally.missing_steps),
    ("distance of end positions", true, |tally| tally.position_error),
    ("given up: no reply", false, |tally| tally.given_up),
    ("  with rates within 4 %", false, |tally| tally.given_up_in_reach),
    ("given up: other reasons", false, |tally| tally.stuck),
];

fn tables(reports: &[(&str, Report)]) -> Tables {
    let counts = reports.iter().flat_map(|(protocol, report)| {
        let shown = ROWS.iter().filter(move |(_, everywhere, _)| *everywhere || *protocol == FRAMED);
        shown.map(move |(name, _, value)| {
            json!({ "protocol": protocol, "count": name.trim(), "value": value(&report.tally) })
        })
    });
    let wrong = reports.iter().flat_map(|(protocol, report)| {
        report.wrong.iter().map(move |seed| json!({ "protocol": protocol, "seed": seed }))
    });
    Tables::of("faults").with("counts", counts).with("wrong_seeds", wrong)
}

fn print(reports: &[(&str, Report)]) -> io::Result<()> {
    let mut out = terminal::out();
    write!(out, "{:30}", "")?;
    reports.iter().try_for_each(|(name, _)| write!(out, "{name:>14}"))?;
    writeln!(out)?;
    for (name, everywhere, value) in ROWS {
        write!(out, "{name:30}")?;
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
        writeln!(out, "{name}: something is wrong with seeds {}{more}", seeds.join(" "))?;
    }
    Ok(())
}
