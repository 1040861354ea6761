//! Compares the registers with the data sheet.

use super::*;
use crate::config::{Bus, Distribution, PulsePhasing, SerialLine};
use crate::{
    protocol::Kind,
    signal::{Positions, Record},
    units::Cycles,
    wire::{Line, Schedule, frame::emit},
};
use alloc::{sync::Arc, vec, vec::Vec};
use map::{
    RegisterBus,
    control::{COMMIT, DISABLE, ENABLE, STOP},
    result::{CODE_BAD_TIMING, CODE_BUSY, CODE_DONE, CODE_QUEUE_FULL, CODE_STOPPED, CODE_TOO_MANY_STEPS},
    status::{EN, FREE, MOVING, PENDING, STATE, STATE_BUSY, STATE_MOVING, STATE_READY, STATE_STOPPED},
    table::{Access, Register, Reset},
};

/// Ticks of 4 slots of 20 cycles; pulses of 5 cycles, 3 cycles after the start of their slot; a queue of 2 ticks; a self-test
/// of 100 cycles.
const BUS: Bus = Bus {
    channels: 2,
    slots: 4,
    step_period_cycles: 20,
    pulse_width_cycles: 5,
    dir_setup_cycles: 3,
    dir_hold_cycles: 0,
    distribution: Distribution::Burst,
    dir_line: DirLine::PerChannel,
    pulse_phasing: PulsePhasing::Simultaneous,
    settle_cycles: 0,
    queue_depth: 2,
    self_test_cycles: 100,
};

#[derive(Default)]
struct Output {
    trace: Vec<Record>,
    events: Vec<Event>,
}

impl Sink for Output {
    fn record(&mut self, record: Record) {
        self.trace.push(record);
    }

    fn event(&mut self, _: Instant, event: Event) {
        self.events.push(event);
    }
}

/// A peripheral and its output; accesses take no time.
struct Bench {
    device: Device,
    output: Output,
}

impl RegisterBus for Bench {
    fn read(&mut self, offset: u32) -> u32 {
        self.device.read(offset)
    }

    fn write(&mut self, offset: u32, value: u32) {
        self.device.write(offset, value, &mut self.output);
    }
}

impl Bench {
    fn new(bus: &Bus, line: &SerialLine) -> Self {
        let config = Config::new(1_600_000, bus, line).expect("a valid configuration");
        Self { device: Device::new(&config), output: Output::default() }
    }

    /// A bench at the end of the self-test, in cycle 100.
    fn ready() -> Self {
        let mut bench = Self::new(&BUS, &SerialLine { baud: 100_000, ..SerialLine::default() });
        bench.run_to(100);
        bench
    }

    /// Runs to the end of cycle `last`.
    fn run_to(&mut self, last: u64) {
        self.device.run(true, Instant(last + 1), &mut self.output);
    }

    fn result(&mut self, offset: u32, value: u32) -> u32 {
        self.write(offset, value);
        self.read(map::result::OFFSET)
    }

    fn command(&mut self, command: map::table::Field) -> u32 {
        self.result(map::control::OFFSET, command.mask())
    }

    fn push(&mut self, commands: u32) -> u32 {
        self.write(map::orders::OFFSET, commands);
        self.result(map::push::OFFSET, 0)
    }

    fn status(&mut self, field: map::table::Field) -> u32 {
        field.extract(self.read(map::status::OFFSET))
    }

    /// Cycles and levels of the trace without RX, TX and DE, from a cycle on.
    fn edges_from(&self, cycle: u64) -> Vec<(u64, u64)> {
        let records = self.output.trace.iter().filter(|record| record.cycle.0 >= cycle);
        records.map(|record| (record.cycle.0, record.levels.0 & (Levels::EN | 0xffff_ffff))).collect()
    }
}

fn registers() -> impl Iterator<Item = (&'static Register, u32)> {
    map::MAP.iter().flat_map(|register| (0..register.count).map(move |n| (register, register.offset + 4 * n)))
}

