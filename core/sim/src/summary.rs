//! The summary of a run for the command, the golden cases and the page.
//!
//! Its text has one line per fact:
//!
//! ```text
//! cycles 6401602
//! records 13201                     per controller; with several, below `controller 0`, `controller 1`, …
//! ticks_done 200
//! positions 3200
//! faults 0x0000 none
//! state READY seq 0 free 16         on a framed line
//! host done                         if the host has ticks for the controller
//! frames 52 repeated 0 …            the host of a framed line
//! line_load 43.4 %                  if the host sends ticks
//! panel 0 READY position 17233 …    each stand-alone controller
//! panels 0123456789abcdef           digest of their records (CONTROLLER.md G8)
//! ```

use crate::framed_host::{Counts, Progress};
use crate::{Experiment, Run};
use alloc::vec::Vec;
use core::fmt;
use stepscope_peripheral::config::{Config, Protocol};
use stepscope_peripheral::device::{Device, Faults};
use stepscope_peripheral::{protocol::Status, trace::Digest, units::Cycles};

/// A run so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Whether the line uses the framed protocol.
    pub framed: bool,
    pub cycles: Cycles,
    pub clock_hz: u32,
    /// The line's load while all controllers move.
    pub line_load: Option<f64>,
    /// Counts of a host that waits for replies.
    pub host: Option<Counts>,
    pub controllers: Vec<ControllerSummary>,
    /// `None` with a line or segments.
    pub stand_alone: Option<crate::StandAloneSummary>,
}

/// Results of one controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ControllerSummary {
    pub address: Option<u8>,
    pub channels: u8,
    pub digest: u64,
    pub records: u64,
    pub ticks_done: u32,
    /// Position counters of the channels in use.
    pub positions: Vec<i32>,
    pub faults: Faults,
    /// `None` on a raw line.
    pub status: Option<Status>,
    pub job: Option<JobSummary>,
}

/// The host's job with one controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobSummary {
    pub ticks: usize,
    pub acknowledged: u32,
    pub progress: Progress,
}

impl Summary {
    /// The summary of a run; `digests` of the traces are in the order of the scenario.
    pub fn new<'a>(
        experiment: &Experiment,
        run: &Run,
        digests: impl IntoIterator<Item = &'a Digest>,
    ) -> Self {
        let devices = run.devices().zip(experiment.configs()).zip(digests).enumerate();
        let controllers = devices.map(|(index, ((device, config), digest))| {
            ControllerSummary::new((experiment, run, index), device, config, digest)
        });
        let config = experiment.config();
        Self {
            framed: config.protocol() == Protocol::Framed,
            cycles: run.cycles(),
            clock_hz: config.clock_hz(),
            line_load: experiment.line_load(),
            host: run.host().map(|host| host.conversation().counts()),
            controllers: controllers.collect(),
            stand_alone: run.stand_alone().map(crate::StandAloneSummary::of),
        }
    }

    /// The summary of one controller, if it exists.
    pub fn only(mut self, controller: usize) -> Self {
        self.controllers = self.controllers.into_iter().skip(controller).take(1).collect();
        self
    }
}

impl ControllerSummary {
    fn new(
        (experiment, run, index): (&Experiment, &Run, usize),
        device: &Device,
        config: &Config,
        digest: &Digest,
    ) -> Self {
        // With segments, no device moves.
        let channels = usize::from(config.channels());
        let first = run.positions();
        let positions = if index == 0 { &first } else { device.positions() };
        let job = experiment.host_progress(run, index).map(|progress| JobSummary {
            ticks: experiment.ticks_of(index).len() / channels.max(1),
            acknowledged: experiment.host_acknowledged(run, index).unwrap_or(0),
            progress,
        });
        Self {
            address: config.address(),
            channels: config.channels(),
            digest: digest.value(),
            records: digest.records(),
            ticks_done: device.ticks_done(),
            positions: positions.iter().take(channels).copied().collect(),
            faults: if index == 0 { run.faults() } else { device.faults() },
            status: device.status(),
            job,
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "cycles {}", self.cycles.0)?;
        for (index, controller) in self.controllers.iter().enumerate() {
            if self.controllers.len() > 1 {
                writeln!(f, "controller {index}")?;
            }
            controller.fmt(f)?;
        }
        if let Some(Counts { frames, repeated, replies, rejected, refused, crashes }) = self.host {
            write!(f, "frames {frames} repeated {repeated} replies {replies} ")?;
            writeln!(f, "rejected {rejected} refused {refused} crashes {crashes}")?;
        }
        self.line_load.map_or(Ok(()), |load| writeln!(f, "line_load {:.1} %", 100.0 * load))?;
        self.stand_alone.as_ref().map_or(Ok(()), |panels| panels.fmt(f))?;
        Ok(())
    }
}

impl fmt::Display for ControllerSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "records {}\nticks_done {}\npositions", self.records, self.ticks_done)?;
        self.positions.iter().try_for_each(|position| write!(f, " {position}"))?;
        write!(f, "\nfaults {:#06x}", self.faults.bits())?;
        if self.faults.bits() == 0 {
            f.write_str(" none")?;
        }
        self.faults.names().try_for_each(|name| write!(f, " {name}"))?;
        f.write_str("\n")?;
        if let Some(Status { state, expected_seq, free, .. }) = self.status {
            writeln!(f, "state {} seq {expected_seq} free {free}", state.name())?;
        }
        self.job.map_or(Ok(()), |job| writeln!(f, "host {}", job.progress))
    }
}
