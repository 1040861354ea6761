//! The serial line, its host and its faults (DESIGN A4 to A6, A9).

use crate::END_OF_TIME;
use crate::schema::rows::{settings, words};
use crate::schema::{Field, OWN, PATENT, label};
use alloc::vec::Vec;
use core::ops::RangeInclusive;
use stepscope_peripheral::config::{Protocol, SerialLine, limits};
use stepscope_peripheral::protocol::MAX_TICKS;

const MAX_GLITCHES: usize = 10_000;
const PPM: RangeInclusive<u64> = 0..=1_000_000;

/// The row of `receiver_baud`, for the first and for additional controllers.
pub(super) const RECEIVER_BAUD: Field = label("Receiver bit rate")
    .unit("baud")
    .range_text("1 to 2*`clock_hz`/21")
    .null_means("same as the host")
    .term("Receiver bit rate", "The receiver has its own clock. If its bit rate is about 5 % off, it samples the stop bit at the wrong time.")
    .from(OWN);

settings! {
    /// RS-485, half duplex, 8N1. A bit of the receiver must last at least 11 cycles.
    pub struct Line {
        /// Bit rate of the host, 8N1; at least 11 clock cycles per bit.
        pub baud: u32 = 115_200 => label("Bit rate").unit("baud").range_text("1 to `clock_hz`")
            .term("Bit rate", "Bits per second on the line. A byte takes ten bits.")
            .from(PATENT),
        /// Bit rate of the receiver, if its clock differs from the host's.
        pub receiver_baud: Option<u32> = None => RECEIVER_BAUD,
        /// Address of the controller, if packets begin with one; 255 addresses all.
        pub address: Option<u8> = None => label("Address").whole(limits::ADDRESS)
            .null_means("raw packets have no address; a framed controller has address 0")
            .term("Address", "Number of a controller on a shared line. A controller accepts packets that begin with its own address or with 255.")
            .from(PATENT),
        /// Framing protocol.
        pub protocol: Protocol = Protocol::Raw => label("Protocol")
            .term("Protocol", "Raw packets have no checksum: a flipped bit moves a motor unnoticed. Frames have a CRC, are acknowledged, and are repeated until they are.")
            .from(PATENT),
        /// Host of a framed line.
        pub host: Host = Host::default() => label("Host of a framed line"),
        /// Random faults of the line and the host.
        pub noise: Noise = Noise::default() => label("Noise"),
        /// Levels forced on the line. If two overlap, the later entry wins.
        pub glitches: Vec<Glitch> = Vec::new() => label("Glitches").length(0..=MAX_GLITCHES, "glitches"),
    }
}

words! {
    Protocol {
        Raw = "raw", "raw": "bytes and pauses (RU 2704486), without checksum and reply";
        Framed = "framed", "framed": "each frame has a CRC and a sequence number, and is repeated until it is acknowledged";
    }
}

settings! {
    /// The host sends a frame, waits for its reply, and sends the next. It keeps the queue filled, repeats a frame without
    /// a reply, and ends with a tick without steps.
    pub struct Host {
        /// Maximum ticks per frame. At most half of the queue is sent at once.
        pub ticks_per_frame: u8 = 8 => label("Ticks per frame").unit("ticks").whole(1..=MAX_TICKS as u64)
            .term("Ticks per frame", "More ticks per frame leave more time for the reply, but need a deeper queue.")
            .from(OWN).when_at("line.protocol", "framed"),
        /// Maximum time from the end of the frame to the end of the reply. Ten bit times later the frame is sent again. The
        /// longer reply to POSITIONS has ten bit times more per additional byte.
        pub reply_timeout_cycles: Option<u32> = None => label("Reply timeout").unit("cycles")
            .whole(1..=u32::MAX as u64)
            .null_means("256 bit times")
            .term("Reply timeout", "Without a complete reply in this time the frame is sent again with the same sequence number, so it is not executed twice.")
            .from(OWN).when_at("line.protocol", "framed"),
        /// Attempts per frame before the host gives up.
        pub max_attempts: u8 = 10 => label("Max attempts").whole(1..=255)
            .term("Max attempts", "After this many attempts without a reply the host gives up on the controller.")
            .from(OWN).when_at("line.protocol", "framed"),
    }
}

settings! {
    /// Each rate is in millionths. The same seed gives the same faults. "Both directions" means the bytes of the host and,
    /// on a framed line, of the replies.
    pub struct Noise {
        /// Random seed.
        pub seed: u32 = 0 => label("Seed")
            .term("Seed", "Seed of the random faults. The same seed gives the same faults on every machine.")
            .from(OWN),
        /// Flipped bits, of all bits in both directions.
        pub flipped_bits_ppm: u32 = 0 => label("Bits flipped").unit("ppm").whole(PPM)
            .term("Bits flipped", "A 0 is received as a 1 or vice versa, for example because of interference.")
            .from(OWN),
        /// Lost bytes, of all bytes in both directions.
        pub lost_bytes_ppm: u32 = 0 => label("Bytes lost").unit("ppm").whole(PPM)
            .term("Bytes lost", "A byte never arrives, for example because a buffer overflows.")
            .from(OWN),
        /// Duplicated bytes, of all bytes in both directions.
        pub duplicated_bytes_ppm: u32 = 0 => label("Bytes duplicated").unit("ppm").whole(PPM)
            .term("Bytes duplicated", "A byte arrives twice, for example because a converter repeats it.")
            .from(OWN),
        /// Levels forced for up to two bit times, of all bytes of the host.
        pub glitches_ppm: u32 = 0 => label("Glitches").unit("ppm").whole(PPM)
            .term("Glitches", "Short wrong levels on the line. A glitch shorter than half a bit is not a start bit.")
            .from(OWN),
        /// Replies that the host does not receive, of all replies.
        pub lost_replies_ppm: u32 = 0 => label("Replies lost").unit("ppm").whole(PPM)
            .term("Replies lost", "The controller executes the frame, but the host does not receive the reply. Sequence numbers handle this case.")
            .from(OWN),
        /// Crashes of the host during a frame (on a raw line: a packet), of all frames. After the restart the host
        /// has lost its state, and starts again from its list of commands.
        pub host_crashes_ppm: u32 = 0 => label("Host restarts").unit("ppm").whole(PPM)
            .term("Host restarts", "The host crashes in the middle of a frame and restarts. The incomplete frame must not damage the following ones.")
            .from(OWN),
    }
}

settings! {
    /// A level forced on the line: a glitch, a break, a wrong bit.
    pub struct Glitch {
        /// First forced cycle.
        pub start_cycle: u64 = 1 => label("Start").unit("cycles").whole(1..=END_OF_TIME - 1)
            .term("Start", "First cycle, counted from reset."),
        /// Length of the forced level.
        pub length_cycles: u64 = 1 => label("Length").unit("cycles")
            .range_text("from 1, ending within 9*10^15")
            .term("Length", "Number of cycles with the forced level.")
            .from(OWN),
        /// Forced level.
        pub level: u8 = 0 => label("Level").whole(0..=1)
            .term("Level", "Forced level of the line. A long 0 is a break: the stop bit is missing, and the receiver reports a framing error.")
            .from(OWN),
    }
}

impl Line {
    /// The line of the first controller.
    pub const fn serial(&self) -> SerialLine {
        SerialLine {
            baud: self.baud,
            receiver_baud: self.receiver_baud,
            address: self.address,
            protocol: self.protocol,
        }
    }
}
