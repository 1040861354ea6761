//! The order of actions within one cycle (DESIGN A7), pair by pair. Each row puts two actions into one cycle, or one cycle
//! apart; with another order the trace and the events would differ.

use super::*;
use crate::{
    config::{Bus, SerialLine},
    protocol::{FrameOutcome, Kind, State},
    signal::Positions,
    units::Cycles,
    wire::{Line, Schedule, frame::encode_frame, packet::ALL},
};
use alloc::{sync::Arc, vec, vec::Vec};

const CLOCK_HZ: u32 = 1_600_000;
const BAUD: u32 = 100_000;
const BIT: u64 = 16;
const BYTE: u64 = 10 * BIT;
const DELIVERY: u64 = BIT / 2 + 9 * BIT;
const TICK: u64 = 4 * 1000;
/// Commit of the first TICKS or packet, and the end of its first tick.
const P: u64 = 2000;
const E: u64 = P + 1 + TICK;

#[derive(Debug, Default, PartialEq)]
struct Output {
    trace: Vec<Record>,
    events: Vec<(u64, Event)>,
}

impl Sink for Output {
    fn record(&mut self, record: Record) {
        self.trace.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.events.push((at.0, event));
    }
}

impl Output {
    fn starts(&self) -> Vec<u64> {
        let starts = self.events.iter().filter(|(_, event)| matches!(event, Event::TickStart { .. }));
        starts.map(|(at, _)| *at).collect()
    }

    fn frames(&self) -> Vec<FrameOutcome> {
        let frame = |(_, event): &(u64, Event)| match event {
            Event::Frame(outcome) => Some(*outcome),
            _ => None,
        };
        self.events.iter().filter_map(frame).collect()
    }
}

fn bus(channels: u8, queue_depth: u8) -> Bus {
    Bus {
        channels,
        slots: 4,
        step_period_cycles: 1000,
        pulse_width_cycles: 5,
        dir_setup_cycles: 3,
        dir_hold_cycles: 0,
        queue_depth,
        self_test_cycles: 0,
        ..Bus::default()
    }
}

/// Sends bytes so that the last one of each send is delivered in the given cycle. Runs to the end of cycle 20 000, cycle by
/// cycle and from event to event.
fn run(bus: &Bus, protocol: Protocol, sends: &[(u64, Vec<u8>)]) -> (Device, Output) {
    let serial = SerialLine { baud: BAUD, protocol, ..SerialLine::default() };
    let config = Config::new(CLOCK_HZ, bus, &serial).expect("a valid configuration");
    let mut schedule = Schedule::default();
    for (delivery, bytes) in sends {
        schedule.push(Instant(delivery - DELIVERY - BYTE * (bytes.len() as u64 - 1)), bytes);
    }
    let line = || Line::new(Arc::new(schedule.clone()), &[], CLOCK_HZ, BAUD);
    let end = Instant(20_001);
    let (mut device, mut slow, mut clocked) = (Device::new(&config), line(), Output::default());
    while device.now() < end {
        if slow.next_change() == device.now() {
            slow.change();
        }
        device.clock(slow.level(true), &mut clocked);
    }
    let (mut device, mut fast, mut output) = (Device::new(&config), line(), Output::default());
    while device.now() < end {
        if fast.next_change() == device.now() {
            fast.change();
        }
        device.run(fast.level(true), fast.next_change().min(end), &mut output);
    }
    assert_eq!(output, clocked, "both speeds have the same output");
    (device, output)
}

/// A broadcast frame, which gets no reply.
fn frame(kind: Kind, body: &[u8]) -> Vec<u8> {
    encode_frame(&[&[ALL, kind as u8], body].concat())
}

#[test]
fn a_place_freed_in_a_cycle_is_free_for_a_packet_of_that_cycle() {
    // A queue of one place: the second packet waits until the first tick ends in E.
    for (third, outcome) in [(E - 1, PacketOutcome::QueueFull), (E, PacketOutcome::Queued)] {
        let sends = [(P, vec![1]), (P + 500, vec![1]), (third, vec![1])];
        let (device, output) = run(&bus(1, 1), Protocol::Raw, &sends);
        assert!(output.events.contains(&(third, Event::Packet(outcome))), "{third}: {:?}", output.events);
        let faults = if outcome == PacketOutcome::Queued { 0 } else { Faults::QUEUE_OVERFLOW.bits() };
        assert_eq!(device.faults().bits(), faults, "{third}");
    }
}

