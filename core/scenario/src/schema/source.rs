//! What the host sends, or the peripheral runs (DESIGN Part B, A8, A9).

use crate::schema::rows::{choices, settings, words};
use crate::schema::{OWN, PATENT, SONOBE, label};
use crate::{END_OF_TIME, Hex, SegmentLists};
use crate::{StandAlone, schema::ZHANG};
use alloc::{vec, vec::Vec};
use stepscope_motion::{AxisList, groups::Group, limits, moves::Axis};
use stepscope_peripheral::units::Instant;
use stepscope_peripheral::wire::{Schedule, frame::encode_frame};

choices! {
    /// One of five kinds. Packets and sends have at most 4 MiB of bytes.
    pub enum Source {
        /// Moves in steps, mm or degrees, divided into ticks or segments.
        Motion(Motion) = "motion" => label("Motion profile"),
        /// The packets themselves, one per tick.
        Packets(Packets) = "packets" => label("Packets in hex").from(PATENT),
        /// Bytes at given cycles, for example to replay a recording.
        Line(LineScript) = "line" => label("Line script").from(OWN),
        /// Controllers with buttons, a program and a memory. Nothing is sent.
        StandAlone(Vec<StandAlone>) = "standalone" => label("Stand-alone controller").from(ZHANG),
        /// Tables of intervals that the controller runs. Nothing is sent.
        Segments(SegmentLists) = "segments" => label("Lists of segments").from(SONOBE),
    }
}

impl Default for Source {
    fn default() -> Self {
        Self::Motion(Motion::default())
    }
}

settings! {
    /// Axis i drives channel i. With `"ticks"` the host sends one packet per tick, back to back in time. On an addressed
    /// line each packet begins with `line.address`. There are at most 2 000 000 ticks.
    ///
    /// With `"segments"` nothing is sent: the peripheral runs a list of segments, each step at cycle 1 +
    /// floor(t*`clock_hz` + 1/2). All axes together then have at most 4 000 000 steps. The interval before each step is at
    /// least the pulse width plus the larger of 1 and hold + set-up time, in cycles. A motion lasts at most 10^6 s.
    pub struct Motion {
        /// Axes, each with its mechanics and moves.
        pub axes: Vec<Axis> = vec![Axis::default()] => label("Axes").range_text("1 to 16, no more than `bus.channels`"),
        /// How steps are generated.
        pub engine: MotionEngine = MotionEngine::Ticks => label("Step generation")
            .term("Step generation", "Ticks: the host sends the number of steps of each tick (RU 2704486). Step table: a timer interrupt of the controller runs the move without a host, from a table of intervals (Sonobe 2011, Zhang 2012, Song 2021).")
            .from(PATENT),
        /// Moves of several axes that start and end together, one group after another, after the axes' own moves. With
        /// groups an axis may have no moves.
        pub groups: Vec<Group> = Vec::new() => label("Groups")
            .length(limits::GROUPS, "groups")
            .term("Group", "Moves of several axes that start and end at the same time. A group starts when the last axis is at rest.")
            .from(OWN)
            .only_if_set(),
    }
}

impl Motion {
    /// Axes and groups with their path in a scenario.
    pub fn axis_list(&self) -> AxisList<'_> {
        AxisList { path: "source.motion.axes".into(), axes: &self.axes, groups: &self.groups }
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
        Ticks = "ticks", "ticks": "the host sends the number of steps of each tick";
        Segments = "segments", "step table (timer interrupt)": "nothing is sent; each step comes in its exact cycle";
    }
}

settings! {
    /// Each packet has `bus.channels` bytes. On an addressed raw line the address comes first. On a framed line packets are
    /// sent in frames of several ticks.
    pub struct Packets {
        /// In hex, one packet per tick, one byte per channel: bit 7 is the direction (1 right), bits 6 to 0 the steps.
        pub packets: Vec<Hex> = Vec::new() => label("One packet per line")
            .range_text("`bus.channels` bytes each, plus the address")
            .term("Packet", "What the host sends for one tick: one byte per motor, with the direction in bit 7 and the number of steps in bits 6 to 0.")
            .from(PATENT),
    }
}

settings! {
    /// Replays bytes at given cycles. `{ "start_cycle": 2000, "frame": "0505" }` stops controller 5.
    pub struct LineScript {
        /// In order of time, without overlap.
        pub sends: Vec<ScriptedSend> = Vec::new() => label("Sends").range_text("at most 4 MiB of bytes"),
    }
}

settings! {
    /// Bytes, or one frame, sent from `start_cycle` on without pauses.
    pub struct ScriptedSend {
        /// Cycle of the first start bit.
        pub start_cycle: u64 = 1 => label("Start").unit("cycles").whole(1..=END_OF_TIME - 1)
            .term("Start", "First cycle, counted from reset."),
        /// Bytes in hex, sent without pauses.
        pub bytes: Hex = Hex::default() => label("Bytes")
            .term("Bytes", "Bytes on the line. Each has a start bit, eight data bits (lowest first) and a stop bit."),
        /// Instead of bytes: address, kind and body in hex, such as `ff 05` (STOP for all). CRC, COBS and delimiters are
        /// added.
        pub frame: Option<Hex> = None => label("Frame").range_text("hex").null_means("the bytes are sent")
            .term("Frame", "Address, kind and body with a CRC, between two zero bytes. COBS removes the zeros from the content, so that the end of a frame is always found.")
            .from(OWN).when_at("line.protocol", "framed"),
    }
}

impl Source {
    /// Whether the host sends packets of ticks.
    pub const fn sends_ticks(&self) -> bool {
        !matches!(self, Self::Line(_)) && !self.sends_nothing()
    }

    /// Whether segments run it instead of ticks.
    pub const fn uses_segments(&self) -> bool {
        matches!(self, Self::Segments(_) | Self::Motion(Motion { engine: MotionEngine::Segments, .. }))
    }

    /// Whether nothing is sent: segments or stand-alone controllers run it.
    pub const fn sends_nothing(&self) -> bool {
        if let Self::StandAlone(_) = self {
            return true;
        }
        self.uses_segments()
    }
}

impl LineScript {
    /// The script as the host's schedule (A9).
    pub fn schedule(&self) -> Schedule {
        let mut schedule = Schedule::default();
        for send in &self.sends {
            schedule.push(Instant(send.start_cycle), &send.line_bytes());
        }
        schedule
    }
}

impl ScriptedSend {
    /// The bytes on the line.
    pub fn line_bytes(&self) -> Vec<u8> {
        self.frame.as_ref().map_or_else(|| self.bytes.0.clone(), |Hex(content)| encode_frame(content))
    }
}
