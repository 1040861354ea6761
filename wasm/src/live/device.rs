//! The device of a real host (LIVE H1, H4, H5): a session in real time and its recording.

use super::{listed, nanos, read};
use crate::convert::object;
use serde::Serialize;
use stepscope_core::peripheral::units::{Cycles, Instant};
use stepscope_core::sim::session::{Input, Pace, Session, SessionClock};
use stepscope_core::sim::{live_trace::LiveTrace, session_times::SessionTimes};
use wasm_bindgen::prelude::*;

/// Maximum cycles, and therefore records, per round.
const MAX_ROUND: u64 = 1_000_000;
/// Rounds that received bytes are ahead of the model, so that it wakes once per frame and not per byte.
const ROUNDS_AHEAD: u64 = 10;
/// Maximum records of the live traces of all controllers.
const MAX_RECORDS: usize = 1_000_000;
/// Length, points and maximum number of position curves.
const CURVE_SECONDS: u64 = 10;
const CURVE_POINTS: usize = 120;
const CURVES: usize = 4;

#[derive(Serialize)]
struct ControllerState {
    state: Option<&'static str>,
    queued: Option<u8>,
    queue_depth: u8,
    positions: Vec<i32>,
    faults: Vec<String>,
    ticks_done: u32,
    /// Positions of each channel; empty with many controllers.
    curves: Vec<Vec<i32>>,
}

#[derive(Serialize)]
struct SessionState {
    seconds: f64,
    curves_from: f64,
    received: u64,
    replies: u64,
    /// Maximum delay of a reply.
    max_delay_ms: f64,
    set_backs: u64,
    set_back_ms: f64,
    records_all: bool,
    controllers: Vec<ControllerState>,
}

#[derive(Serialize)]
struct Recorded {
    scenario: String,
    digests: Vec<String>,
    /// Why it does not reproduce the digests; null if it does.
    why: Option<String>,
    whole: bool,
}

/// The device of a real host.
#[wasm_bindgen]
pub struct LiveDevice {
    session: Session,
    /// Bytes that wait for the line.
    input: Input,
    clock: SessionClock,
    traces: Vec<LiveTrace>,
    times: SessionTimes,
    reply_count: u64,
    max_delay_ns: u64,
}

#[wasm_bindgen]
impl LiveDevice {
    /// The controllers of a scenario. Above a lag of `lag_ms` the clock is set back. `unix_ms` is the start.
    /// Errors: if the scenario has problems, or its controllers have no line.
    #[wasm_bindgen(constructor)]
    pub fn new(json: &str, lag_ms: u32, unix_ms: f64) -> Result<LiveDevice, JsError> {
        let session = Session::new(&read(json)?).map_err(|problems| listed(&problems))?;
        let clock_hz = session.experiment().config().clock_hz();
        let pace = Pace::REAL_TIME;
        let clock = SessionClock::new(clock_hz, pace, nanos(lag_ms.into()));
        let controllers = session.experiment().controllers();
        Ok(Self {
            traces: vec![LiveTrace::new(MAX_RECORDS / controllers.max(1)); controllers],
            times: SessionTimes::new(unix_ms as u64, pace.to_string(), lag_ms.into(), true),
            session,
            input: Input::default(),
            clock,
            reply_count: 0,
            max_delay_ns: 0,
        })
    }

    /// Bit rate.
    pub fn baud(&self) -> u32 {
        self.session.experiment().baud()
    }

    /// Runs the model for at most 1 ms, `elapsed_ms` after the start. Returns whether it is still behind.
    pub fn round(&mut self, elapsed_ms: f64) -> bool {
        let now = self.session.now();
        let clock_hz = u64::from(self.session.experiment().config().clock_hz());
        let target = self.clock.target(nanos(elapsed_ms), now);
        let step = (clock_hz / 1000).clamp(1, MAX_ROUND);
        let to = target.min(Instant(now.0 + step));
        self.input.feed(&mut self.session, to + Cycles(ROUNDS_AHEAD * step));
        if to > now {
            self.session.advance(to, &mut self.traces);
        }
        to < target
    }

