//! Example firmware: a driver for the registers of the peripheral ([`stepscope_registers`]), without allocation or the
//! standard library. It runs unchanged on a chip and, in tests, on the model.
//!
//! A motion is a sequence of ticks with one command per channel. Call [`Driver::fill`] often enough that the queue never
//! runs empty.
//!
//! ```
//! use stepscope_firmware::{Driver, ChannelCommand};
//! use stepscope_registers::RegisterBus;
//!
//! fn one_turn<B: RegisterBus>(bus: B) -> Result<(), stepscope_firmware::Error> {
//!     let mut driver = Driver::new(bus)?;
//!     driver.wait_for_self_test();
//!     let mut ticks = (0..16).map(|_| [ChannelCommand::right(100), ChannelCommand::left(50)]);
//!     while driver.fill(&mut ticks)? != 0 {}
//!     while !driver.is_done()? {}
//!     Ok(())
//! }
//! ```
#![no_std]

use core::fmt;
use stepscope_registers::{
    RegisterBus, capabilities, control, faults, id, orders, position, push, result, slots, status, ticks_done,
};

/// Why an operation failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// No peripheral; the value of the ID register.
    NotFound(u32),
    /// The version of the register map is not 1.
    UnknownVersion(u32),
    /// The queue is full; try again.
    Full,
    /// More steps than slots per tick, or no such channel.
    TooManySteps,
    /// In the self-test or, for disable, during a tick; try again.
    Busy,
    /// Stopped; call [`Driver::enable`] first.
    Stopped,
    /// The peripheral returned an unknown result code.
    Unexpected(u32),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFound(id) => {
                write!(f, "no peripheral: ID is {id:#010x}, not {:#010x}", id::MAGIC_STEP)
            }
            Self::UnknownVersion(version) => {
                write!(f, "register map version {version} is unknown; use version 1")
            }
            Self::Full => f.write_str("the queue is full; try again"),
            Self::TooManySteps => {
                f.write_str("more steps than the tick has slots, or no such channel; use fewer")
            }
            Self::Busy => f.write_str("busy; try again"),
            Self::Stopped => f.write_str("stopped; call enable first"),
            Self::Unexpected(code) => write!(f, "unknown result code {code}"),
        }
    }
}

impl core::error::Error for Error {}

/// One channel's command for one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChannelCommand {
    /// Right (DIR high) or left; sets DIR even without steps.
    pub right: bool,
    /// Steps, 0 to the slots per tick.
    pub steps: u8,
}

impl ChannelCommand {
    /// Steps to the right, 0 to the slots per tick.
    pub const fn right(steps: u8) -> Self {
        Self { right: true, steps }
    }

    /// Steps to the left, 0 to the slots per tick.
    pub const fn left(steps: u8) -> Self {
        Self { right: false, steps }
    }

    /// `None` above 127 steps.
    const fn byte(self) -> Option<u8> {
        if self.steps > 127 { None } else { Some((self.right as u8) << 7 | self.steps) }
    }
}

/// A driver of the peripheral on the bus `B`.
#[derive(Debug)]
pub struct Driver<B> {
    bus: B,
}

impl<B: RegisterBus> Driver<B> {
    /// Checks that the peripheral is present.
    /// Errors: [`Error::NotFound`], [`Error::UnknownVersion`].
    pub fn new(mut bus: B) -> Result<Self, Error> {
        let found = bus.read(id::OFFSET);
        if found != id::MAGIC_STEP {
            return Err(Error::NotFound(found));
        }
        match capabilities::VERSION.extract(bus.read(capabilities::OFFSET)) {
            capabilities::VERSION_1 => Ok(Self { bus }),
            version => Err(Error::UnknownVersion(version)),
        }
    }

    /// The bus, for registers that this driver does not use.
    pub const fn bus(&mut self) -> &mut B {
        &mut self.bus
    }

    /// Waits until the self-test after reset has ended.
    pub fn wait_for_self_test(&mut self) {
        while status::STATE.extract(self.bus.read(status::OFFSET)) == status::STATE_BUSY {}
    }

    /// Number of channels, 1 to 16.
    pub fn channels(&mut self) -> u32 {
        capabilities::CHANNELS.extract(self.bus.read(capabilities::OFFSET))
    }

