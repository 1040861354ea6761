//! `stepscope powercut`: cuts a stand-alone controller's power and checks the restored position.

use crate::{
    failure::Failure,
    json::Tables,
    options::{Json, Work},
    parallel,
    progress::Progress,
    quantity::whole,
    scenarios, terminal,
};
use clap::Args;
use serde_json::{Value, json};
use std::{
    io::{self, Write},
    num::NonZero,
    path::PathBuf,
};
use stepscope_core::{
    controller::{
        CheckedSetup,
        parameters::{Parameters, Policy, Setup},
    },
    peripheral::units::Instant,
    scenario::Source,
    sim::power_cut::{PowerCuts, Tally, Wear, min_hold_up, tally, wear, with_memory},
};

/// Parts of the cuts; each starts its run again.
const PARTS: usize = 16;
/// Byte times of a record if another byte is being written.
const BYTE_TIMES: u64 = 17;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario with stand-alone controllers: a JSON file or a preset's name; `-` reads standard input
    scenario: PathBuf,
    /// Number of power cuts
    ///
    /// If the run has fewer cycles, there is one cut per cycle. Otherwise the cycles are random; half of them are during
    /// writes of records.
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

struct Row {
    policy: Policy,
    hold_up_cycles: u64,
    what: &'static str,
    tally: Tally,
}

pub(crate) fn powercut(arguments: &Arguments) -> Result<(), Failure> {
    let none = || Failure::NoStandAlone(arguments.scenario.clone());
    let (_, experiment) = scenarios::validated_after(&arguments.scenario, |scenario| {
        if matches!(scenario.source, Source::Standalone(_)) { Ok(()) } else { Err(none()) }
    })?;
    let checked = experiment.stand_alone().ok_or_else(none)?;
    let cost = experiment.cost();
    if cost.is_over_budget() {
        return Err(Failure::LongRun(arguments.scenario.clone()));
    }
    let end = Instant(cost.end_cycle);
    let mut rows = Vec::new();
    let memories = memories(checked);
    // The search halves its range, and begins with a measurement of its end.
    let searches = 1 + most_hold_up(checked).max(1).ilog2() as usize + 1;
    let mut progress =
        Progress::new("powercut", arguments.work.show.progress).with_parts(memories.len() + searches);
    for (policy, hold_up_cycles, what) in memories {
        let one = with_memory(checked, policy, hold_up_cycles);
        let cuts = PowerCuts::of(&one, end, arguments.cuts as usize, arguments.seed);
        let tally = counted(&cuts, arguments.work.threads, &mut progress)?;
        rows.push(Row { policy, hold_up_cycles, what, tally });
    }
    let enough = least(checked, end, arguments, &mut progress)?;
    progress.end(format_args!("{} cuts", rows.iter().map(|row| row.tally.cuts).sum::<u64>()), &[]);
    let controllers = checked.controllers().len();
    let worn: Vec<(Policy, usize, Wear)> = [Policy::PowerLoss, Policy::WriteAhead]
        .into_iter()
        .flat_map(|policy| (0..controllers).map(move |index| (policy, index)))
        .map(|(policy, index)| {
            let one = &checked.controllers()[index].memory;
            let of_policy = with_memory(checked, policy, enough);
            (policy, index, wear(&of_policy, end, index, 2 * one.slots, arguments.endurance))
        })
        .collect();
    if arguments.json.json {
        tables(&rows, enough, &worn).print()?;
    } else {
        print(&rows, enough, &worn, checked).map_err(Failure::output)?;
    }
    match rows.iter().map(|row| row.tally.wrong).sum() {
        0 => Ok(()),
        wrong => Err(Failure::SilentlyWrong(wrong)),
    }
}

/// The compared memories: both policies, each without buffer, with one that is a cycle too short, with a sufficient
/// one, and with the first controller's own.
fn memories(checked: &CheckedSetup) -> Vec<(Policy, u64, &'static str)> {
    let of = |one: &std::rc::Rc<Parameters>| BYTE_TIMES * u64::from(one.memory.byte_write_cycles) - 1;
    let enough = checked.controllers().iter().map(of).max().unwrap_or(0);
    let own = checked.controllers().first().map_or(0, |first| first.memory.hold_up_cycles);
    let mut all = vec![
        (Policy::PowerLoss, 0, "none"),
        (Policy::PowerLoss, enough.saturating_sub(1), "17 byte times less two cycles"),
        (Policy::PowerLoss, enough, "17 byte times less one cycle"),
        (Policy::WriteAhead, 0, "none"),
    ];
    if all.iter().all(|&(_, hold_up, _)| hold_up != own) {
        all.push((Policy::PowerLoss, own, "of controller 0"));
        all.push((Policy::WriteAhead, own, "of controller 0"));
    }
    all
}

