//! The host of a raw line in real time (LIVE H3, H4): packets are paced, and nothing is verified.
//!
//! ```text
//! packet j is due at t0 + (its cycle - the first one's)/clock_hz - lead*M*Ts/clock_hz, or at once where that is before t0
//! ```
//!
//! A late packet is sent immediately. The lead is the maximum delay of a write before the controller's queue is empty. Times
//! are nanoseconds since t0.

use crate::{Experiment, lateness::Lateness};
use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use core::fmt;
use stepscope_peripheral::units::Instant;
use stepscope_peripheral::wire::{Schedule, schedule::line_time};

/// Ticks named in a report.
const MAX_NAMED: usize = 10;
const MAX_DEPTH: u64 = u8::MAX as u64;

/// Why packets cannot be paced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotPaced {
    /// The scenario has no packets.
    Nothing,
    /// The queue is too short for this number of packets ahead.
    Overflow { lead: u8, depth: u8 },
    /// The queue is too short for the requested lead.
    Short { slack_ns: u64, tick_ns: u64, depth: u8 },
}

fn ms(ns: u64) -> f64 {
    (ns / 1000) as f64 / 1000.0
}

impl fmt::Display for NotPaced {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Nothing => {
                out.write_str("the scenario sends no packets; use a motion or packets as the source")
            }
            Self::Overflow { lead, depth } => {
                let max = depth.saturating_sub(1);
                write!(out, "a lead of {lead} packets does not fit in a queue of {depth}; use 0 to {max}")
            }
            Self::Short { slack_ns, tick_ns, depth } => {
                let needed = slack_ns.div_ceil(tick_ns.max(1));
                let held = u64::from(depth.saturating_sub(1));
                write!(
                    out,
                    "a lead of {} ms needs {needed} ticks of {} ms in the queue, but a queue of {depth} holds {held} ({} ms)",
                    ms(slack_ns),
                    ms(tick_ns),
                    ms(held * tick_ns)
                )?;
                let longer = slack_ns.checked_div(held).map(|ns| ms(ns + 999));
                match (longer, needed < MAX_DEPTH) {
                    (Some(longer), true) => {
                        write!(out, "; use ticks of {longer} ms or a queue of {}", needed + 1)
                    }
                    (Some(longer), false) => write!(out, "; use ticks of {longer} ms"),
                    (None, _) => write!(out, "; use a queue of {}", (needed + 1).min(MAX_DEPTH)),
                }
            }
        }
    }
}

/// Model of the controller's queue: a tick begins when its packet has arrived and the previous tick has ended.
#[derive(Clone, Copy, Debug)]
struct QueueModel {
    tick_ns: u64,
    /// When the line is free.
    free_ns: u64,
    /// End of the last queued tick.
    end_ns: Option<u64>,
}

impl QueueModel {
    /// Sends a packet of this duration; returns whether the motor stopped before its tick.
    fn packet(&mut self, at_ns: u64, duration_ns: u64) -> bool {
        self.free_ns = self.free_ns.max(at_ns) + duration_ns;
        let has_stopped = self.end_ns.is_some_and(|end| end < self.free_ns);
        self.end_ns = Some(self.end_ns.unwrap_or(0).max(self.free_ns) + self.tick_ns);
        has_stopped
    }
}

/// Paces the packets of an experiment for a real port.
///
/// ```
/// use stepscope_sim::{Experiment, raw_host::RawHost};
///
/// let experiment = Experiment::from_json(r#"{ "line": { "protocol": "raw" } }"#).expect("no problems");
/// let mut host = RawHost::with_slack(&experiment, 20_000_000).expect("the queue holds 20 ms");
/// let mut now_ns = 0;
/// while let Some(due_ns) = host.due_ns() {
///     now_ns = now_ns.max(due_ns); // wait until then
///     let packet = host.packet(now_ns).expect("due"); // write it to your port
///     assert!(!packet.is_empty());
///     host.written(now_ns);
/// }
/// assert_eq!(host.report(false).standstill_count, 0);
/// ```
#[derive(Clone, Debug)]
pub struct RawHost {
    schedule: Schedule,
    first: Instant,
    clock_hz: u32,
    baud: u32,
    lead: u8,
    queue: QueueModel,
    sent: usize,
    late: Lateness,
    standstills: Vec<usize>,
    standstill_count: u64,
}

