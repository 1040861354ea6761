//! Sends raw packets to a real line, paced and without replies (LIVE H3). Nothing is confirmed.

use super::{port::Received, status_line::StatusLine, stop_watch::StopWatch, wire::Wire};
use crate::{failure::Failure, interrupt, json::Tables, terminal};
use serde_json::json;
use std::{io::Write, thread, time::Duration};
use stepscope_core::sim::Experiment;
use stepscope_core::sim::raw_host::{NotPaced, RawHost, RawReport};

const WRITE_LIMIT: Duration = Duration::from_secs(2);

pub(super) fn host(experiment: &Experiment, lead: u8) -> Result<RawHost, Failure> {
    RawHost::new(experiment, lead).map_err(|why| match why {
        NotPaced::Nothing => Failure::Option(why.to_string()),
        _ => Failure::Option(format!("--lead: {lead}: {why}")),
    })
}

pub(super) fn send(
    mut host: RawHost,
    wire: &mut Wire,
    (as_json, progress): (bool, bool),
) -> Result<(), Failure> {
    let (mut lost, mut interrupted) = (None, false);
    let mut line = StatusLine::new(progress);
    let watch = StopWatch::start();
    while let Some(due) = host.due_ns() {
        interrupted = !wait_until(due, watch, wire)?;
        if interrupted {
            break;
        }
        let at = watch.nanos();
        if let Some(packet) = host.packet(at)
            && let Err(error) = wire.write(packet, WRITE_LIMIT)
        {
            lost = Some(error.to_string());
            break;
        }
        host.written(at);
        line.update(|| host.report(false).status());
    }
    drop(line);
    if lost.is_none() {
        // The controller executes what is in its queue.
        let _ = wire.port.drain();
    }
    print(&host.report(interrupted), lost.as_deref(), as_json)?;
    match lost {
        Some(why) => Err(Failure::LostPort(why)),
        None if interrupted => Err(Failure::Interrupted),
        None => Err(Failure::Check(
            "raw packets were sent, not verified, because a raw controller does not reply; use the framed protocol for a verified result"
                .to_owned(),
        )),
    }
}

/// Reads an echo while waiting; false on Ctrl-C.
fn wait_until(due_ns: u64, watch: StopWatch, wire: &mut Wire) -> Result<bool, Failure> {
    let mut buffer = [0; 256];
    while interrupt::count() == 0 {
        let left = due_ns.saturating_sub(watch.nanos());
        if left == 0 {
            return Ok(true);
        }
        let left = Duration::from_nanos(left).min(Duration::from_millis(20));
        if wire.echo && left > Duration::from_millis(2) {
            let received = wire.port.read(&mut buffer, left.saturating_sub(Duration::from_millis(1)));
            match received.map_err(|error| Failure::LostPort(error.to_string()))? {
                Received::Bytes(count) => drop(wire.without_echo(buffer.get(..count).unwrap_or_default())),
                Received::Gone | Received::Ended => {
                    return Err(Failure::LostPort("the other end closed the connection".to_owned()));
                }
                Received::Nothing | Received::Connected => {}
            }
        } else {
            thread::sleep(left);
        }
    }
    Ok(false)
}

fn print(report: &RawReport, lost: Option<&str>, as_json: bool) -> Result<(), Failure> {
    if as_json {
        let RawReport { packets, sent, late, standstills, standstill_count, stopped } = report;
        let row = json!({
            "protocol": "raw",
            "outcome": "not verified",
            "packets": packets,
            "packets_sent": sent,
            "interrupted": stopped,
            "lost": lost,
            "late_median_ms": late.within_ms(50),
            "late_99_percent_ms": late.within_ms(99),
            "late_worst_ms": late.worst_ms(),
            "stood_before_ticks": standstill_count,
        });
        let named = standstills.iter().map(|tick| json!({ "tick": tick }));
        return Tables::of("send").with("send", [row]).with("stood_before", named).print();
    }
    let mut out = terminal::out();
    write!(out, "{report}").and_then(|()| out.flush()).map_err(Failure::output)
}