#[test]
fn every_register_has_its_reset_value_and_access() {
    let built = [
        ("CAPABILITIES", 0x0002_1001),
        ("CLOCK_HZ", 1_600_000),
        ("BOOT", 100),
        ("STATUS", 0x0200_0200),
        ("SLOTS", 4),
        ("STEP_PERIOD", 20),
        ("PULSE_WIDTH", 5),
        ("DIR_SETUP", 3),
        ("DIR_HOLD", 0),
        ("SETTLE", 0),
        ("MODE", 0),
    ];
    let mut bench =
        Bench::new(&Bus { channels: 16, ..BUS }, &SerialLine { baud: 100_000, ..SerialLine::default() });
    for (register, offset) in registers() {
        let expected = match register.reset {
            Reset::Fixed(value) => value,
            Reset::Configured => {
                built.iter().find(|(name, _)| *name == register.name).expect("a listed register").1
            }
        };
        assert_eq!(bench.read(offset), expected, "{}", register.name);
    }
    bench.run_to(0);
    for (register, offset) in registers().filter(|(register, _)| register.access != Access::Wo) {
        let before = bench.read(offset);
        bench.write(offset, 2);
        let changes = register.access == Access::Rw;
        assert_eq!(bench.read(offset), if changes { 2 } else { before }, "{}", register.name);
    }
}

#[test]
fn without_a_register_reads_return_0_and_writes_are_ignored() {
    let mut bench = Bench::ready();
    let before: Vec<u32> = registers().map(|(_, offset)| bench.read(offset)).collect();
    let known: Vec<u32> = registers().map(|(_, offset)| offset).collect();
    for offset in (0..0x200).chain([u32::MAX - 3, u32::MAX]).filter(|offset| !known.contains(offset)) {
        bench.write(offset, u32::MAX);
        assert_eq!(bench.read(offset), 0, "{offset:#x}");
    }
    assert_eq!(registers().map(|(_, offset)| bench.read(offset)).collect::<Vec<_>>(), before);
}

#[test]
fn pushes_are_ignored_before_cycle_0_and_start_a_tick_in_the_next_cycle() {
    let mut bench = Bench::new(
        &Bus { self_test_cycles: 0, ..BUS },
        &SerialLine { baud: 100_000, ..SerialLine::default() },
    );
    assert_eq!((bench.push(0x01), bench.status(MOVING)), (CODE_DONE, 0), "RESULT has its reset value");
    bench.run_to(0);
    assert_eq!(bench.push(0x81), CODE_DONE);
    bench.run_to(200);
    let en = Levels::EN;
    assert_eq!(
        bench.edges_from(0),
        [(0, en), (1, en | 0x1_0000), (1 + 3, en | 0x1_0001), (1 + 3 + 5, en | 0x1_0000)]
    );
}

#[test]
fn a_push_reports_errors_in_the_order_of_the_data_sheet() {
    let mut bench = Bench::new(&BUS, &SerialLine { baud: 100_000, ..SerialLine::default() });
    let faults = map::faults::OFFSET;
    bench.run_to(50);
    assert_eq!((bench.push(0x7f), bench.status(STATE)), (CODE_BUSY, STATE_BUSY));
    bench.command(STOP);
    assert_eq!((bench.push(0x7f), bench.status(STATE)), (CODE_STOPPED, STATE_STOPPED));
    bench.command(ENABLE);
    bench.run_to(99);
    assert_eq!((bench.push(0x01), bench.read(faults)), (CODE_BUSY, 0));
    bench.run_to(100);
    assert_eq!((bench.status(STATE), bench.status(FREE)), (STATE_READY, 2));
    assert_eq!((bench.push(0x81), bench.push(0x81), bench.status(FREE)), (CODE_DONE, CODE_DONE, 0));
    assert_eq!((bench.push(0x05), bench.read(faults)), (CODE_TOO_MANY_STEPS, 0x20));
    assert_eq!((bench.push(0x04), bench.read(faults)), (CODE_QUEUE_FULL, 0x30));
    assert_eq!(bench.status(STATE), STATE_MOVING);
    bench.run_to(101);
    assert_eq!(bench.status(FREE), 1, "the first tick leaves the queue at its start");
    bench.run_to(101 + 2 * 80 - 1);
    assert_eq!((bench.status(MOVING), bench.read(map::ticks_done::OFFSET)), (1, 1));
    bench.run_to(101 + 2 * 80);
    assert_eq!((bench.status(MOVING), bench.read(map::ticks_done::OFFSET)), (0, 2));
    assert_eq!(bench.read(map::position::OFFSET), 2);
}