impl RawHost {
    /// A host that sends each packet `lead` ticks ahead. Errors: no packets, or a queue that is too short.
    pub fn new(experiment: &Experiment, lead: u8) -> Result<Self, NotPaced> {
        let depth = depth(experiment);
        if lead > 0 && lead >= depth {
            return Err(NotPaced::Overflow { lead, depth });
        }
        let schedule = experiment.schedule().clone();
        let first = schedule.get(0).ok_or(NotPaced::Nothing)?.start;
        let clock_hz = experiment.config().clock_hz().max(1);
        let tick_ns = tick_ns(experiment);
        Ok(Self {
            schedule,
            first,
            clock_hz,
            baud: experiment.baud(),
            lead,
            queue: QueueModel { tick_ns, free_ns: 0, end_ns: None },
            sent: 0,
            late: Lateness::default(),
            standstills: Vec::new(),
            standstill_count: 0,
        })
    }

    /// As [`Self::new`], with the minimum lead of at least `slack_ns`. After a stop the controller still runs the lead.
    /// Errors: no packets, or a queue that is too short.
    pub fn with_slack(experiment: &Experiment, slack_ns: u64) -> Result<Self, NotPaced> {
        if experiment.schedule().is_empty() {
            return Err(NotPaced::Nothing);
        }
        let depth = depth(experiment);
        let tick_ns = tick_ns(experiment);
        let lead = u8::try_from(slack_ns.div_ceil(tick_ns.max(1)).max(1)).ok();
        let lead = lead.filter(|&lead| lead < depth);
        Self::new(experiment, lead.ok_or(NotPaced::Short { slack_ns, tick_ns, depth })?)
    }

    /// Packets sent ahead.
    pub const fn lead(&self) -> u8 {
        self.lead
    }

    /// Maximum delay of a write before the queue is empty.
    pub fn slack_ns(&self) -> u64 {
        u64::from(self.lead) * self.queue.tick_ns
    }

    /// `None` when all packets are sent.
    pub fn due_ns(&self) -> Option<u64> {
        let next = self.schedule.get(self.sent)?;
        Some(nanos((next.start - self.first).0, self.clock_hz).saturating_sub(self.slack_ns()))
    }

    /// The next packet, if it is due.
    pub fn packet(&self, now_ns: u64) -> Option<&[u8]> {
        self.due_ns().filter(|&due| due <= now_ns)?;
        self.schedule.get(self.sent).map(|next| next.bytes)
    }

    /// Reports that the next packet was written.
    pub fn written(&mut self, at_ns: u64) {
        let (Some(due), Some(packet)) = (self.due_ns(), self.schedule.get(self.sent)) else { return };
        self.late.add(at_ns.saturating_sub(due));
        let duration = line_time(packet.bytes.len() as u64, self.clock_hz, self.baud);
        if self.queue.packet(at_ns, nanos(duration, self.clock_hz)) {
            self.standstill_count += 1;
            if self.standstills.len() < MAX_NAMED {
                self.standstills.push(self.sent);
            }
        }
        self.sent += 1;
    }

    /// Time until the controller's queue is empty, by the model.
    pub fn left_ns(&self, now_ns: u64) -> u64 {
        self.queue.end_ns.unwrap_or(0).saturating_sub(now_ns)
    }

    /// The report so far; `stopped` if the host was stopped.
    pub fn report(&self, stopped: bool) -> RawReport {
        RawReport {
            packets: self.schedule.len(),
            sent: self.sent,
            late: self.late,
            standstills: self.standstills.clone(),
            standstill_count: self.standstill_count,
            stopped,
        }
    }
}

fn depth(experiment: &Experiment) -> u8 {
    experiment.configs().map(stepscope_peripheral::config::Config::queue_depth).min().unwrap_or(0)
}

/// Rounded up, so that a reported standstill is certain.
fn tick_ns(experiment: &Experiment) -> u64 {
    let config = experiment.config();
    let ns = (u128::from(config.tick().0) * 1_000_000_000).div_ceil(config.clock_hz().max(1).into());
    u64::try_from(ns).unwrap_or(u64::MAX)
}

fn nanos(cycles: u64, clock_hz: u32) -> u64 {
    (u128::from(cycles) * 1_000_000_000 / u128::from(clock_hz)) as u64
}

/// The report about raw packets. They have no replies, so nothing is confirmed.
#[derive(Clone, Debug)]
pub struct RawReport {
    pub packets: usize,
    pub sent: usize,
    pub late: Lateness,
    /// The first ticks before which the motor must have stopped.
    pub standstills: Vec<usize>,
    pub standstill_count: u64,
    pub stopped: bool,
}

impl RawReport {
    /// The status line.
    pub fn status(&self) -> String {
        format!("{} of {} packets, late{}", self.sent, self.packets, self.late)
    }
}

