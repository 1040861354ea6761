//! The maximum cost of a run, computed before it starts (DESIGN A4).
//!
//! Each received byte begins with a fall of the line, and the next one at least floor(B/2) + 9*B + 1 cycles later.
//! A receiver gets exactly the sent bytes if no level is forced and it samples each bit within the bit. Otherwise one byte
//! can become several, and a forced level can become a byte.

use crate::controller_plan::{ControllerPlan, job, pulses};
use stepscope_peripheral::config::{Config, DirLine, Protocol, PulsePhasing};
use stepscope_peripheral::wire::frame::{Kind, NAK_LEN, reply_len};
use stepscope_peripheral::wire::{BitTimes, Schedule, bit_times::BYTE_BITS, schedule::line_time};
use stepscope_peripheral::{segment::CheckedSegments, units::Cycles};
use stepscope_scenario::{CheckedScenario, Noise, Source};

/// Maximum edges of a byte on the line, and how many of them fall.
const MAX_EDGES_PER_BYTE: u64 = 10;
const MAX_FALLS_PER_BYTE: u64 = 5;
/// The last possible fall: the start of data bit 7.
const LAST_FALL_BIT: u64 = 8;

/// Bits of a byte that has just begun and of the gap after it (45), rounded up.
const MAX_IDLE_BITS: u64 = 60;

/// Bytes of a frame besides its ticks.
const FRAME_OVERHEAD: u64 = 13;

/// Maximum cost of a run; an estimate if the host waits for replies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    pub records: u64,
    pub sends: u64,
    pub bytes: u64,
    /// Cycle after which no event follows, or the given end.
    pub end_cycle: u64,
    /// Grid steps of all plants, multiplied by their motors; 0 without a plant.
    pub motor_grid_steps: u64,
}

/// Grid steps of all motors that run without a confirmation.
pub const BUDGET_MOTOR_GRID_STEPS: u64 = 40_000_000;

/// Records that run without a confirmation.
pub const BUDGET_RECORDS: u64 = 4_000_000;

impl Cost {
    /// Whether a run needs a confirmation.
    pub const fn is_over_budget(&self) -> bool {
        self.records > BUDGET_RECORDS || self.motor_grid_steps > BUDGET_MOTOR_GRID_STEPS
    }

    pub(super) fn of(checked: &CheckedScenario, controllers: &[ControllerPlan], schedule: &Schedule) -> Self {
        let sends = if checked.waits_for_replies() {
            Sends::framed(checked, controllers)
        } else {
            Sends::scheduled(checked, schedule)
        };
        let edges = MAX_EDGES_PER_BYTE * (sends.bytes + sends.reply_bytes) + 2 * checked.forced.len() as u64;
        let records = controllers.iter().map(|plan| 1 + edges + tick_records(checked, plan, schedule)).sum();
        Self {
            records,
            sends: sends.count,
            bytes: sends.bytes,
            end_cycle: checked.run.map_or_else(
                || last_cycle(schedule, checked, controllers).max(sends.end_cycle),
                |Cycles(run)| run,
            ),
            motor_grid_steps: 0,
        }
    }

    pub(super) fn with_plants(self, checked: &CheckedScenario) -> Self {
        let Some(plants) = &checked.plants else { return self };
        let tail = if checked.run.is_some() { 0 } else { plants.tail.0 };
        let boot = if plants.self_test && checked.run.is_none() {
            checked.configs.iter().map(|config| config.boot().0).max().unwrap_or(0)
        } else {
            0
        };
        let end_cycle = self.end_cycle.saturating_add(tail).max(boot);
        let steps = plants.setups.iter().map(|setup| {
            (end_cycle / u64::from(setup.grid_cycles())).saturating_mul(setup.motors.len() as u64)
        });
        let motor_grid_steps = steps.fold(0, u64::saturating_add);
        // EN and STEP fall at an overload; a host may enable the drivers again.
        let overloads: u64 =
            plants.setups.iter().map(|setup| u64::from(setup.protection.is_some()) * (1 + self.sends)).sum();
        // Two steps with DIR per channel.
        let tests = if plants.self_test {
            6 * plants.setups.iter().map(|s| s.motors.len() as u64).sum::<u64>()
        } else {
            0
        };
        Self { end_cycle, motor_grid_steps, records: self.records + tests + overloads, ..self }
    }

