//! The serial line, its host and its faults (DESIGN A4 to A6, A9).

use crate::{
    END_OF_TIME,
    schema::{
        OWN, PATENT, label,
        rows::{settings, words},
    },
};
use alloc::vec::Vec;
use core::ops::RangeInclusive;
use stepscope_peripheral::{
    config::{Protocol, SerialLine, limits},
    protocol::MAX_TICKS,
};

const MAX_GLITCHES: usize = 10_000;
const PPM: RangeInclusive<u64> = 0..=1_000_000;

settings! {
    /// The line is RS-485, half duplex, 8N1. The receiver's bit (its rate, or the host's where it has none of its own)
    /// must last at least 11 cycles.
    pub struct Line {
        /// Bit rate of the host, 8N1; at least 11 clock cycles a bit.
        pub baud: u32 = 115_200 => label("Bit rate")
            .unit("baud")
            .follows("1 to `clock_hz`")
            .term("Bit rate", "Bits a second on the line; a byte takes ten of them.")
            .from(PATENT),
        /// Bit rate of the receiver, where its clock differs from the host's.
        pub receiver_baud: Option<u32> = None => label("Receiver's rate")
            .unit("baud")
            .follows("1 to 2*`clock_hz`/21")
            .empty("the same as the host's")
            .term("Receiver's rate", "Two clocks never agree. When the receiver's bits are some 5 % longer or shorter, it looks for the stop bit in the wrong place.")
            .from(OWN),
        /// The controller's address, if packets begin with one; 255 addresses all.
        pub address: Option<u8> = None => label("Address")
            .whole(limits::ADDRESS)
            .empty("none: raw packets then begin with no address, and a framed controller has 0")
            .term("Address", "Number of a controller on a line that several share. All hear everything; each takes what begins with its own number or with 255.")
            .from(PATENT),
        /// What stands around the orders.
        pub protocol: Protocol = Protocol::Raw => label("Protocol")
            .term("Protocol", "Raw packets carry no check: one flipped bit moves a motor, and nobody notices. Frames are checked, answered and sent again until they are answered.")
            .from(PATENT),
        /// How the host of a framed line behaves.
        pub host: Host = Host::default() => label("Host of a framed line"),
        /// Random faults of the line and of the host.
        pub noise: Noise = Noise::default() => label("Noise"),
        /// Levels forced on the line whatever is sent; where two overlap the later entry wins.
        pub glitches: Vec<Glitch> = Vec::new() => label("Glitches").length(0..=MAX_GLITCHES, "glitches"),
    }
}

words! {
    Protocol {
        /// bytes and pauses, as in RU 2704486, with no check and no answer
        Raw = "raw", "raw";
        /// each frame has a check and a sequence number, is answered, and is repeated until it is
        Framed = "framed", "framed";
    }
}

settings! {
    /// One frame, its reply, the next; docs/decisions.md has the policy. The host keeps the queue filled from what
    /// replies tell of free places, repeats a frame that is not answered, and ends with a tick without steps.
    pub struct Host {
        /// Most ticks in one frame; at most half of the queue is sent at once.
        pub ticks_per_frame: u8 = 8 => label("Ticks in a frame")
            .unit("ticks")
            .whole(1..=MAX_TICKS as u64)
            .term("Ticks in a frame", "More ticks in a frame leave more time for its reply, and need a deeper queue.")
            .from(OWN)
            .when_at("line.protocol", "framed"),
        /// How long a reply is waited for, from the end of the frame to the end of the reply; ten bit times later the
        /// frame is sent again. The reply to POSITIONS, which is longer, has ten bit times more for each further byte.
        pub reply_timeout_cycles: Option<u32> = None => label("Reply time-out")
            .unit("cycles")
            .whole(1..=u32::MAX as u64)
            .empty("256 bit times")
            .term("Reply time-out", "When no whole reply has come by then, the frame is sent again with the same seq, so that nothing is done twice.")
            .from(OWN)
            .when_at("line.protocol", "framed"),
        /// How often one frame is sent before the host gives up.
        pub attempts: u8 = 10 => label("Attempts")
            .whole(1..=255)
            .term("Attempts", "After so many without an answer the host gives the controller up.")
            .from(OWN)
            .when_at("line.protocol", "framed"),
    }
}

