//! Raw packets (DESIGN A5, RU 2704486).
//!
//! A packet has one byte per channel, bit 7 the direction (1 = right), bits 6..=0 the number of steps; on an addressed
//! line the controller's address comes first. A pause of more than 45 bit times is a gap: the next byte begins a packet.
//!
//! ```
//! use stepscope_peripheral::wire::packet::ChannelCommand;
//!
//! let command = ChannelCommand { right: true, steps: 5 };
//! assert_eq!(command.emit(), Some(0x85));
//! assert_eq!(ChannelCommand::parse(0x85), command);
//! assert_eq!(ChannelCommand { right: true, steps: 128 }.emit(), None); // seven bits hold at most 127
//! ```

use crate::units::{Cycles, Instant};
use crate::{config::Config, signal::MAX_CHANNELS};

const RIGHT: u8 = 1 << 7;
pub const MAX_STEPS: u8 = RIGHT - 1;
/// Broadcast address.
pub const ALL: u8 = 255;
/// Maximum pause within a packet in bit times.
pub const GAP_BITS: u64 = 45;

/// One channel's command for one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelCommand {
    pub right: bool,
    /// Number of steps, 0..=127.
    pub steps: u8,
}

impl ChannelCommand {
    pub const fn parse(byte: u8) -> Self {
        Self { right: byte & RIGHT != 0, steps: byte & MAX_STEPS }
    }

    /// Encodes a byte; `None` above [`MAX_STEPS`].
    pub const fn emit(self) -> Option<u8> {
        let direction = if self.right { RIGHT } else { 0 };
        if self.steps > MAX_STEPS { None } else { Some(direction | self.steps) }
    }
}

/// One tick's commands, one byte per channel; unused channels have 0.
pub type Tick = [u8; MAX_CHANNELS];

/// A complete packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unpacked {
    Own(Tick),
    OtherAddress,
}

/// Assembles packets from bytes.
#[derive(Clone, Debug)]
pub struct Unpacker {
    /// Invariant: 1..=16.
    channels: u8,
    address: Option<u8>,
    gap: Cycles,
    /// Commands so far, and received bytes with the address.
    /// Invariant: fewer bytes than a packet.
    commands: Tick,
    received: u8,
    other_address: bool,
    /// After a framing error, until a gap.
    ignoring: bool,
    /// When the gap ends the packet.
    /// Invariant: [`Instant::NEVER`] exactly if no packet is open and nothing is ignored.
    deadline: Instant,
}

impl Unpacker {
    /// An unpacker for the packets of a raw line.
    pub const fn new(config: &Config) -> Self {
        Self {
            channels: config.channels(),
            address: config.packet_address(),
            gap: Cycles(GAP_BITS * config.bit().0 + 1),
            commands: [0; MAX_CHANNELS],
            received: 0,
            other_address: false,
            ignoring: false,
            deadline: Instant::NEVER,
        }
    }

    /// When a gap ends the packet; [`Instant::NEVER`] if no packet is open.
    pub const fn deadline(&self) -> Instant {
        self.deadline
    }

    /// Ends the packet at its [`Self::deadline`]; returns whether the gap cuts it short.
    pub const fn gap(&mut self) -> bool {
        debug_assert!(self.received > 0 || self.ignoring, "nothing is open that a gap could end");
        let short = self.received > 0;
        self.received = 0;
        self.ignoring = false;
        self.deadline = Instant::NEVER;
        short
    }

    /// A framing error in cycle `now` drops the packet, and bytes until a gap.
    pub fn framing_error(&mut self, now: Instant) {
        self.deadline = now + self.gap;
        self.received = 0;
        self.ignoring = true;
    }

    /// Takes a byte in cycle `now`; returns the packet it completes.
    pub fn byte(&mut self, now: Instant, byte: u8) -> Option<Unpacked> {
        self.deadline = now + self.gap;
        if self.ignoring {
            return None;
        }
        let addressed = u8::from(self.address.is_some());
        debug_assert!(self.received < self.channels + addressed, "the packet was complete before");
        if self.received == 0 {
            self.commands = [0; MAX_CHANNELS];
            self.other_address = self.address.is_some_and(|own| byte != own && byte != ALL);
        }
        if self.received >= addressed
            && let Some(command) = self.commands.get_mut(usize::from(self.received - addressed))
        {
            *command = byte;
        }
        self.received += 1;
        if self.received < self.channels + addressed {
            return None;
        }
        self.received = 0;
        self.deadline = Instant::NEVER;
        Some(if self.other_address { Unpacked::OtherAddress } else { Unpacked::Own(self.commands) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Bus, SerialLine};

    #[test]
    fn parse_and_emit_are_inverses() {
        for byte in 0..=255 {
            assert_eq!(ChannelCommand::parse(byte).emit(), Some(byte));
        }
        assert_eq!(ChannelCommand { right: true, steps: 128 }.emit(), None);
        assert_eq!(ChannelCommand::parse(0x85), ChannelCommand { right: true, steps: 5 });
    }

    /// Two channels, 11 cycles per bit.
    fn unpacker(address: Option<u8>) -> Unpacker {
        let line = SerialLine { baud: 100_000, address, ..SerialLine::default() };
        let bus = Bus { channels: 2, ..Bus::default() };
        Unpacker::new(&Config::new(1_100_000, &bus, &line).expect("a valid configuration"))
    }

    fn own(a: u8, b: u8) -> Option<Unpacked> {
        let mut tick = [0; MAX_CHANNELS];
        tick[..2].copy_from_slice(&[a, b]);
        Some(Unpacked::Own(tick))
    }

    #[test]
    fn a_packet_is_complete_with_its_last_byte() {
        let mut raw = unpacker(None);
        assert_eq!(raw.byte(Instant(10), 1), None);
        assert_eq!(raw.byte(Instant(20), 2), own(1, 2));
        assert_eq!(raw.deadline(), Instant::NEVER);
    }

    #[test]
    fn packets_for_other_addresses_are_skipped_by_their_length() {
        let mut addressed = unpacker(Some(7));
        let rows = [
            (7, None),
            (1, None),
            (2, own(1, 2)),
            (8, None),
            (7, None),
            (7, Some(Unpacked::OtherAddress)),
            (ALL, None),
            (3, None),
            (4, own(3, 4)),
        ];
        for (index, (byte, expected)) in rows.into_iter().enumerate() {
            assert_eq!(addressed.byte(Instant(index as u64), byte), expected, "byte {index}");
        }
    }

    #[test]
    fn a_gap_is_45_bits_and_one_cycle_after_the_last_byte() {
        let mut raw = unpacker(None);
        raw.byte(Instant(100), 1);
        assert_eq!(raw.deadline(), Instant(100 + 45 * 11 + 1));
        assert!(raw.gap());
        assert_eq!(raw.deadline(), Instant::NEVER);
    }

    #[test]
    fn after_a_framing_error_bytes_are_ignored_and_restart_the_gap() {
        let mut raw = unpacker(None);
        raw.byte(Instant(100), 1);
        raw.framing_error(Instant(200));
        assert_eq!(raw.byte(Instant(300), 2), None);
        assert_eq!(raw.deadline(), Instant(300 + 496));
        assert!(!raw.gap(), "no packet was open");
        raw.byte(Instant(1000), 3);
        assert_eq!(raw.byte(Instant(1100), 4), own(3, 4));
    }
}