#[test]
fn writing_1_clears_a_fault() {
    let mut bench = Bench::ready();
    for command in [0x7f, 1, 1, 1] {
        bench.push(command);
    }
    let steps = [(0x10, 0x20), (0, 0x20), (0x40, 0x20), (u32::MAX, 0)];
    for (written, expected) in steps {
        bench.write(map::faults::OFFSET, written);
        assert_eq!(bench.read(map::faults::OFFSET), expected, "{written:#x}");
    }
}

#[test]
fn underrun_is_set_on_a_framed_line_and_can_be_cleared() {
    let line = SerialLine { baud: 100_000, protocol: Protocol::Framed, ..SerialLine::default() };
    let mut bench = Bench::new(&BUS, &line);
    bench.run_to(100);
    bench.push(1);
    bench.run_to(300);
    assert_eq!(bench.read(map::faults::OFFSET), map::faults::UNDERRUN.mask());
    bench.write(map::faults::OFFSET, map::faults::UNDERRUN.mask());
    bench.push(0);
    bench.run_to(500);
    assert_eq!(bench.read(map::faults::OFFSET), 0, "the last tick had no steps");
}

#[test]
fn a_reply_to_positions_has_the_values_of_the_registers_in_its_cycle() {
    let serial = SerialLine { baud: 100_000, protocol: Protocol::Framed, ..SerialLine::default() };
    let bus = Bus { step_period_cycles: 1000, ..BUS };
    // The tick pushed in cycle 100 has steps in 104, 1104, 2104, 3104: channel 0 to the right, channel 1 twice to the left.
    for (p, steps) in [(2103, [2, -2]), (2104, [3, -2]), (2105, [3, -2])] {
        // Eight bytes, the last one delivered 152 cycles after its start.
        let mut schedule = Schedule::default();
        schedule.push(Instant(p - 7 * 160 - 152), &emit(0, Kind::Positions as u8, &[]));
        let mut line = Line::new(Arc::new(schedule), &[], 1_600_000, serial.baud);
        let mut bench = Bench::new(&bus, &serial);
        while bench.device.now() <= Instant(p) {
            let now = bench.device.now();
            if line.next_change() == now {
                line.change();
            }
            bench.device.clock(line.level(true), &mut bench.output);
            if now == Instant(100) {
                bench.write(map::orders::OFFSET, 0x0284);
                bench.write(map::push::OFFSET, 0);
            }
        }
        let read = [0, 4].map(|channel| bench.read(map::position::OFFSET + channel).cast_signed());
        let replied = bench.output.events.iter().find_map(|event| match event {
            Event::Reply { positions, .. } => *positions,
            _ => None,
        });
        assert_eq!((read, replied), (steps, Positions::new(&steps)), "POSITIONS in {p}");
    }
}

#[test]
fn commands_of_missing_channels_are_not_stored() {
    let mut bench = Bench::ready();
    assert_eq!(bench.push(0x7f7f_0201), CODE_DONE);
    assert_eq!(bench.read(map::orders::OFFSET), 0x0201);
    bench.run_to(200);
    assert_eq!(bench.device.positions(), [-1, -2]);
    assert_eq!(bench.read(map::position::OFFSET + 4), u32::MAX - 1, "two's complement");
}

