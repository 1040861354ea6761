//! A framed host and a controller with faults between them: every single fault of a frame, one after another.

use super::*;
use alloc::{string::ToString, sync::Arc};
use stepscope_peripheral::{
    config::{Bus, Config, Protocol},
    device::Device,
    signal::{Event, MAX_CHANNELS, Positions, Record, Sink},
    wire::{
        Schedule,
        frame::{Deframed, Deframer, Frame, Kind, Reason, Reply, State, Status, Ticks},
    },
};
use stepscope_scenario::Line as LineSettings;

/// 11 cycles per bit.
const CLOCK_HZ: u32 = 1100;
const BAUD: u32 = 100;
/// Ticks of two channels; the last one has no steps.
const COMMANDS: &[u8] = &[0x81, 2, 0x83, 4, 0x82, 1, 0x80, 0];

/// The ticks that began.
#[derive(Default)]
struct Executed(Vec<[u8; MAX_CHANNELS]>);

impl Sink for Executed {
    fn record(&mut self, _: Record) {}

    fn event(&mut self, _: Instant, event: Event) {
        if let Event::TickStart { commands } = event {
            self.0.push(commands);
        }
    }
}

/// The bytes of a frame that reach the line, and whether the host crashes during the frame.
type CorruptedSend = (Vec<u8>, bool);

/// Runs the job with `spoil` between host and line; it gets the number of each frame. Returns the
/// executed commands, the host's final state, its counters, and the unchanged bytes of each
/// frame.
fn run(mut spoil: impl FnMut(usize, &[u8]) -> CorruptedSend) -> (Vec<u8>, Progress, Counts, Vec<Vec<u8>>) {
    let bus = Bus { channels: 2, slots: 4, step_period_cycles: 100, self_test_cycles: 5, ..Bus::default() };
    let line = LineSettings { baud: BAUD, protocol: Protocol::Framed, ..LineSettings::default() };
    let config = Config::new(CLOCK_HZ, &bus, &line.serial()).expect("it holds");
    let job =
        Job { address: 0, channels: 2, tick: config.tick(), queue_depth: 16, commands: COMMANDS.into() };
    let settings = Settings { ticks_per_frame: 2, ..Settings::default() };
    let mut host =
        FramedHost::new(alloc::vec![job], &settings, (CLOCK_HZ, BAUD, config.bit()), Instant(6), None);
    let quiet = || Line::new(Arc::new(Schedule::default()), &[], CLOCK_HZ, BAUD);
    let (mut meant, mut line) = (quiet(), quiet());
    let (mut device, mut ticks, mut frames) = (Device::new(&config), Executed::default(), Vec::new());
    for now in 0..1_000_000 {
        let now = Instant(now);
        if host.conversation().is_over() && device.is_idle() {
            let executed = ticks.0.iter().flat_map(|tick| tick[..2].to_vec()).collect();
            let progress = host.conversation().progress().next().expect("there is one job");
            return (executed, progress, host.conversation().counts(), frames);
        }
        if line.next_change() == now {
            line.change();
        }
        let (driven, sending) = (device.driven().unwrap_or(true), host.is_sending(now));
        let level = line.level(true);
        host.clock(now, sending || line.host_level(driven), &mut meant);
        if let Some(sent) = meant.schedule().get(frames.len()) {
            let (bytes, crashed) = spoil(frames.len(), sent.bytes);
            line.send(sent.start, &bytes);
            frames.push(sent.bytes.to_vec());
            if let Some(Sending { end, crashes }) = &mut host.sending {
                *end = sent.start + Cycles(line_time(bytes.len() as u64, CLOCK_HZ, BAUD));
                *crashes = crashed;
            }
        }
        device.clock(level, &mut ticks);
    }
    panic!("the host never ends");
}

/// Checks that each tick was executed once, and that the host has confirmed it.
fn check(what: &str, spoil: impl FnMut(usize, &[u8]) -> CorruptedSend) -> Counts {
    let (executed, progress, counts, _) = run(spoil);
    assert_eq!((executed.as_slice(), progress), (COMMANDS, Progress::Done), "{what}");
    counts
}