impl fmt::Display for RawReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { packets, sent, late, standstills, standstill_count, stopped } = self;
        writeln!(out, "sent {sent} of {packets} packets; not verified: raw packets are not answered")?;
        let (half, percent99) = (late.within_ms(50), late.within_ms(99));
        writeln!(out, "late median <={half} ms, 99 % <={percent99} ms, worst {:.2} ms", late.worst_ms())?;
        if *standstill_count > 0 {
            let named: Vec<String> = standstills.iter().map(ToString::to_string).collect();
            let more = if *standstill_count > named.len() as u64 { " …" } else { "" };
            writeln!(
                out,
                "the motor must have stopped before {standstill_count} ticks: {}{more}",
                named.join(" ")
            )?;
        }
        if *stopped {
            writeln!(out, "stopped sending: queued packets still run, because a raw line has no STOP")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::session::Session;
    use stepscope_peripheral::signal::{Event, Record, Sink};
    use stepscope_scenario::Scenario;

    /// When ticks began and ended.
    #[derive(Default)]
    struct Ticks {
        starts: Vec<Instant>,
        ends: Vec<Instant>,
    }

    impl Sink for Ticks {
        fn record(&mut self, _: Record) {}

        fn event(&mut self, at: Instant, event: Event) {
            match event {
                Event::TickStart { .. } => self.starts.push(at),
                Event::TickEnd => self.ends.push(at),
                _ => {}
            }
        }
    }

    /// Ticks of this length, and a queue.
    fn experiment(tick_ms: u32, depth: u32) -> Experiment {
        Experiment::new(&scenario(tick_ms, depth)).expect("it has no problems")
    }

    fn scenario(tick_ms: u32, depth: u32) -> Scenario {
        let slot = 1600 * tick_ms;
        let json = format!(
            r#"{{ "line": {{ "protocol": "raw" }}, "bus": {{ "slots": 10, "step_period_cycles": {slot}, "queue_depth": {depth} }},
                "source": {{ "packets": {{ "packets": ["81", "01", "81", "01", "81"] }} }} }}"#
        );
        Scenario::from_json(&json).expect("reads")
    }

    #[test]
    fn a_late_packet_stops_the_motor() {
        let mut model = QueueModel { tick_ns: 100, free_ns: 0, end_ns: None };
        // Written at, and whether the motor stood; a packet takes 10.
        for (at, standstills) in
            [(0, false), (100, false), (190, false), (301, true), (302, false), (2000, true)]
        {
            assert_eq!(model.packet(at, 10), standstills, "{at}");
        }
    }

    #[test]
    fn packets_are_due_by_their_ticks_minus_the_lead() {
        const MS: u64 = 1_000_000;
        for (lead, due) in [(0, [0, 10, 20, 30, 40]), (1, [0, 0, 10, 20, 30]), (3, [0, 0, 0, 0, 10])] {
            let mut host = RawHost::new(&experiment(10, 4), lead).expect("the queue takes it");
            for due in due.map(|ms| ms * MS) {
                assert_eq!(host.due_ns(), Some(due), "{lead}");
                assert!(due == 0 || host.packet(due - 1).is_none(), "{lead}");
                assert_eq!(host.packet(due).map(<[u8]>::len), Some(1), "{lead}");
                host.written(due);
            }
            assert_eq!((host.due_ns(), host.packet(u64::MAX)), (None, None));
            // The last tick begins when its packet is there or the one before is over; a byte takes 87 us.
            assert_eq!(host.left_ns(50 * MS) / 1000, 86, "{lead}");
            assert_eq!(host.report(false).standstills, Vec::<usize>::new());
        }
    }

    #[test]
    fn punctual_packets_never_stop_the_motor() {
        for clock_hz in [16_000_000, 7_372_800, 7_000_000, 11_059_200] {
            let mut scenario = scenario(1, 4);
            scenario.clock_hz = clock_hz;
            let experiment = Experiment::new(&scenario).expect("it has no problems");
            for lead in [0, 2] {
                let mut host = RawHost::new(&experiment, lead).expect("the queue takes it");
                while let Some(due) = host.due_ns() {
                    host.written(due);
                }
                assert_eq!(host.report(false).standstills, Vec::<usize>::new(), "{clock_hz} {lead}");
            }
        }
    }

    #[test]
    fn late_packets_are_reported_with_the_stopped_ticks() {
        let mut host = RawHost::new(&experiment(10, 4), 0).expect("it needs no queue");
        for at in [0, 10_000_000, 41_000_000, 41_000_000] {
            host.written(at);
        }
        assert_eq!(
            host.report(true).to_string(),
            "sent 4 of 5 packets; not verified: raw packets are not answered\n\
             late median <=0.1 ms, 99 % <=50 ms, worst 21.00 ms\n\
             the motor must have stopped before 1 ticks: 2\n\
             stopped sending: queued packets still run, because a raw line has no STOP\n"
        );
    }

    #[test]
    fn reported_standstills_are_those_of_the_device() {
        for lead in [0, 1, 3] {
            for late_ms in [[0; 5], [3, 0, 25, 0, 0], [0, 41, 0, 0, 0], [0, 0, 12, 0, 31], [0, 0, 0, 0, 90]] {
                let mut host = RawHost::new(&experiment(10, 5), lead).expect("the queue takes it");
                let mut device = Session::new(&scenario(10, 5)).expect("it has no problems");
                let (mut ticks, mut now_ns) = (Ticks::default(), 0);
                for late in late_ms {
                    now_ns = now_ns.max(host.due_ns().expect("a packet is left") + late * 1_000_000);
                    // Behind its self-test.
                    device.advance(Instant(100_000 + now_ns * 16 / 1000), core::slice::from_mut(&mut ticks));
                    device.receive(host.packet(now_ns).expect("it is due"));
                    host.written(now_ns);
                }
                device.advance(Instant(10_000_000), core::slice::from_mut(&mut ticks));
                assert_eq!((ticks.starts.len(), ticks.ends.len()), (5, 5));
                let pairs = ticks.starts.iter().skip(1).zip(&ticks.ends);
                let standstills = pairs.enumerate().filter(|(_, (start, end))| start > end);
                let standstills: Vec<usize> = standstills.map(|(index, _)| index + 1).collect();
                assert_eq!(host.report(false).standstills, standstills, "{lead} {late_ms:?}");
            }
        }
    }

    #[test]
    fn a_lead_is_as_long_as_requested_or_refused() {
        const SLACK_NS: u64 = 200_000_000;
        for (tick_ms, depth, lead) in [(10, 21, 20), (10, 255, 20), (30, 16, 7), (200, 2, 1), (255, 2, 1)] {
            let host = RawHost::with_slack(&experiment(tick_ms, depth), SLACK_NS).expect("it is long enough");
            assert_eq!(host.lead(), lead, "{tick_ms} {depth}");
            assert!(host.slack_ns() >= SLACK_NS);
        }
        for (tick_ms, depth, why) in [
            (
                10,
                20,
                "20 ticks of 10 ms in the queue, but a queue of 20 holds 19 (190 ms); use ticks of 10.527 ms or a queue of 21",
            ),
            (
                1,
                200,
                "200 ticks of 1 ms in the queue, but a queue of 200 holds 199 (199 ms); use ticks of 1.006 ms or a queue of 201",
            ),
            (100, 1, "2 ticks of 100 ms in the queue, but a queue of 1 holds 0 (0 ms); use a queue of 3"),
        ] {
            let refused = RawHost::with_slack(&experiment(tick_ms, depth), SLACK_NS).err();
            let text = refused.expect("the queue is too short").to_string();
            assert_eq!(text, format!("a lead of 200 ms needs {why}"));
        }
        // No queue could be so deep.
        let refused = NotPaced::Short { slack_ns: SLACK_NS, tick_ns: 62_500, depth: 16 };
        assert!(refused.to_string().ends_with("(0.937 ms); use ticks of 13.334 ms"), "{refused}");
    }

    #[test]
    fn a_lead_longer_than_the_queue_is_refused() {
        assert_eq!(RawHost::new(&experiment(10, 4), 4).err(), Some(NotPaced::Overflow { lead: 4, depth: 4 }));
        let nothing =
            Scenario::from_json(r#"{ "source": { "packets": { "packets": [] } } }"#).expect("reads");
        let nothing = Experiment::new(&nothing).expect("it has no problems");
        assert_eq!(RawHost::new(&nothing, 0).err(), Some(NotPaced::Nothing));
    }

    #[test]
    fn packets_are_sent_when_they_are_due() {
        use crate::{Experiment, raw_host::RawHost};
        use stepscope_scenario::Scenario;

        let scenario = Scenario::from_json(r#"{ "line": { "protocol": "raw" } }"#).expect("reads");
        let experiment = Experiment::new(&scenario).expect("it has no problems");
        let mut host = RawHost::new(&experiment, 2).expect("the queue holds them");
        let mut now_ns = 0;
        while let Some(due_ns) = host.due_ns() {
            now_ns = now_ns.max(due_ns);
            assert!(host.packet(now_ns).is_some());
            host.written(now_ns);
        }
        let report = host.report(false);
        assert_eq!((report.sent, report.standstill_count, report.late.worst_ms()), (report.packets, 0, 0.0));
    }
}
