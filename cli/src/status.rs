//! What `stepscope run` prints: digests, and what controllers and host have come to.

use crate::files::Station;
use std::io::{self, Write};
use stepscope_core::sim::{Experiment, Run};

/// A run that is over.
pub(crate) struct Shown<'a> {
    /// A station for each controller.
    pub(crate) stations: &'a [Station],
    /// The controller that was asked for; without it all are shown.
    pub(crate) only: Option<usize>,
    pub(crate) run: &'a Run,
    pub(crate) experiment: &'a Experiment,
}

impl Shown<'_> {
    /// The controllers to show, each with its number.
    fn stations(&self) -> impl Iterator<Item = (usize, &Station)> {
        let only = self.only;
        self.stations.iter().enumerate().filter(move |(index, _)| only.is_none_or(|only| only == *index))
    }
}

/// One digest a line.
pub(crate) fn digests(shown: &Shown<'_>) -> io::Result<()> {
    let mut out = io::stdout().lock();
    shown.stations().try_for_each(|(_, station)| writeln!(out, "{:016x}", station.digest.value()))
}

/// Digests, the run's length, a block for each controller, and the host of a framed line.
pub(crate) fn print(shown: &Shown<'_>) -> io::Result<()> {
    let mut out = io::stdout().lock();
    for (_, station) in shown.stations() {
        writeln!(out, "digest {:016x}", station.digest.value())?;
    }
    writeln!(out, "cycles {}", shown.run.cycles().0)?;
    for (index, station) in shown.stations() {
        if index > 0 && shown.only.is_none() {
            writeln!(out, "controller {index}")?;
        }
        controller(&mut out, shown, index, station)?;
    }
    if let Some(host) = shown.run.host() {
        let counts = host.counts();
        writeln!(
            out,
            "frames {} repeated {} replies {} rejected {} refused {} crashes {}",
            counts.frames, counts.repeated, counts.replies, counts.rejected, counts.refused, counts.crashes
        )?;
    }
    if let Some(load) = shown.experiment.line_load() {
        writeln!(out, "line_load {:.1} %", 100.0 * load)?;
    }
    Ok(())
}

fn controller(out: &mut impl Write, shown: &Shown<'_>, index: usize, station: &Station) -> io::Result<()> {
    let Shown { run, experiment, .. } = shown;
    let Some((device, config)) = run.devices().zip(experiment.configs()).nth(index) else { return Ok(()) };
    // Where segments run the scenario there is one controller, and no device moves.
    let positions = if index == 0 { run.positions() } else { device.positions() };
    let positions: Vec<String> =
        positions.iter().take(config.channels().into()).map(i32::to_string).collect();
    let faults: Vec<&str> = device.faults().names().collect();
    let faults = if faults.is_empty() { "none".into() } else { faults.join(" ") };
    writeln!(out, "records {}", station.digest.records())?;
    writeln!(out, "ticks_done {}", device.ticks_done())?;
    writeln!(out, "positions {}", positions.join(" "))?;
    writeln!(out, "faults {:#06x} {faults}", device.faults().bits())?;
    if let Some(status) = device.status() {
        writeln!(out, "state {} seq {} free {}", status.state.name(), status.expected_seq, status.free)?;
    }
    match experiment.host_progress(run, index) {
        Some(progress) => writeln!(out, "host {progress}"),
        None => Ok(()),
    }
}
