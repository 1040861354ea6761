//! Prints digests and status of `stepscope run`.

use crate::{json::Tables, terminal};
use serde_json::{Value, json};
use std::io::{self, Write};
use stepscope_core::controller::trust_name;
use stepscope_core::sim::{ControllerSummary, StandAloneSummary, Summary};

pub(crate) fn digests(summary: &Summary) -> io::Result<()> {
    let mut out = terminal::out();
    summary.controllers.iter().try_for_each(|controller| writeln!(out, "{:016x}", controller.digest))
}

pub(crate) fn print(summary: &Summary) -> io::Result<()> {
    let mut out = terminal::out();
    for controller in &summary.controllers {
        writeln!(out, "digest {:016x}", controller.digest)?;
    }
    write!(out, "{summary}")
}

/// `first` is the number of the first controller.
pub(crate) fn tables(tables: Tables, summary: &Summary, first: usize) -> Tables {
    let numbered = || (first..).zip(&summary.controllers);
    let run = json!({
        "cycles": summary.cycles.0,
        "clock_hz": summary.clock_hz,
        "length_s": summary.cycles.0 as f64 / f64::from(summary.clock_hz.max(1)),
        "line_load": summary.line_load,
    });
    let positions = numbered().flat_map(|(index, controller)| {
        let channels = controller.positions.iter().enumerate();
        channels
            .map(move |(channel, steps)| json!({ "controller": index, "channel": channel, "steps": steps }))
    });
    let faults = numbered().flat_map(|(index, controller)| {
        controller.faults.names().map(move |name| json!({ "controller": index, "fault": name.to_string() }))
    });
    let host = summary.host.map(|host| {
        json!({
            "frames": host.frames,
            "repeated": host.repeated,
            "replies": host.replies,
            "rejected": host.rejected,
            "refused": host.refused,
            "crashes": host.crashes,
        })
    });
    let all_panels = || summary.stand_alone.iter().flat_map(|summary| &summary.panels).enumerate();
    let panels = all_panels().map(|(index, panel)| {
        json!({
            "controller": index,
            "state": panel.state.name(),
            "alarm": panel.alarm.name(),
            "trust": trust_name(panel.trust),
            "position": panel.position,
            "axis_error": panel.axis_error,
            "records": panel.records,
            "most_writes": panel.most_writes,
            "presses_without_meaning": panel.ignored.len(),
        })
    });
    let ignored = all_panels().flat_map(|(index, panel)| {
        panel.ignored.iter().map(move |press| {
            json!({
                "controller": index,
                "cycle": press.cycle.0,
                "button": press.button.name(),
                "state": press.state.name(),
            })
        })
    });
    let tables = match &summary.stand_alone {
        Some(StandAloneSummary { digest, too_many_groups: work, .. }) => {
            let ended = work.map(|work| work.to_string());
            tables
                .with("panels", panels)
                .with("presses_without_meaning", ignored)
                .with("panel_digest", [json!({ "digest": format!("{digest:016x}"), "ended": ended })])
        }
        None => tables,
    };
    tables
        .with("run", [run])
        .with("controllers", numbered().map(|(index, controller)| row(index, controller)))
        .with("positions", positions)
        .with("faults", faults)
        .with("host", host)
}

fn row(index: usize, controller: &ControllerSummary) -> Value {
    let status = controller.status;
    json!({
        "controller": index,
        "address": controller.address,
        "channels": controller.channels,
        "digest": format!("{:016x}", controller.digest),
        "records": controller.records,
        "ticks_done": controller.ticks_done,
        "state": status.map(|status| status.state.name()),
        "expected_seq": status.map(|status| status.expected_seq),
        "free_ticks": status.map(|status| status.free),
        "host": controller.job.map(|job| job.progress.to_string()),
        "host_ticks": controller.job.map(|job| job.ticks),
        "host_acknowledged": controller.job.map(|job| job.acknowledged),
    })
}
