//! An additional controller on the line (DESIGN A9).

use crate::{
    Hex,
    schema::{OWN, PATENT, label, rows::settings},
};
use alloc::vec::Vec;
use stepscope_motion::moves::Axis;
use stepscope_peripheral::config::{Bus, limits};

settings! {
    /// The first controller is described by `bus`, `line.address` and `line.receiver_baud`. Each has its own bus, trace
    /// and digest; all hear one line. Addresses differ, and on a raw line the first controller needs one too; only with
    /// a line script may several have one address.
    ///
    /// On a raw line the packets of tick j are sent back to back, in ascending address, from boot + 1 + j*M*Ts (boot is
    /// the longest self-test); so all ticks have one length, and all controllers as many channels, because a raw packet
    /// for another is consumed by its length. On a framed line each controller starts when its first frame has come.
    pub struct Controller {
        /// Its address, which no other controller has.
        pub address: u8 = 1 => label("Address")
            .whole(limits::ADDRESS)
            .term("Address", "Number of a controller on a line that several share. All hear everything; each takes what begins with its own number or with 255.")
            .from(PATENT),
        /// Bit rate of its receiver and of its replies, where its clock differs from the host's.
        pub receiver_baud: Option<u32> = None => label("Receiver's rate")
            .unit("baud")
            .follows("1 to 2*`clock_hz`/21")
            .empty("the same as the host's")
            .term("Receiver's rate", "Two clocks never agree. When the receiver's bits are some 5 % longer or shorter, it looks for the stop bit in the wrong place.")
            .from(OWN),
        /// Its driver bus and queue.
        pub bus: Bus = Bus::default() => label("Driver bus"),
        /// What its axes do, where the source is a motion.
        pub axes: Vec<Axis> = Vec::new() => label("Axes").follows("none to its channels"),
        /// What it is sent, where the source is packets.
        pub packets: Vec<Hex> = Vec::new() => label("Packets, one a line")
            .follows("as in `source.packets`")
            .term("Packet", "What the host sends for one tick: a byte a motor, bit 7 the direction, bits 6 to 0 the number of steps.")
            .from(PATENT),
    }
}

impl Controller {
    /// Whether it has something to do.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.axes.is_empty() || !self.packets.is_empty()
    }
}
