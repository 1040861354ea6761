//! The host of a real device (LIVE H3, H4), compared with the model.

use super::{SCRIPT, SEGMENTS, listed, nanos, read};
use crate::convert::object;
use serde::Serialize;
use std::mem::take;
use stepscope_core::{
    peripheral::{
        protocol::{Kind, Status},
        units::{Cycles, Instant},
        wire::{
            frame::{Deframed, Deframer, Reply},
            schedule::line_time,
        },
    },
    scenario::Host,
    sim::{
        Experiment,
        framed_host::{Conversation, HostStatus, Job, Known, Progress, Report, for_real_line},
        session::{Pace, SessionClock},
        twin::{Answer, Twin},
    },
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Exchange {
    /// Time of the reply or of the timeout.
    at_ms: f64,
    controller: usize,
    kind: &'static str,
    /// The reply; null after a timeout.
    reply: Option<String>,
    state: Option<&'static str>,
    ticks_done: Option<u32>,
    /// From the end of the frame to the end of the reply.
    delay_ms: Option<f64>,
    model_ms: Option<f64>,
    difference: Option<String>,
}

#[derive(Serialize)]
struct State {
    text: String,
    accepted: u64,
    done: u64,
    ticks: u64,
    repeats: u64,
    naks: u64,
}

#[derive(Serialize)]
struct End {
    state: &'static str,
    ticks_done: Option<u32>,
    /// Since opening; null if unknown.
    went: Option<Vec<i32>>,
}

#[derive(Serialize)]
struct EndPair {
    controller: usize,
    address: u8,
    ticks: u32,
    device: Option<End>,
    model: Option<End>,
}

#[derive(Serialize)]
struct FinalReport {
    text: String,
    verified: bool,
    why: Option<String>,
    stop_acknowledged: bool,
    ends: Vec<EndPair>,
    difference: Option<String>,
}

/// The frame that waits for its reply.
struct PendingFrame {
    controller: usize,
    job: usize,
    kind: Kind,
    /// Its time on the line, and its end.
    takes: Cycles,
    end: Instant,
}

/// The host of a real device.
#[wasm_bindgen]
pub struct LiveHost {
    experiment: Experiment,
    host: Conversation,
    settings: Host,
    clock: SessionClock,
    twin: Twin,
    deframer: Deframer,
    pending: Option<PendingFrame>,
    rows: Vec<Exchange>,
    exchanges: u64,
    difference: Option<String>,
    stopped: bool,
}

#[wasm_bindgen]
impl LiveHost {
    /// The host of a scenario. Replies may be `slack_ms` late.
    /// Errors: if the scenario has problems, or a device cannot confirm it.
    #[wasm_bindgen(constructor)]
    pub fn new(json: &str, slack_ms: f64) -> Result<LiveHost, JsError> {
        let scenario = for_real_line(read(json)?);
        let experiment = Experiment::new(&scenario).map_err(|problems| listed(&problems))?;
        if experiment.segments().is_some() {
            return Err(JsError::new(SEGMENTS));
        }
        let clock_hz = experiment.config().clock_hz();
        let clock = SessionClock::new(clock_hz, Pace::REAL_TIME, u64::MAX);
        let Some(host) = experiment.conversation(Instant(1)) else {
            return Err(JsError::new(SCRIPT));
        };
        let slack = Cycles((slack_ms.max(0.0) / 1000.0 * f64::from(clock_hz)) as u64);
        let twin = Twin::new(&scenario).map_err(|problems| listed(&problems))?;
        Ok(Self {
            host: host.with_slack(slack),
            settings: scenario.line.host,
            experiment,
            clock,
            twin,
            deframer: Deframer::default(),
            pending: None,
            rows: Vec::new(),
            exchanges: 0,
            difference: None,
            stopped: false,
        })
    }

    /// Bit rate.
    pub fn baud(&self) -> u32 {
        self.experiment.baud()
    }

    /// Maximum delay of the host before a filled queue is empty, in ms.
    pub fn margin_ms(&self) -> f64 {
        let margin = |job: &Job| {
            let left = job.queue_depth.saturating_sub(job.ticks_per_frame(&self.settings));
            self.millis(Cycles(u64::from(left) * job.tick.0))
        };
        self.host.known().map(|(job, _)| margin(job)).fold(f64::INFINITY, f64::min)
    }

    /// Whether it has ended.
    pub fn is_over(&self) -> bool {
        self.host.is_over()
    }

    /// The frame to write now, if any.
    pub fn poll(&mut self, ms: f64) -> Option<Vec<u8>> {
        let now = self.now(ms);
        while self.host.deadline() <= now {
            if self.host.is_waiting() {
                self.timed_out(ms);
            }
            let Some(bytes) = self.host.poll(now) else { continue };
            if let Some((job, kind)) = self.host.pending_frame() {
                let mut controllers = 0..self.experiment.controllers();
                let controller =
                    controllers.find(|&index| self.experiment.job_index(index) == Some(job)).unwrap_or(0);
                if let Some((job, known)) = self.host.known().nth(job) {
                    self.twin.send(&bytes, now, (job.channels, known));
                }
                let clock_hz = self.experiment.config().clock_hz();
                let takes = line_time(bytes.len() as u64, clock_hz, self.experiment.baud());
                self.pending = Some(PendingFrame { controller, job, kind, takes: Cycles(takes), end: now });
            }
            self.deframer = Deframer::default();
            return Some(bytes);
        }
        None
    }

    /// The system has accepted the whole frame.
    pub fn sent(&mut self, ms: f64) {
        if self.host.is_waiting() {
            return;
        }
        let now = self.now(ms);
        if let Some(PendingFrame { takes, end, .. }) = &mut self.pending {
            *end = now + *takes;
            self.host.sent(*end);
        }
    }

    /// Receives bytes.
    pub fn receive(&mut self, bytes: &[u8], ms: f64) {
        let now = self.now(ms);
        // A reply implies that the frame was sent, even if the system reports that later.
        self.sent(ms);
        for &byte in bytes {
            let frame = match self.deframer.byte(byte) {
                Some(Deframed::Frame(frame)) => Reply::parse(frame).map(|reply| (reply, frame.positions())),
                _ => None,
            };
            self.host.receive(byte, now);
            if let Some((reply, positions)) = frame {
                // Otherwise the reply belongs to an earlier frame.
                if !self.host.is_waiting()
                    && let Some(pending) = self.pending.take()
                {
                    let delay = Cycles(now.0.saturating_sub(pending.end.0));
                    self.replied(&pending, &Answer { reply, positions, delay }, ms);
                }
            }
        }
    }

    /// Time until the next event without received bytes, in ms.
    pub fn wait(&mut self, ms: f64) -> f64 {
        let due = self.host.deadline();
        if due == Instant::NEVER {
            return f64::INFINITY;
        }
        let now = self.now(ms);
        self.clock.nanos(Cycles(due.0.saturating_sub(now.0))) as f64 / 1e6
    }

    /// Ends the current frame, then sends STOP until it is acknowledged.
    pub fn stop(&mut self, ms: f64) {
        let now = self.now(ms);
        self.stopped = true;
        self.host.stop(now);
    }

    /// Progress (`State`).
    pub fn state(&self) -> Result<JsValue, JsError> {
        let standing = HostStatus::new(&self.host);
        object(&State {
            text: standing.to_string(),
            accepted: standing.accepted,
            done: standing.done,
            ticks: standing.ticks,
            repeats: standing.counts.repeated,
            naks: standing.counts.refused,
        })
    }

    /// New exchanges (`Exchange`).
    pub fn rows(&mut self) -> Result<JsValue, JsError> {
        object(&take(&mut self.rows))
    }

    /// The report (`FinalReport`). `lost`: why the port is lost.
    pub fn report(&mut self, lost: Option<String>) -> Result<JsValue, JsError> {
        let report = Report::new(&self.experiment, &mut self.host, self.stopped);
        let ends = report.rows.iter().map(|row| {
            let Known { opening, started, last, positions, opening_positions, .. } = row.known;
            let count = |status: Option<Status>| status.map_or(0, |status| status.ticks_done);
            // The model also has the opening ticks.
            let opening_ticks = started.map_or(0, |_| count(started).wrapping_sub(count(opening)));
            let device = last.map(|last| End {
                state: last.state.name(),
                ticks_done: row.known.ticks_done(),
                went: opening_positions.zip(positions).map(|(began, now)| {
                    let pairs = now.as_slice().iter().zip(began.as_slice());
                    pairs.map(|(now, began)| now.wrapping_sub(*began)).collect()
                }),
            });
            let model = opening.and(self.twin.end(row.controller)).map(|(status, done, went)| End {
                state: status.state.name(),
                ticks_done: Some(done.wrapping_sub(opening_ticks)),
                went: Some(went),
            });
            EndPair { controller: row.controller, address: row.address, ticks: row.ticks, device, model }
        });
        let ends: Vec<EndPair> = ends.collect();
        let why = lost.or_else(|| report.doubt());
        object(&FinalReport {
            verified: why.is_none(),
            why,
            stop_acknowledged: self.stopped
                && report.rows.iter().all(|row| row.known.stop_acknowledged || is_done(row.progress)),
            ends,
            difference: self.difference.clone(),
            text: report.to_string(),
        })
    }
}

fn is_done(progress: Progress) -> bool {
    matches!(progress, Progress::Done | Progress::Counted)
}

impl LiveHost {
    fn now(&mut self, ms: f64) -> Instant {
        self.clock.target(nanos(ms), Instant::RESET)
    }

    fn millis(&self, cycles: Cycles) -> f64 {
        self.clock.nanos(cycles) as f64 / 1e6
    }

    fn replied(&mut self, pending: &PendingFrame, reply: &Answer, ms: f64) {
        self.exchanges += 1;
        let &PendingFrame { controller, job, kind, .. } = pending;
        let model = self.twin.answer();
        let known = self.host.known().nth(job).map(|(_, known)| *known).unwrap_or_default();
        let difference = match &model {
            Some(model) => self.twin.difference(controller, (reply, &known), model),
            None => Some("the model does not reply".to_owned()),
        };
        let Status { state, ticks_done, .. } = reply.reply.status;
        let row = Exchange {
            at_ms: ms,
            controller,
            kind: kind.name(),
            reply: Some(reply.reply.to_string()),
            state: Some(state.name()),
            ticks_done: Some(ticks_done),
            delay_ms: Some(self.millis(reply.delay)),
            model_ms: model.map(|model| self.millis(model.delay)),
            difference,
        };
        if let (None, Some(difference)) = (&self.difference, &row.difference) {
            let Exchange { at_ms, kind, .. } = row;
            let number = self.exchanges;
            self.difference = Some(format!(
                "reply {number}, to {kind} of controller {controller} at {:.3} s: {difference}",
                at_ms / 1000.0
            ));
        }
        self.rows.push(row);
    }

    fn timed_out(&mut self, ms: f64) {
        let Some(PendingFrame { controller, kind, .. }) = self.pending.take() else { return };
        self.rows.push(Exchange {
            at_ms: ms,
            controller,
            kind: kind.name(),
            reply: None,
            state: None,
            ticks_done: None,
            delay_ms: None,
            model_ms: None,
            difference: None,
        });
    }
}