#[test]
fn a_tick_starts_from_commits_of_earlier_cycles_only() {
    // Commit, start.
    for (commit, start) in [(E - 2, E), (E - 1, E), (E, E + 1), (E + 1, E + 2)] {
        let (_, output) = run(&bus(1, 2), Protocol::Raw, &[(P, vec![1]), (commit, vec![1])]);
        assert_eq!(output.starts(), [P + 1, start], "committed in {commit}");
    }
}

#[test]
fn a_gap_precedes_a_byte_delivered_in_its_cycle() {
    let gap = P + 45 * BIT + 1;
    // Delivery of the second byte, whether it continues the packet.
    for (second, continues) in [(gap - 1, true), (gap, false), (gap + 1, false)] {
        let (device, output) = run(&bus(2, 2), Protocol::Raw, &[(P, vec![1]), (second, vec![2])]);
        let byte =
            output.events.iter().position(|(at, event)| *at == second && matches!(event, Event::Byte { .. }));
        let cut = output.events.iter().position(|event| *event == (gap, Event::Gap { cuts_packet: true }));
        assert_eq!(cut.is_none(), continues, "{second}");
        assert!(cut.is_none() || cut < byte, "{second}: {:?}", output.events);
        assert_eq!(output.starts(), if continues { vec![second + 1] } else { vec![] }, "{second}");
        // Without a third byte the second one's packet is cut short, too.
        let faults = if continues { 0 } else { Faults::SHORT_PACKET.bits() };
        assert_eq!(device.faults().bits(), faults, "{second}");
    }
}

#[test]
fn ignoring_ends_before_a_byte_delivered_in_the_cycle_of_the_gap() {
    // A break instead of a byte: its stop bit is low, and the line rises before the next one.
    let gap = P + 45 * BIT + 1;
    for (byte, taken) in [(gap - 1, false), (gap, true)] {
        let serial = SerialLine { baud: BAUD, ..SerialLine::default() };
        let config = Config::new(CLOCK_HZ, &bus(1, 2), &serial).expect("a valid configuration");
        let mut schedule = Schedule::default();
        schedule.push(Instant(byte - DELIVERY), &[1]);
        let start = Instant(P - DELIVERY);
        let forced = crate::wire::ForcedLevel { start, end: start + Cycles(BYTE), level: false };
        let mut line = Line::new(Arc::new(schedule), &[forced], CLOCK_HZ, BAUD);
        let (mut device, mut output) = (Device::new(&config), Output::default());
        while device.now() < Instant(10_000) {
            if line.next_change() == device.now() {
                line.change();
            }
            device.clock(line.level(true), &mut output);
        }
        assert_eq!(output.starts(), if taken { vec![byte + 1] } else { vec![] }, "delivered in {byte}");
        assert_eq!(device.faults(), Faults::FRAMING);
    }
}

#[test]
fn a_tick_ends_before_a_frame_of_that_cycle_is_executed() {
    let (busy, done) = (FrameOutcome::Refused(Reason::Busy), FrameOutcome::Executed(Kind::Disable));
    for (at, outcome) in [(E - 1, busy), (E, done)] {
        let sends = [(P, frame(Kind::Ticks, &[0, 1, 1])), (at, frame(Kind::Disable, &[]))];
        let (_, output) = run(&bus(1, 2), Protocol::Framed, &sends);
        assert_eq!(output.frames(), [FrameOutcome::Queued(1), outcome], "DISABLE in {at}");
    }
}