    /// Reply bytes up to now.
    pub fn replies(&mut self, elapsed_ms: f64) -> Vec<u8> {
        let Self { session, clock, times, reply_count, max_delay_ns, .. } = self;
        let mut bytes = Vec::new();
        for reply in session.take_replies() {
            bytes.push(reply.byte);
            // A reply ends with its delimiter.
            if reply.byte == 0 {
                *reply_count += 1;
                let late = clock.late_ns(nanos(elapsed_ms), reply.end);
                *max_delay_ns = (*max_delay_ns).max(late);
                times.reply(&reply, nanos(elapsed_ms), late);
            }
        }
        bytes
    }

    /// Receives bytes; returns how many were accepted. The others must wait, as on a line.
    pub fn receive(&mut self, bytes: &[u8], elapsed_ms: f64) -> usize {
        let count = self.input.push(bytes);
        if count > 0 {
            self.times.chunk(nanos(elapsed_ms), self.session.now(), count);
        }
        count
    }

    /// Time until the next event without received bytes, in ms.
    pub fn wait(&self) -> f64 {
        let due = self.session.deadline();
        let cycles = Cycles(due.0.saturating_sub(self.session.now().0));
        if due == Instant::NEVER { f64::INFINITY } else { self.clock.nanos(cycles) as f64 / 1e6 }
    }

    /// Its state (`SessionState`).
    pub fn state(&self) -> Result<JsValue, JsError> {
        let Self { session, clock, traces, reply_count, max_delay_ns, .. } = self;
        let experiment = session.experiment();
        let clock_hz = experiment.config().clock_hz().max(1);
        let to = session.now();
        let mut from = Instant(to.0.saturating_sub(CURVE_SECONDS * u64::from(clock_hz)));
        let drawn = Some(&traces[..]).filter(|all| all.len() <= CURVES).unwrap_or_default();
        // All curves have the same start.
        for trace in drawn {
            from = from.max(trace.positions(&[], (from, to), 0).from);
        }
        let devices = session.run().devices().zip(experiment.configs()).enumerate();
        let controllers = devices.map(|(index, (device, config))| {
            let status = device.status();
            let positions = device.positions();
            let curve = |trace: &LiveTrace| trace.positions(positions, (from, to), CURVE_POINTS).channels;
            let queued = |free: u8| config.queue_depth() - free.min(config.queue_depth());
            ControllerState {
                state: status.map(|status| status.state.name()),
                queued: status.map(|status| queued(status.free)),
                queue_depth: config.queue_depth(),
                curves: drawn.get(index).map(curve).unwrap_or_default(),
                positions: positions.to_vec(),
                faults: device.faults().names().map(|name| name.to_string()).collect(),
                ticks_done: device.ticks_done(),
            }
        });
        let setbacks = clock.setbacks();
        object(&SessionState {
            seconds: to.0 as f64 / f64::from(clock_hz),
            curves_from: from.0 as f64 / f64::from(clock_hz),
            received: session.received(),
            replies: *reply_count,
            max_delay_ms: *max_delay_ns as f64 / 1e6,
            set_backs: setbacks.count,
            set_back_ms: clock.nanos(setbacks.cycles) as f64 / 1e6,
            records_all: session.records_all(),
            controllers: controllers.collect(),
        })
    }

    /// The content of `NAME.session.json`.
    pub fn times(&self) -> String {
        let Self { session, clock, times, .. } = self;
        times.to_json(clock, &session.recording(), session.records_all())
    }

    /// The session as a scenario, repeated and compared (`Recorded`).
    pub fn verified_recording(&self) -> Result<JsValue, JsError> {
        let recording = self.session.recording();
        object(&Recorded {
            why: recording.verify().err().map(|why| why.to_string()),
            scenario: recording.scenario.to_json(),
            digests: recording.digests.iter().map(|digest| format!("{digest:016x}")).collect(),
            whole: self.session.records_all(),
        })
    }
}