    /// Maximum steps per channel and tick, 1 to 127.
    pub fn slots(&mut self) -> u32 {
        self.bus.read(slots::OFFSET)
    }

    /// Enables the drivers and leaves STOPPED.
    pub fn enable(&mut self) -> Result<(), Error> {
        self.command(control::ENABLE.mask())
    }

    /// Disables the drivers.
    /// Errors: [`Error::Busy`] while a tick runs or waits.
    pub fn disable(&mut self) -> Result<(), Error> {
        self.command(control::DISABLE.mask())
    }

    /// Emergency stop: no pulses from the next cycle on, drivers off, queue cleared. A single write, safe in interrupts.
    pub fn stop(&mut self) {
        self.bus.write(control::OFFSET, control::STOP.mask());
    }

    /// Queues a tick; channels without a command do not move.
    /// Errors: [`Error::Full`], [`Error::TooManySteps`], [`Error::Busy`] in the self-test, [`Error::Stopped`].
    pub fn push(&mut self, tick: &[ChannelCommand]) -> Result<(), Error> {
        let channels = self.channels() as usize;
        if tick.len() > channels {
            return Err(Error::TooManySteps);
        }
        for (first, offset) in (0..channels).step_by(4).zip((orders::OFFSET..).step_by(4)) {
            let mut four = [0; 4];
            for (byte, command) in four.iter_mut().zip(tick.iter().skip(first)) {
                *byte = command.byte().ok_or(Error::TooManySteps)?;
            }
            self.bus.write(offset, u32::from_le_bytes(four));
        }
        self.bus.write(push::OFFSET, 0);
        self.result()
    }

    /// Fills the queue from `ticks`; returns the number of ticks added.
    /// Errors: like [`Self::push`] except [`Error::Full`]. The refused tick is taken from `ticks`.
    pub fn fill<const N: usize>(
        &mut self,
        ticks: &mut impl Iterator<Item = [ChannelCommand; N]>,
    ) -> Result<u32, Error> {
        let mut pushed = 0;
        while status::FREE.extract(self.bus.read(status::OFFSET)) > 0 {
            let Some(tick) = ticks.next() else { break };
            self.push(&tick)?;
            pushed += 1;
        }
        Ok(pushed)
    }

    /// Whether all ticks are done.
    /// Errors: [`Error::Stopped`]: remaining ticks never run.
    pub fn is_done(&mut self) -> Result<bool, Error> {
        let read = self.bus.read(status::OFFSET);
        match status::STATE.extract(read) {
            status::STATE_STOPPED => Err(Error::Stopped),
            _ => Ok(!status::MOVING.is_set(read)),
        }
    }

    /// Ticks done since reset, wrapping.
    pub fn ticks_done(&mut self) -> u32 {
        self.bus.read(ticks_done::OFFSET)
    }

    /// A channel's position in steps since reset; 0 if there is no such channel.
    pub fn position(&mut self, channel: u8) -> i32 {
        let offset = position::OFFSET + 4 * u32::from(channel);
        if offset < position::REGISTER.end() { self.bus.read(offset).cast_signed() } else { 0 }
    }

    /// Fault flags: bits of [`faults`].
    pub fn faults(&mut self) -> u32 {
        self.bus.read(faults::OFFSET)
    }

    /// Returns and clears the fault flags. A fault that occurs meanwhile stays.
    pub fn clear_faults(&mut self) -> u32 {
        let seen = self.faults();
        self.bus.write(faults::OFFSET, seen);
        seen
    }

    fn command(&mut self, command: u32) -> Result<(), Error> {
        self.bus.write(control::OFFSET, command);
        self.result()
    }

    fn result(&mut self) -> Result<(), Error> {
        match result::CODE.extract(self.bus.read(result::OFFSET)) {
            result::CODE_DONE => Ok(()),
            result::CODE_QUEUE_FULL => Err(Error::Full),
            result::CODE_TOO_MANY_STEPS => Err(Error::TooManySteps),
            result::CODE_BUSY => Err(Error::Busy),
            result::CODE_STOPPED => Err(Error::Stopped),
            code => Err(Error::Unexpected(code)),
        }
    }
}
