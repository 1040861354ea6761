//! The model next to a real device: it gets the same frames, and its replies are compared (LIVE H4).
//!
//! ```text
//! host ── frame ──┬── the device ── its reply ─────────┐
//!                 └── the model ─── its reply ─────────┴── the first difference, and both delays
//! ```
//!
//! The device may have run before: sequence numbers, ticks, positions and faults are compared relative to the start. Ticks
//! done during a motion depend on exact cycles and are not compared. The model has no plant.

use crate::framed_host::Known;
use crate::session::{ReplyByte, Session};
use alloc::{
    format,
    string::{String, ToString as _},
    vec,
    vec::Vec,
};
use stepscope_peripheral::protocol::{Kind, Reply, State, Status};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::frame::{Deframed, Deframer, Frame, Ticks, emit};
use stepscope_peripheral::wire::schedule::line_time;
use stepscope_peripheral::{device::Faults, signal::Positions, trace::Digest};
use stepscope_scenario::{Problems, Scenario};

/// Maximum cycles to wait until the model is idle.
const MAX_WAIT: u64 = 20_000_000_000;
const WAIT_ROUND: u64 = 1_000_000;

/// A reply and its delay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    pub reply: Reply,
    /// Its positions, if it has any.
    pub positions: Option<Positions>,
    /// From the end of the frame to the end of the reply.
    pub delay: Cycles,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Opening {
    status: Option<Status>,
    positions: Option<Positions>,
}

/// Runs the model next to a real device, and compares their replies.
#[derive(Clone)]
pub struct Twin {
    session: Session,
    /// Cycles that the model ran before the host's cycle 0.
    lead: Cycles,
    deframers: Vec<Deframer>,
    opening: Vec<Opening>,
    sent_end: Instant,
}

impl Twin {
    /// Resets the controllers and waits until they are idle. Errors: every problem, and segments, which have no line.
    pub fn new(scenario: &Scenario) -> Result<Self, Problems> {
        let mut session = Session::new(&Scenario { plant: None, ..scenario.clone() })?;
        run_until_idle(&mut session);
        let controllers = session.experiment().controllers();
        let deframers = (0..controllers).map(|_| Deframer::default()).collect();
        let lead = Cycles(session.now().0);
        Ok(Self {
            session,
            lead,
            deframers,
            opening: vec![Opening::default(); controllers],
            sent_end: Instant(0),
        })
    }

    /// Passes a frame, sent from cycle `now` on, to the model. `device` has the reports of the device, with `channels`.
    pub fn send(&mut self, bytes: &[u8], now: Instant, (channels, device): (u8, &Known)) {
        let bytes = renumbered(bytes, device.opening.map_or(0, |opening| opening.expected_seq), channels);
        self.advance(now);
        self.session.take_replies().for_each(drop);
        self.deframers.fill_with(Deframer::default);
        let experiment = self.session.experiment();
        let takes = line_time(bytes.len() as u64, experiment.config().clock_hz(), experiment.baud());
        self.session.receive(&bytes);
        self.sent_end = self.session.now().next() + Cycles(takes);
    }

    fn advance(&mut self, now: Instant) {
        self.session.advance::<Digest>(now + self.lead, &mut []);
    }

    /// The model's reply to the last frame, if there is one.
    pub fn answer(&mut self) -> Option<Answer> {
        let mut answer = None;
        while self.session.is_busy() && answer.is_none() {
            self.session.advance::<Digest>(self.session.deadline(), &mut []);
            let replies: Vec<ReplyByte> = self.session.take_replies().collect();
            for ReplyByte { controller, end, byte } in replies {
                let frame = self.deframers.get_mut(controller).and_then(|deframer| deframer.byte(byte));
                if let Some(Deframed::Frame(frame)) = frame
                    && let Some(reply) = Reply::parse(frame)
                {
                    let delay = Cycles(end.0.saturating_sub(self.sent_end.0));
                    answer = Some(Answer { reply, positions: frame.positions(), delay });
                }
            }
        }
        answer
    }

