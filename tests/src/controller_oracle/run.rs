//! A run: all controllers cycle by cycle, the bus, the records and the digests.

use super::arithmetic::Table;
use super::panel::PanelRecord;
use super::parameters::{Case, Controller, Entry, What};
use super::room::{Alarm, Plan, Room, State};
use crate::xxh64::xxh64;

/// Maximum number of groups that begin in a run.
const MAX_GROUPS: u64 = 1_000_000;

/// Results of a controller.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerOutcome {
    /// Panel records.
    pub panel: Vec<PanelRecord>,
    /// The EEPROM's bytes at the end.
    pub memory: Vec<u8>,
    /// Writes of each of its cells.
    pub writes: Vec<u32>,
    /// State at the end of the last cycle.
    pub state: State,
    /// Alarm at the end of the last cycle.
    pub alarm: Alarm,
    /// Trust at the end of the last cycle.
    pub trust: u8,
    /// Position at the end of the last cycle.
    pub position: i32,
    /// The current numbers.
    pub numbers: Vec<i64>,
    /// m.
    pub place: i64,
    /// The error that is reported (G6).
    pub error: i64,
    /// Number of groups that began.
    pub groups_begun: u64,
}

/// Results of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Records (A3).
    pub trace: Vec<(u64, u64)>,
    /// XXH64 of them.
    pub trace_digest: u64,
    /// XXH64 of the panel records of all controllers.
    pub panel_digest: u64,
    /// Cycles 0 to this minus 1 were run.
    pub cycles: u64,
    /// More than 1 000 000 groups began; all other results are those until then.
    pub work: Option<String>,
    /// Each controller.
    pub controllers: Vec<ControllerOutcome>,
}

/// The run, without the cycles in which nothing can happen.
pub fn run(case: &Case) -> Outcome {
    finished(case, u64::MAX, u64::MAX, false).unwrap_or_else(|| unreachable!())
}

/// The run, if it ends before cycle `most_cycles`, with at most `most_steps` cycles that were not skipped.
pub fn run_up_to(case: &Case, most_cycles: u64, most_steps: u64) -> Option<Outcome> {
    finished(case, most_cycles, most_steps, false)
}

/// The run, with every cycle.
pub fn run_every_cycle(case: &Case) -> Outcome {
    finished(case, u64::MAX, u64::MAX, true).unwrap_or_else(|| unreachable!())
}

fn plans(case: &Case) -> Vec<Plan> {
    let plan = |controller: &Controller| {
        let is_common = |entry: &&Entry| matches!(entry.what, What::Level(input, _) if input.is_common());
        let mut script: Vec<Entry> = case.controllers[0].inputs.iter().filter(is_common).copied().collect();
        script.extend(controller.inputs.iter().filter(|entry| !is_common(entry)));
        script.sort_by_key(|entry| entry.cycle);
        let tables = (1..=5)
            .map(|level| {
                let acceleration = level * controller.level_hz_s;
                Table::new(controller.start_speed_hz, acceleration, controller.max_speed_hz)
            })
            .collect();
        Plan {
            clock_hz: case.clock_hz,
            w: case.w,
            d: case.d,
            h: case.h,
            controller: controller.clone(),
            script,
            tables,
        }
    };
    case.controllers.iter().map(plan).collect()
}

fn finished(case: &Case, most_cycles: u64, most_steps: u64, every_cycle: bool) -> Option<Outcome> {
    let mut rooms: Vec<Room> = plans(case).into_iter().map(Room::new).collect();
    let mut trace: Vec<(u64, u64)> = Vec::new();
    let mut work = None;
    let mut c = 0;
    // The cycle after the last change or record.
    let mut quiet_from = 0;
    let mut steps = 0;
    loop {
        if case.run_cycles == Some(c) {
            break;
        }
        if c >= most_cycles || steps >= most_steps {
            return None;
        }
        steps += 1;
        let before: Vec<_> = rooms.iter().map(|room| room.s.clone()).collect();
        let shown = trace.len() + rooms.iter().map(|room| room.panel.len()).sum::<usize>();
        let levels = levels(&mut rooms, c);
        if trace.last().is_none_or(|(_, last)| *last != levels) {
            trace.push((c, levels));
        }
        if rooms.iter().map(|room| room.s.groups_begun).sum::<u64>() > MAX_GROUPS {
            // Reading: groups of all controllers are counted together.
            work = Some(format!("more than {MAX_GROUPS} groups begin"));
            break;
        }
        let changed = rooms.iter().zip(&before).any(|(room, before)| room.s != *before);
        let showed = trace.len() + rooms.iter().map(|room| room.panel.len()).sum::<usize>() > shown;
        if changed || showed {
            quiet_from = c + 1;
        }
        let next = rooms.iter().filter_map(Room::next_time).min();
        match (next, case.run_cycles) {
            // A change in c takes effect and shows in c + 1.
            _ if changed || (every_cycle && (next.is_some() || case.run_cycles.is_some())) => c += 1,
            (Some(next), run_cycles) => c = next.min(run_cycles.unwrap_or(u64::MAX)),
            (None, Some(run_cycles)) => c = run_cycles,
            (None, None) => break,
        }
    }
    // Reading: a run without `run_cycles` ends with the last cycle that changes something or records a change.
    let cycles = if work.is_some() { c + 1 } else { case.run_cycles.unwrap_or(quiet_from) };
    Some(outcome(rooms, trace, cycles, work))
}

/// One cycle of all controllers; the levels of the bus in it.
fn levels(rooms: &mut [Room], c: u64) -> u64 {
    // RX = TX = 1, DE = 0; the AND of their EN.
    let mut levels = 1 << 33 | 1 << 34 | 1 << 32;
    for (channel, room) in rooms.iter_mut().enumerate() {
        let (step, dir, en) = room.cycle(c);
        levels |= u64::from(step) << channel | u64::from(dir) << (16 + channel);
        if !en {
            levels &= !(1 << 32);
        }
    }
    levels
}

fn outcome(rooms: Vec<Room>, trace: Vec<(u64, u64)>, cycles: u64, work: Option<String>) -> Outcome {
    let mut bytes = Vec::new();
    for (cycle, levels) in &trace {
        bytes.extend(cycle.to_le_bytes());
        bytes.extend(levels.to_le_bytes());
    }
    let trace_digest = xxh64(&bytes);
    bytes.clear();
    for record in rooms.iter().flat_map(|room| &room.panel) {
        bytes.extend(record.cycle.to_le_bytes());
        bytes.extend(record.word.to_le_bytes());
        bytes.extend(i64::from(record.position).to_le_bytes());
        bytes.extend(record.display.to_le_bytes());
    }
    let panel_digest = xxh64(&bytes);
    let controllers = rooms
        .into_iter()
        .map(|room| ControllerOutcome {
            error: room.axis_error(),
            place: room.s.place,
            numbers: room.s.numbers.values().to_vec(),
            panel: room.panel,
            memory: room.s.eeprom.cells,
            writes: room.s.eeprom.writes,
            state: room.s.state,
            alarm: room.s.alarm,
            trust: room.s.trust,
            position: room.s.position,
            groups_begun: room.s.groups_begun,
        })
        .collect();
    Outcome { trace, trace_digest, panel_digest, cycles, work, controllers }
}
