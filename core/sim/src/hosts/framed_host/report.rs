//! The report at the end of a conversation (LIVE H3). Only ticks that a controller has confirmed count as done.

use super::{Conversation, Counts, Known, Progress};
use crate::Experiment;
use alloc::{
    borrow::ToOwned as _,
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::fmt;
use stepscope_peripheral::device::Faults;
use stepscope_peripheral::protocol::{State, Status};
use stepscope_scenario::{Noise, Scenario};

/// The scenario without its end and without noise, for a real line.
pub fn for_real_line(mut scenario: Scenario) -> Scenario {
    scenario.run_cycles = None;
    scenario.line.noise = Noise::default();
    scenario.line.glitches.clear();
    scenario
}

/// Result of a job for one controller.
#[derive(Clone, Debug)]
pub struct ReportRow {
    pub controller: usize,
    pub address: u8,
    pub ticks: u32,
    pub acknowledged: u32,
    pub progress: Progress,
    /// Positions after the done ticks, if the start is known.
    pub expected: Option<Vec<i32>>,
    /// Travel of the done ticks, without and with the next tick, which STOP may have interrupted.
    pub bounds: Option<(Vec<i32>, Vec<i32>)>,
    /// Confirmed ticks.
    pub done: Option<u32>,
    pub known: Known,
    stopped: bool,
}

impl ReportRow {
    /// Fault flags that are new since the start.
    pub fn new_faults(&self) -> Vec<String> {
        let bits = |status: Option<Status>| status.map_or(0, |status| status.faults);
        let new = bits(self.known.last) & !bits(self.known.opening);
        Faults::from_bits(new).names().map(|name| name.to_string()).collect()
    }

    /// Why the job is not confirmed; `None` if it is.
    pub fn doubt(&self) -> Option<String> {
        let faults = self.new_faults();
        let controller = self.controller;
        let is_ready = self.known.last.is_some_and(|last| last.state == State::Ready);
        match self.progress {
            Progress::Done if is_ready && faults.is_empty() => None,
            Progress::Done if faults.is_empty() => Some(format!("controller {controller} is not READY")),
            Progress::Done => Some(format!(
                "controller {controller}: all ticks are done, but with faults: {}",
                faults.join(" ")
            )),
            progress => Some(format!("controller {controller}: {progress}")),
        }
    }
}

fn list(positions: &[i32]) -> String {
    positions.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

impl fmt::Display for ReportRow {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { controller, address, ticks, acknowledged, progress, done, known, .. } = self;
        writeln!(out, "controller {controller} address {address}: {progress}")?;
        match done {
            Some(done) => write!(out, "  ticks {done} of {ticks} done, {acknowledged} acknowledged")?,
            None => write!(out, "  ticks {ticks}, none sent: the job never started")?,
        }
        let counted = matches!(progress, Progress::Done | Progress::Counted);
        if !counted && done.is_none_or(|done| done < *ticks) {
            write!(out, "; tick {} is the first that is not confirmed", done.unwrap_or(0))?;
        }
        writeln!(out)?;
        match (&known.positions, &self.expected) {
            (Some(reported), _) if *progress == Progress::Done => {
                writeln!(out, "  positions {}: the sums of the ticks", list(reported.as_slice()))?;
            }
            (Some(reported), Some(expected)) if known.stop_acknowledged => {
                let (reported, expected) = (list(reported.as_slice()), list(expected));
                writeln!(out, "  positions {reported}; expected after the ticks that are done: {expected}")?;
            }
            (Some(reported), _) => {
                writeln!(out, "  positions {} as last reported", list(reported.as_slice()))?
            }
            (None, _) if known.hides_positions => {
                writeln!(out, "  it does not support POSITIONS, so the distance is not confirmed")?;
                if let Some((min, max)) = self.bounds.as_ref().filter(|_| known.stop_acknowledged) {
                    let (min, max) = (list(min), list(max));
                    let cut = "and with the tick that STOP interrupted";
                    writeln!(out, "  the ticks that are done moved the motors by {min}, {cut} {max}")?;
                }
            }
            _ => {}
        }
        if known.stop_acknowledged {
            writeln!(out, "  STOP is acknowledged")?;
        } else if self.stopped && !counted {
            writeln!(out, "  STOP is not acknowledged")?;
        }
        if let Some(last) = known.last {
            let faults = self.new_faults();
            let faults = if faults.is_empty() { "none".to_owned() } else { faults.join(" ") };
            writeln!(out, "  state {}, new faults {faults}", last.state.name())?;
        }
        Ok(())
    }
}

/// Results of a job for all controllers, and the counters of the host.
#[derive(Clone, Debug)]
pub struct Report {
    pub rows: Vec<ReportRow>,
    pub counts: Counts,
}

impl Report {
    /// The report of a conversation; `stopped` if the host was stopped.
    pub fn new(experiment: &Experiment, host: &mut Conversation, stopped: bool) -> Self {
        let mut rows = Vec::new();
        for controller in 0..experiment.controllers() {
            let Some(job) = experiment.job_index(controller) else { continue };
            let reported =
                host.known().nth(job).map(|(reported, known)| (reported.address, reported.ticks(), *known));
            let ends = host.progress().nth(job).zip(host.acknowledged().nth(job));
            let (Some((address, ticks, known)), Some((progress, acknowledged))) = (reported, ends) else {
                continue;
            };
            let done = known.ticks_done().map(|done| done.min(ticks));
            let expected = done.and_then(|done| host.expected(job, done));
            let bounds =
                done.map(|done| (host.sums(job, done), host.sums(job, done.saturating_add(1).min(ticks))));
            rows.push(ReportRow {
                controller,
                address,
                ticks,
                acknowledged,
                progress,
                expected,
                bounds,
                done,
                known,
                stopped,
            });
        }
        Self { rows, counts: host.counts() }
    }

    /// Why the first unconfirmed job is not confirmed; `None` if all jobs are done.
    pub fn doubt(&self) -> Option<String> {
        self.rows.iter().find_map(ReportRow::doubt)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in &self.rows {
            row.fmt(out)?;
        }
        let Counts { frames, repeated, replies, rejected, refused, .. } = self.counts;
        writeln!(
            out,
            "frames {frames} repeated {repeated} replies {replies} rejected {rejected} refused {refused}"
        )
    }
}

/// The status line during a conversation; ticks are the total of all jobs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostStatus {
    pub progress: Vec<Progress>,
    pub accepted: u64,
    pub done: u64,
    pub ticks: u64,
    pub counts: Counts,
}

impl HostStatus {
    /// The current status.
    pub fn new(host: &Conversation) -> Self {
        let (mut done, mut ticks) = (0, 0);
        for (job, known) in host.known() {
            done += u64::from(known.ticks_done().unwrap_or(0).min(job.ticks()));
            ticks += u64::from(job.ticks());
        }
        let accepted = host.acknowledged().map(u64::from).sum();
        Self { progress: host.progress().collect(), accepted, done, ticks, counts: host.counts() }
    }
}

impl fmt::Display for HostStatus {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { progress, accepted, done, ticks, counts } = self;
        let names: Vec<&str> = progress.iter().map(|progress| progress.name()).collect();
        write!(
            out,
            "{}: {accepted} ticks accepted, {done} done, {} left, {} repeats, {} NAKs",
            names.join(" "),
            ticks - accepted,
            counts.repeated,
            counts.refused
        )
    }
}
