//! An additional controller on the line (DESIGN A9).

use crate::Hex;
use crate::schema::{PATENT, label, line::RECEIVER_BAUD, rows::settings};
use alloc::vec::Vec;
use stepscope_motion::moves::Axis;
use stepscope_peripheral::config::{Bus, limits};

settings! {
    /// `bus`, `line.address` and `line.receiver_baud` describe the first controller. All controllers share one line; each
    /// has its own bus, trace and digest. Addresses must differ, and on a raw line the first controller needs one too.
    /// Only with a line script may several controllers have the same address.
    ///
    /// On a raw line the packets of tick j are sent without pauses, in ascending address, from boot + 1 + j*M*Ts (boot is
    /// the longest self-test), so all controllers need the same tick length and the same number of channels. On a framed
    /// line each controller starts with its first frame.
    pub struct Controller {
        /// Address, different for each controller.
        pub address: u8 = 1 => label("Address").whole(limits::ADDRESS)
            .term("Address", "Number of a controller on a shared line. A controller accepts packets that begin with its own address or with 255.")
            .from(PATENT),
        /// Bit rate of its receiver and its replies, if its clock differs from the host's.
        pub receiver_baud: Option<u32> = None => RECEIVER_BAUD,
        /// Driver bus and queue.
        pub bus: Bus = Bus::default() => label("Driver bus"),
        /// Axes, if the source is a motion.
        pub axes: Vec<Axis> = Vec::new() => label("Axes").range_text("up to its number of channels"),
        /// Packets, if the source is packets.
        pub packets: Vec<Hex> = Vec::new() => label("One packet per line")
            .range_text("as in `source.packets`")
            .term("Packet", "What the host sends for one tick: one byte per motor, with the direction in bit 7 and the number of steps in bits 6 to 0.")
            .from(PATENT),
    }
}

impl Controller {
    /// Whether it has axes or packets.
    pub fn is_busy(&self) -> bool {
        !self.axes.is_empty() || !self.packets.is_empty()
    }
}
