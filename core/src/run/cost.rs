//! What a run costs at most, before it starts: from the host's bytes, what is forced on the line,
//! and what the receiver can make of both.
//!
//! Each byte that is heard begins with a fall of the line, and the next one no earlier than
//! floor(B/2) + 9*B + 1 cycles later (DESIGN A4). So a receiver hears what is sent only if nothing
//! is forced and its samples lie in their bits; otherwise one byte can become several, and a forced
//! level can begin one of its own.

use crate::{
    scenario::{Checked, Config, DirLine, Pulses, Source, line_time},
    units::Cycles,
    wire::{Schedule, packet::Order},
};

/// Edges of the line that a byte has at most, and how many of them fall.
const MOST_EDGES_A_BYTE: u64 = 10;
const MOST_FALLS_A_BYTE: u64 = 5;
/// Where the last of them can be: the start of data bit 7.
const LAST_FALL_BIT: u64 = 8;

/// Bits of a byte that has just begun, rounded up.
const BYTE_BITS: u64 = 10;
/// Bits of a byte that has just begun and of the gap after it (45, A5), rounded up.
const LONGEST_REST_BITS: u64 = 60;

/// What a run costs, known before it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Records of the trace, at most.
    pub records: u64,
    /// Sends of the host.
    pub sends: u64,
    /// Bytes that the host sends.
    pub bytes: u64,
    /// Cycle by which nothing can change any more, or the run's given end.
    pub end_cycle: u64,
}

/// Records up to which a scenario runs without asking.
pub const BUDGET_RECORDS: u64 = 4_000_000;

impl Cost {
    /// Whether it is more than runs without asking.
    #[must_use]
    pub const fn is_over_budget(&self) -> bool {
        self.records > BUDGET_RECORDS
    }

    pub(super) fn of(checked: &Checked, schedule: &Schedule) -> Self {
        let (bytes, forced) = (schedule.total_bytes() as u64, checked.forced.len() as u64);
        let line = MOST_EDGES_A_BYTE * bytes + 2 * forced;
        Self {
            records: 1 + line + tick_records(checked, schedule),
            sends: schedule.len() as u64,
            bytes,
            end_cycle: checked.run.map_or_else(|| last_cycle(schedule, checked), |Cycles(run)| run),
        }
    }
}

/// Records of all ticks at most.
fn tick_records(checked: &Checked, schedule: &Schedule) -> u64 {
    let config = &checked.config;
    if paced_and_heard(checked) {
        return schedule.iter().map(|packet| records_of(config, pulses(config, packet.bytes))).sum();
    }
    let most = u64::from(config.slots()) * u64::from(config.channels());
    most_ticks(checked, schedule) * records_of(config, most)
}

/// Whether each packet comes with its tick and is heard as it was sent.
fn paced_and_heard(checked: &Checked) -> bool {
    !matches!(checked.source, Source::Line(_)) && is_faithful(checked)
}

fn is_faithful(checked: &Checked) -> bool {
    checked.forced.is_empty() && hears(&checked.config, checked.baud)
}

/// Packets for this controller that can be heard.
fn most_ticks(checked: &Checked, schedule: &Schedule) -> u64 {
    let heard = if is_faithful(checked) {
        schedule.total_bytes() as u64
    } else {
        let sent: u64 = schedule.iter().map(|send| most_heard(checked, send.bytes.len())).sum();
        sent + checked.forced.len() as u64
    };
    heard / checked.config.packet_len() as u64
}

/// Whether the receiver takes each sample in the bit that it is of, and is armed for the next byte.
fn hears(config: &Config, baud: u32) -> bool {
    let (bit, clock_hz, baud) = (config.bit().0, u64::from(config.clock_hz()), u64::from(baud));
    let starts = |k: u64| k * clock_hz / baud;
    (0..10).all(|k| (starts(k)..starts(k + 1)).contains(&(bit / 2 + k * bit)))
}

/// Bytes that can be heard of so many that are sent back to back.
fn most_heard(checked: &Checked, bytes: usize) -> u64 {
    let (bytes, bit) = (bytes as u64, checked.config.bit().0);
    let Some(before) = bytes.checked_sub(1) else { return 0 };
    let last_fall =
        (10 * before + LAST_FALL_BIT) * u64::from(checked.config.clock_hz()) / u64::from(checked.baud);
    (MOST_FALLS_A_BYTE * bytes).min(last_fall / (bit / 2 + 9 * bit + 1) + 1)
}

/// Pulses that a packet orders.
fn pulses(config: &Config, packet: &[u8]) -> u64 {
    let orders = packet.iter().skip(usize::from(config.address().is_some()));
    orders.map(|&byte| u64::from(Order::parse(byte).steps)).sum()
}

