//! A device alone that its caller clocks: by levels of the line, by bytes, by registers.
//!
//! ```
//! use stepscope_peripheral::trace::Digest;
//! use stepscope_sim::{ClockedDevice, Experiment};
//!
//! let experiment = Experiment::from_json("{}").expect("no problems");
//! let mut device = ClockedDevice::new(&experiment, 0, Digest::default()).expect("it has one controller");
//! device.run_until(2000, true)?; // the self-test
//! device.send(&[0x85])?; // a packet: 5 steps to the right
//! device.run_until(device.cycles() + 40_000, true)?; // a tick and more
//! assert_eq!(device.positions(), [5]);
//! # Ok::<(), stepscope_sim::ClockedDeviceError>(())
//! ```

use crate::Experiment;
use alloc::{collections::VecDeque, vec::Vec};
use core::fmt;
use stepscope_peripheral::device::{Device, Faults};
use stepscope_peripheral::protocol::Status;
use stepscope_peripheral::signal::{Event, Levels, Record, Sink};
use stepscope_peripheral::trace::Digest;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::{BitTimes, Schedule, Sender};
use stepscope_scenario::END_OF_TIME;

/// Replies that wait to be received; then the oldest is dropped.
const MAX_REPLIES: usize = 1024;
/// Bit times that [`ClockedDevice::await_reply`] waits by default.
const REPLY_BITS: u64 = 256;

/// A device with clock, bus and line of a controller; edges go to the sink.
#[derive(Clone)]
pub struct ClockedDevice<S> {
    device: Device,
    output: Output<S>,
    clock_hz: u32,
    /// The host's bit rate.
    baud: u32,
}

/// Why a call did nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockedDeviceError {
    /// An argument is out of range.
    Range { name: &'static str, given: u64, min: u64, max: u64 },
    /// A register was written before the first cycle.
    NotRun,
}

impl ClockedDeviceError {
    /// The name of the wrong argument, or `device`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Range { name, .. } => name,
            Self::NotRun => "device",
        }
    }
}

impl fmt::Display for ClockedDeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range { given, min, max, .. } if min == max => {
                write!(f, "{given} is out of range; use {min}")
            }
            Self::Range { given, min, max, .. } => {
                write!(f, "{given} is out of range; use {min} to {max}")
            }
            Self::NotRun => f.write_str("no cycle has run; clock the device first"),
        }
    }
}

impl core::error::Error for ClockedDeviceError {}

#[derive(Clone)]
struct Output<S> {
    sink: S,
    digest: Digest,
    replies: VecDeque<Reply>,
    /// A call waits for a reply, and the device pauses with the rise of DE.
    awaits_reply: bool,
    de: bool,
}

#[derive(Clone, Debug)]
struct Reply {
    /// Cycle of DE's fall.
    end: Instant,
    bytes: Vec<u8>,
}

impl<S: Sink> Sink for Output<S> {
    fn record(&mut self, record: Record) {
        self.digest.record(record);
        self.de = record.levels.has(Levels::DE);
        self.sink.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        if let Event::Reply { end, reply, positions, .. } = &event {
            if self.replies.len() == MAX_REPLIES {
                self.replies.pop_front();
            }
            self.replies.push_back(Reply { end: *end, bytes: reply.emit(positions.as_ref()) });
        }
        self.sink.event(at, event);
    }

    fn is_paused(&self) -> bool {
        self.awaits_reply && self.de
    }
}

impl<S: Sink> ClockedDevice<S> {
    /// A device before cycle 0, as controller `controller` of the experiment; its motion is not used.
    ///
    /// # Errors
    /// No such controller.
    pub fn new(experiment: &Experiment, controller: usize, sink: S) -> Result<Self, ClockedDeviceError> {
        let max = (experiment.controllers() as u64).saturating_sub(1);
        let missing = ClockedDeviceError::Range { name: "controller", given: controller as u64, min: 0, max };
        let config = experiment.configs().nth(controller).ok_or(missing)?;
        let output = Output {
            sink,
            digest: Digest::default(),
            replies: VecDeque::new(),
            awaits_reply: false,
            de: false,
        };
        Ok(Self { device: Device::new(config), output, clock_hz: config.clock_hz(), baud: experiment.baud() })
    }

    pub const fn sink(&self) -> &S {
        &self.output.sink
    }

    pub const fn sink_mut(&mut self) -> &mut S {
        &mut self.output.sink
    }