/// The frames of a run without faults: STATUS, POSITIONS, TICKS, TICKS, STATUS, POSITIONS.
fn frames() -> Vec<Vec<u8>> {
    let (executed, progress, counts, frames) = run(|_, bytes| (bytes.to_vec(), false));
    assert_eq!((executed.as_slice(), progress), (COMMANDS, Progress::Done));
    assert_eq!((counts.frames, counts.repeated, counts.replies, frames.len()), (6, 0, 6, 6));
    frames
}

/// Calls `each` with the number of every frame and of every byte in it.
fn each_byte(mut each: impl FnMut(usize, usize)) {
    for (frame, bytes) in frames().iter().enumerate() {
        (0..bytes.len()).for_each(|byte| each(frame, byte));
    }
}

#[test]
fn a_lost_byte_causes_a_repetition_and_loses_no_step() {
    let lengths: Vec<usize> = frames().iter().map(Vec::len).collect();
    each_byte(|frame, byte| {
        let counts = check(&alloc::format!("byte {byte} of frame {frame}"), |index, bytes| {
            let mut bytes = bytes.to_vec();
            if index == frame {
                bytes.remove(byte);
            }
            (bytes, false)
        });
        // Without its delimiter a frame is executed when its repetition begins. Its reply collides with the
        // repetition, and only the next reply is received.
        let is_mark = byte + 1 == lengths[frame];
        assert_eq!(counts.repeated, if is_mark { 2 } else { 1 }, "byte {byte} of frame {frame}");
    });
}