#[test]
fn stop_in_mid_pulse_ends_the_pulse_in_the_next_cycle() {
    let mut bench = Bench::ready();
    bench.push(0x8202);
    // The tick starts at 101, STEP rises at 104.
    bench.run_to(105);
    assert_eq!(bench.command(STOP), CODE_DONE);
    assert_eq!((bench.status(EN), bench.status(STATE)), (1, STATE_STOPPED), "EN falls in the next cycle");
    bench.run_to(400);
    assert_eq!(bench.edges_from(105), [(106, 0x2_0000)]);
    assert_eq!(bench.device.positions()[..2], [-1, 1], "a pulse that was cut short counts");
    assert_eq!((bench.status(EN), bench.status(FREE), bench.status(MOVING)), (0, 2, 0));
    assert_eq!(bench.command(ENABLE), CODE_DONE);
    bench.run_to(500);
    assert_eq!(bench.edges_from(107), [(401, Levels::EN | 0x2_0000)]);
}

#[test]
fn stop_enable_and_push_in_one_cycle_start_the_tick_in_the_next() {
    let mut bench = Bench::ready();
    bench.push(0x04);
    bench.run_to(105);
    assert_eq!((bench.command(STOP), bench.command(ENABLE), bench.push(0x81)), (0, 0, CODE_DONE));
    bench.run_to(300);
    let right = Levels::EN | 0x1_0000;
    assert_eq!(bench.edges_from(105), [(106, right), (109, right | 1), (114, right)]);
    assert_eq!((bench.device.positions()[0], bench.device.ticks_done()), (0, 1));
}

#[test]
fn disable_is_busy_until_the_end_of_the_tick() {
    let mut bench = Bench::ready();
    bench.push(0x01);
    bench.run_to(101 + 80 - 1);
    assert_eq!((bench.command(DISABLE), bench.status(STATE)), (CODE_BUSY, STATE_MOVING));
    bench.run_to(101 + 80);
    assert_eq!((bench.command(DISABLE), bench.status(STATE)), (CODE_DONE, STATE_STOPPED));
    bench.run_to(200);
    assert_eq!(bench.edges_from(181), [(182, 0)]);
}

#[test]
fn of_several_commands_the_highest_bit_is_executed() {
    let rows = [
        (0, STATE_READY),
        (ENABLE.mask() | DISABLE.mask(), STATE_STOPPED),
        (ENABLE.mask() | COMMIT.mask(), STATE_READY),
        (0xf, STATE_STOPPED),
        (0xffff_fff0, STATE_STOPPED),
        (0, STATE_STOPPED),
    ];
    let mut bench = Bench::ready();
    for (written, state) in rows {
        bench.write(map::control::OFFSET, written);
        assert_eq!(bench.status(STATE), state, "{written:#x}");
    }
}

#[test]
fn after_commit_the_trace_equals_that_of_a_peripheral_with_this_timing() {
    let bus = Bus {
        slots: 6,
        step_period_cycles: 44,
        pulse_width_cycles: 7,
        dir_setup_cycles: 8,
        dir_hold_cycles: 2,
        settle_cycles: 19,
        distribution: Distribution::Spread,
        pulse_phasing: PulsePhasing::Staggered,
        ..BUS
    };
    let line = SerialLine { baud: 100_000, ..SerialLine::default() };
    let (mut bench, mut built) = (Bench::new(&BUS, &line), Bench::new(&bus, &line));
    bench.run_to(0);
    built.run_to(0);
    for register in map::MAP.iter().filter(|r| (map::slots::OFFSET..=map::mode::OFFSET).contains(&r.offset)) {
        assert_eq!(bench.status(PENDING), u32::from(register.offset != map::slots::OFFSET));
        bench.write(register.offset, built.read(register.offset));
    }
    assert_eq!((bench.command(COMMIT), bench.status(PENDING)), (CODE_DONE, 0));
    for bench in [&mut bench, &mut built] {
        bench.run_to(100);
        assert_eq!((bench.push(0x8605), bench.push(0x0283)), (CODE_DONE, CODE_DONE));
        bench.run_to(2_000);
    }
    assert_eq!(bench.output.trace, built.output.trace);
    assert_eq!(bench.device.ticks_done(), 2);
}