    pub const fn clock_hz(&self) -> u32 {
        self.clock_hz
    }

    /// Number of cycles that were run, and the next cycle.
    pub const fn cycles(&self) -> u64 {
        self.device.now().0
    }

    /// Levels of the last cycle; before it, those of reset.
    pub const fn levels(&self) -> Levels {
        self.device.levels()
    }

    pub const fn digest(&self) -> &Digest {
        &self.output.digest
    }

    /// Positions of the channels in use, in steps.
    pub fn positions(&self) -> &[i32] {
        self.device.positions()
    }

    pub const fn faults(&self) -> Faults {
        self.device.faults()
    }

    pub const fn ticks_done(&self) -> u32 {
        self.device.ticks_done()
    }

    /// State of a framed device; `None` on a raw line.
    pub fn status(&self) -> Option<Status> {
        self.device.status()
    }

    /// Runs one cycle with the line at `line`, as others drive it. In cycle 0, reset, the line counts as high.
    ///
    /// # Errors
    /// The end of time.
    pub fn clock(&mut self, line: bool) -> Result<Levels, ClockedDeviceError> {
        self.check_until("cycle", self.cycles().saturating_add(1))?;
        Ok(self.device.clock(line, &mut self.output))
    }

    /// Cycles without change while the line keeps its level; `None` if nothing can change any more.
    pub fn cycles_until_event(&self) -> Option<Cycles> {
        self.device.cycles_until_event()
    }

    /// Skips `cycles` cycles without change.
    ///
    /// # Errors
    /// More than [`Self::cycles_until_event`]; nothing is done.
    pub fn advance(&mut self, cycles: u64) -> Result<(), ClockedDeviceError> {
        let until = self.check_span("cycles", cycles)?;
        match self.device.cycles_until_event() {
            Some(Cycles(max)) if cycles > max => {
                Err(ClockedDeviceError::Range { name: "cycles", given: cycles, min: 0, max })
            }
            _ => {
                self.device.advance(until - self.device.now());
                Ok(())
            }
        }
    }

    /// Runs until `cycle` is the next one, with the line at `line`.
    ///
    /// # Errors
    /// The cycle is past, or behind the end of time.
    pub fn run_until(&mut self, cycle: u64, line: bool) -> Result<(), ClockedDeviceError> {
        let until = self.check_until("cycle", cycle)?;
        self.run(line, until);
        Ok(())
    }