fn counted(
    cuts: &PowerCuts,
    threads: Option<NonZero<usize>>,
    progress: &mut Progress,
) -> Result<Tally, Failure> {
    let cycles = cuts.cycles();
    let part = cycles.len().div_ceil(PARTS).max(1);
    let parts: Vec<&[u64]> = cycles.chunks(part).collect();
    let setup: Setup = cuts.checked().setup();
    let each = |index: u64| {
        let checked = setup.clone().check();
        checked.map_or_else(|_| Tally::default(), |checked| tally(&checked, parts[index as usize]))
    };
    let tallies = parallel::each(parts.len() as u64, threads, progress, each).map_err(Failure::threads)?;
    progress.next_part();
    let mut whole = Tally::default();
    tallies.iter().for_each(|tally| whole.join(tally));
    Ok(whole)
}

/// The shortest sufficient hold-up time of the policy `power_loss`, up to 18 byte times.
fn least(
    checked: &CheckedSetup,
    end: Instant,
    arguments: &Arguments,
    progress: &mut Progress,
) -> Result<u64, Failure> {
    let mut failed = None;
    let losses = |one: &CheckedSetup| {
        let cuts = PowerCuts::of(one, end, arguments.cuts as usize, arguments.seed);
        match counted(&cuts, arguments.work.threads, progress) {
            Ok(tally) => tally.lost,
            Err(failure) => {
                failed = Some(failure);
                0
            }
        }
    };
    let enough = min_hold_up(checked, most_hold_up(checked), losses);
    failed.map_or(Ok(enough), Err)
}

fn most_hold_up(checked: &CheckedSetup) -> u64 {
    let longest = checked.controllers().iter().map(|one| one.memory.byte_write_cycles).max().unwrap_or(1);
    (BYTE_TIMES + 1) * u64::from(longest)
}

const fn name(policy: Policy) -> &'static str {
    match policy {
        Policy::PowerLoss => "power_loss",
        Policy::WriteAhead => "write_ahead",
    }
}

fn print(
    rows: &[Row],
    enough: u64,
    worn: &[(Policy, usize, Wear)],
    checked: &CheckedSetup,
) -> io::Result<()> {
    let mut out = terminal::out();
    writeln!(
        out,
        "{:<12} {:>14} {:>9} {:>9} {:>9} {:>12} {:>9} {:>15}",
        "policy", "hold-up", "cuts", "known", "lost", "never known", "old zero", "silently wrong"
    )?;
    for Row { policy, hold_up_cycles, what, tally } in rows {
        writeln!(
            out,
            "{:<12} {hold_up_cycles:>14} {:>9} {:>9} {:>9} {:>12} {:>9} {:>15}  {what}",
            name(*policy),
            tally.cuts,
            tally.known,
            tally.lost,
            tally.never_known,
            tally.old_zero,
            tally.wrong
        )?;
    }
    let w = checked.controllers().first().map_or(1, |first| u64::from(first.memory.byte_write_cycles));
    let bytes = (enough + 1) as f64 / w as f64;
    writeln!(out, "minimum hold-up {enough} cycles, {bytes} byte times less one cycle (power_loss)")?;
    for (policy, index, wear) in worn {
        write!(
            out,
            "controller {index} {}: most worn cell {} writes per power cycle",
            name(*policy),
            wear.writes_a_cycle
        )?;
        wear.life_power_cycles.map_or(Ok(()), |life| write!(out, ", lasts {life} power cycles"))?;
        writeln!(out)?;
    }
    Ok(())
}

fn tables(rows: &[Row], enough: u64, worn: &[(Policy, usize, Wear)]) -> Tables {
    let cuts = rows.iter().map(|row| {
        json!({
            "policy": name(row.policy),
            "hold_up_cycles": row.hold_up_cycles,
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
    let wear = worn.iter().map(|(policy, index, wear)| {
        json!({
            "policy": name(*policy),
            "controller": index,
            "writes_a_power_cycle": wear.writes_a_cycle,
            "life_power_cycles": wear.life_power_cycles,
        })
    });
    let least: Vec<Value> = vec![json!({ "policy": "power_loss", "least_hold_up_cycles": enough })];
    Tables::of("powercut").with("cuts", cuts).with("hold_up", least).with("wear", wear)
}