settings! {
    /// Each rate is in millionths. The same seed gives the same faults. "Both ways" is the host's bytes and, on a framed
    /// line, the replies.
    pub struct Noise {
        /// Where the random numbers begin.
        pub seed: u32 = 0 => label("Seed")
            .term("Seed", "Where the random numbers of the noise begin: chance that can be repeated exactly, on any machine.")
            .from(OWN),
        /// Bits that are flipped, of all bits of all bytes, both ways.
        pub flipped_bits_ppm: u32 = 0 => label("Bits flipped")
            .unit("ppm")
            .whole(PPM)
            .term("Bits flipped", "A 0 is heard as a 1 or the other way round, as by a disturbance near the cable.")
            .from(OWN),
        /// Bytes that are left out, of all bytes, both ways.
        pub lost_bytes_ppm: u32 = 0 => label("Bytes lost")
            .unit("ppm")
            .whole(PPM)
            .term("Bytes lost", "A byte that never arrives, as when a buffer runs over.")
            .from(OWN),
        /// Bytes that come twice, of all bytes, both ways.
        pub duplicated_bytes_ppm: u32 = 0 => label("Bytes duplicated")
            .unit("ppm")
            .whole(PPM)
            .term("Bytes duplicated", "A byte that arrives twice, as after a clumsy repetition in a converter.")
            .from(OWN),
        /// Levels forced on the line for up to two bit times, of all bytes of the host.
        pub glitches_ppm: u32 = 0 => label("Glitches")
            .unit("ppm")
            .whole(PPM)
            .term("Glitches", "Short wrong levels on the line. One of less than half a bit is not taken for a start bit.")
            .from(OWN),
        /// Replies that the host does not hear, of all replies.
        pub lost_replies_ppm: u32 = 0 => label("Replies lost")
            .unit("ppm")
            .whole(PPM)
            .term("Replies lost", "The controller has done it but the host does not hear so: the case for which frames have a seq.")
            .from(OWN),
        /// Frames (on a raw line: packets) within which the host crashes, of all of them; it restarts and remembers
        /// nothing but its orders.
        pub host_crashes_ppm: u32 = 0 => label("Host restarts")
            .unit("ppm")
            .whole(PPM)
            .term("Host restarts", "The program that sends crashes in the middle of a frame and starts again: the next frames must not be harmed by the first half.")
            .from(OWN),
    }
}

settings! {
    /// A level forced on the line: a glitch, a break, a broken bit.
    pub struct Glitch {
        /// First forced cycle.
        pub start_cycle: u64 = 1 => label("Start")
            .unit("cycles")
            .whole(1..=END_OF_TIME - 1)
            .term("Start", "Cycle of the controller's clock, counted from reset, in which this begins."),
        /// For how many cycles.
        pub length_cycles: u64 = 1 => label("Length")
            .unit("cycles")
            .follows("from 1, ending within 9*10^15")
            .term("Length", "For how many cycles the line is forced.")
            .from(OWN),
        /// Forced on the line whatever is sent; the later entry wins.
        pub level: u8 = 0 => label("Level")
            .whole(0..=1)
            .term("Level", "The level that the line has meanwhile. A long 0 is a break: no stop bit comes, and the receiver reports a framing error.")
            .from(OWN),
    }
}

impl Line {
    /// What the scenario's own controller has to know of the line.
    #[must_use]
    pub const fn serial(&self) -> SerialLine {
        SerialLine {
            baud: self.baud,
            receiver_baud: self.receiver_baud,
            address: self.address,
            protocol: self.protocol,
        }
    }
}