#[test]
fn stop_cancels_the_running_tick_and_the_next_one() {
    // Cycle of STOP, ticks done, starts.
    let rows: [(u64, u32, &[u64]); 4] =
        [(E - 2, 0, &[P + 1]), (E - 1, 0, &[P + 1]), (E, 1, &[P + 1, E]), (E + 1, 1, &[P + 1, E])];
    for (at, done, starts) in rows {
        let sends = [(P, frame(Kind::Ticks, &[0, 2, 1, 1])), (at, frame(Kind::Stop, &[]))];
        let (device, output) = run(&bus(1, 2), Protocol::Framed, &sends);
        assert_eq!((device.ticks_done(), output.starts()), (done, starts.to_vec()), "STOP in {at}");
        assert_eq!(device.faults(), Faults::default(), "STOP causes no fault");
        let off = output.trace.iter().find(|record| !record.levels.has(Levels::EN));
        assert_eq!(off.map(|record| record.cycle), Some(Instant(at + 1)), "signals change in the next cycle");
    }
}

#[test]
fn a_tick_committed_in_the_last_cycle_of_a_tick_is_too_late_to_prevent_an_underrun() {
    for (at, underrun) in [(E - 1, false), (E, true)] {
        let next = frame(Kind::Ticks, &[1, 1, 0]);
        let (device, output) =
            run(&bus(1, 2), Protocol::Framed, &[(P, frame(Kind::Ticks, &[0, 1, 1])), (at, next)]);
        assert_eq!(output.events.contains(&(E, Event::Underrun)), underrun, "TICKS in {at}");
        assert_eq!(device.faults().contains(Faults::UNDERRUN), underrun);
        assert_eq!(device.ticks_done(), 2);
    }
}

#[test]
fn a_reply_has_the_state_at_the_end_of_its_cycle() {
    // Cycle of STATUS, state, free places, ticks done, faults.
    let rows = [
        (E - 1, State::Moving, 1, 0, 0),
        (E, State::Moving, 2, 1, 0),
        (E + TICK - 1, State::Moving, 2, 1, 0),
        (E + TICK, State::Ready, 2, 2, Faults::UNDERRUN.bits()),
    ];
    for (at, state, free, ticks_done, faults) in rows {
        let status = encode_frame(&[0, Kind::Status as u8]);
        let sends = [(P, frame(Kind::Ticks, &[0, 2, 1, 1])), (at, status)];
        let (_, output) = run(&bus(1, 2), Protocol::Framed, &sends);
        let reply = output.events.iter().find_map(|(in_cycle, event)| match event {
            Event::Reply { reply, start, end, .. } => Some((*in_cycle, *reply, start.0, end.0)),
            _ => None,
        });
        let (in_cycle, reply, start, end) = reply.expect("a reply");
        assert_eq!(
            reply.status,
            Status { state, free, expected_seq: 1, faults, ticks_done },
            "STATUS in {at}"
        );
        assert_eq!((in_cycle, start, end), (at, at + 11 * BIT, at + 11 * BIT + 17 * BYTE));
        // DE rises ten bits after the frame and falls with the end of the last stop bit.
        let de: Vec<u64> = output
            .trace
            .windows(2)
            .filter(|pair| (pair[0].levels.0 ^ pair[1].levels.0) & Levels::DE != 0)
            .map(|pair| pair[1].cycle.0)
            .collect();
        assert_eq!(de, [at + 10 * BIT, end]);
    }
}

#[test]
fn positions_include_a_pulse_that_rises_in_the_cycle_of_the_frame() {
    // The third step of each channel, one to the right and one to the left: 3 cycles after the slot's start.
    let rise = P + 1 + 2 * 1000 + 3;
    // Cycle of POSITIONS, counters.
    for (at, counters) in [(rise - 1, [2, -2]), (rise, [3, -3]), (rise + 1, [3, -3]), (E, [4, -4])] {
        let positions = encode_frame(&[0, Kind::Positions as u8]);
        let sends = [(P, frame(Kind::Ticks, &[0, 1, 0x84, 0x04])), (at, positions)];
        let (_, output) = run(&bus(2, 2), Protocol::Framed, &sends);
        let reply = output.events.iter().find_map(|(_, event)| match event {
            Event::Reply { positions, start, end, .. } => Some((*positions, end.0 - start.0)),
            _ => None,
        });
        assert_eq!(reply, Some((Positions::new(&counters), (17 + 4 * 2) * BYTE)), "POSITIONS in {at}");
    }
}

