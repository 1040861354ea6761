//! The registers: accesses in any cycle have equal results at both speeds of DESIGN A2, and a command by register equals
//! a frame of DESIGN A6 that ends in the same cycle.

use proptest::prelude::*;
use std::sync::Arc;
use stepscope_core::peripheral::wire::schedule::line_time;
use stepscope_core::{
    peripheral::{
        config::{Config, Protocol},
        device::Device,
        protocol::{FrameOutcome, Kind},
        signal::{Event, Levels, Record, Sink},
        units::{Cycles, Instant},
        wire::{Line, Schedule, frame::encode_frame},
    },
    scenario::Scenario,
};
use stepscope_registers::{
    self as map, control, faults, orders, pulse_width, push, result, settle, slots, step_period,
};
use stepscope_tests::{effort, scenarios::small};

/// All results of a run.
#[derive(Debug, Default, PartialEq)]
struct Left {
    trace: Vec<Record>,
    events: Vec<(Instant, Event)>,
}

impl Sink for Left {
    fn record(&mut self, record: Record) {
        self.trace.push(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.events.push((at, event));
    }
}

/// Accesses of firmware in a cycle.
#[derive(Clone, Copy, Debug)]
enum Access {
    Read(u32),
    Write(u32, u32),
}

fn access(channels: u8, most_steps: u8) -> impl Strategy<Value = Access> {
    let used = orders::REGISTER.end() - orders::OFFSET;
    let order = (any::<bool>(), prop_oneof![20 => 0..=most_steps, 1 => 0..=127_u8]);
    let order = order.prop_map(|(right, steps)| u8::from(right) << 7 | steps);
    let four = prop::array::uniform4(order).prop_map(u32::from_le_bytes);
    let timing = prop_oneof![Just(slots::OFFSET), Just(step_period::OFFSET), Just(pulse_width::OFFSET)];
    let timing = prop_oneof![3 => timing, 1 => Just(settle::OFFSET), 1 => Just(map::mode::OFFSET)];
    prop_oneof![
        4 => prop::sample::select(vec![1_u32, 2, 2, 4, 8, 15]).prop_map(|bits| Access::Write(control::OFFSET, bits)),
        3 => (0..u32::from(channels).div_ceil(4), four)
            .prop_map(|(n, four)| Access::Write(orders::OFFSET + 4 * n, four)),
        6 => Just(Access::Write(push::OFFSET, 0)),
        2 => (timing, 0..100_u32).prop_map(|(offset, value)| Access::Write(offset, value)),
        1 => any::<u32>().prop_map(|bits| Access::Write(faults::OFFSET, bits)),
        1 => (0..used + 0x40, any::<u32>()).prop_map(|(offset, value)| Access::Write(offset, value)),
        4 => (0..0x40_u32).prop_map(|n| Access::Read(4 * n)),
    ]
}

/// Activity on the line: bytes of either protocol.
fn sends() -> impl Strategy<Value = Vec<(u64, Vec<u8>)>> {
    let bytes = prop_oneof![
        3 => prop::collection::vec(0..=10_u8, 1..4),
        2 => (1..=6_u8).prop_map(|kind| encode_frame(&[0, kind])),
        2 => (0..3_u8, 0..=8_u8).prop_map(|(seq, order)| encode_frame(&[0, 1, seq, 1, order])),
    ];
    prop::collection::vec((0..1_500_u64, bytes), 0..6)
}

struct Case {
    config: Config,
    line: Line,
    /// Accesses by cycle.
    accesses: Vec<(u64, Access)>,
    end: u64,
}

fn case(scenario: &Scenario, sends: &[(u64, Vec<u8>)], accesses: &[(u64, Access)]) -> Option<Case> {
    let config = Config::new(scenario.clock_hz, &scenario.bus, &scenario.line.serial()).ok()?;
    let mut schedule = Schedule::default();
    let mut start = 1;
    for (pause, bytes) in sends {
        start += pause;
        schedule.push(Instant(start), bytes);
        start += line_time(bytes.len() as u64, scenario.clock_hz, scenario.line.baud);
    }
    let line = Line::new(Arc::new(schedule), &[], scenario.clock_hz, scenario.line.baud);
    let mut at = 0;
    let accesses = accesses.iter().map(|&(pause, access)| {
        at += pause;
        (at, access)
    });
    let accesses = accesses.collect();
    Some(Case { config, line, accesses, end: start.max(at) + 3_000 })
}

impl Case {
    /// Runs the case; `pass` advances the time, at most to the given cycle, with the line at the given level.
    fn run(&self, mut pass: impl FnMut(&mut Device, bool, Instant, &mut Left)) -> (Left, Vec<u32>, Device) {
        let (mut left, mut read) = (Left::default(), Vec::new());
        let (mut device, mut line) = (Device::new(&self.config), self.line.clone());
        let mut accesses = self.accesses.iter().peekable();
        while device.now().0 < self.end {
            let next = accesses.peek().map_or(self.end, |(cycle, _)| cycle + 1);
            if line.next_change() == device.now() {
                line.change();
            }
            let until = next.min(self.end).min(line.next_change().0);
            pass(&mut device, line.level(true), Instant(until), &mut left);
            while let Some((_, access)) = accesses.next_if(|(cycle, _)| cycle + 1 == device.now().0) {
                match *access {
                    Access::Read(offset) => read.push(device.read(offset)),
                    Access::Write(offset, value) => device.write(offset, value, &mut left),
                }
            }
        }
        (left, read, device)
    }
}

fn same(
    way: &str,
    (left, read, device): &(Left, Vec<u32>, Device),
    clocked: &(Left, Vec<u32>, Device),
) -> Result<(), TestCaseError> {
    prop_assert_eq!(&left.trace, &clocked.0.trace, "{}: trace", way);
    prop_assert_eq!(&left.events, &clocked.0.events, "{}: events", way);
    prop_assert_eq!(read, &clocked.1, "{}: what was read", way);
    for register in map::MAP {
        for n in 0..register.count {
            let offset = register.offset + 4 * n;
            prop_assert_eq!(device.read(offset), clocked.2.read(offset), "{}: {}{}", way, register.name, n);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(effort::cases(1_500))]

    #[test]
    fn accesses_in_any_cycle_have_equal_results_at_both_speeds(
        (scenario, accesses) in (small(), any::<bool>()).prop_flat_map(|(mut scenario, framed)| {
            scenario.line.protocol = if framed { Protocol::Framed } else { Protocol::Raw };
            let access = access(scenario.bus.channels, scenario.bus.slots);
            let pause = prop_oneof![2 => Just(0), 3 => 0..40_u64, 2 => 0..1_500_u64];
            (Just(scenario), prop::collection::vec((pause, access), 0..60))
        }),
        sends in sends(),
        hurry in 0..=100_u64,
    ) {
        let Some(case) = case(&scenario, &sends, &accesses) else { return Ok(()) };
        let clocked = case.run(|device, level, until, left| {
            while device.now() < until {
                device.clock(level, left);
            }
        });
        let skipped = case.run(|device, level, until, left| {
            device.clock(level, left);
            let most = until.0 - device.now().0;
            let quiet = device.cycles_until_event().map_or(most, |quiet| quiet.0.min(most));
            device.advance(Cycles(quiet * hurry / 100));
        });
        same("skipped", &skipped, &clocked)?;
        let ran = case.run(|device, level, until, left| device.run(level, until, left));
        same("run", &ran, &clocked)?;
    }
}

/// A command that both a frame and a register can give.
#[derive(Clone, Copy, Debug)]
enum Command {
    Enable,
    Disable,
    Stop,
    Push([u8; 2]),
}

impl Command {
    fn frame(self, seq: u8) -> Vec<u8> {
        match self {
            Self::Enable => vec![255, Kind::Enable as u8],
            Self::Disable => vec![255, Kind::Disable as u8],
            Self::Stop => vec![255, Kind::Stop as u8],
            Self::Push([first, second]) => vec![255, Kind::Ticks as u8, seq, 1, first, second],
        }
    }

    fn write(self, device: &mut Device, left: &mut Left) {
        let (offset, value) = match self {
            Self::Enable => (control::OFFSET, control::ENABLE.mask()),
            Self::Disable => (control::OFFSET, control::DISABLE.mask()),
            Self::Stop => (control::OFFSET, control::STOP.mask()),
            Self::Push([first, second]) => {
                device.write(orders::OFFSET, u32::from_le_bytes([first, second, 0, 0]), left);
                (push::OFFSET, 0)
            }
        };
        device.write(offset, value, left);
    }
}

/// The commands and their results. By frames: each is a frame to all, without a reply. By registers:
/// each is replaced by a frame of the same length that changes nothing, and in the cycle of its end the
/// registers are written.
fn commanded(
    scenario: &Scenario,
    commands: &[(u64, Command)],
    by_frames: bool,
) -> (Vec<(u64, u64)>, Vec<u32>, Device) {
    let config = Config::new(scenario.clock_hz, &scenario.bus, &scenario.line.serial()).expect("it holds");
    let mut device = Device::new(&config);
    let mut line = Line::new(Arc::default(), &[], scenario.clock_hz, scenario.line.baud);
    let (mut left, mut results) = (Left::default(), Vec::new());
    for &(pause, command) in commands {
        let seq = device.status().map_or(0, |status| status.expected_seq);
        let mut frame = command.frame(seq);
        if !by_frames {
            frame[1] = Kind::Status as u8;
        }
        let (start, known) = (Instant(device.now().0 + 1 + pause), left.events.len());
        line.send(start, &encode_frame(&frame));
        let fate = loop {
            if line.next_change() == device.now() {
                line.change();
            }
            device.clock(line.level(true), &mut left);
            let fate = left.events.iter().skip(known).find_map(|(_, event)| match event {
                Event::Frame(fate) => Some(*fate),
                _ => None,
            });
            if let Some(fate) = fate {
                break fate;
            }
        };
        if by_frames {
            results.push(match fate {
                FrameOutcome::Refused(reason) => reason as u32,
                _ => result::CODE_DONE,
            });
        } else {
            command.write(&mut device, &mut left);
            results.push(device.read(result::OFFSET));
        }
    }
    for _ in 0..2_000 {
        device.clock(true, &mut left);
    }
    let mut trace: Vec<_> = left.trace.iter().map(|r| (r.cycle.0, r.levels.0 & !Levels::RX)).collect();
    trace.dedup_by_key(|(_, levels)| *levels);
    (trace, results, device)
}

proptest! {
    #![proptest_config(effort::cases(500))]

    #[test]
    fn a_register_write_equals_a_frame_that_ends_in_its_cycle(
        mut scenario in small(),
        commands in prop::collection::vec(
            (
                0..400_u64,
                prop_oneof![
                    3 => Just(Command::Enable),
                    2 => Just(Command::Disable),
                    1 => Just(Command::Stop),
                    8 => prop::array::uniform2(prop_oneof![0..=8_u8, 0x80..=0x88_u8]).prop_map(Command::Push),
                ],
            ),
            1..12,
        ),
    ) {
        scenario.line.protocol = Protocol::Framed;
        scenario.line.receiver_baud = None;
        scenario.bus.channels = 2;
        // Space for staggered pulses of two channels.
        scenario.bus.step_period_cycles = scenario.bus.step_period_cycles.max(50);
        prop_assume!(Config::new(scenario.clock_hz, &scenario.bus, &scenario.line.serial()).is_ok());
        let (trace, results, device) = commanded(&scenario, &commands, false);
        let (expected, reasons, framed) = commanded(&scenario, &commands, true);
        prop_assert_eq!(results, reasons);
        prop_assert_eq!(trace, expected);
        prop_assert_eq!(device.positions(), framed.positions());
        prop_assert_eq!(device.faults(), framed.faults());
        prop_assert_eq!(device.ticks_done(), framed.ticks_done());
    }
}
