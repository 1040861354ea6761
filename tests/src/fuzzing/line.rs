//! Bytes as a small peripheral and the activity on its line: with any bytes and forced levels (DESIGN A4 to A7), all ways
//! to run it agree, and its results do not contradict each other.

use crate::equivalence::{self, Ways};
use arbitrary::{Result, Unstructured};
use stepscope_core::peripheral::wire::schedule::line_time;
use stepscope_core::{
    peripheral::config::{Bus, DirLine, Distribution, PulsePhasing},
    scenario::{Compact, Glitch, Hex, Line, LineScript, Scenario, ScriptedSend, Source},
    sim::Experiment,
};

/// Maximum length of a run, in cycles.
const LONGEST_RUN: u64 = 10_000;
/// Maximum number of sends and glitches.
const MAX_ACTS: usize = 40;

/// Runs the scenario of the bytes in every way.
///
/// # Panics
/// If a property is violated.
pub fn check(data: &[u8]) {
    let Some((scenario, slices, hurry)) = bounded(data) else { return };
    if let Ok(experiment) = Experiment::new(&scenario) {
        equivalence::check(
            &scenario,
            &experiment,
            Ways { slices: &slices, hurry, most_clocked: LONGEST_RUN },
        );
    }
}

/// The scenario of the bytes, as JSON.
#[must_use]
pub fn told(data: &[u8]) -> String {
    bounded(data).map_or_else(String::new, |(scenario, ..)| scenario.compact().to_string())
}

/// The scenario of the bytes, limited in length.
fn bounded(data: &[u8]) -> Option<(Scenario, Vec<u64>, u64)> {
    // Bytes beyond the end read as zeros, so there always is a scenario.
    let (mut scenario, slices, hurry) = drawn(&mut Unstructured::new(data)).ok()?;
    if Experiment::new(&scenario).is_ok_and(|experiment| experiment.cost().end_cycle > LONGEST_RUN) {
        scenario.run_cycles = Some(LONGEST_RUN);
    }
    Some((scenario, slices, hurry))
}

/// The contents of published links: deflated, so nearly random, and always the same.
#[must_use]
pub fn seeds() -> Vec<Vec<u8>> {
    super::links().filter_map(super::link::payload).collect()
}

fn drawn(bytes: &mut Unstructured<'_>) -> Result<(Scenario, Vec<u64>, u64)> {
    let slices = [bytes.int_in_range(1..=40)?, bytes.int_in_range(1..=40)?].to_vec();
    let hurry = bytes.int_in_range(0..=100)?;
    let mut scenario = peripheral(bytes)?;
    acts(bytes, &mut scenario)?;
    Ok((scenario, slices, hurry))
}

/// At and near the limits of A4 and A7; a value that breaks a rule is refused.
fn peripheral(bytes: &mut Unstructured<'_>) -> Result<Scenario> {
    let mut number = |least: u32, most: u32| bytes.int_in_range(least..=most);
    let (channels, slots, queue_depth) = (number(1, 16)?, number(1, 12)?, number(1, 4)?);
    let (width, setup, hold) = (number(1, 6)?, number(0, 5)?, number(0, 5)?);
    let (spare, settle, self_test_cycles) = (number(0, 255)?, number(0, 63)?, number(0, 1023)?);
    let (clock_hz, bit_permille) = (number(1_000, 65_000)?, number(10_400, 26_000)?);
    let baud = (u64::from(clock_hz) * 1_000 / u64::from(bit_permille)) as u32;
    let receiver_baud = match number(0, 511)? {
        off @ 0..=140 => Some(baud * (930 + off) / 1_000),
        _ => None,
    };
    let address = u8::try_from(number(0, 511)?).ok().filter(|address| *address < 255);
    let [burst, common, staggered] = bytes.arbitrary()?;
    let room = width + (setup + hold).max(1);
    let pulses = if staggered { channels } else { 1 + u32::from(common) };
    Ok(Scenario {
        clock_hz,
        bus: Bus {
            channels: channels as u8,
            slots: slots as u8,
            step_period_cycles: (room * pulses + spare).saturating_sub(1),
            pulse_width_cycles: width,
            dir_setup_cycles: setup,
            dir_hold_cycles: hold,
            distribution: if burst { Distribution::Burst } else { Distribution::Spread },
            dir_line: if common { DirLine::Common } else { DirLine::PerChannel },
            pulse_phasing: if staggered { PulsePhasing::Staggered } else { PulsePhasing::Simultaneous },
            settle_cycles: settle,
            queue_depth: queue_depth as u8,
            self_test_cycles,
        },
        line: Line { baud, receiver_baud, address, ..Line::default() },
        ..Scenario::default()
    })
}

/// Packets, noise and forced levels until the bytes are used up.
fn acts(bytes: &mut Unstructured<'_>, scenario: &mut Scenario) -> Result<()> {
    let (channels, slots) = (usize::from(scenario.bus.channels), scenario.bus.slots);
    let mut sends = Vec::new();
    let mut free_from = 1;
    // Truncated, or complete.
    if bytes.arbitrary()? {
        scenario.run_cycles = Some(bytes.int_in_range(1..=LONGEST_RUN)?);
    }
    for _ in 0..MAX_ACTS {
        if bytes.is_empty() || free_from > LONGEST_RUN {
            break;
        }
        let act = bytes.int_in_range(0..=7_u8)?;
        if act < 2 {
            // From the previous send to the next one.
            let before = bytes.int_in_range(0..=4_000_u64)?;
            scenario.line.glitches.push(Glitch {
                start_cycle: free_from.saturating_sub(before).max(1),
                length_cycles: bytes.int_in_range(1..=if act == 0 { 40 } else { 3_000 })?,
                level: bytes.int_in_range(0..=1)?,
            });
            continue;
        }
        let pause = bytes.int_in_range(0..=if act < 5 { 3_u64 } else { 1_500 })?;
        let sent = if act == 2 {
            let length = bytes.int_in_range(0..=4)?;
            bytes.bytes(length.min(bytes.len()))?.to_vec()
        } else {
            let mut sent = match scenario.line.address {
                Some(own) => vec![*bytes.choose(&[own, own, 255, own ^ 1])?],
                None => Vec::new(),
            };
            for _ in 0..channels {
                // Sometimes one step more than there are slots.
                let order = bytes.int_in_range(0..=slots * 2 + 2)?;
                sent.push((order / 2) | (order << 7));
            }
            sent
        };
        let start_cycle = free_from + pause;
        free_from = start_cycle + line_time(sent.len() as u64, scenario.clock_hz, scenario.line.baud);
        sends.push(ScriptedSend { start_cycle, bytes: Hex(sent), ..ScriptedSend::default() });
    }
    scenario.source = Source::Line(LineScript { sends });
    Ok(())
}