#[test]
fn a_line_that_is_low_at_reset_falls_in_the_following_cycle() {
    for protocol in [Protocol::Raw, Protocol::Framed] {
        let line = SerialLine { baud: BAUD, protocol, ..SerialLine::default() };
        let config = Config::new(CLOCK_HZ, &bus(1, 4), &line).expect("a valid configuration");
        let (mut slow, mut slow_output) = (Device::new(&config), Output::default());
        while slow.now() < Instant(400) {
            slow.clock(false, &mut slow_output);
        }
        let (mut fast, mut fast_output) = (Device::new(&config), Output::default());
        fast.run(false, Instant(400), &mut fast_output);
        assert_eq!(fast_output, slow_output);
        assert_eq!(fast_output.trace.get(1).map(|record| record.cycle), Some(Instant(1)));
        assert_eq!((fast.faults(), slow.faults()), (Faults::FRAMING, Faults::FRAMING));
    }
}

#[test]
fn the_receiver_samples_the_line_again_when_de_falls() {
    let fall = P + 11 * BIT + 17 * BYTE;
    let status = || encode_frame(&[0, Kind::Status as u8]);
    // First cycle of the start bit, cycle in which it is detected.
    for (start, detected) in [(fall - 1, fall), (fall, fall), (fall + 1, fall + 1)] {
        let (_, output) = run(&bus(1, 2), Protocol::Framed, &[(P, status()), (start + DELIVERY, vec![0xff])]);
        let last = output.events.iter().rev().find_map(|(_, event)| match event {
            Event::Byte { start, .. } => Some(start.0),
            _ => None,
        });
        assert_eq!(last, Some(detected), "sent from {start} on");
    }
}

/// [`Device::driven`] reports the next cycle, but registers that firmware reads have the state of the last one.
#[test]
fn reading_what_is_driven_next_has_no_side_effect() {
    use stepscope_registers as map;
    let serial = SerialLine { baud: BAUD, protocol: Protocol::Framed, ..SerialLine::default() };
    let config = Config::new(CLOCK_HZ, &bus(1, 2), &serial).expect("a valid configuration");
    let status = encode_frame(&[0, Kind::Status as u8]);
    let mut schedule = Schedule::default();
    schedule.push(Instant(P - DELIVERY - BYTE * (status.len() as u64 - 1)), &status);
    let mut line = Line::new(Arc::new(schedule), &[], CLOCK_HZ, BAUD);
    // DISABLE in one cycle, ENABLE in another, and the reply of STATUS between.
    let (disable, enable, end) = (P - 100, P + 3000, Instant(P + 6000));
    let mut devices = [(); 2].map(|()| Device::new(&config));
    let mut output = [(); 2].map(|()| Output::default());
    let mut driving = 0;
    while devices[0].now() < end {
        let now = devices[0].now();
        if line.next_change() == now {
            line.change();
        }
        let level = line.level(true);
        let [plain, watched] = &mut devices;
        let drives = watched.driven();
        assert_eq!(plain.read(map::status::OFFSET), watched.read(map::status::OFFSET), "before {now:?}");
        assert_eq!(plain.status(), watched.status());
        assert!(watched.next_driven(level) > now);
        let levels = plain.clock(level, &mut output[0]);
        assert_eq!(watched.clock(level, &mut output[1]), levels);
        assert_eq!(drives, levels.has(Levels::DE).then(|| levels.has(Levels::TX)), "in {now:?}");
        driving += u32::from(drives.is_some());
        let command = match now.0 {
            at if at == disable => map::control::DISABLE.insert(1),
            at if at == enable => map::control::ENABLE.insert(1),
            _ => continue,
        };
        let _ = devices[1].driven();
        for (device, output) in devices.iter_mut().zip(&mut output) {
            device.write(map::control::OFFSET, command, output);
        }
        let watched = &mut devices[1];
        assert!(watched.next_driven(level) > watched.now(), "EN is due again after {now:?}");
    }
    let [plain, watched] = output;
    assert_eq!(plain, watched);
    let en = plain.trace.windows(2).filter(|pair| (pair[0].levels.0 ^ pair[1].levels.0) & Levels::EN != 0);
    assert!(en.map(|pair| pair[1].cycle.0).eq([disable + 1, enable + 1]));
    assert!(driving > 1000, "{driving}");
}
