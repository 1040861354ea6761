//! The host of a raw line (LIVE H3, H4): packets are sent ahead of time, without replies.

use super::{SCRIPT, SEGMENTS, listed, nanos, read};
use crate::convert::object;
use serde::Serialize;
use stepscope_core::scenario::Source;
use stepscope_core::sim::raw_host::{RawHost, RawReport};
use stepscope_core::sim::{Experiment, framed_host::for_real_line};
use wasm_bindgen::prelude::*;

/// Covers the delays of a page (LIVE H3).
const LEAD_NS: u64 = 200_000_000;

#[derive(Serialize)]
struct State {
    text: String,
    done: usize,
    ticks: usize,
    lead: u8,
    lead_ms: f64,
}

/// The final report; nothing is verified.
#[derive(Serialize)]
struct FinalReport {
    text: String,
    sent: usize,
    packets: usize,
    stood: u64,
    /// Remaining time of the queue.
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
    /// Errors: if the scenario has problems, no ticks, or a queue that is too short for the lead.
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
                "{why}; or choose the framed protocol in the form, which keeps the queue filled"
            ))
        })?;
        Ok(Self { baud: experiment.baud(), host })
    }

    /// Bit rate.
    pub fn baud(&self) -> u32 {
        self.baud
    }

    /// Maximum delay of the page before the queue is empty, in ms.
    pub fn margin_ms(&self) -> f64 {
        self.host.slack_ns() as f64 / 1e6
    }

    /// Whether everything is sent.
    pub fn is_over(&self) -> bool {
        self.host.due_ns().is_none()
    }

    /// The packet to write now, if any.
    pub fn packet(&self, ms: f64) -> Option<Vec<u8>> {
        self.host.packet(nanos(ms)).map(<[u8]>::to_vec)
    }

    /// The packet was written.
    pub fn written(&mut self, ms: f64) {
        self.host.written(nanos(ms));
    }

    /// Time until the next packet, in ms.
    pub fn wait(&self, ms: f64) -> f64 {
        self.host.due_ns().map_or(f64::INFINITY, |due| due.saturating_sub(nanos(ms)) as f64 / 1e6)
    }

    /// Progress (`State`).
    pub fn state(&self) -> Result<JsValue, JsError> {
        let report = self.host.report(false);
        object(&State {
            text: report.status(),
            done: report.sent,
            ticks: report.packets,
            lead: self.host.lead(),
            lead_ms: self.margin_ms(),
        })
    }

    /// The report (`FinalReport`).
    pub fn report(&self, stopped: bool, ms: f64) -> Result<JsValue, JsError> {
        let report = self.host.report(stopped);
        let RawReport { sent, packets, standstill_count, .. } = report;
        object(&FinalReport {
            text: report.to_string(),
            sent,
            packets,
            stood: standstill_count,
            left_ms: self.host.left_ns(nanos(ms)) as f64 / 1e6,
        })
    }
}