    pub(super) fn of_segments(segments: &CheckedSegments, run: Option<Cycles>) -> Self {
        let end_cycle = run.map_or(segments.end().0 + 1, |Cycles(run)| run);
        let records = segments.max_records().min(end_cycle);
        Self { records, sends: 0, bytes: 0, end_cycle, motor_grid_steps: 0 }
    }
}

struct Sends {
    count: u64,
    bytes: u64,
    reply_bytes: u64,
    /// The end, unless a schedule gives it.
    end_cycle: u64,
}

impl Sends {
    fn scheduled(checked: &CheckedScenario, schedule: &Schedule) -> Self {
        let bytes = schedule.total_bytes() as u64;
        let framed = checked.configs.iter().any(|config| config.protocol() == Protocol::Framed);
        // A frame is seven bytes at least.
        let replies = if framed { bytes / 7 + checked.forced.len() as u64 } else { 0 };
        let longest = checked.configs.iter().map(longest_reply).max().unwrap_or(0);
        Self { count: schedule.len() as u64, bytes, reply_bytes: replies * longest, end_cycle: 0 }
    }

    /// Frames with ticks, and STATUS and POSITIONS before and after them. With noise this is an estimate, because frames are
    /// repeated and a crashed host opens every controller again.
    fn framed(checked: &CheckedScenario, controllers: &[ControllerPlan]) -> Self {
        let has_faults = checked.noise != Noise::default() || !checked.forced.is_empty();
        let tries = if has_faults { u64::from(checked.host.max_attempts) } else { 1 };
        let repeats = tries * if checked.noise.host_crashes_ppm > 0 { controllers.len() as u64 } else { 1 };
        let mut sends = Self { count: 0, bytes: 0, reply_bytes: 0, end_cycle: 0 };
        for plan in controllers.iter().filter(|plan| plan.has_ticks()) {
            let job = job(plan.config(), &plan.shared_ticks());
            let frames = u64::from(job.ticks()).div_ceil(job.ticks_per_frame(&checked.host).into()) + 4;
            let positions = longest_reply(plan.config());
            sends.count += repeats * frames;
            sends.bytes += repeats * (plan.ticks().len() as u64 + FRAME_OVERHEAD * frames);
            sends.reply_bytes += repeats * (NAK_LEN as u64 * (frames - 2) + 2 * positions);
            let ticks = u64::from(job.ticks()) * job.tick.0;
            sends.end_cycle = sends.end_cycle.max(plan.config().boot().0 + ticks);
        }
        let bytes = (sends.bytes + sends.reply_bytes) / repeats;
        let clock_hz = controllers.first().map_or(1, |first| first.config().clock_hz());
        // Line and ticks overlap, except for the first and the last exchange. On a noisy line, too, most jobs end with
        // their ticks.
        sends.end_cycle = sends.end_cycle.max(line_time(bytes, clock_hz, checked.baud))
            + line_time(sends.bytes / sends.count.max(1) + 200, clock_hz, checked.baud);
        sends
    }
}

const fn longest_reply(config: &Config) -> u64 {
    reply_len(Kind::Positions, config.channels()) as u64
}

fn tick_records(checked: &CheckedScenario, plan: &ControllerPlan, schedule: &Schedule) -> u64 {
    let config = plan.config();
    if checked.waits_for_replies() || arrives_as_scheduled(checked, config) {
        if let Source::Packets(_) = &checked.source
            && config.protocol() == Protocol::Raw
            && checked.configs.len() > 1
        {
            // Any packet may address any controller.
            let max = schedule.iter().map(|send| pulses(send.bytes)).sum::<u64>();
            return records_of(config, max) + schedule.total_bytes() as u64;
        }
        return plan.each_tick().map(|tick| records_of(config, pulses(tick))).sum();
    }
    let max = u64::from(config.slots()) * u64::from(config.channels());
    max_ticks(checked, config, schedule) * records_of(config, max)
}

fn arrives_as_scheduled(checked: &CheckedScenario, config: &Config) -> bool {
    checked.source.sends_ticks() && is_faithful(checked, config)
}

fn is_faithful(checked: &CheckedScenario, config: &Config) -> bool {
    checked.forced.is_empty() && checked.noise == Noise::default() && gets_all_bits(config, checked.baud)
}