#[test]
fn a_duplicated_byte_loses_no_step() {
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
fn a_flipped_bit_causes_a_repetition_and_loses_no_step() {
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
fn a_crashed_host_continues_with_the_next_tick() {
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
fn two_faults_in_a_row_lose_no_step() {
    // Two faults in a row: a frame without its delimiter, and a lost byte in its repetition.
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
fn a_late_reply_to_the_previous_frame_acknowledges_nothing() {
    for (expected_seq, acknowledged) in [(7, 0), (8, 2)] {
        let job =
            Job { address: 0, channels: 2, tick: Cycles(400), queue_depth: 16, commands: COMMANDS.into() };
        let mut host = Conversation::new(alloc::vec![job], &Settings::default(), Cycles(11), Instant(1));
        (host.peers[0].progress, host.peers[0].seq, host.peers[0].free) = (Progress::Filling, 7, 2);
        let _ = host.poll(Instant(1)).expect("TICKS are due");
        host.sent(Instant(8));
        let status = Status { state: State::Moving, free: 14, expected_seq, faults: 0, ticks_done: 0 };
        for byte in (Reply { address: 0, result: Ok(Kind::Ticks), status }).emit(None) {
            host.receive(byte, Instant(9));
        }
        assert_eq!(host.acknowledged().next(), Some(acknowledged), "seq {expected_seq}");
        assert_eq!(host.counts().replies, u64::from(acknowledged > 0));
    }
}

#[test]
fn a_controller_without_replies_executes_what_it_receives() {
    for silent_from in 0..6 {
        let heard =
            |index: usize, bytes: &[u8]| if index < silent_from { bytes.to_vec() } else { Vec::new() };
        let (executed, progress, counts, _) = run(|index, bytes| (heard(index, bytes), false));
        assert_eq!(progress, Progress::GivenUp(GivenUp::NoReply));
        assert_eq!((counts.frames, counts.repeated), (silent_from as u64 + 10, 9));
        assert_eq!(executed, COMMANDS[..4 * silent_from.saturating_sub(2).min(2)], "{silent_from}");
    }
}

/// A controller of two channels that executes each command immediately.
struct Reported {
    seq: u8,
    ticks_done: u32,
    positions: Vec<i32>,
    state: State,
}

/// Runs the job with a controller that replies immediately; `falsify` may change or drop a reply. Returns
/// the requested kinds, and the host's final state.
fn converse(
    falsify: impl FnMut(&mut Conversation, usize, Kind, &mut Reported) -> Option<Result<Kind, Reason>>,
) -> (Vec<Kind>, Progress, Known) {
    let reported =
        Reported { seq: 7, ticks_done: 1000, positions: alloc::vec![-3, i32::MAX], state: State::Ready };
    converse_with(reported, false, falsify)
}

/// The same with a controller that has run before, and optionally with an opening tick.
fn converse_with(
    mut reported: Reported,
    opening_tick: bool,
    mut falsify: impl FnMut(&mut Conversation, usize, Kind, &mut Reported) -> Option<Result<Kind, Reason>>,
) -> (Vec<Kind>, Progress, Known) {
    let job = Job { address: 0, channels: 2, tick: Cycles(400), queue_depth: 16, commands: COMMANDS.into() };
    let settings = Settings { ticks_per_frame: 2, ..Settings::default() };
    let settings = if opening_tick { settings } else { Settings::default() };
    let mut host = Conversation::new(alloc::vec![job], &settings, Cycles(11), Instant(6));
    if opening_tick {
        host = host.with_opening_tick();
    }
    let (mut asked, mut now) = (Vec::new(), Instant(6));
    while !host.is_over() {
        now = now.max(host.deadline());
        let Some(frame) = host.poll(now) else { continue };
        host.sent(now);
        let (mut deframer, mut refused) = (Deframer::default(), false);
        let kind = frame.iter().find_map(|&byte| match deframer.byte(byte) {
            Some(Deframed::Frame(Frame { kind, body, .. })) => {
                let kind = Kind::parse(kind).expect("it is one of the contract's");
                if let Some(ticks) = Ticks::parse(body, 2).filter(|_| kind == Kind::Ticks) {
                    if ticks.seq != reported.seq {
                        refused = ticks.seq != reported.seq.wrapping_sub(1);
                        return Some(kind);
                    }
                    reported.seq = reported.seq.wrapping_add(1);
                    reported.ticks_done = reported.ticks_done.wrapping_add(ticks.count() as u32);
                    let orders = ticks.commands().chunks(2).flat_map(|tick| tick.iter().zip(0..));
                    for (&byte, channel) in orders {
                        let steps = i32::from(byte & 0x7f) * if byte & 0x80 == 0 { -1 } else { 1 };
                        reported.positions[channel] = reported.positions[channel].wrapping_add(steps);
                    }
                }
                if kind == Kind::Stop {
                    reported.state = State::Stopped;
                }
                Some(kind)
            }
            _ => None,
        });
        let kind = kind.expect("a frame");
        asked.push(kind);
        let Some(answer) = falsify(&mut host, asked.len() - 1, kind, &mut reported) else { continue };
        let answer = if refused { Err(Reason::BadSeq) } else { answer };
        let Reported { seq: expected_seq, ticks_done, state, .. } = reported;
        let status = Status { state, free: 16, expected_seq, faults: 0, ticks_done };
        let positions =
            (answer == Ok(Kind::Positions)).then(|| Positions::new(&reported.positions).expect("some"));
        now += Cycles(100);
        (Reply { address: 0, result: answer, status })
            .emit(positions.as_ref())
            .iter()
            .for_each(|&byte| host.receive(byte, now));
    }
    let known = *host.known().next().expect("one job").1;
    (asked, host.progress().next().expect("one job"), known)
}

#[test]
fn positions_are_compared_with_the_sums_of_the_ticks() {
    use Kind::{Positions, Status, Stop, Ticks};
    let whole = [Status, Positions, Ticks, Status, Positions];
    let (asked, progress, known) = converse(|_, _, kind, _| Some(Ok(kind)));
    assert_eq!((asked.as_slice(), progress), (&whole[..], Progress::Done));
    // 1 + 3 + 2 steps right; 2, 4 and 1 steps left, wrapping at 32 bits.
    assert_eq!(known.positions.expect("told").as_slice(), [3, i32::MAX - 7]);
    assert_eq!(
        (known.opening_positions.expect("told").as_slice(), known.ticks_done()),
        (&[-3, i32::MAX][..], Some(4))
    );

    // One additional step on the second channel, at the end.
    let (_, progress, _) = converse(|_, index, kind, reported| {
        reported.positions[1] += i32::from(index == 4);
        Some(Ok(kind))
    });
    let (channel, ticks, reported) = (1, 4, i32::MAX - 6);
    let displaced = GivenUp::Displaced { channel, ticks, expected: reported - 1, reported };
    assert_eq!(progress, Progress::GivenUp(displaced));
    assert_eq!(displaced.to_string(), "after 4 ticks channel 1 is at 2147483641 instead of 2147483640");

    // A device with other channels than the ticks gets none.
    let (asked, progress, _) = converse(|_, _, kind, reported| {
        reported.positions = alloc::vec![0; 3];
        Some(Ok(kind))
    });
    let other = GivenUp::OtherChannels { expected: 2, reported: 3 };
    assert_eq!((asked.as_slice(), progress), (&[Status, Positions][..], Progress::GivenUp(other)));

    // A controller without POSITIONS gets one request, and only its ticks are confirmed.
    let (asked, progress, known) =
        converse(|_, _, kind, _| Some(if kind == Positions { Err(Reason::UnknownKind) } else { Ok(kind) }));
    assert_eq!((asked.as_slice(), progress), (&[Status, Positions, Ticks, Status][..], Progress::Counted));
    assert!(known.hides_positions && known.positions.is_none());

    // A controller that was reset, or has another host, too.
    let (_, progress, _) = converse(|_, index, kind, reported| {
        reported.ticks_done += u32::from(index == 3);
        Some(Ok(kind))
    });
    assert_eq!(progress, Progress::GivenUp(GivenUp::OtherTicks { done: 5, commanded: 4 }));

    // Another host moves it during the opening: the opening is repeated.
    let (asked, progress, _) = converse(|_, index, kind, reported| {
        reported.state = if index == 1 { State::Moving } else { State::Ready };
        reported.ticks_done += u32::from(index == 2);
        Some(Ok(kind))
    });
    assert_eq!(asked, [[Status, Positions].as_slice(), &whole].concat());
    assert_eq!(progress, Progress::Done);

    // A stop request while a reply is due: STOP follows and is repeated, then the status is requested.
    let (asked, progress, known) = converse(|host, index, kind, _| {
        if index == 1 {
            host.stop(Instant(6));
        }
        (index != 2).then_some(Ok(kind))
    });
    assert_eq!(asked, [Status, Positions, Stop, Stop, Status, Positions]);
    assert_eq!(progress, Progress::GivenUp(GivenUp::Interrupted));
    assert!(known.stop_acknowledged && known.last.is_some_and(|last| last.state == State::Stopped));
}

#[test]
fn the_time_for_a_reply_is_that_of_its_longest_form() {
    // Kind, channels, bit times from the end of the frame.
    for (kind, channels, bits) in [
        (Kind::Status, 16, 256),
        (Kind::Ticks, 1, 256),
        (Kind::Positions, 1, 256 + 10 * 3),
        (Kind::Positions, 16, 256 + 10 * 63),
    ] {
        let host = Conversation::new(Vec::new(), &Settings::default(), Cycles(11), Instant(6));
        assert_eq!(host.timeout_of(kind, channels), Cycles(11 * bits), "{kind:?} of {channels}");
        let settings = Settings { reply_timeout_cycles: Some(5000), ..Settings::default() };
        let own = Conversation::new(Vec::new(), &settings, Cycles(11), Instant(6)).with_slack(Cycles(7));
        assert_eq!(
            own.timeout_of(kind, channels),
            Cycles(5007 + 11 * (bits - 256)),
            "{kind:?} of {channels}"
        );
    }
}

#[test]
fn an_opening_tick_makes_every_later_reset_detectable() {
    use Kind::{Positions, Status, Ticks};
    // STATUS, POSITIONS, the opening tick, STATUS, two frames of ticks, STATUS, POSITIONS.
    let whole = [Status, Positions, Ticks, Status, Ticks, Ticks, Status, Positions];
    let numbers = [0, 1, 127, 254, 255];
    let counts = [0, 1, 1000, u32::MAX - 4, u32::MAX - 1, u32::MAX];
    for (seq, ticks_done) in numbers.into_iter().flat_map(|seq| counts.map(|count| (seq, count))) {
        let what = alloc::format!("seq {seq} ticks {ticks_done}");
        let reported =
            || Reported { seq, ticks_done, positions: alloc::vec![-3, i32::MAX], state: State::Ready };
        let (asked, progress, known) = converse_with(reported(), true, |_, _, kind, _| Some(Ok(kind)));
        assert_eq!(progress, Progress::Done, "{what}");
        assert_eq!(
            (known.ticks_done(), known.positions.expect("told").as_slice()),
            (Some(4), &[3, i32::MAX - 7][..])
        );
        // A controller that would look the same after a reset gets another tick without steps.
        let is_plain = seq != 255 && ticks_done != u32::MAX;
        assert_eq!(asked == whole, is_plain, "{what}: {asked:?}");
        assert!(asked.len() <= whole.len() + 4, "{what}: {asked:?}");

        // A reset while its reply is on the line, or lost, in one exchange or in two.
        for (first, again) in
            (0..asked.len()).flat_map(|first| (first..asked.len()).map(move |again| (first, again)))
        {
            for heard in [true, false] {
                let mut steps = alloc::vec![0_i64; 2];
                let mut before = reported().positions;
                let (_, progress, _) = converse_with(reported(), true, |_, index, kind, reported| {
                    for ((steps, now), before) in steps.iter_mut().zip(&reported.positions).zip(&before) {
                        *steps += i64::from(now.wrapping_sub(*before));
                    }
                    let is_reset = index == first || index == again;
                    if is_reset {
                        *reported = Reported {
                            seq: 0,
                            ticks_done: 0,
                            positions: alloc::vec![0; 2],
                            state: State::Ready,
                        };
                    }
                    before = reported.positions.clone();
                    (heard || !is_reset).then_some(Ok(kind))
                });
                let right = steps == [6, -7];
                assert!(
                    progress != Progress::Done || right,
                    "{what}, reset in {first} and {again}, {heard}: {steps:?}"
                );
            }
        }
    }
}

#[test]
fn after_a_reset_the_report_has_the_ticks_that_were_reported_before() {
    let reported = Reported { seq: 0, ticks_done: 0, positions: alloc::vec![0; 2], state: State::Ready };
    let (_, progress, known) = converse_with(reported, true, |_, index, kind, reported| {
        if index == 4 {
            *reported = Reported { seq: 0, ticks_done: 0, positions: alloc::vec![0; 2], state: State::Ready };
            return None;
        }
        Some(Ok(kind))
    });
    assert_eq!((progress, known.ticks_done()), (Progress::GivenUp(GivenUp::Reset), Some(0)));
    assert_eq!(
        GivenUp::Reset.to_string(),
        "the controller was reset during the job, or another host controls it"
    );
}

#[test]
fn a_framed_job_is_done() {
    use crate::{Experiment, framed_host::Progress};
    use stepscope_peripheral::signal::Record;

    // The default motion over the framed protocol: opened, filled, confirmed.
    let framed = r#"{ "line": { "protocol": "framed" } }"#;
    let run = Experiment::from_json(framed).expect("no problems").run(&mut Vec::<Record>::new());
    let host = run.host().expect("a framed line has one");
    assert!(host.conversation().progress().all(|progress| progress == Progress::Done));
}
