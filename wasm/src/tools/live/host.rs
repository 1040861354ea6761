//! The host of a real device (LIVE H3, H4): a conversation against the wall clock, with the model beside it.

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
        framed_host::{Conversation, Job, Known, Progress, Report, Standing, for_real_line},
        session::{Pace, SessionClock},
        twin::{Answer, Twin},
    },
};
use wasm_bindgen::prelude::*;

/// One exchange, as a row of the page.
#[derive(Serialize)]
struct Exchange {
    /// When its reply was heard, or when none came.
    at_ms: f64,
    controller: usize,
    kind: &'static str,
    /// What the reply says; null where none came.
    reply: Option<String>,
    state: Option<&'static str>,
    ticks_done: Option<u32>,
    /// From the end of the frame to that of the reply: the device's, and the model's.
    delay_ms: Option<f64>,
    model_ms: Option<f64>,
    /// What is not as the model's.
    difference: Option<String>,
}

/// How far it is.
#[derive(Serialize)]
struct State {
    text: String,
    accepted: u64,
    done: u64,
    ticks: u64,
    repeats: u64,
    naks: u64,
}

/// What one of both has come to.
#[derive(Serialize)]
struct End {
    state: &'static str,
    /// Since it was opened.
    ticks_done: Option<u32>,
    /// Since it was opened; null where they are not told.
    went: Option<Vec<i32>>,
}

/// A device's end beside the model's.
#[derive(Serialize)]
struct Beside {
    controller: usize,
    address: u8,
    ticks: u32,
    device: Option<End>,
    model: Option<End>,
}

/// What is known at the end.
#[derive(Serialize)]
struct Told {
    text: String,
    verified: bool,
    /// Why it is not known that all was done.
    why: Option<String>,
    stop_acknowledged: bool,
    beside: Vec<Beside>,
    /// The first that was not as the model's.
    difference: Option<String>,
}

/// The frame that is on its way or waits for its reply.
struct UnderWay {
    controller: usize,
    job: usize,
    kind: Kind,
    /// How long it takes on the line, and when it has left.
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
    under_way: Option<UnderWay>,
    rows: Vec<Exchange>,
    exchanges: u64,
    difference: Option<String>,
    stopped: bool,
}