    /// Sends bytes back to back at the host's bit rate, from the next cycle on (at least cycle 1), to the end of the last stop
    /// bit.
    ///
    /// # Errors
    /// More bytes than time.
    pub fn send(&mut self, bytes: &[u8]) -> Result<(), ClockedDeviceError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let start = self.device.now().max(Instant(1));
        let length = self.bit_times().bytes(bytes.len() as u64);
        let end = self.check_until("length", start.0.saturating_add(length.0))?;
        let mut schedule = Schedule::default();
        schedule.push(start, bytes);
        let mut sender = Sender::new(schedule.into(), self.clock_hz, self.baud);
        while sender.next_edge() != Instant::NEVER {
            self.run(sender.level(), sender.next_edge());
            sender.pass();
        }
        self.run(sender.level(), end);
        Ok(())
    }

    /// Waits for the oldest reply and returns its bytes, with the closing 0x00; [`Self::take_reply`] removes it. Runs on with an
    /// idle line until DE falls. `None` if DE does not rise within `timeout` cycles (default: 256 bit times); [`u64::MAX`]
    /// waits until nothing can change any more.
    ///
    /// # Errors
    /// A timeout behind the end of time.
    pub fn await_reply(&mut self, timeout: Option<u64>) -> Result<Option<&[u8]>, ClockedDeviceError> {
        let now = self.device.now();
        let timeout = timeout.unwrap_or_else(|| self.bit_times().bit(REPLY_BITS).0);
        // Forever: until nothing can change any more, but not up to the end of time.
        let until = match timeout {
            u64::MAX => Instant::NEVER,
            _ => self.check_span("timeout_cycles", timeout)?,
        };
        let was_sent = self.output.replies.front().is_some_and(|reply| reply.end < now);
        if !was_sent {
            if !self.output.de {
                self.output.awaits_reply = true;
                self.device.run(true, until, &mut self.output);
                self.output.awaits_reply = false;
            }
            let oldest = self.output.replies.front().filter(|_| self.output.de);
            let Some(end) = oldest.map(|reply| reply.end) else { return Ok(None) };
            self.run(true, end.next());
        }
        Ok(self.output.replies.front().map(|reply| &*reply.bytes))
    }

    /// Removes the oldest reply.
    pub fn take_reply(&mut self) -> Option<Vec<u8>> {
        self.output.replies.pop_front().map(|reply| reply.bytes)
    }

    /// Reads the register at a byte offset in the last cycle, or as in reset; 0 where there is none.
    pub fn read(&self, offset: u32) -> u32 {
        self.device.read(offset)
    }

    /// Writes the register at a byte offset in the last cycle, after everything else in it.
    ///
    /// # Errors
    /// The device has not run.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), ClockedDeviceError> {
        if self.device.now() == Instant::RESET {
            return Err(ClockedDeviceError::NotRun);
        }
        self.device.write(offset, value, &mut self.output);
        Ok(())
    }

    fn run(&mut self, line: bool, until: Instant) {
        self.device.run(line, until, &mut self.output);
    }

    fn bit_times(&self) -> BitTimes {
        BitTimes::new(self.clock_hz, self.baud)
    }

    fn check_span(&self, name: &'static str, given: u64) -> Result<Instant, ClockedDeviceError> {
        let max = END_OF_TIME.saturating_sub(self.cycles());
        let is_possible = given <= max;
        let until = Instant(self.cycles().saturating_add(given));
        is_possible.then_some(until).ok_or(ClockedDeviceError::Range { name, given, min: 0, max })
    }

    /// Device time has an end, far behind that of any run.
    fn check_until(&self, name: &'static str, given: u64) -> Result<Instant, ClockedDeviceError> {
        let (min, max) = (self.cycles(), END_OF_TIME);
        let is_possible = (min..=max).contains(&given);
        is_possible.then_some(Instant(given)).ok_or(ClockedDeviceError::Range { name, given, min, max })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;
    use stepscope_peripheral::protocol::Kind;
    use stepscope_peripheral::wire::frame::emit;

    fn device(json: &str) -> ClockedDevice<Vec<Record>> {
        let experiment = Experiment::from_json(json).expect(json);
        ClockedDevice::new(&experiment, 0, Vec::new()).expect("it has a controller")
    }

    #[test]
    fn a_framed_device_replies_and_waits_for_no_reply_by_default() {
        let mut framed = device(r#"{"line":{"protocol":"framed","address":7}}"#);
        framed.run_until(2000, true).expect("it is later");
        let bit = framed.bit_times().bit(REPLY_BITS).0;
        let before = framed.cycles();
        assert_eq!(framed.await_reply(None), Ok(None));
        assert_eq!(framed.cycles(), before + bit);
        framed.send(&emit(7, Kind::Status as u8, &[])).expect("there is time");
        let waiting = framed.await_reply(Some(u64::MAX)).expect("no timeout").expect("a reply").to_vec();
        assert_eq!(waiting.last(), Some(&0));
        assert!(!framed.levels().has(Levels::DE));
        assert_eq!((framed.take_reply(), framed.take_reply()), (Some(waiting), None));
        assert_eq!(framed.digest().value(), Digest::of(framed.sink()));
    }

    #[test]
    fn refusals_name_the_argument_and_do_nothing() {
        let mut raw = device("{}");
        let check = |found: Result<(), ClockedDeviceError>, expected: &str| {
            let error = found.expect_err(expected);
            assert_eq!(alloc::format!("{}: {error}", error.name()), expected);
        };
        check(raw.write(0, 1), "device: no cycle has run; clock the device first");
        raw.run_until(5, true).expect("it is later");
        check(raw.run_until(4, true), "cycle: 4 is out of range; use 5 to 9000000000000000");
        check(
            raw.await_reply(Some(END_OF_TIME)).map(|_| ()),
            "timeout_cycles: 9000000000000000 is out of range; use 0 to 8999999999999995",
        );
        assert_eq!(raw.cycles(), 5);
        raw.run_until(2000, true).expect("it is later");
        raw.send(&[0x85]).expect("there is time");
        let max = raw.cycles_until_event().expect("a tick begins").0;
        check(raw.advance(max + 1), &alloc::format!("cycles: {} is out of range; use 0 to {max}", max + 1));
        let experiment = Experiment::from_json("{}").expect("no problems");
        let missing = ClockedDevice::new(&experiment, 1, ()).err().map(|error| error.to_string());
        assert_eq!(missing.as_deref(), Some("1 is out of range; use 0"));
    }
}
