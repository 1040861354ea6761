//! A host and a controller with someone between them: every fault of one frame, one after the other.

use super::*;
use alloc::rc::Rc;
use stepscope_peripheral::{
    config::{Bus, Config, Protocol},
    device::Device,
    signal::{Event, MAX_CHANNELS, Record, Sink},
    wire::{
        Schedule,
        frame::{State, Status},
    },
};
use stepscope_scenario::Line as LineSettings;

/// 11 cycles a bit.
const CLOCK_HZ: u32 = 1100;
const BAUD: u32 = 100;
/// Ticks of two channels; the last one has no steps.
const ORDERS: &[u8] = &[0x81, 2, 0x83, 4, 0x82, 1, 0x80, 0];

/// The ticks that begin.
#[derive(Default)]
struct Ticks(Vec<[u8; MAX_CHANNELS]>);

impl Sink for Ticks {
    fn record(&mut self, _: Record) {}

    fn event(&mut self, _: Instant, event: Event) {
        if let Event::TickStart { orders } = event {
            self.0.push(orders);
        }
    }
}

/// What reaches the line of one frame, and whether the host crashes in it.
type CorruptedSend = (Vec<u8>, bool);

/// Runs the job with `spoil` between host and line, which is given the number of each frame. Gives
/// the executed orders, where the host ended, what it counted, and the bytes of each frame as it was
/// meant.
fn run(mut spoil: impl FnMut(usize, &[u8]) -> CorruptedSend) -> (Vec<u8>, Progress, Counts, Vec<Vec<u8>>) {
    let bus = Bus { channels: 2, slots: 4, step_period_cycles: 100, boot_cycles: 5, ..Bus::default() };
    let line = LineSettings { baud: BAUD, protocol: Protocol::Framed, ..LineSettings::default() };
    let config = Config::new(CLOCK_HZ, &bus, &line.serial()).expect("it holds");
    let job = Job { address: 0, channels: 2, tick: config.tick(), queue_depth: 16, commands: ORDERS.into() };
    let settings = Settings { ticks_per_frame: 2, ..Settings::default() };
    let mut host =
        FramedHost::new(alloc::vec![job], &settings, (CLOCK_HZ, BAUD, config.bit()), Instant(6), None);
    let quiet = || Line::new(Rc::new(Schedule::default()), &[], CLOCK_HZ, BAUD);
    let (mut meant, mut line) = (quiet(), quiet());
    let (mut device, mut ticks, mut frames) = (Device::new(&config), Ticks::default(), Vec::new());
    for now in 0..1_000_000 {
        let now = Instant(now);
        if host.is_over() && device.at_rest() {
            let executed = ticks.0.iter().flat_map(|tick| tick[..2].to_vec()).collect();
            let progress = host.progress().next().expect("there is one job");
            return (executed, progress, host.counts(), frames);
        }
        if line.next_change() == now {
            line.change();
        }
        let (driven, sending) = (device.driven().unwrap_or(true), host.is_sending(now));
        let level = line.heard(true);
        host.clock(now, sending || line.replied(driven), &mut meant);
        if let Some(sent) = meant.schedule().get(frames.len()) {
            let (bytes, crashed) = spoil(frames.len(), sent.bytes);
            line.send(sent.start, &bytes);
            frames.push(sent.bytes.to_vec());
            if let Phase::Sending { end, crashes, .. } = &mut host.phase {
                *end = sent.start + Cycles(line_time(bytes.len() as u64, CLOCK_HZ, BAUD));
                *crashes = crashed;
            }
        }
        device.clock(level, &mut ticks);
    }
    panic!("the host never ends");
}

/// Every tick was executed once, and the host knows.
fn check(what: &str, spoil: impl FnMut(usize, &[u8]) -> CorruptedSend) -> Counts {
    let (executed, progress, counts, _) = run(spoil);
    assert_eq!((executed.as_slice(), progress), (ORDERS, Progress::Done), "{what}");
    counts
}

/// The frames of a run without faults: STATUS, TICKS, TICKS, STATUS.
fn frames() -> Vec<Vec<u8>> {
    let (executed, progress, counts, frames) = run(|_, bytes| (bytes.to_vec(), false));
    assert_eq!((executed.as_slice(), progress), (ORDERS, Progress::Done));
    assert_eq!((counts.frames, counts.repeated, counts.replies, frames.len()), (4, 0, 4, 4));
    frames
}