fn max_ticks(checked: &CheckedScenario, config: &Config, schedule: &Schedule) -> u64 {
    let received = if is_faithful(checked, config) {
        schedule.total_bytes() as u64
    } else {
        let sent: u64 = schedule.iter().map(|send| max_received(checked, config, send.bytes.len())).sum();
        sent + checked.forced.len() as u64
    };
    received / config.packet_len() as u64
}

/// Whether each bit is sampled within the bit, and the receiver is ready before the next byte.
fn gets_all_bits(config: &Config, baud: u32) -> bool {
    let (bit, sent) = (config.bit().0, BitTimes::new(config.clock_hz(), baud));
    (0..BYTE_BITS).all(|k| (sent.bit(k)..sent.bit(k + 1)).contains(&Cycles(bit / 2 + k * bit)))
}

/// Maximum received bytes when `bytes` are sent back to back.
fn max_received(checked: &CheckedScenario, config: &Config, bytes: usize) -> u64 {
    let (bytes, bit) = (bytes as u64, config.bit().0);
    let Some(before) = bytes.checked_sub(1) else { return 0 };
    let Cycles(last_fall) =
        BitTimes::new(config.clock_hz(), checked.baud).bit(BYTE_BITS * before + LAST_FALL_BIT);
    (MAX_FALLS_PER_BYTE * bytes).min(last_fall / (bit / 2 + 9 * bit + 1) + 1)
}

/// Two records per pulse, or per slot where pulses coincide, and the changes of DIR.
fn records_of(config: &Config, pulses: u64) -> u64 {
    let slots = pulses.min(u64::from(config.slots()));
    match (config.bus().pulse_phasing, config.bus().dir_line) {
        (PulsePhasing::Simultaneous, DirLine::PerChannel) => 2 * slots + 1,
        (PulsePhasing::Simultaneous, DirLine::Common) => 6 * slots,
        (PulsePhasing::Staggered, DirLine::PerChannel) => 2 * pulses + 1,
        (PulsePhasing::Staggered, DirLine::Common) => 2 * pulses + 2 * slots,
    }
}

/// A cycle after all sends, a late byte, the running and queued ticks, and a reply with its gap.
fn last_cycle(schedule: &Schedule, checked: &CheckedScenario, controllers: &[ControllerPlan]) -> u64 {
    let last = schedule.len().checked_sub(1).and_then(|index| schedule.get(index));
    let clock_hz = controllers.first().map_or(1, |first| first.config().clock_hz());
    let sent =
        last.map_or(0, |send| send.start.0 + line_time(send.bytes.len() as u64, clock_hz, checked.baud));
    let forced = checked.forced.iter().map(|forced| forced.end.0).max().unwrap_or(0);
    let sent = sent.max(forced);
    let end = |plan: &ControllerPlan| {
        let config = plan.config();
        let late = if is_faithful(checked, config) { 0 } else { BYTE_BITS * config.bit().0 };
        let ticks_end = if checked.waits_for_replies() {
            sent + late + config.tick().0
        } else if arrives_as_scheduled(checked, config) {
            scheduled_end(schedule, checked, controllers.len(), plan)
        } else {
            let ticks = max_ticks(checked, config, schedule).min(u64::from(config.queue_depth()) + 1);
            sent + late + ticks * config.tick().0
        };
        let is_framed = config.protocol() == Protocol::Framed;
        let reply = if is_framed { longest_reply(config) } else { NAK_LEN as u64 };
        let reply = line_time(reply, clock_hz, config.reply_baud());
        ticks_end.max(sent + late + MAX_IDLE_BITS * config.bit().0 + reply)
    };
    controllers.iter().map(end).max().unwrap_or(sent) + 1
}

