//! The host of a raw line (LIVE H3, H4): packets go at their times, with a lead, and nobody answers.

use super::{SCRIPT, SEGMENTS, listed, nanos, read};
use crate::convert::object;
use serde::Serialize;
use stepscope_core::{
    scenario::Source,
    sim::{
        Experiment,
        framed_host::for_real_line,
        raw_host::{RawHost, RawReport},
    },
};
use wasm_bindgen::prelude::*;

/// A page is sometimes late: less ahead would be a demonstration (LIVE H3).
const LEAD_NS: u64 = 200_000_000;

/// How far it is.
#[derive(Serialize)]
struct State {
    text: String,
    done: usize,
    ticks: usize,
    lead: u8,
    lead_ms: f64,
}

/// What is known at the end: that nothing is verified.
#[derive(Serialize)]
struct Told {
    text: String,
    sent: usize,
    packets: usize,
    stood: u64,
    /// How long the device has something to do, by the model of its queue.
    left_ms: f64,
}

/// The host of a raw line.
#[wasm_bindgen]
pub struct LiveRawHost {
    baud: u32,
    host: RawHost,
}

#[wasm_bindgen]
impl LiveRawHost {
    /// The host of a scenario's packets, sent 200 ms ahead.
    ///
    /// # Errors
    /// If the scenario has problems, has no ticks, or a queue that does not hold the lead: with what to change.
    #[wasm_bindgen(constructor)]
    pub fn new(json: &str) -> Result<LiveRawHost, JsError> {
        let scenario = for_real_line(read(json)?);
        if matches!(scenario.source, Source::Line(_)) {
            return Err(JsError::new(SCRIPT));
        }
        let experiment = Experiment::new(&scenario).map_err(|problems| listed(&problems))?;
        if experiment.segments().is_some() {
            return Err(JsError::new(SEGMENTS));
        }
        let host = RawHost::with_slack(&experiment, LEAD_NS).map_err(|why| {
            JsError::new(&format!(
                "{why}; or choose the framed protocol in the form, whose replies keep the queue filled"
            ))
        })?;
        Ok(Self { baud: experiment.baud(), host })
    }

    /// The line's rate.
    #[must_use]
    pub fn baud(&self) -> u32 {
        self.baud
    }

    /// How late the page may be before the queue runs dry, in ms.
    #[must_use]
    pub fn margin_ms(&self) -> f64 {
        self.host.slack_ns() as f64 / 1e6
    }

    /// Whether all is sent.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.host.due_ns().is_none()
    }

    /// The packet that is to be written now, if one is due.
    #[must_use]
    pub fn packet(&self, ms: f64) -> Option<Vec<u8>> {
        self.host.packet(nanos(ms)).map(<[u8]>::to_vec)
    }

    /// It was given to the port at a time.
    pub fn written(&mut self, ms: f64) {
        self.host.written(nanos(ms));
    }

    /// How long nothing is due, in ms; infinite when all is sent.
    #[must_use]
    pub fn wait(&self, ms: f64) -> f64 {
        self.host.due_ns().map_or(f64::INFINITY, |due| due.saturating_sub(nanos(ms)) as f64 / 1e6)
    }

    /// How far it is: `{text, done, ticks, lead, lead_ms}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn state(&self) -> Result<JsValue, JsError> {
        let report = self.host.report(false);
        object(&State {
            text: report.standing(),
            done: report.sent,
            ticks: report.packets,
            lead: self.host.lead(),
            lead_ms: self.margin_ms(),
        })
    }

    /// What is known now: `{text, sent, packets, stood, left_ms}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn report(&self, stopped: bool, ms: f64) -> Result<JsValue, JsError> {
        let report = self.host.report(stopped);
        let RawReport { sent, packets, stood_count, .. } = report;
        object(&Told {
            text: report.to_string(),
            sent,
            packets,
            stood: stood_count,
            left_ms: self.host.left_ns(nanos(ms)) as f64 / 1e6,
        })
    }
}
