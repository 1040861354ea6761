//! `stepscope open --verify`: compares a run with that of the link's sender.

use crate::{failure::Failure, progress::Progress, terminal};
use std::{io::Write, path::PathBuf};
use stepscope_core::{
    inspect::trace::{
        fingerprint::Shorter,
        run_fingerprint::{RunFingerprint, VERSION, Verification},
    },
    peripheral::units::Instant,
    scenario::Scenario,
    sim::Experiment,
};

/// Records between progress reports.
const SLICE: u64 = 1 << 16;

pub(crate) fn verify(scenario: &Scenario, part: Option<&str>) -> Result<(), Failure> {
    let proof = part.ok_or(Failure::NoDigests)?;
    let proof = RunFingerprint::parse(proof).map_err(Failure::RunFingerprint)?;
    let experiment = Experiment::new(scenario)
        .map_err(|problems| Failure::Scenario(PathBuf::from("the link"), problems))?;
    let own = experiment.controllers();
    let mut checks = proof.checks(own).map_err(|sent| {
        Failure::OtherRun(format!(
            "the link has digests of {sent} controllers, but its scenario has {own}; create the link again"
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
                proof.controllers.iter().map(|fingerprint| format!("{:016x}", fingerprint.digest)).collect();
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
    let controller = if own > 1 { format!(" of controller {controller}") } else { String::new() };
    let ends = match shorter {
        Some(Shorter::This) => "; this run ends there",
        Some(Shorter::Other) => "; the sender's run ends there",
        None => "",
    };
    let version = proof.other_version().map_or_else(String::new, |version| {
        format!("; the link was made with version {version}, this is version {VERSION}")
    });
    Err(Failure::OtherRun(format!(
        "the run differs from the sender's: the first difference{controller} is between edge {}, {}, and edge {}, {}{ends}{version}",
        after.edges,
        at(after.cycle),
        until.edges,
        at(until.cycle),
    )))
}