    /// The first difference of a device's reply from the model's.
    pub fn difference(
        &mut self,
        controller: usize,
        (reported, device): (&Answer, &Known),
        model: &Answer,
    ) -> Option<String> {
        let own = self.opening.get_mut(controller)?;
        let (status, model_status) = (reported.reply.status, model.reply.status);
        let is_ready = |status: Status| status.state == State::Ready;
        if own.status.is_none() && device.opening.is_some() && is_ready(model_status) {
            own.status = Some(model_status);
        }
        if own.positions.is_none() && device.opening_positions.is_some() {
            own.positions = model.positions;
        }
        let name = |answer: Result<Kind, _>| match answer {
            Ok(kind) => format!("ACK {}", kind.name()),
            Err(reason) => format!("NAK {}", stepscope_peripheral::protocol::Reason::name(reason)),
        };
        if reported.reply.result != model.reply.result {
            let (reported, model) = (name(reported.reply.result), name(model.reply.result));
            return Some(format!("it replies {reported}, the model {model}"));
        }
        if (status.state == State::Stopped) != (model_status.state == State::Stopped) {
            return Some(format!("it is {}, the model {}", status.state.name(), model_status.state.name()));
        }
        let (opening, own_opening) = (device.opening?, own.status?);
        let seqs = [(status, opening), (model_status, own_opening)]
            .map(|(now, opening)| now.expected_seq.wrapping_sub(opening.expected_seq));
        if seqs[0] != seqs[1] {
            let [reported, model] = seqs;
            return Some(format!(
                "it has accepted {reported} frames of ticks since the start, the model {model}, modulo 256"
            ));
        }
        let faults = [status.faults & !opening.faults, model_status.faults & !own_opening.faults];
        if faults[0] != faults[1] {
            let [reported, model] = faults.map(fault_names);
            return Some(format!("its new faults are {reported}, the model's {model}"));
        }
        if !(is_ready(status) && is_ready(model_status)) {
            return None;
        }
        let done = [(status, opening), (model_status, own_opening)]
            .map(|(now, opening)| now.ticks_done.wrapping_sub(opening.ticks_done));
        if done[0] != done[1] {
            let [reported, model] = done;
            return Some(format!("idle, it has done {reported} ticks since the start, the model {model}"));
        }
        let reported = travel(reported.positions?, device.opening_positions?)?;
        let model = travel(model.positions?, own.positions?)?;
        let (channel, (reported, model)) =
            reported.iter().zip(&model).enumerate().find(|(_, (reported, model))| reported != model)?;
        Some(format!(
            "idle, channel {channel} has moved {reported} steps since the start, the model's {model}"
        ))
    }

    /// Status, ticks and steps per channel since the start of a controller of the model, once it is idle.
    pub fn end(&mut self, controller: usize) -> Option<(Status, u32, Vec<i32>)> {
        run_until_idle(&mut self.session);
        let opening = self.opening.get(controller)?;
        let device = self.session.run().devices().nth(controller)?;
        let status = device.status()?;
        let start = opening.positions.as_ref().map_or(&[][..], Positions::as_slice);
        let start = start.iter().chain(core::iter::repeat(&0));
        let travel = device.positions().iter().zip(start).map(|(now, start)| now.wrapping_sub(*start));
        let done = status.ticks_done.wrapping_sub(opening.status.map_or(0, |opening| opening.ticks_done));
        Some((status, done, travel.collect()))
    }
}

fn fault_names(bits: u16) -> String {
    let names: Vec<String> = Faults::from_bits(bits).names().map(|name| name.to_string()).collect();
    if names.is_empty() { "none".into() } else { names.join(" ") }
}

fn travel(now: Positions, start: Positions) -> Option<Vec<i32>> {
    let (now, start) = (now.as_slice(), start.as_slice());
    (now.len() == start.len())
        .then(|| now.iter().zip(start).map(|(now, start)| now.wrapping_sub(*start)).collect())
}

/// Runs until the session is idle, for a limited time.
fn run_until_idle(session: &mut Session) {
    let end = session.now().0.saturating_add(MAX_WAIT);
    while !session.is_idle() && session.now().0 < end {
        session.advance::<Digest>(Instant(session.now().0 + WAIT_ROUND), &mut []);
        session.take_replies().for_each(drop);
    }
}

