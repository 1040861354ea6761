//! `stepscope powercut`: cuts a stand-alone controller's power and checks the restored position.

use crate::failure::{Failure, plural};
use crate::options::{Json, Work};
use crate::{json::Tables, parallel, progress::Progress, quantity::whole, scenarios, terminal};
use clap::Args;
use serde_json::json;
use std::io::{self, Write};
use std::path::PathBuf;
use stepscope_core::controller::CheckedSetup;
use stepscope_core::controller::parameters::{Parameters, Policy, Setup};
use stepscope_core::sim::power_cut::{PowerCuts, Tally, Wear, min_hold_up, tally, wear, with_memory};
use stepscope_core::{peripheral::units::Instant, scenario::Source};

/// Number of parallel parts; each part runs the scenario from its start.
const PARTS: usize = 16;
/// Byte times to write a record while another byte is being written.
const BYTE_TIMES: u64 = 17;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario with stand-alone controllers: a JSON file or a preset's name; `-` reads standard input
    scenario: PathBuf,
    /// Number of power cuts
    ///
    /// If the run has fewer cycles, there is one cut per cycle. Otherwise the cuts are at random cycles, about half of them
    /// while the memory is being written.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = whole::<u32>(1..=10_000_000))]
    cuts: u32,
    /// Random seed
    #[arg(long, value_name = "SEED", default_value_t = 1, value_parser = whole::<u64>(0..=u64::MAX))]
    seed: u64,
    /// Endurance of a memory cell, in write cycles
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = whole::<u32>(1..=u32::MAX.into()))]
    endurance: u32,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    work: Work,
}

/// A memory to compare; `note` describes its hold-up time.
struct MemoryCase {
    policy: Policy,
    hold_up_cycles: u64,
    note: &'static str,
}

struct Row {
    memory: MemoryCase,
    tally: Tally,
}

struct WearRow {
    policy: Policy,
    controller: usize,
    wear: Wear,
}

pub(crate) fn powercut(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let missing = || {
        let why = "the scenario has no stand-alone controller; use one with source.standalone, or a preset such as zhang-2012-controller";
        Failure::invalid(path, why)
    };
    let (_, experiment) = scenarios::validated_after(path, |scenario| {
        if matches!(scenario.source, Source::StandAlone(_)) { Ok(()) } else { Err(missing()) }
    })?;
    let setup = experiment.stand_alone().ok_or_else(missing)?;
    let cost = experiment.cost();
    if cost.is_over_budget() {
        let why = "the run has more than 4000000 edges, or no end; set run_cycles, or use a shorter program";
        return Err(Failure::invalid(path, why));
    }
    let end = Instant(cost.end_cycle);
    let memories = memories(setup);
    // The search measures its maximum first, and then halves its range.
    let searches = 1 + max_hold_up_cycles(setup).max(1).ilog2() as usize + 1;
    let parts = memories.len() + searches;
    let mut progress = Progress::new("powercut", arguments.work.show.progress).with_parts(parts);
    let mut rows = Vec::new();
    for memory in memories {
        let setup = with_memory(setup, memory.policy, memory.hold_up_cycles);
        let tally = count_outcomes(&setup, end, arguments, &mut progress)?;
        rows.push(Row { memory, tally });
    }
    let min_hold_up = find_min_hold_up(setup, end, arguments, &mut progress)?;
    progress.end(format_args!("{} cuts", rows.iter().map(|row| row.tally.cuts).sum::<u64>()), &[]);
    let wear = wear_rows(setup, end, min_hold_up, arguments.endurance);
    if arguments.json.json {
        tables(&rows, min_hold_up, &wear).print()?;
    } else {
        print(&rows, min_hold_up, &wear, setup).map_err(Failure::output)?;
    }
    match rows.iter().map(|row| row.tally.wrong).sum() {
        0 => Ok(()),
        wrong => Err(Failure::Check(format!(
            "a wrong position is trusted after {wrong} power cut{}; use --json for the first cycle",
            plural(wrong)
        ))),
    }
}

/// The compared memories: both policies without a buffer, `power_loss` also with one that is a cycle too short and with
/// a sufficient one, and both with the buffer of controller 0.
fn memories(setup: &CheckedSetup) -> Vec<MemoryCase> {
    let record_cycles = |parameters: &std::sync::Arc<Parameters>| {
        BYTE_TIMES * u64::from(parameters.memory.byte_write_cycles) - 1
    };
    let sufficient = setup.controllers().iter().map(record_cycles).max().unwrap_or(0);
    let own = setup.controllers().first().map_or(0, |first| first.memory.hold_up_cycles);
    let case = |policy, hold_up_cycles, note| MemoryCase { policy, hold_up_cycles, note };
    let mut cases = vec![
        case(Policy::PowerLoss, 0, "none"),
        case(Policy::PowerLoss, sufficient.saturating_sub(1), "17 byte times less two cycles"),
        case(Policy::PowerLoss, sufficient, "17 byte times less one cycle"),
        case(Policy::WriteAhead, 0, "none"),
    ];
    if cases.iter().all(|case| case.hold_up_cycles != own) {
        cases.push(case(Policy::PowerLoss, own, "of controller 0"));
        cases.push(case(Policy::WriteAhead, own, "of controller 0"));
    }
    cases
}

