//! What is known of each controller at the end of a conversation, and what is not (LIVE H3). The command and the page say it in
//! these words; "done" is nothing that a controller has not told.

use super::{Conversation, Counts, Known, Progress};
use crate::Experiment;
use alloc::{
    borrow::ToOwned as _,
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::fmt;
use stepscope_peripheral::{
    device::Faults,
    protocol::{State, Status},
};
use stepscope_scenario::{Noise, Scenario};

/// The scenario without its end and without noise, for a real line.
#[must_use]
pub fn for_real_line(mut scenario: Scenario) -> Scenario {
    scenario.run_cycles = None;
    scenario.line.noise = Noise::default();
    scenario.line.glitches.clear();
    scenario
}

/// What is known of one controller.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub struct ReportRow {
    pub controller: usize,
    pub address: u8,
    pub ticks: u32,
    pub acknowledged: u32,
    pub progress: Progress,
    /// Sums of the ticks that it reports as done.
    pub expected: Option<Vec<i32>>,
    /// Distance of these ticks, and with the next one, which STOP may have cut anywhere.
    pub bounds: Option<(Vec<i32>, Vec<i32>)>,
    pub done: Option<u32>,
    pub known: Known,
    stopped: bool,
}

impl ReportRow {
    /// Fault flags that are new since the start.
    #[must_use]
    pub fn new_faults(&self) -> Vec<String> {
        let bits = |status: Option<Status>| status.map_or(0, |status| status.faults);
        let new = bits(self.known.last) & !bits(self.known.opened);
        Faults::from_bits(new).names().map(|name| name.to_string()).collect()
    }

    /// Why the job is not known to be done; `None` where it is.
    #[must_use]
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
            None => write!(out, "  ticks {ticks}, none sent: it was never opened")?,
        }
        let counted = matches!(progress, Progress::Done | Progress::Counted);
        if !counted && done.is_none_or(|done| done < *ticks) {
            write!(out, "; tick {} is the first not known to be done", done.unwrap_or(0))?;
        }
        writeln!(out)?;
        match (&known.positions, &self.expected) {
            (Some(told), _) if *progress == Progress::Done => {
                writeln!(out, "  positions {}: the sums of the ticks", list(told.as_slice()))?;
            }
            (Some(told), Some(expected)) if known.stop_acknowledged => {
                let (told, expected) = (list(told.as_slice()), list(expected));
                writeln!(out, "  positions {told}; the ticks that are done lead to {expected}")?;
            }
            (Some(told), _) => {
                writeln!(out, "  positions {} when they were told last", list(told.as_slice()))?
            }
            (None, _) if known.hides_positions => {
                writeln!(out, "  it does not know POSITIONS: how far its motors went is not told")?;
                if let Some((least, most)) = self.bounds.as_ref().filter(|_| known.stop_acknowledged) {
                    let (least, most) = (list(least), list(most));
                    let cut = "with all of the one that STOP cut short";
                    writeln!(out, "  by the ticks that are done they went {least}, {cut} {most}")?;
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

/// What is known of all controllers with a job.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Report {
    pub rows: Vec<ReportRow>,
    pub counts: Counts,
}

impl Report {
    /// From a conversation as it stands; `stopped`: the host was stopped.
    pub fn new(experiment: &Experiment, host: &mut Conversation, stopped: bool) -> Self {
        let mut rows = Vec::new();
        for controller in 0..experiment.controllers() {
            let Some(job) = experiment.job(controller) else { continue };
            let told = host.known().nth(job).map(|(told, known)| (told.address, told.ticks(), *known));
            let ends = host.progress().nth(job).zip(host.acknowledged().nth(job));
            let (Some((address, ticks, known)), Some((progress, acknowledged))) = (told, ends) else {
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

    /// The first doubt of a controller; `None` where all jobs are done.
    #[must_use]
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

/// How far a conversation is.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Standing {
    pub progress: Vec<Progress>,
    pub accepted: u64,
    pub done: u64,
    pub ticks: u64,
    pub counts: Counts,
}

impl Standing {
    /// Of a conversation now.
    #[must_use]
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

impl fmt::Display for Standing {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { progress, accepted, done, ticks, counts } = self;
        let words: Vec<&str> = progress.iter().map(|progress| progress.name()).collect();
        write!(
            out,
            "{}: {accepted} ticks accepted, {done} done, {} left, {} repeats, {} NAKs",
            words.join(" "),
            ticks - accepted,
            counts.repeated,
            counts.refused
        )
    }
}