/// The end of a controller's last tick if each packet arrives as sent. A late packet delays all later ticks.
fn scheduled_end(
    schedule: &Schedule,
    checked: &CheckedScenario,
    controllers: usize,
    plan: &ControllerPlan,
) -> u64 {
    let config = plan.config();
    let tick = config.tick().0;
    // Any packet may address any controller, more than once per turn.
    let (turns, each) = match &checked.source {
        Source::Packets(_) if controllers > 1 => (schedule.len(), controllers as u64),
        _ => (plan.each_tick().len(), 1),
    };
    let max_waiting = u64::from(config.queue_depth()) + 1;
    schedule.iter().take(turns).fold(0, |end, send| {
        let received = send.start.0 + line_time(send.bytes.len() as u64, config.clock_hz(), checked.baud);
        (end.max(received) + each * tick).min(received + max_waiting * tick)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Experiment;
    use alloc::vec;
    use stepscope_peripheral::config::Bus;
    use stepscope_scenario::{Glitch, Line, Scenario};

    fn config(clock_hz: u32, baud: u32, receiver_baud: u32) -> Option<Config> {
        let line = Line { baud, receiver_baud: Some(receiver_baud), ..Line::default() };
        Config::new(clock_hz, &Bus::default(), &line.serial()).ok()
    }

    #[test]
    fn a_receiver_at_the_senders_rate_gets_all_bytes() {
        for clock_hz in [21, 1000, 1603, 16_000_000] {
            for baud in (1..clock_hz / 10).step_by(1 + clock_hz as usize / 3000) {
                assert!(
                    config(clock_hz, baud, baud).is_none_or(|c| gets_all_bits(&c, baud)),
                    "{clock_hz} {baud}"
                );
            }
        }
        // With 16 cycles per bit, receivers with 15 and 17 sample a wrong bit.
        for (receiver_baud, expected) in [(100, true), (97, true), (107, false), (95, false)] {
            let config = config(1600, 100, receiver_baud).expect("holds");
            assert_eq!(gets_all_bits(&config, 100), expected, "{receiver_baud}");
        }
    }

    #[test]
    fn a_slow_receiver_begins_its_tick_after_the_byte() {
        // The sender has 10.4 cycles per bit, the receiver 11: the byte ends at 105 and is delivered there.
        let json = r#"{"clock_hz":1000,"line":{"baud":96,"receiver_baud":94},
            "bus":{"self_test_cycles":0},"source":{"line":{"sends":[{"start_cycle":1,"bytes":"87"}]}}}"#;
        let experiment = Experiment::from_json(json).expect("runs");
        let run = experiment.run(&mut vec![]);
        assert_eq!(run.cycles().0, 105 + 1 + 32_000 + 1);
        assert!(run.cycles().0 <= experiment.cost().end_cycle);
    }

    #[test]
    fn a_late_tick_delays_all_later_ticks() {
        // Two controllers share the line at first, then one has it for itself (found by `cargo xtask fuzz`).
        let json = r#"{"bus":{"channels":2},"line":{"address":9},"controllers":[
            {"address":3,"bus":{"channels":2},"axes":[{"moves":[
                {"constant":{"distance":{"steps":-19},"speed":{"steps_s":500}}}]}]},
            {"address":4,"bus":{"channels":2},"axes":[]}],
            "source":{"motion":{"axes":[{"moves":[
                {"constant":{"distance":{"steps":40},"speed":{"steps_s":1000}}}]}]}}}"#;
        let experiment = Experiment::from_json(json).expect("runs");
        assert_eq!(experiment.run(&mut vec![]).cycles().0, 649_867);
        assert_eq!(experiment.cost().end_cycle, 649_934, "an estimate without the delay is 647 106");
    }

    #[test]
    fn replies_to_a_script_are_within_its_cost() {
        for channels in [1, 2, 16] {
            let json = format!(
                r#"{{"bus":{{"channels":{channels},"self_test_cycles":0}},"line":{{"protocol":"framed"}},
                "source":{{"line":{{"sends":[{{"start_cycle":1,"frame":"0007"}}]}}}}}}"#
            );
            let experiment = Experiment::from_json(&json).expect("runs");
            let mut trace = vec![];
            let run = experiment.run(&mut trace);
            let cost = experiment.cost();
            assert!(run.cycles().0 <= cost.end_cycle, "{channels}: {} of {cost:?}", run.cycles().0);
            assert!(trace.len() as u64 <= cost.records, "{channels}: {} of {cost:?}", trace.len());
        }
    }

    #[test]
    fn each_forced_level_may_become_a_byte() {
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
        scenario.source = stepscope_scenario::part_from_json(json).expect("reads");
        let records = Experiment::new(&scenario).expect("runs").cost().records;
        assert_eq!(records, 1 + 2 * 10 + 10 * 255, "each fall of the line may begin a byte");
    }
}
