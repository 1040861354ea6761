//! The order in which the rules for a TICKS frame are checked (DESIGN A6):
//!
//! ```text
//! BAD_BODY > repeat > BAD_SEQ > STOPPED > BUSY > TOO_MANY_STEPS > QUEUE_FULL > queued
//! ```
//!
//! For each two neighbors there is a frame that breaks both rules and gets the first result, and one that breaks only the
//! second rule and gets the second result.

use std::sync::Arc;
use stepscope_peripheral::{
    config::{Bus, Config, DirLine, Distribution, Protocol, PulsePhasing, SerialLine},
    device::{Device, Faults},
    protocol::{FrameOutcome, Kind, Reason, Reply},
    signal::{Event, Record, Sink},
    units::{Cycles, Instant},
    wire::{
        Line, Schedule,
        frame::{Ticks, emit},
        packet::ALL,
    },
};

const CLOCK_HZ: u32 = 1_600_000;
const BAUD: u32 = 100_000;
/// From the start of a frame to the start of the next: longer than any frame.
const APART: u64 = 30 * 10 * 16;
/// Longer than any row lasts.
const LONG: u32 = 100_000;

/// Four slots per tick and two places in the queue; a tick lasts longer than a row.
const BUS: Bus = Bus {
    channels: 1,
    slots: 4,
    step_period_cycles: LONG,
    pulse_width_cycles: 5,
    dir_setup_cycles: 3,
    dir_hold_cycles: 0,
    distribution: Distribution::Burst,
    dir_line: DirLine::PerChannel,
    pulse_phasing: PulsePhasing::Simultaneous,
    settle_cycles: 0,
    queue_depth: 2,
    self_test_cycles: 0,
};
/// The same during the self-test.
const BOOTING: Bus = Bus { self_test_cycles: LONG, ..BUS };

/// Outcomes of the frames, and the replies.
#[derive(Default)]
struct Log {
    outcomes: Vec<FrameOutcome>,
    replies: Vec<Reply>,
}

impl Sink for Log {
    fn record(&mut self, _: Record) {}

    fn event(&mut self, _: Instant, event: Event) {
        match event {
            Event::Frame(outcome) => self.outcomes.push(outcome),
            Event::Reply { reply, .. } => self.replies.push(reply),
            _ => {}
        }
    }
}

/// A frame's kind and its body.
type Sent<'a> = (Kind, &'a [u8]);
/// The bus, earlier frames, the body of TICKS (sequence number, count, commands), its outcome, and the faults.
type Case<'a> = (&'a Bus, &'a [Sent<'a>], &'a [u8], FrameOutcome, Faults);

/// Broadcasts the frames of `before`, and then sends TICKS with this body to the controller.
fn send_ticks(bus: &Bus, before: &[Sent], body: &[u8]) -> (FrameOutcome, Faults) {
    let serial = SerialLine { baud: BAUD, protocol: Protocol::Framed, ..SerialLine::default() };
    let config = Config::new(CLOCK_HZ, bus, &serial).expect("a valid configuration");
    let mut schedule = Schedule::default();
    let frames = before.iter().map(|(kind, body)| emit(ALL, *kind as u8, body));
    let frames = frames.chain([emit(0, Kind::Ticks as u8, body)]);
    let mut end = Instant(APART);
    for frame in frames {
        schedule.push(end, &frame);
        end += Cycles(APART);
    }
    let (mut device, mut log) = (Device::new(&config), Log::default());
    let mut line = Line::new(Arc::new(schedule), &[], CLOCK_HZ, BAUD);
    while device.now() < end {
        if line.next_change() == device.now() {
            line.change();
        }
        device.run(line.level(true), line.next_change().min(end), &mut log);
    }
    assert_eq!(log.outcomes.len(), before.len() + 1, "one outcome per frame");
    let outcome = *log.outcomes.last().expect("an outcome");
    let results: Vec<_> = log.replies.iter().map(|reply| Some(reply.result)).collect();
    assert_eq!(results, [outcome.reply_result()], "only the frame for this controller gets a reply");
    (outcome, device.faults())
}

#[test]
fn of_two_broken_rules_the_first_in_the_order_is_reported() {
    let refused = FrameOutcome::Refused;
    let taken: Sent = (Kind::Ticks, &[0, 1, 1]);
    let [stop, enable, resync]: [Sent; 3] =
        [Kind::Stop, Kind::Enable, Kind::Resync].map(|kind| (kind, &[][..]));
    let none = Faults::default();

    // A frame that breaks both rules, and one that breaks only the second.
    let rows: [[Case; 2]; 7] = [
        // The count is two, but there is one tick; the sequence number is a repetition.
        [
            (&BUS, &[taken], &[0, 2, 1], refused(Reason::BadBody), none),
            (&BUS, &[taken], &[0, 1, 1], FrameOutcome::Repeated, none),
        ],
        // After RESYNC no sequence number is a repetition.
        [
            (&BUS, &[taken], &[0, 1, 1], FrameOutcome::Repeated, none),
            (&BUS, &[taken, resync], &[255, 1, 1], refused(Reason::BadSeq), Faults::BAD_SEQ),
        ],
        [
            (&BUS, &[stop], &[1, 1, 1], refused(Reason::BadSeq), Faults::BAD_SEQ),
            (&BUS, &[stop], &[0, 1, 1], refused(Reason::Stopped), none),
        ],
        [
            (&BOOTING, &[stop], &[0, 1, 1], refused(Reason::Stopped), none),
            (&BOOTING, &[stop, enable], &[0, 1, 1], refused(Reason::Busy), none),
        ],
        // Five steps in four slots.
        [
            (&BOOTING, &[], &[0, 1, 5], refused(Reason::Busy), none),
            (&BUS, &[], &[0, 1, 5], refused(Reason::TooManySteps), Faults::TOO_MANY_STEPS),
        ],
        // Three ticks for two free entries, the last of them with too many steps.
        [
            (&BUS, &[], &[0, 3, 4, 4, 5], refused(Reason::TooManySteps), Faults::TOO_MANY_STEPS),
            (&BUS, &[], &[0, 3, 4, 4, 4], refused(Reason::QueueFull), Faults::QUEUE_OVERFLOW),
        ],
        [
            (&BUS, &[], &[0, 3, 4, 4, 4], refused(Reason::QueueFull), Faults::QUEUE_OVERFLOW),
            (&BUS, &[], &[0, 2, 4, 4], FrameOutcome::Queued(2), none),
        ],
    ];
    for (bus, before, body, outcome, faults) in rows.into_iter().flatten() {
        assert_eq!(send_ticks(bus, before, body), (outcome, faults), "{before:?}, then TICKS {body:?}");
    }
    // The second outcome of each row is the first of the next row.
    assert!(rows.windows(2).all(|pair| pair[0][1].3 == pair[1][0].3), "the chain has no gap");
}

#[test]
fn a_wrong_sequence_number_takes_precedence_over_all_later_rules() {
    // Also stopped, in the self-test, five steps in four slots, and three ticks for two places.
    let body = Ticks::emit(1, 1, &[5, 5, 5]);
    let (outcome, faults) = send_ticks(&BOOTING, &[(Kind::Stop, &[])], &body);
    assert_eq!((outcome, faults), (FrameOutcome::Refused(Reason::BadSeq), Faults::BAD_SEQ));
}