/// The frame with the sequence number that the model expects.
fn renumbered(bytes: &[u8], offset: u8, channels: u8) -> Vec<u8> {
    let mut deframer = Deframer::default();
    let mut renumbered = None;
    for &byte in bytes {
        if let Some(Deframed::Frame(Frame { address, kind, body })) = deframer.byte(byte)
            && kind == Kind::Ticks as u8
            && let Some(ticks) = Ticks::parse(body, channels)
        {
            let body = Ticks::emit(ticks.seq.wrapping_sub(offset), channels, ticks.commands());
            // Leading delimiters end a broken frame.
            let mut bytes: Vec<u8> = bytes.iter().copied().take_while(|&byte| byte == 0).collect();
            bytes.extend(emit(address, kind, &body));
            renumbered = Some(bytes);
        }
    }
    renumbered.unwrap_or_else(|| bytes.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Experiment, framed_host::Conversation};

    const FRAMED: &str = r#"{ "line": { "protocol": "framed" } }"#;

    /// Streams the default motion to a device that another session is, whose replies `spoil` changes, and gives the differences to
    /// its twin. `before` is streamed to it so often before.
    fn differences(before: usize, mut spoil: impl FnMut(usize, &mut Reply)) -> Vec<String> {
        let scenario = Scenario::from_json(FRAMED).expect("reads");
        let experiment = Experiment::new(&scenario).expect("no problems");
        let mut device = Session::new(&scenario).expect("no problems");
        run_until_idle(&mut device);
        let mut found = Vec::new();
        for stream in 0..=before {
            let mut host = experiment.conversation(device.now()).expect("it is confirmed");
            let mut twin = Twin::new(&scenario).expect("no problems");
            let (mut number, mut deframer) = (0, Deframer::default());
            while !host.is_over() {
                let now = host.deadline();
                device.advance::<Digest>(now, &mut []);
                let Some(bytes) = host.poll(now) else { continue };
                let channels = experiment.config().channels();
                let known = *host.known().next().expect("one job").1;
                twin.send(&bytes, now, (channels, &known));
                device.receive(&bytes);
                let takes = line_time(bytes.len() as u64, experiment.config().clock_hz(), experiment.baud());
                host.sent(now + Cycles(takes));
                deliver(&mut host, &mut device, &mut deframer, |host, mut reported| {
                    let model = twin.answer().expect("the model answers");
                    if stream == before {
                        spoil(number, &mut reported.reply);
                        number += 1;
                        let known = *host.known().next().expect("one job").1;
                        assert_eq!(model.delay, reported.delay, "reply {number}");
                        found.extend(twin.difference(0, (&reported, &known), &model));
                    }
                });
            }
            assert_eq!(host.progress().next(), Some(crate::hosts::framed_host::Progress::Done));
            let (status, done, went) = twin.end(0).expect("there is one");
            // The opening tick is one more.
            assert_eq!((status.state, done, went), (State::Ready, 201, vec![3200]));
        }
        found
    }

    /// Receives the reply of a device to its last frame.
    fn deliver(
        host: &mut Conversation,
        device: &mut Session,
        deframer: &mut Deframer,
        mut reported: impl FnMut(&Conversation, Answer),
    ) {
        let sent_end = device.now().next();
        while device.is_busy() {
            device.advance::<Digest>(device.deadline(), &mut []);
            let replies: Vec<ReplyByte> = device.take_replies().collect();
            for ReplyByte { end, byte, .. } in replies {
                host.receive(byte, end);
                if let Some(Deframed::Frame(frame)) = deframer.byte(byte) {
                    let reply = Reply::parse(frame).expect("a reply");
                    let frame_bytes =
                        device.run().schedule().iter().last().map_or(0, |send| send.bytes.len());
                    let experiment = device.experiment();
                    let clock_hz = experiment.config().clock_hz();
                    let takes = line_time(frame_bytes as u64, clock_hz, experiment.baud());
                    let delay = Cycles(end.0 - sent_end.0 - takes);
                    reported(host, Answer { reply, positions: frame.positions(), delay });
                }
            }
        }
    }

    #[test]
    fn a_device_that_equals_the_model_has_no_differences_even_if_it_ran_before() {
        for before in [0, 1, 2] {
            assert_eq!(differences(before, |_, _| {}), Vec::<String>::new(), "{before}");
        }
    }

    #[test]
    fn each_difference_is_described() {
        type Spoil = fn(&mut Reply);
        let rows: [(usize, Spoil, &str); 5] = [
            (
                5,
                |reply| reply.result = Err(stepscope_peripheral::protocol::Reason::Busy),
                "NAK BUSY, the model ACK TICKS",
            ),
            (6, |reply| reply.status.state = State::Stopped, "it is STOPPED, the model MOVING"),
            (7, |reply| reply.status.expected_seq = 9, "it has accepted 9 frames of ticks"),
            (8, |reply| reply.status.faults |= 1, "its new faults are"),
            (
                29,
                |reply| reply.status.ticks_done -= 1,
                "it has done 200 ticks since the start, the model 201",
            ),
        ];
        for (at, change, expected) in rows {
            let found = differences(0, |number, reply| {
                if number == at {
                    change(reply);
                }
            });
            assert_eq!(found.len(), 1, "{expected}: {found:?}");
            assert!(found[0].contains(expected), "{found:?}");
        }
    }

    #[test]
    fn the_model_replies_as_a_device() {
        use crate::{Experiment, twin::Twin};
        use stepscope_peripheral::units::Instant;
        use stepscope_scenario::Scenario;

        let scenario = Scenario::from_json(r#"{ "line": { "protocol": "framed" } }"#).expect("reads");
        let experiment = Experiment::new(&scenario).expect("it has no problems");
        let mut host = experiment.conversation(Instant::RESET).expect("a framed host waits for replies");
        let mut twin = Twin::new(&scenario).expect("it has no problems");

        let now = host.deadline();
        let opening = host.poll(now).expect("it requests the status");
        let known = *host.known().next().expect("there is one controller").1;
        twin.send(&opening, now, (experiment.config().channels(), &known));
        assert!(twin.answer().is_some_and(|answer| answer.reply.result.is_ok()));
    }
}
