//! Executes the commands of frames (DESIGN A6), raw packets (A5) and registers: queue and sequencer, EN, STOPPED, faults.
//! A command is executed in a cycle p after everything else in it; EN, STEP and tick starts follow from p + 1 on.

use crate::device::{Faults, sequencer::Sequencer, transceiver::Transceiver};
use crate::protocol::{Reason, State, Status};
use crate::{config::Config, units::Instant, wire::packet::ChannelCommand};

#[derive(Clone, Debug)]
pub(super) struct Executor {
    slots: u8,
    boot: Instant,
    /// From STOP or DISABLE to ENABLE, during which no tick is accepted.
    /// Invariant: while set, no tick runs or waits.
    stopped: bool,
    pub(super) transceiver: Transceiver,
    pub(super) sequencer: Sequencer,
    faults: Faults,
}

impl Executor {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            slots: config.slots(),
            boot: config.boot(),
            stopped: false,
            transceiver: Transceiver::new(config),
            sequencer: Sequencer::new(config),
            faults: Faults::default(),
        }
    }

    /// Checks whether `ticks` ticks with these commands can be queued in cycle `now`: all or none.
    pub(super) fn admit(&mut self, now: Instant, commands: &[u8], ticks: usize) -> Result<(), Reason> {
        self.assert_idle_if_stopped();
        if self.stopped {
            Err(Reason::Stopped)
        } else if now < self.boot {
            Err(Reason::Busy)
        } else if commands.iter().any(|&byte| ChannelCommand::parse(byte).steps > self.slots) {
            self.faults.set(Faults::TOO_MANY_STEPS);
            Err(Reason::TooManySteps)
        } else if ticks > usize::from(self.sequencer.free()) {
            self.faults.set(Faults::QUEUE_OVERFLOW);
            Err(Reason::QueueFull)
        } else {
            Ok(())
        }
    }

    pub(super) fn stop(&mut self, now: Instant) {
        self.transceiver.enable(now, false);
        self.sequencer.stop(now);
        self.stopped = true;
    }

    pub(super) fn enable(&mut self, now: Instant) {
        self.transceiver.enable(now, true);
        self.stopped = false;
    }

    /// Disables the drivers if nothing moves; returns whether it did.
    pub(super) fn disable(&mut self, now: Instant) -> bool {
        let idle = !self.sequencer.is_moving();
        if idle {
            self.transceiver.enable(now, false);
            self.stopped = true;
        }
        idle
    }

    fn assert_idle_if_stopped(&self) {
        debug_assert!(!(self.stopped && self.sequencer.is_moving()), "a tick runs or waits while stopped");
    }

    /// Changes the timing; the caller has checked that no tick runs or waits.
    pub(super) fn retime(&mut self, config: &Config) {
        self.slots = config.slots();
        self.sequencer.retime(config);
    }

    pub(super) const fn faults(&self) -> Faults {
        self.faults.union(self.sequencer.faults())
    }

    pub(super) const fn fault(&mut self, fault: Faults) {
        self.faults.set(fault);
    }

    pub(super) fn clear_faults(&mut self, which: Faults) {
        self.faults.clear(which);
        self.sequencer.clear_faults(which);
    }

    pub(super) fn status(&self, now: Instant, expected_seq: u8) -> Status {
        self.assert_idle_if_stopped();
        let state = if self.stopped {
            State::Stopped
        } else if now < self.boot {
            State::Busy
        } else if self.sequencer.is_moving() {
            State::Moving
        } else {
            State::Ready
        };
        Status {
            state,
            free: self.sequencer.free(),
            expected_seq,
            faults: self.faults().bits(),
            ticks_done: self.sequencer.ticks_done(),
        }
    }
}