/// Records that a tick of `pulses` pulses makes at most: two edges a pulse, or a slot where they
/// come together, and the changes of DIR.
fn records_of(config: &Config, pulses: u64) -> u64 {
    let slots = pulses.min(u64::from(config.slots()));
    match (config.pulses, config.dir_line) {
        (Pulses::Simultaneous, DirLine::PerChannel) => 2 * slots + 1,
        (Pulses::Simultaneous, DirLine::Common) => 6 * slots,
        (Pulses::Staggered, DirLine::PerChannel) => 2 * pulses + 1,
        (Pulses::Staggered, DirLine::Common) => 2 * pulses + 2 * slots,
    }
}

/// A cycle by which everything has been sent and what can follow it has passed: a byte that is heard
/// late (by a slow receiver, or begun by a forced level), the tick that runs and those that wait,
/// or the gap.
fn last_cycle(schedule: &Schedule, checked: &Checked) -> u64 {
    let config = &checked.config;
    let last = schedule.len().checked_sub(1).and_then(|index| schedule.get(index));
    let sent = last
        .map_or(0, |send| send.start.0 + line_time(send.bytes.len() as u64, config.clock_hz(), checked.baud));
    let forced = checked.forced.iter().map(|forced| forced.end.0).max().unwrap_or(0);
    let ticks = if paced_and_heard(checked) {
        1
    } else {
        most_ticks(checked, schedule).min(u64::from(config.queue_depth) + 1)
    };
    let late = if is_faithful(checked) { 0 } else { BYTE_BITS * config.bit().0 };
    sent.max(forced) + late + (ticks * config.tick().0).max(LONGEST_REST_BITS * config.bit().0) + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        run::Experiment,
        scenario::{Bus, Glitch, Line, Scenario},
    };
    use alloc::vec;

    fn config(clock_hz: u32, baud: u32, receiver_baud: u32) -> Option<Config> {
        let line = Line { baud, receiver_baud: Some(receiver_baud), ..Line::default() };
        Config::new(clock_hz, &Bus::default(), &line).ok()
    }

    #[test]
    fn a_receiver_at_the_senders_rate_hears_what_is_sent() {
        for clock_hz in [21, 1000, 1603, 16_000_000] {
            for baud in (1..clock_hz / 10).step_by(1 + clock_hz as usize / 3000) {
                assert!(config(clock_hz, baud, baud).is_none_or(|c| hears(&c, baud)), "{clock_hz} {baud}");
            }
        }
        // 16 cycles a bit; a receiver's 15 and 17 take a sample in the wrong bit.
        for (receiver_baud, expected) in [(100, true), (97, true), (107, false), (95, false)] {
            let config = config(1600, 100, receiver_baud).expect("holds");
            assert_eq!(hears(&config, 100), expected, "{receiver_baud}");
        }
    }

    #[test]
    fn a_slow_receivers_tick_begins_after_the_byte_has_been_sent() {
        // 10.4 cycles a bit are sent, 11 heard: the byte ends at 105 and is delivered there.
        let json = r#"{"clock_hz":1000,"line":{"baud":96,"receiver_baud":94},
            "bus":{"boot_cycles":0},"source":{"line":{"sends":[{"start_cycle":1,"bytes":"87"}]}}}"#;
        let experiment = Experiment::from_json(json).expect("runs");
        let run = experiment.run(&mut vec![]);
        assert_eq!(run.cycles().0, 105 + 1 + 32_000 + 1);
        assert!(run.cycles().0 <= experiment.cost().end_cycle);
    }

    #[test]
    fn each_forced_level_may_be_heard_as_a_byte() {
        // A low of half a bit on an idle line is the byte ff: 127 steps, 255 records.
        let glitch = |k: u64| Glitch { start_cycle: 1 + k * 2000, length_cycles: 80, level: 0 };
        let mut scenario =
            Scenario::from_json(r#"{"bus":{"slots":127},"source":{"line":{}}}"#).expect("reads");
        for glitches in [0, 1, 10] {
            scenario.line.glitches = (0..glitches).map(glitch).collect();
            let records = Experiment::new(&scenario).expect("runs").cost().records;
            assert_eq!(records, 1 + glitches * (2 + 255));
        }
        scenario.line = Line { glitches: vec![], receiver_baud: Some(1_000_000), ..Line::default() };
        let json = r#"{"line":{"sends":[{"bytes":"5555"}]}}"#;
        scenario.source = serde_json::from_str(json).expect("reads");
        let records = Experiment::new(&scenario).expect("runs").cost().records;
        assert_eq!(records, 1 + 2 * 10 + 10 * 255, "every fall of the line may begin a byte");
    }
}
