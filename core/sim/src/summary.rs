//! What a run came to, in short: the one summary that the command, the golden cases and the page show.
//!
//! Its text is a line a fact, each with a name of its own:
//!
//! ```text
//! cycles 6401602
//! records 13201                     of each controller, of several below `controller 0`, `controller 1`, …
//! ticks_done 200
//! positions 3200
//! faults 0x0000 none
//! state READY seq 0 free 16         on a framed line
//! host done                         where the host has ticks for the controller
//! frames 52 repeated 0 …            the host of a framed line
//! line_load 43.4 %                  where something paced is sent
//! panel 0 READY position 17233 …    each stand-alone controller
//! panels 0123456789abcdef           digest of their records (CONTROLLER.md G8)
//! ```

use crate::{
    Experiment, Run,
    framed_host::{Counts, Progress},
};
use alloc::vec::Vec;
use core::fmt;
use stepscope_peripheral::{
    config::{Config, Protocol},
    device::{Device, Faults},
    protocol::Status,
    trace::Digest,
    units::Cycles,
};

/// A run so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Whether the line speaks the framed protocol.
    pub framed: bool,
    /// Cycles that have been run.
    pub cycles: Cycles,
    /// Cycles a second.
    pub clock_hz: u32,
    /// The part of the line's time that is taken while all controllers move; `None` where nothing paced is sent.
    pub line_load: Option<f64>,
    /// What the host of a framed line counted; `None` where nobody waits for replies.
    pub host: Option<Counts>,
    /// In the order of the scenario.
    pub controllers: Vec<ControllerSummary>,
    /// The stand-alone controllers; `None` where a line or segments run the scenario.
    #[cfg(feature = "controller")]
    pub stand_alone: Option<crate::StandAloneSummary>,
}

/// One controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ControllerSummary {
    /// Its address, where it has one.
    pub address: Option<u8>,
    /// Channels in use.
    pub channels: u8,
    /// The digest of its trace (DESIGN A3).
    pub digest: u64,
    /// Records of its trace.
    pub records: u64,
    /// Ticks that have ended.
    pub ticks_done: u32,
    /// Position counters of the channels in use.
    pub positions: Vec<i32>,
    /// Faults so far.
    pub faults: Faults,
    /// What it would tell; `None` on a raw line.
    pub status: Option<Status>,
    /// What the host of a framed line has to do with it.
    pub job: Option<JobSummary>,
}

/// What the host has to do with one controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobSummary {
    /// Ticks to do.
    pub ticks: usize,
    /// Ticks that the controller has acknowledged.
    pub acknowledged: u32,
    /// How far the host has come.
    pub progress: Progress,
}

impl Summary {
    /// Of a run, with the digest of each controller's trace in the order of the scenario.
    #[must_use]
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
            host: run.host().map(|host| host.counts()),
            controllers: controllers.collect(),
            #[cfg(feature = "controller")]
            stand_alone: run.stand_alone().map(crate::StandAloneSummary::of),
        }
    }

    /// The same of one controller alone; of none where there is no such controller.
    #[must_use]
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
        // Where segments run the scenario there is one controller, and no device moves.
        let positions = if index == 0 { run.positions() } else { device.positions() };
        let channels = usize::from(config.channels());
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
            positions: positions.into_iter().take(channels).collect(),
            faults: if index == 0 { run.faults() } else { device.faults() },
            status: device.status(),
            job,
        }
    }
}

impl fmt::Display for Summary {
    /// All but the digests.
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
        #[cfg(feature = "controller")]
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
