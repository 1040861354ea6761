//! `NAME.session.json`, beside a recording: what was of the wall clock (LIVE H5).

use serde_json::{Value, json};
use std::{
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};
use stepscope_core::sim::session::{Recording, SessionClock};

/// Most chunks and most replies that are told of: as many as a recording may have sends.
const MAX_ROWS: usize = 400_000;

/// When bytes came and went.
pub(crate) struct Sidecar {
    started_unix_ms: u64,
    pace: String,
    lag_ms: u64,
    chunks: Vec<Value>,
    replies: Vec<Value>,
    left_out: u64,
}

/// The path beside a recording's.
pub(crate) fn beside(record: &Path) -> PathBuf {
    let stem = record.file_stem().unwrap_or_default().to_os_string();
    let mut name = stem;
    name.push(".session.json");
    record.with_file_name(name)
}

impl Sidecar {
    pub(crate) fn new(pace: String, lag_ms: u64) -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let started_unix_ms = u64::try_from(since.as_millis()).unwrap_or(u64::MAX);
        Self { started_unix_ms, pace, lag_ms, chunks: Vec::new(), replies: Vec::new(), left_out: 0 }
    }

    fn push(rows: &mut Vec<Value>, left_out: &mut u64, row: Value) {
        if rows.len() < MAX_ROWS { rows.push(row) } else { *left_out += 1 }
    }

    /// So many bytes were read at a time, while the model stood behind a cycle.
    pub(crate) fn chunk(&mut self, at_ns: u64, cycle: u64, bytes: usize) {
        let row = json!({ "at_ns": at_ns, "cycle": cycle, "bytes": bytes });
        Self::push(&mut self.chunks, &mut self.left_out, row);
    }

    /// A reply whose last stop bit ended in a cycle was written at a time.
    pub(crate) fn reply(&mut self, controller: usize, cycle: u64, written_ns: u64, late_ns: u64) {
        let row = json!({
            "controller": controller, "end_cycle": cycle, "written_ns": written_ns, "late_ns": late_ns,
        });
        Self::push(&mut self.replies, &mut self.left_out, row);
    }

    /// The whole file.
    pub(crate) fn json(&self, clock: &SessionClock, recording: &Recording, whole: bool) -> String {
        let stretches = clock.stretches();
        let digests: Vec<String> = recording.digests.iter().map(|digest| format!("{digest:016x}")).collect();
        let file = json!({
            "stepscope": env!("CARGO_PKG_VERSION"),
            "started_unix_ms": self.started_unix_ms,
            "pace": self.pace,
            "lag_ms": self.lag_ms,
            "stretches": { "count": stretches.count, "cycles": stretches.cycles.0 },
            "run_cycles": recording.scenario.run_cycles,
            "records_all": whole,
            "digests": digests,
            "chunks": self.chunks,
            "replies": self.replies,
            "rows_left_out": self.left_out,
        });
        format!("{file:#}\n")
    }
}
