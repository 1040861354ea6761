//! The registers for firmware on the same chip ([`stepscope_registers`]; DESIGN A6, A7).
//!
//! An access happens in the last clocked cycle p, after everything else in it. It reads the state in p; EN, STEP and tick
//! starts follow from p + 1 on, as after a frame that ends in p.

use crate::config::{Config, DirLine, Protocol};
use crate::device::{Device, Faults, Framing, latches::Timing};
use crate::protocol::{Reason, State};
use crate::signal::{Event, Levels, MAX_CHANNELS, Sink};
use crate::units::Instant;
use core::ops::BitOr;
use stepscope_registers as map;

const _: () = assert!(map::position::REGISTER.count as usize == MAX_CHANNELS);
const _: () = assert!(map::orders::REGISTER.count as usize * 4 == MAX_CHANNELS);
const _: () = {
    use map::result;
    assert!(Reason::QueueFull as u32 == result::CODE_QUEUE_FULL);
    assert!(Reason::TooManySteps as u32 == result::CODE_TOO_MANY_STEPS);
    assert!(Reason::Busy as u32 == result::CODE_BUSY);
    assert!(Reason::Stopped as u32 == result::CODE_STOPPED);
    assert!(State::Busy as u32 == map::status::STATE_BUSY && State::Ready as u32 == map::status::STATE_READY);
    assert!(State::Moving as u32 == map::status::STATE_MOVING);
    assert!(State::Stopped as u32 == map::status::STATE_STOPPED);
};

fn index(register: &map::table::Register, offset: u32) -> Option<usize> {
    let within = register.offset <= offset && offset < register.end() && offset.is_multiple_of(4);
    within.then_some((offset.wrapping_sub(register.offset) / 4) as usize)
}

impl Device {
    /// Reads the register at the byte offset in the last clocked cycle; 0 if there is none.
    pub fn read(&self, offset: u32) -> u32 {
        let (latches, config) = (&self.latches, &self.latches.config);
        if let Some(index) = index(&map::position::REGISTER, offset) {
            return self.positions().get(index).map_or(0, |position| position.cast_unsigned());
        }
        if let Some(index) = index(&map::orders::REGISTER, offset) {
            return latches.commands(index);
        }
        match offset {
            map::id::OFFSET => map::id::MAGIC_STEP,
            map::capabilities::OFFSET => capabilities(config),
            map::clock_hz::OFFSET => config.clock_hz(),
            map::boot::OFFSET => config.boot().0 as u32,
            map::result::OFFSET => latches.result,
            map::status::OFFSET => self.status_register(),
            map::faults::OFFSET => self.faults().bits().into(),
            map::ticks_done::OFFSET => self.ticks_done(),
            _ => {
                let mut timing = latches.timing;
                timing.register(offset).map_or(0, |value| *value)
            }
        }
    }

    /// Writes the register at the byte offset in the last clocked cycle, after everything else in it. Ignored before
    /// cycle 0 and if no register there is writable.
    pub fn write(&mut self, offset: u32, value: u32, sink: &mut impl Sink) {
        if self.now == Instant::RESET {
            return;
        }
        // `finish` must not set a time before an access.
        self.last_active = self.last_cycle();
        if let Some(index) = index(&map::orders::REGISTER, offset) {
            return self.latches.set_commands(index, value);
        }
        match offset {
            map::control::OFFSET => self.command(value, sink),
            map::push::OFFSET => self.push(sink),
            map::faults::OFFSET => self.executor.clear_faults(Faults::from_bits(value as u16)),
            map::mode::OFFSET => {
                self.latches.timing.mode =
                    value & (map::mode::DISTRIBUTION.mask() | map::mode::PULSES.mask());
            }
            _ => {
                if let Some(register) = self.latches.timing.register(offset) {
                    *register = value;
                }
            }
        }
    }

    /// Executes the highest command bit of CONTROL.
    fn command(&mut self, value: u32, sink: &mut impl Sink) {
        let now = self.last_cycle();
        self.latches.result = if map::control::STOP.is_set(value) {
            self.executor.stop(now);
            sink.event(now, Event::Stopped);
            map::result::CODE_DONE
        } else if map::control::DISABLE.is_set(value) {
            if self.executor.disable(now) { map::result::CODE_DONE } else { Reason::Busy as u32 }
        } else if map::control::ENABLE.is_set(value) {
            self.executor.enable(now);
            map::result::CODE_DONE
        } else if map::control::COMMIT.is_set(value) {
            self.retime()
        } else {
            return;
        };
    }

    /// Applies the latched timing; returns the code for RESULT.
    fn retime(&mut self) -> u32 {
        if self.executor.sequencer.is_moving() {
            return Reason::Busy as u32;
        }
        let Some(config) = self.latches.timing.apply(&self.latches.config) else {
            return map::result::CODE_BAD_TIMING;
        };
        self.executor.retime(&config);
        self.latches.config = config;
        map::result::CODE_DONE
    }

    fn push(&mut self, sink: &mut impl Sink) {
        let (now, commands) = (self.last_cycle(), self.latches.commands);
        self.latches.result = match self.executor.admit(now, &commands, 1) {
            Ok(()) => {
                self.executor.sequencer.push(now, commands);
                sink.event(now, Event::Pushed);
                map::result::CODE_DONE
            }
            Err(reason) => reason as u32,
        };
    }

    fn status_register(&self) -> u32 {
        use map::status::{EN, EXPECTED_SEQ, FREE, MOVING, PENDING, STATE};
        let expected_seq = match &self.framing {
            Framing::Framed(controller) => controller.expected_seq(),
            Framing::Raw(_) => 0,
        };
        let status = self.executor.status(self.last_cycle(), expected_seq);
        let pending = self.latches.timing != Timing::of(&self.latches.config);
        with_fields([
            STATE.insert(status.state as u32),
            FREE.insert(status.free.into()),
            EXPECTED_SEQ.insert(expected_seq.into()),
            MOVING.insert(self.executor.sequencer.is_moving().into()),
            EN.insert((self.executor.transceiver.levels() & Levels::EN != 0).into()),
            PENDING.insert(pending.into()),
        ])
    }
}

fn capabilities(config: &Config) -> u32 {
    use map::capabilities::{CHANNELS, DIR_LINE, PROTOCOL, QUEUE_DEPTH, VERSION};
    let dir_line = match config.bus().dir_line {
        DirLine::PerChannel => map::capabilities::DIR_LINE_PER_CHANNEL,
        DirLine::Common => map::capabilities::DIR_LINE_COMMON,
    };
    let protocol = match config.protocol() {
        Protocol::Raw => map::capabilities::PROTOCOL_RAW,
        Protocol::Framed => map::capabilities::PROTOCOL_FRAMED,
    };
    with_fields([
        VERSION.insert(map::capabilities::VERSION_1),
        CHANNELS.insert(config.channels().into()),
        QUEUE_DEPTH.insert(config.queue_depth().into()),
        DIR_LINE.insert(dir_line),
        PROTOCOL.insert(protocol),
    ])
}

/// The register with these fields, each at its position.
fn with_fields<const COUNT: usize>(fields: [u32; COUNT]) -> u32 {
    fields.into_iter().fold(0, u32::bitor)
}

#[cfg(test)]
mod tests;
