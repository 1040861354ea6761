//! `NAME.session.json`: a session's wall-clock times (LIVE H5); a scenario would refuse them as unknown fields.

use crate::live::session::{Recording, ReplyByte, SessionClock};
use alloc::{format, string::String, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::units::Instant;

/// Maximum chunks and replies, as in a recording.
const MAX_ROWS: usize = 400_000;

/// Bytes read at a time, with the model at a cycle.
#[derive(Clone, Debug, Serialize)]
struct Chunk {
    at_ns: u64,
    cycle: u64,
    bytes: u32,
}

/// A reply whose last stop bit ended in a cycle, and when it was written.
#[derive(Clone, Debug, Serialize)]
struct Reply {
    controller: u32,
    end_cycle: u64,
    written_ns: u64,
    late_ns: u64,
}

/// Wall-clock times of bytes in and out.
#[derive(Clone, Debug)]
pub struct SessionTimes {
    started_unix_ms: u64,
    pace: String,
    lag_ms: u64,
    /// Only a recording needs rows.
    keeps: bool,
    chunks: Vec<Chunk>,
    replies: Vec<Reply>,
    left_out: u64,
}

#[derive(Serialize)]
struct Contents<'a> {
    stepscope: &'static str,
    started_unix_ms: u64,
    pace: &'a str,
    lag_ms: u64,
    stretches: StretchesOf,
    run_cycles: Option<u64>,
    records_all: bool,
    digests: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    panel_digest: Option<String>,
    chunks: &'a [Chunk],
    replies: &'a [Reply],
    rows_left_out: u64,
}

#[derive(Serialize)]
struct StretchesOf {
    count: u64,
    cycles: u64,
}

impl SessionTimes {
    /// A session that began `started_unix_ms` after 1970; `pace` is `max` without pacing; rows are stored only if `keeps`.
    pub const fn new(started_unix_ms: u64, pace: String, lag_ms: u64, keeps: bool) -> Self {
        Self { started_unix_ms, pace, lag_ms, keeps, chunks: Vec::new(), replies: Vec::new(), left_out: 0 }
    }

    fn push<T>(keeps: bool, rows: &mut Vec<T>, left_out: &mut u64, row: T) {
        match rows.len() < MAX_ROWS {
            _ if !keeps => {}
            true => rows.push(row),
            false => *left_out += 1,
        }
    }

    /// Bytes were read at a time, with the model at a cycle.
    pub fn chunk(&mut self, at_ns: u64, now: Instant, bytes: usize) {
        let row = Chunk { at_ns, cycle: now.0, bytes: u32::try_from(bytes).unwrap_or(u32::MAX) };
        Self::push(self.keeps, &mut self.chunks, &mut self.left_out, row);
    }

    /// A reply, whose last byte this is, was written so late after its cycle.
    pub fn reply(&mut self, last: &ReplyByte, written_ns: u64, late_ns: u64) {
        let controller = u32::try_from(last.controller).unwrap_or(u32::MAX);
        let row = Reply { controller, end_cycle: last.end.0, written_ns, late_ns };
        Self::push(self.keeps, &mut self.replies, &mut self.left_out, row);
    }

    /// The whole file. `records_all`: whether the recording has the whole session.
    pub fn to_json(&self, clock: &SessionClock, recording: &Recording, records_all: bool) -> String {
        let stretches = clock.setbacks();
        let digest = |digest: &u64| format!("{digest:016x}");
        let contents = Contents {
            stepscope: env!("CARGO_PKG_VERSION"),
            started_unix_ms: self.started_unix_ms,
            pace: &self.pace,
            lag_ms: self.lag_ms,
            stretches: StretchesOf { count: stretches.count, cycles: stretches.cycles.0 },
            run_cycles: recording.scenario.run_cycles,
            records_all,
            digests: recording.digests.iter().map(digest).collect(),
            panel_digest: recording.panel_digest.as_ref().map(digest),
            chunks: &self.chunks,
            replies: &self.replies,
            rows_left_out: self.left_out,
        };
        serde_json::to_string_pretty(&contents).unwrap_or_default() + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::session::{Pace, Session};
    use stepscope_scenario::Scenario;

    #[test]
    fn rows_are_stored_only_for_recordings_and_bounded() {
        for (keeps, kept, left_out) in [(false, 0, 0), (true, MAX_ROWS, 3)] {
            let mut times = SessionTimes::new(0, "1".into(), 50, keeps);
            for index in 0..MAX_ROWS as u64 + 3 {
                times.chunk(index, Instant(index), 1);
            }
            assert_eq!((times.chunks.len(), times.left_out), (kept, left_out), "{keeps}");
        }
    }

    #[test]
    fn the_file_has_start_setbacks_chunks_and_replies() {
        let scenario = Scenario::from_json(r#"{ "line": { "protocol": "framed" } }"#).expect("reads");
        let session = Session::new(&scenario).expect("it has no problems");
        let mut clock = SessionClock::new(1_000_000, Pace::REAL_TIME, 0);
        clock.target(7000, Instant(0));
        let mut times = SessionTimes::new(1234, "0.5".into(), 50, true);
        times.chunk(10, Instant(2), 3);
        times.reply(&ReplyByte { controller: 1, end: Instant(5), byte: 0 }, 20, 6);
        let recording = session.recording();
        let text = times.to_json(&clock, &recording, false);
        let file: serde_json::Value = serde_json::from_str(&text).expect("it is JSON");
        let expected = serde_json::json!({
            "stepscope": env!("CARGO_PKG_VERSION"),
            "started_unix_ms": 1234,
            "pace": "0.5",
            "lag_ms": 50,
            "stretches": { "count": 1, "cycles": 7 },
            "run_cycles": 1,
            "records_all": false,
            "digests": [format!("{:016x}", recording.digests[0])],
            "chunks": [{ "at_ns": 10, "cycle": 2, "bytes": 3 }],
            "replies": [{ "controller": 1, "end_cycle": 5, "written_ns": 20, "late_ns": 6 }],
            "rows_left_out": 0,
        });
        assert_eq!(file, expected);
    }

    #[test]
    fn times_of_a_session_are_json() {
        use crate::{
            session::{Pace, ReplyByte, Session, SessionClock},
            session_times::SessionTimes,
        };
        use stepscope_peripheral::units::Instant;
        use stepscope_scenario::Scenario;

        let scenario = Scenario::from_json(r#"{ "line": { "protocol": "framed" } }"#).expect("reads");
        let mut session = Session::new(&scenario).expect("it has no problems");
        let clock = SessionClock::new(16_000_000, Pace::REAL_TIME, 50_000_000);
        let mut times = SessionTimes::new(1_790_000_000_000, "1".into(), 50, true);
        session.receive(&[0]);
        times.chunk(120_000, session.now(), 1);
        times.reply(&ReplyByte { controller: 0, end: Instant(48_000), byte: 0 }, 3_100_000, 100_000);
        let text = times.to_json(&clock, &session.recording(), session.records_all());
        assert!(text.contains(r#""started_unix_ms": 1790000000000"#));
    }
}
