//! Raw packets to a real line, paced and unanswered (LIVE H3): nobody tells whether they arrive, so nothing is verified.
//!
//! Packet j is due at t0 + its cycle, absolute, never summed. One that is late goes at once.

use super::{
    histogram::Histogram, interrupt, port::Heard, status_line::StatusLine, stop_watch::StopWatch, wire::Wire,
};
use crate::{failure::Failure, json::Tables};
use serde_json::json;
use std::{
    io::{self, Write},
    thread,
    time::Duration,
};
use stepscope_core::{peripheral::wire::schedule::line_time, sim::Experiment};

/// Ticks that are named of those before which the motor stood.
const MAX_NAMED: usize = 10;
/// How long a write is given.
const WRITE_WITHIN: Duration = Duration::from_secs(2);

/// What became of a raw motion.
#[derive(Default)]
struct Outcome {
    sent: usize,
    late: Histogram,
    /// Ticks, from 0, before which the queue must have been empty.
    stood: Vec<usize>,
    stood_count: u64,
    lost: Option<String>,
    interrupted: bool,
}

/// The queue of the controller as it must be by what was sent when: a tick begins when its packet is there and the one before
/// is over.
struct QueueModel {
    tick_ns: u64,
    /// When the line is free, and when the last tick ends.
    free_ns: u64,
    end_ns: Option<u64>,
}

impl QueueModel {
    /// A packet is written at a time and takes so long; whether the motor stood before its tick.
    fn packet(&mut self, at_ns: u64, takes_ns: u64) -> bool {
        self.free_ns = self.free_ns.max(at_ns) + takes_ns;
        let stood = self.end_ns.is_some_and(|end| end < self.free_ns);
        self.end_ns = Some(self.end_ns.unwrap_or(0).max(self.free_ns) + self.tick_ns);
        stood
    }
}

/// Whether so many packets can be sent ahead.
pub(super) fn judge_lead(experiment: &Experiment, lead: u8) -> Result<(), Failure> {
    let depth = experiment.config().queue_depth();
    if lead == 0 || lead < depth {
        return Ok(());
    }
    Err(Failure::Option(format!(
        "--lead {lead}: the queue has {depth} places; give less, so that none overflows"
    )))
}

/// Sends the schedule of a raw experiment, the first `lead` packets ahead.
pub(super) fn send(
    experiment: &Experiment,
    wire: &mut Wire,
    (lead, as_json, progress): (u8, bool, bool),
) -> Result<(), Failure> {
    let config = experiment.config();
    let clock_hz = u64::from(config.clock_hz().max(1));
    let schedule = experiment.schedule();
    let Some(first) = schedule.get(0) else {
        return Err(Failure::Option("the scenario sends nothing".to_owned()));
    };
    let nanos = |cycles: u64| (u128::from(cycles) * 1_000_000_000 / u128::from(clock_hz)) as u64;
    let tick_ns = nanos(config.tick().0);
    let ahead = u64::from(lead) * tick_ns;
    let mut model = QueueModel { tick_ns, free_ns: 0, end_ns: None };
    let mut outcome = Outcome::default();
    let mut line = StatusLine::new(progress);
    let watch = StopWatch::start();
    for (index, packet) in schedule.iter().enumerate() {
        let due = nanos((packet.start - first.start).0).saturating_sub(ahead);
        outcome.interrupted = !wait_until(due, watch, wire)?;
        if outcome.interrupted {
            break;
        }
        let at = watch.nanos();
        if let Err(error) = wire.write(packet.bytes, WRITE_WITHIN) {
            outcome.lost = Some(error.to_string());
            break;
        }
        outcome.late.add(at.saturating_sub(due));
        let takes = nanos(line_time(packet.bytes.len() as u64, config.clock_hz(), experiment.baud()));
        if model.packet(at, takes) {
            outcome.stood_count += 1;
            if outcome.stood.len() < MAX_NAMED {
                outcome.stood.push(index);
            }
        }
        outcome.sent = index + 1;
        line.tell(|| format!("{} of {} packets, late{}", outcome.sent, schedule.len(), outcome.late));
    }
    drop(line);
    if outcome.lost.is_none() {
        // What is queued at the controller runs on.
        let _ = wire.port.drain();
    }
    report(experiment, &outcome, as_json)?;
    match outcome {
        Outcome { lost: Some(why), .. } => Err(Failure::LostPort(why)),
        Outcome { interrupted: true, .. } => Err(Failure::Interrupted),
        _ => Ok(()),
    }
}

/// Waits for a time, listening for an echo meanwhile; false where Ctrl-C came first.
fn wait_until(due_ns: u64, watch: StopWatch, wire: &mut Wire) -> Result<bool, Failure> {
    let mut buffer = [0; 256];
    while interrupt::count() == 0 {
        let left = due_ns.saturating_sub(watch.nanos());
        if left == 0 {
            return Ok(true);
        }
        let left = Duration::from_nanos(left).min(Duration::from_millis(20));
        if wire.echo && left > Duration::from_millis(2) {
            let heard = wire.port.read(&mut buffer, left.saturating_sub(Duration::from_millis(1)));
            match heard.map_err(|error| Failure::LostPort(error.to_string()))? {
                Heard::Bytes(count) => drop(wire.without_echo(buffer.get(..count).unwrap_or_default())),
                Heard::Gone => return Err(Failure::LostPort("the other end has closed it".to_owned())),
                Heard::Nothing => {}
            }
        } else {
            thread::sleep(left);
        }
    }
    Ok(false)
}

fn report(experiment: &Experiment, outcome: &Outcome, as_json: bool) -> Result<(), Failure> {
    let Outcome { sent, late, stood, stood_count, lost, interrupted } = outcome;
    let all = experiment.schedule().len();
    if as_json {
        let row = json!({
            "protocol": "raw",
            "outcome": "not verified",
            "packets": all,
            "packets_sent": sent,
            "interrupted": interrupted,
            "lost": lost,
            "late_median_ms": late.within_ms(50),
            "late_99_percent_ms": late.within_ms(99),
            "late_worst_ms": late.worst_ms(),
            "stood_before_ticks": stood_count,
        });
        let named = stood.iter().map(|tick| json!({ "tick": tick }));
        return Tables::of("send").with("send", [row]).with("stood_before", named).print();
    }
    let mut out = io::stdout().lock();
    let mut write = || -> io::Result<()> {
        writeln!(out, "sent {sent} of {all} packets; not verified: raw packets are not answered")?;
        writeln!(
            out,
            "late median <={} ms, 99 % <={} ms, worst {:.2} ms",
            late.within_ms(50),
            late.within_ms(99),
            late.worst_ms()
        )?;
        if *stood_count > 0 {
            let named: Vec<String> = stood.iter().map(ToString::to_string).collect();
            let more = if *stood_count > named.len() as u64 { " …" } else { "" };
            writeln!(out, "the motor must have stood before {stood_count} ticks: {}{more}", named.join(" "))?;
        }
        if *interrupted {
            writeln!(
                out,
                "stopped sending: what the controller has queued runs on, for a raw line has no STOP"
            )?;
        }
        out.flush()
    };
    write().map_err(Failure::output)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motor_stands_before_a_tick_whose_packet_comes_after_the_end_of_the_one_before() {
        let mut model = QueueModel { tick_ns: 100, free_ns: 0, end_ns: None };
        // Written at, and whether the motor stood; a packet takes 10.
        for (at, stood) in [(0, false), (100, false), (190, false), (301, true), (302, false), (2000, true)] {
            assert_eq!(model.packet(at, 10), stood, "{at}");
        }
    }
}
