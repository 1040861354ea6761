//! `NAME.session.json`, beside a recording: what was of the wall clock (LIVE H5).

use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};
use stepscope_core::sim::session::{Recording, SessionClock};

/// Most chunks and most replies that are told of: as many as a recording may have sends.
const MAX_ROWS: usize = 400_000;

/// So many bytes were read at a time, while the model stood behind a cycle.
#[derive(Serialize)]
struct Chunk {
    at_ns: u64,
    cycle: u64,
    bytes: u32,
}

/// A reply whose last stop bit ended in a cycle was written at a time.
#[derive(Serialize)]
struct Reply {
    controller: u32,
    end_cycle: u64,
    written_ns: u64,
    late_ns: u64,
}

/// When bytes came and went.
pub(crate) struct Sidecar {
    started_unix_ms: u64,
    pace: String,
    lag_ms: u64,
    /// Rows are kept for a recording only.
    keeps: bool,
    chunks: Vec<Chunk>,
    replies: Vec<Reply>,
    left_out: u64,
}

/// The file, in the order of its fields.
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

/// The path beside a recording's.
pub(crate) fn beside(record: &Path) -> PathBuf {
    let stem = record.file_stem().unwrap_or_default().to_os_string();
    let mut name = stem;
    name.push(".session.json");
    record.with_file_name(name)
}

impl Sidecar {
    /// Of a session that begins now, and is recorded or not.
    pub(crate) fn new(pace: String, lag_ms: u64, keeps: bool) -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let started_unix_ms = u64::try_from(since.as_millis()).unwrap_or(u64::MAX);
        Self { started_unix_ms, pace, lag_ms, keeps, chunks: Vec::new(), replies: Vec::new(), left_out: 0 }
    }

    fn push<T>(keeps: bool, rows: &mut Vec<T>, left_out: &mut u64, row: T) {
        match rows.len() < MAX_ROWS {
            _ if !keeps => {}
            true => rows.push(row),
            false => *left_out += 1,
        }
    }

    /// So many bytes were read at a time, while the model stood behind a cycle.
    pub(crate) fn chunk(&mut self, at_ns: u64, cycle: u64, bytes: usize) {
        let row = Chunk { at_ns, cycle, bytes: u32::try_from(bytes).unwrap_or(u32::MAX) };
        Self::push(self.keeps, &mut self.chunks, &mut self.left_out, row);
    }

    /// A reply whose last stop bit ended in a cycle was written at a time.
    pub(crate) fn reply(&mut self, controller: usize, end_cycle: u64, written_ns: u64, late_ns: u64) {
        let controller = u32::try_from(controller).unwrap_or(u32::MAX);
        let row = Reply { controller, end_cycle, written_ns, late_ns };
        Self::push(self.keeps, &mut self.replies, &mut self.left_out, row);
    }

    /// The whole file.
    pub(crate) fn json(&self, clock: &SessionClock, recording: &Recording, whole: bool) -> String {
        let stretches = clock.stretches();
        let digest = |digest: &u64| format!("{digest:016x}");
        let contents = Contents {
            stepscope: env!("CARGO_PKG_VERSION"),
            started_unix_ms: self.started_unix_ms,
            pace: &self.pace,
            lag_ms: self.lag_ms,
            stretches: StretchesOf { count: stretches.count, cycles: stretches.cycles.0 },
            run_cycles: recording.scenario.run_cycles,
            records_all: whole,
            digests: recording.digests.iter().map(digest).collect(),
            panel_digest: recording.panel_digest.as_ref().map(digest),
            chunks: &self.chunks,
            replies: &self.replies,
            rows_left_out: self.left_out,
        };
        // Numbers and texts alone: nothing of it can be refused.
        serde_json::to_string_pretty(&contents).unwrap_or_default() + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_that_is_not_recorded_keeps_no_rows_and_one_that_is_a_bounded_number() {
        for (keeps, kept, left_out) in [(false, 0, 0), (true, MAX_ROWS, 3)] {
            let mut sidecar = Sidecar::new("1".to_owned(), 50, keeps);
            for index in 0..MAX_ROWS as u64 + 3 {
                sidecar.chunk(index, index, 1);
            }
            assert_eq!((sidecar.chunks.len(), sidecar.left_out), (kept, left_out), "{keeps}");
        }
    }
}
