//! What the host sends, or the peripheral runs (DESIGN Part B, A8, A9).

use crate::{
    END_OF_TIME, Hex, SegmentLists,
    schema::{
        OWN, PATENT, SONOBE, label,
        rows::{choices, settings, words},
    },
};
use crate::{StandAlone, schema::ZHANG};
use alloc::{vec, vec::Vec};
use stepscope_motion::moves::Axis;
use stepscope_peripheral::{
    units::Instant,
    wire::{Schedule, frame::encode_frame},
};

choices! {
    /// One of five kinds, with what is in it. At most 4 MiB of bytes in packets or sends.
    pub enum Source {
        /// Moves in steps, mm or degrees, that the host divides into ticks or segments.
        Motion(Motion) = "motion" => label("Motion of axes"),
        /// The packets themselves, one a tick.
        Packets(Packets) = "packets" => label("Packets in hex").from(PATENT),
        /// Bytes at cycles: what was recorded of a real line can be replayed.
        Line(LineScript) = "line" => label("Line script").from(OWN),
        /// Controllers with buttons, a program and a memory; nothing is sent.
        Standalone(Vec<StandAlone>) = "standalone" => label("Stand-alone controller").from(ZHANG),
        /// Tables that a controller runs by itself; nothing is sent.
        Segments(SegmentLists) = "segments" => label("Lists of segments").from(SONOBE),
    }
}

impl Default for Source {
    fn default() -> Self {
        Self::Motion(Motion::default())
    }
}

settings! {
    /// Axis i drives channel i. With `"ticks"` the host sends one packet a tick, paced, so that tick follows tick without
    /// a pause; on an addressed line it writes `line.address` before each. There are at most 2 000 000 ticks.
    ///
    /// With `"segments"` nothing is sent: the peripheral runs a list of segments, each step at cycle 1 +
    /// floor(t*`clock_hz` + 1/2). Then all axes together have at most 4 000 000 steps, and no step may come sooner than
    /// W + max(H + D, 1) cycles after the one before, the first after the start. A motion lasts at most 10^6 s;
    /// docs/decisions.md has the other bounds on the work of one scenario.
    pub struct Motion {
        /// The axes, each with its mechanics and its moves.
        pub axes: Vec<Axis> = vec![Axis::default()] => label("Axes").follows("1 to 16, no more than `bus.channels`"),
        /// Who makes the steps.
        pub engine: MotionEngine = MotionEngine::Ticks => label("Step generation")
            .term("Step generation", "With ticks the host says how many steps each tick has, as in the patent. With segments the controller runs the move alone, from a table of intervals, as in the other documents.")
            .from(PATENT),
    }
}

/// What runs a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotionEngine {
    /// The tick path: the host sends the steps of each tick (DESIGN A7, B7).
    #[default]
    Ticks,
    /// The segment engine: each step at the cycle in which it falls due (DESIGN A8, B8).
    Segments,
}

words! {
    MotionEngine {
        /// the host sends the steps of each tick, in which they fall due
        Ticks = "ticks", "ticks";
        /// nothing is sent; the peripheral makes each step in the cycle in which it falls due
        Segments = "segments", "segments";
    }
}

settings! {
    /// Each packet has `bus.channels` bytes, on an addressed raw line one more, first: the address. On a framed line they
    /// go into frames of several ticks.
    pub struct Packets {
        /// In hex, one packet a tick, a byte a channel: bit 7 is the direction (1 right), bits 6 to 0 the steps.
        pub packets: Vec<Hex> = Vec::new() => label("Packets, one a line")
            .follows("`bus.channels` bytes each, one more with an address")
            .term("Packet", "What the host sends for one tick: a byte a motor, bit 7 the direction, bits 6 to 0 the number of steps.")
            .from(PATENT),
    }
}

settings! {
    /// So a recorded byte stream can be replayed; `{ "start_cycle": 2000, "frame": "0505" }` stops controller 5 at once.
    pub struct LineScript {
        /// Rising in time, not overlapping.
        pub sends: Vec<ScriptedSend> = Vec::new() => label("Sends").follows("at most 4 MiB of bytes in all"),
    }
}

settings! {
    /// Bytes that are sent back to back from a cycle on; or a frame in their place.
    pub struct ScriptedSend {
        /// Cycle in which the first start bit falls.
        pub start_cycle: u64 = 1 => label("Start")
            .unit("cycles")
            .whole(1..=END_OF_TIME - 1)
            .term("Start", "Cycle of the controller's clock, counted from reset, in which this begins."),
        /// Bytes in hex, sent back to back.
        pub bytes: Hex = Hex::default() => label("Bytes")
            .term("Bytes", "What goes over the line, each byte as a start bit, eight data bits with the lowest first, and a stop bit."),
        /// In place of bytes: address, kind and body in hex, such as `ff 05` (STOP for all); CRC, COBS and the delimiter
        /// are added.
        pub frame: Option<Hex> = None => label("Or a frame")
            .empty("the bytes are sent")
            .term("Frame", "Address, kind and body between two zero bytes, with a checksum. COBS takes the zeros out of the inside, so that an end can always be found again.")
            .from(OWN)
            .when_at("line.protocol", "framed"),
    }
}

impl Source {
    /// Whether the host sends ticks of it.
    #[must_use]
    pub const fn is_ticks(&self) -> bool {
        !matches!(self, Self::Line(_)) && !self.runs_alone()
    }

    /// Whether segments run it, and not ticks.
    #[must_use]
    pub const fn runs_segments(&self) -> bool {
        matches!(self, Self::Segments(_) | Self::Motion(Motion { engine: MotionEngine::Segments, .. }))
    }

    /// Whether nothing is sent: segments run it, or controllers of their own.
    #[must_use]
    pub const fn runs_alone(&self) -> bool {
        if let Self::Standalone(_) = self {
            return true;
        }
        self.runs_segments()
    }
}

impl LineScript {
    /// The host's schedule that the script is (A9).
    #[must_use]
    pub fn schedule(&self) -> Schedule {
        let mut schedule = Schedule::default();
        for send in &self.sends {
            schedule.push(Instant(send.start_cycle), &send.wire());
        }
        schedule
    }
}

impl ScriptedSend {
    /// The bytes that go over the line.
    #[must_use]
    pub fn wire(&self) -> Vec<u8> {
        self.frame.as_ref().map_or_else(|| self.bytes.0.clone(), |Hex(content)| encode_frame(content))
    }
}