/// Calls `each` with the number of every frame and of every byte in it.
fn each_byte(mut each: impl FnMut(usize, usize)) {
    for (frame, bytes) in frames().iter().enumerate() {
        (0..bytes.len()).for_each(|byte| each(frame, byte));
    }
}

#[test]
fn a_byte_that_is_lost_costs_a_repetition_and_no_step() {
    let lengths: Vec<usize> = frames().iter().map(Vec::len).collect();
    each_byte(|frame, byte| {
        let counts = check(&alloc::format!("byte {byte} of frame {frame}"), |index, bytes| {
            let mut bytes = bytes.to_vec();
            if index == frame {
                bytes.remove(byte);
            }
            (bytes, false)
        });
        // Without its delimiter a frame is taken when its repetition begins; the answer to it and the
        // repetition meet, and only the next one is heard.
        let is_mark = byte + 1 == lengths[frame];
        assert_eq!(counts.repeated, if is_mark { 2 } else { 1 }, "byte {byte} of frame {frame}");
    });
}

#[test]
fn a_byte_that_comes_twice_costs_no_step() {
    each_byte(|frame, byte| {
        check(&alloc::format!("byte {byte} of frame {frame}"), |index, bytes| {
            let mut bytes = bytes.to_vec();
            if index == frame {
                bytes.insert(byte, bytes[byte]);
            }
            (bytes, false)
        });
    });
}

#[test]
fn a_bit_that_is_turned_over_costs_a_repetition_and_no_step() {
    each_byte(|frame, byte| {
        for bit in 0..8 {
            let counts =
                check(&alloc::format!("bit {bit} of byte {byte} of frame {frame}"), |index, bytes| {
                    let mut bytes = bytes.to_vec();
                    if index == frame {
                        bytes[byte] ^= 1 << bit;
                    }
                    (bytes, false)
                });
            assert!(counts.repeated > 0);
        }
    });
}

#[test]
fn a_host_that_dies_within_a_frame_goes_on_with_the_tick_that_is_due() {
    each_byte(|frame, byte| {
        for sent in [byte, byte + 1] {
            let counts =
                check(&alloc::format!("crashes after {sent} bytes of frame {frame}"), |index, bytes| {
                    let crashes = index == frame;
                    (bytes[..if crashes { sent } else { bytes.len() }].to_vec(), crashes)
                });
            assert_eq!(counts.crashes, 1);
        }
    });
}

#[test]
fn what_is_left_of_each_frame_may_be_any_of_its_bytes_twice_over() {
    // Two faults in a row: a frame without its delimiter, and in its repetition each byte lost.
    each_byte(|frame, byte| {
        check(&alloc::format!("byte {byte} of the repetition of frame {frame}"), |index, bytes| {
            let mut bytes = bytes.to_vec();
            if index == frame {
                bytes.pop();
            }
            if index == frame + 1 {
                bytes.remove(byte);
            }
            (bytes, false)
        });
    });
}

#[test]
fn a_late_answer_to_the_frame_before_acknowledges_nothing() {
    for (expected_seq, acknowledged) in [(7, 0), (8, 2)] {
        let job =
            Job { address: 0, channels: 2, tick: Cycles(400), queue_depth: 16, commands: ORDERS.into() };
        let wire = (CLOCK_HZ, BAUD, Cycles(11));
        let mut host = FramedHost::new(alloc::vec![job], &Settings::default(), wire, Instant(1), None);
        (host.peers[0].progress, host.peers[0].seq) = (Progress::Filling, 7);
        let status = Status { state: State::Moving, free: 14, expected_seq, faults: 0, ticks_done: 0 };
        for byte in (Reply { address: 0, answer: Ok(Kind::Ticks), status }).emit(None) {
            host.hear(byte, Instant(9), (0, Kind::Ticks, 2));
        }
        assert_eq!(host.acknowledged().next(), Some(acknowledged), "seq {expected_seq}");
        assert_eq!(host.counts().replies, u64::from(acknowledged > 0));
    }
}

#[test]
fn a_controller_that_never_answers_is_given_up_and_has_done_what_it_heard() {
    for silent_from in 0..4 {
        let heard =
            |index: usize, bytes: &[u8]| if index < silent_from { bytes.to_vec() } else { Vec::new() };
        let (executed, progress, counts, _) = run(|index, bytes| (heard(index, bytes), false));
        assert_eq!(progress, Progress::GivenUp(GivenUp::NoReply));
        assert_eq!((counts.frames, counts.repeated), (silent_from as u64 + 10, 9));
        assert_eq!(executed, ORDERS[..4 * silent_from.saturating_sub(1).min(2)], "{silent_from}");
    }
}
