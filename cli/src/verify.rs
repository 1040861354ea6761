//! `stepscope open --verify`: compares a run with the sender's run.

use crate::{failure::Failure, progress::Progress, terminal};
use std::{io::Write, path::PathBuf};
use stepscope_core::inspect::trace::fingerprint::{Fingerprinter, Shorter};
use stepscope_core::inspect::trace::run_fingerprint::{RunFingerprint, VERSION, Verification};
use stepscope_core::scenario::{Scenario, link};
use stepscope_core::{peripheral::units::Instant, sim::Experiment};

/// Records between progress reports.
const SLICE: u64 = 1 << 16;

/// Adds the digests of a run to the link of its scenario.
pub(crate) fn with_digests(link: String, traces: impl Iterator<Item = Fingerprinter>) -> String {
    let fingerprint = RunFingerprint::of(traces.map(Fingerprinter::finish).collect());
    link::with_part(link, "d", &fingerprint.emit())
}

pub(crate) fn verify(scenario: &Scenario, part: Option<&str>) -> Result<(), Failure> {
    let sent = part.ok_or_else(|| Failure::Option(
        "--verify: the link has no digests of its sender (no d= part); create it with Share in the page, or with `stepscope run --link`"
            .to_owned(),
    ))?;
    let sent = RunFingerprint::parse(sent).map_err(|error| Failure::Option(error.to_string()))?;
    let experiment = Experiment::new(scenario)
        .map_err(|problems| Failure::Scenario(PathBuf::from("the link"), problems))?;
    let controllers = experiment.controllers();
    let mut checks = sent.checks(controllers).map_err(|count| {
        Failure::Check(format!(
            "the link has digests of {count} controllers, but its scenario has {controllers}; create the link again"
        ))
    })?;
    let mut progress = Progress::new("open", false);
    let mut run = experiment.start();
    while !run.advance_each(SLICE, &mut checks) {
        progress.update(run.cycles().0, experiment.cost().end_cycle);
    }
    progress.end(format_args!("{} cycles", run.cycles().0), &[]);
    let clock_hz = experiment.config().clock_hz();
    let (controller, after, until, shorter) = match Verification::of(checks) {
        Verification::Same { edges } => {
            let digests: Vec<String> =
                sent.controllers.iter().map(|fingerprint| format!("{:016x}", fingerprint.digest)).collect();
            // If standard error is closed, the exit code remains.
            let _ = writeln!(
                terminal::err(),
                "identical to the sender's run: {edges} edges, digest {}",
                digests.join(" ")
            );
            return Ok(());
        }
        Verification::Differs { controller, after, until, shorter } => (controller, after, until, shorter),
    };
    let at = |cycle: Instant| format!("cycle {} ({} s)", cycle.0, cycle.seconds(clock_hz));
    let controller = if controllers > 1 { format!(" of controller {controller}") } else { String::new() };
    let ends = match shorter {
        Some(Shorter::This) => "; this run ends there",
        Some(Shorter::Other) => "; the sender's run ends there",
        None => "",
    };
    let version = sent.other_version().map_or_else(String::new, |version| {
        format!("; the link was made with version {version}, this is version {VERSION}")
    });
    Err(Failure::Check(format!(
        "the run differs from the sender's: the first difference{controller} is between edge {}, {}, and edge {}, {}{ends}{version}",
        after.edges,
        at(after.cycle),
        until.edges,
        at(until.cycle),
    )))
}