#[wasm_bindgen]
impl LiveHost {
    /// The host of a scenario's ticks, whose replies may come so much later than on the line.
    ///
    /// # Errors
    /// If the scenario has problems, or gives nothing that a device could confirm: with what to change.
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
            under_way: None,
            rows: Vec::new(),
            exchanges: 0,
            difference: None,
            stopped: false,
        })
    }

    /// The line's rate.
    #[must_use]
    pub fn baud(&self) -> u32 {
        self.experiment.baud()
    }

    /// How late the host may be before a queue that was filled runs dry, in ms: a frame's ticks are sent as soon as they find a
    /// place.
    #[must_use]
    pub fn margin_ms(&self) -> f64 {
        let margin = |job: &Job| {
            let left = job.queue_depth.saturating_sub(job.ticks_per_frame(&self.settings));
            self.millis(Cycles(u64::from(left) * job.tick.0))
        };
        self.host.known().map(|(job, _)| margin(job)).fold(f64::INFINITY, f64::min)
    }

    /// Whether it has nothing more to say.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.host.is_over()
    }

    /// The frame that is to be written now, if one is due.
    pub fn poll(&mut self, ms: f64) -> Option<Vec<u8>> {
        let now = self.now(ms);
        while self.host.deadline() <= now {
            if self.host.is_waiting() {
                self.unanswered(ms);
            }
            let Some(bytes) = self.host.poll(now) else { continue };
            if let Some((job, kind)) = self.host.under_way() {
                let mut controllers = 0..self.experiment.controllers();
                let controller =
                    controllers.find(|&index| self.experiment.job(index) == Some(job)).unwrap_or(0);
                if let Some((told, known)) = self.host.known().nth(job) {
                    self.twin.send(&bytes, now, (told.channels, known));
                }
                let clock_hz = self.experiment.config().clock_hz();
                let takes = line_time(bytes.len() as u64, clock_hz, self.experiment.baud());
                self.under_way = Some(UnderWay { controller, job, kind, takes: Cycles(takes), end: now });
            }
            self.deframer = Deframer::default();
            return Some(bytes);
        }
        None
    }

    /// The frame was written: the system took the last of it now.
    pub fn sent(&mut self, ms: f64) {
        if self.host.is_waiting() {
            return;
        }
        let now = self.now(ms);
        if let Some(UnderWay { takes, end, .. }) = &mut self.under_way {
            *end = now + *takes;
            self.host.sent(*end);
        }
    }

    /// Bytes that were read.
    pub fn hear(&mut self, bytes: &[u8], ms: f64) {
        let now = self.now(ms);
        // Nobody answers before the frame has left, though the system may tell that later.
        self.sent(ms);
        for &byte in bytes {
            let frame = match self.deframer.byte(byte) {
                Some(Deframed::Frame(frame)) => Reply::parse(frame).map(|reply| (reply, frame.positions())),
                _ => None,
            };
            self.host.hear(byte, now);
            if let Some((reply, positions)) = frame {
                // A reply that the host did not take is that of an earlier frame.
                if !self.host.is_waiting()
                    && let Some(under_way) = self.under_way.take()
                {
                    let delay = Cycles(now.0.saturating_sub(under_way.end.0));
                    self.answered(&under_way, &Answer { reply, positions, delay }, ms);
                }
            }
        }
    }

    /// How long nothing is due, in ms, if nothing is heard; infinite while a frame is written and when it is over.
    #[must_use]
    pub fn wait(&mut self, ms: f64) -> f64 {
        let due = self.host.deadline();
        if due == Instant::NEVER {
            return f64::INFINITY;
        }
        let now = self.now(ms);
        self.clock.nanos(Cycles(due.0.saturating_sub(now.0))) as f64 / 1e6
    }

    /// No further ticks: what is under way ends, then STOP until it is acknowledged.
    pub fn stop(&mut self, ms: f64) {
        let now = self.now(ms);
        self.stopped = true;
        self.host.stop(now);
    }

    /// How far it is: `{text, accepted, done, ticks, repeats, naks}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn state(&self) -> Result<JsValue, JsError> {
        let standing = Standing::new(&self.host);
        object(&State {
            text: standing.to_string(),
            accepted: standing.accepted,
            done: standing.done,
            ticks: standing.ticks,
            repeats: standing.counts.repeated,
            naks: standing.counts.refused,
        })
    }

    /// The exchanges since this was asked last: `[{at_ms, controller, kind, reply, state, ticks_done, delay_ms, model_ms,
    /// difference}]`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn rows(&mut self) -> Result<JsValue, JsError> {
        object(&take(&mut self.rows))
    }

    /// What is known now: `{text, verified, why, stop_acknowledged, beside, difference}`. `lost`: why the port is lost.
    ///
    /// # Errors
    /// Never in practice.
    pub fn report(&mut self, lost: Option<String>) -> Result<JsValue, JsError> {
        let report = Report::new(&self.experiment, &mut self.host, self.stopped);
        let beside = report.rows.iter().map(|row| {
            let Known { opened, started, last, positions, opened_at, .. } = row.known;
            let count = |status: Option<Status>| status.map_or(0, |status| status.ticks_done);
            // The model did the opening ticks, too.
            let opening_ticks = started.map_or(0, |_| count(started).wrapping_sub(count(opened)));
            let device = last.map(|last| End {
                state: last.state.name(),
                ticks_done: row.known.ticks_done(),
                went: opened_at.zip(positions).map(|(began, now)| {
                    let pairs = now.as_slice().iter().zip(began.as_slice());
                    pairs.map(|(now, began)| now.wrapping_sub(*began)).collect()
                }),
            });
            let model = opened.and(self.twin.end(row.controller)).map(|(status, done, went)| End {
                state: status.state.name(),
                ticks_done: Some(done.wrapping_sub(opening_ticks)),
                went: Some(went),
            });
            Beside { controller: row.controller, address: row.address, ticks: row.ticks, device, model }
        });
        let beside: Vec<Beside> = beside.collect();
        let why = lost.or_else(|| report.doubt());
        object(&Told {
            verified: why.is_none(),
            why,
            stop_acknowledged: self.stopped
                && report.rows.iter().all(|row| row.known.stop_acknowledged || is_done(row.progress)),
            beside,
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

    fn answered(&mut self, under_way: &UnderWay, told: &Answer, ms: f64) {
        self.exchanges += 1;
        let &UnderWay { controller, job, kind, .. } = under_way;
        let model = self.twin.answer();
        let known = self.host.known().nth(job).map(|(_, known)| *known).unwrap_or_default();
        let difference = match &model {
            Some(model) => self.twin.difference(controller, (told, &known), model),
            None => Some("the model does not answer".to_owned()),
        };
        let Status { state, ticks_done, .. } = told.reply.status;
        let row = Exchange {
            at_ms: ms,
            controller,
            kind: kind.name(),
            reply: Some(told.reply.to_string()),
            state: Some(state.name()),
            ticks_done: Some(ticks_done),
            delay_ms: Some(self.millis(told.delay)),
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

    /// The time for a reply is over.
    fn unanswered(&mut self, ms: f64) {
        let Some(UnderWay { controller, kind, .. }) = self.under_way.take() else { return };
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