#[test]
fn commit_accepts_exactly_the_named_codes_of_mode() {
    for field in map::mode::REGISTER.fields {
        for code in 0..=field.extract(u32::MAX) {
            let known = field.values.iter().any(|named| named.value == code);
            let expected = if known { (CODE_DONE, 0) } else { (CODE_BAD_TIMING, 1) };
            let mut bench = Bench::ready();
            bench.write(map::mode::OFFSET, field.insert(code));
            let found = (bench.command(COMMIT), bench.status(PENDING));
            assert_eq!(found, expected, "code {code} of {}", field.name);
        }
    }
}

#[test]
fn a_refused_commit_changes_nothing() {
    let rows = [
        (map::pulse_width::OFFSET, 18, CODE_BAD_TIMING),
        (map::pulse_width::OFFSET, 17, CODE_DONE),
        (map::pulse_width::OFFSET, 0, CODE_BAD_TIMING),
        (map::slots::OFFSET, 128, CODE_BAD_TIMING),
        (map::slots::OFFSET, 256 + 4, CODE_BAD_TIMING),
        (map::slots::OFFSET, 127, CODE_DONE),
        (map::step_period::OFFSET, 1_000_000_001, CODE_BAD_TIMING),
        (map::dir_hold::OFFSET, u32::MAX, CODE_BAD_TIMING),
        (map::mode::OFFSET, map::mode::PULSES.mask(), CODE_DONE),
    ];
    for (offset, value, expected) in rows {
        let (mut bench, mut untouched) = (Bench::ready(), Bench::ready());
        bench.write(offset, value);
        assert_eq!(bench.command(COMMIT), expected, "{value} at {offset:#x}");
        assert_eq!(bench.read(offset), value, "the written value can be corrected");
        assert_eq!(bench.status(PENDING), u32::from(expected != CODE_DONE));
        if expected != CODE_DONE {
            for bench in [&mut bench, &mut untouched] {
                assert_eq!((bench.push(0x04), bench.push(0x05)), (CODE_DONE, CODE_TOO_MANY_STEPS));
                bench.run_to(300);
            }
            assert_eq!(bench.output.trace, untouched.output.trace);
        }
    }
    let mut bench = Bench::ready();
    bench.write(map::slots::OFFSET, 3);
    bench.push(0x04);
    assert_eq!(bench.command(COMMIT), CODE_BUSY, "a tick waits");
    bench.run_to(180);
    assert_eq!(bench.command(COMMIT), CODE_BUSY, "a tick runs");
    bench.run_to(181);
    assert_eq!((bench.command(COMMIT), bench.push(0x04)), (CODE_DONE, CODE_TOO_MANY_STEPS));
}

#[test]
fn a_stopped_controller_drops_raw_packets_without_a_fault() {
    let mut bench = Bench::ready();
    bench.command(STOP);
    // Two bytes with 16 cycles per bit: start bit, data from bit 0 up, stop bit.
    for byte in [0x01_u32, 0x81] {
        for bit in 0..10 {
            let level = (byte << 1 | 1 << 9) >> bit & 1 != 0;
            let end = bench.device.now() + Cycles(16);
            bench.device.run(level, end, &mut bench.output);
        }
    }
    let packets = bench.output.events.iter().filter(|event| matches!(event, Event::Packet(_)));
    assert_eq!(packets.collect::<Vec<_>>(), vec![&Event::Packet(crate::signal::PacketOutcome::Stopped)]);
    assert_eq!((bench.read(map::faults::OFFSET), bench.status(MOVING)), (0, 0));
}

#[test]
fn finish_does_not_move_time_back_before_a_write() {
    let mut bench = Bench::ready();
    bench.push(0x04);
    bench.device.run(true, Instant::NEVER, &mut bench.output);
    bench.push(0x01);
    let end = 101 + 80;
    assert_eq!(bench.device.now(), Instant(end + 1));
    bench.run_to(5_000);
    bench.write(map::faults::OFFSET, 0);
    let rest = bench.device.last_active().next();
    bench.device.finish(rest);
    assert_eq!(bench.device.now(), Instant(5_001));
    assert_eq!(bench.edges_from(end), [(end + 4, Levels::EN | 1), (end + 9, Levels::EN)]);
}