fn count_outcomes(
    setup: &CheckedSetup,
    end: Instant,
    arguments: &Arguments,
    progress: &mut Progress,
) -> Result<Tally, Failure> {
    let cuts = PowerCuts::of(setup, end, arguments.cuts as usize, arguments.seed);
    let cycles = cuts.cycles();
    let parts: Vec<&[u64]> = cycles.chunks(cycles.len().div_ceil(PARTS).max(1)).collect();
    let setup: Setup = cuts.checked().setup();
    let tally_part = |index: u64| {
        let checked = setup.clone().check();
        checked.map_or_else(|_| Tally::default(), |checked| tally(&checked, parts[index as usize]))
    };
    let tallies = parallel::each(parts.len() as u64, arguments.work.threads, progress, tally_part)
        .map_err(Failure::threads)?;
    progress.next_part();
    let mut total = Tally::default();
    tallies.iter().for_each(|tally| total.join(tally));
    Ok(total)
}

/// The minimum sufficient hold-up time of the policy `power_loss`, in cycles, up to 18 byte times.
fn find_min_hold_up(
    setup: &CheckedSetup,
    end: Instant,
    arguments: &Arguments,
    progress: &mut Progress,
) -> Result<u64, Failure> {
    let mut failure = None;
    let losses = |setup: &CheckedSetup| match count_outcomes(setup, end, arguments, progress) {
        Ok(tally) => tally.lost,
        Err(error) => {
            failure = Some(error);
            0
        }
    };
    let cycles = min_hold_up(setup, max_hold_up_cycles(setup), losses);
    failure.map_or(Ok(cycles), Err)
}

fn max_hold_up_cycles(setup: &CheckedSetup) -> u64 {
    let byte_write_cycles = setup.controllers().iter().map(|parameters| parameters.memory.byte_write_cycles);
    (BYTE_TIMES + 1) * u64::from(byte_write_cycles.max().unwrap_or(1))
}

fn wear_rows(setup: &CheckedSetup, end: Instant, hold_up_cycles: u64, endurance: u32) -> Vec<WearRow> {
    let mut rows = Vec::new();
    for policy in [Policy::PowerLoss, Policy::WriteAhead] {
        let setup = with_memory(setup, policy, hold_up_cycles);
        for (controller, parameters) in setup.controllers().iter().enumerate() {
            let wear = wear(&setup, end, controller, 2 * parameters.memory.slots, endurance);
            rows.push(WearRow { policy, controller, wear });
        }
    }
    rows
}

const fn name(policy: Policy) -> &'static str {
    match policy {
        Policy::PowerLoss => "power_loss",
        Policy::WriteAhead => "write_ahead",
    }
}

fn print(rows: &[Row], min_hold_up: u64, wear_rows: &[WearRow], setup: &CheckedSetup) -> io::Result<()> {
    let mut out = terminal::out();
    writeln!(
        out,
        "{:<12} {:>14} {:>9} {:>9} {:>9} {:>12} {:>9} {:>15}",
        "policy", "hold-up", "cuts", "known", "lost", "never known", "old zero", "silently wrong"
    )?;
    for Row { memory: MemoryCase { policy, hold_up_cycles, note }, tally } in rows {
        writeln!(
            out,
            "{:<12} {hold_up_cycles:>14} {:>9} {:>9} {:>9} {:>12} {:>9} {:>15}  {note}",
            name(*policy),
            tally.cuts,
            tally.known,
            tally.lost,
            tally.never_known,
            tally.old_zero,
            tally.wrong
        )?;
    }
    let byte_time = setup.controllers().first().map_or(1, |first| first.memory.byte_write_cycles);
    let byte_times = (min_hold_up + 1) as f64 / f64::from(byte_time);
    writeln!(
        out,
        "minimum hold-up {min_hold_up} cycles, {byte_times} byte times less one cycle (power_loss)"
    )?;
    for WearRow { policy, controller, wear } in wear_rows {
        write!(
            out,
            "controller {controller} {}: most worn cell {} writes per power cycle",
            name(*policy),
            wear.writes_per_cycle
        )?;
        wear.life_power_cycles.map_or(Ok(()), |life| write!(out, ", lasts {life} power cycles"))?;
        writeln!(out)?;
    }
    Ok(())
}

fn tables(rows: &[Row], min_hold_up: u64, wear_rows: &[WearRow]) -> Tables {
    let cuts = rows.iter().map(|row| {
        json!({
            "policy": name(row.memory.policy),
            "hold_up_cycles": row.memory.hold_up_cycles,
            "cuts": row.tally.cuts,
            "known": row.tally.known,
            "lost": row.tally.lost,
            "never_known": row.tally.never_known,
            "old_zero": row.tally.old_zero,
            "silently_wrong": row.tally.wrong,
            "first_lost_cycle": row.tally.first_lost.map(|at| at.0),
            "first_wrong_cycle": row.tally.first_wrong.map(|at| at.0),
        })
    });
    let wear = wear_rows.iter().map(|WearRow { policy, controller, wear }| {
        json!({
            "policy": name(*policy),
            "controller": controller,
            "writes_a_power_cycle": wear.writes_per_cycle,
            "life_power_cycles": wear.life_power_cycles,
        })
    });
    let hold_up = [json!({ "policy": "power_loss", "least_hold_up_cycles": min_hold_up })];
    Tables::of("powercut").with("cuts", cuts).with("hold_up", hold_up).with("wear", wear)
}
