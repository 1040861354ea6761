//! What a link, a file and the page's fields hold: one experiment.
//!
//! Every field has a default, so `{}` is a scenario. Units stand in the names. Choices are written
//! as one key that names the choice, with its own settings inside:
//!
//! ```json
//! { "source": { "motion": { "axes": [ { "moves": [
//!     { "cosine": { "distance": { "steps": 6400 }, "duration_s": 0.4, "ramp_s": 0.2 } } ] } ] } } }
//! ```
//!
//! A scenario as read is only text with types; [`Scenario::check`] makes a [`Checked`] of it or
//! returns every problem at once, each with its path. What comes after never meets a bad number.
//!
//! ```
//! use stepscope_scenario::Scenario;
//!
//! let scenario = Scenario::from_json(r#"{ "clock_hz": 20000000 }"#).expect("it reads");
//! assert_eq!((scenario.clock_hz, scenario.bus.slots), (20_000_000, 100));
//! assert!(scenario.check().is_ok());
//!
//! let broken = Scenario::from_json(r#"{ "bus": { "slots": 200 }, "line": { "baud": 0 } }"#).expect("it reads");
//! let problems = broken.check().unwrap_err();
//! assert_eq!(problems.iter().map(|problem| problem.path.as_str()).collect::<Vec<_>>(), ["bus.slots", "line.baud"]);
//! ```

#![cfg_attr(not(test), no_std)]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod problem;

mod compact;

mod reader;

mod hex;

mod table;

mod schema;

mod points;

mod segments;

mod driver_timing;

mod check;

mod upgrade;

mod read;

mod recorded;

pub mod link;

pub mod presets;

pub use check::{Checked, END_OF_TIME, MAX_CONTROLLERS};
pub use compact::{Compact, Kinds, Parts};
pub use driver_timing::{DriverModel, DriverTiming, TimingRules};
pub use hex::Hex;
pub use points::points_of_table;
pub use problem::{Cause, Problem, Validator, ValueError, of_config, of_motion};
pub use read::{part_from_json, to_json};
pub use reader::{Read, Reader};
pub use segments::{ChannelSegments, DwellSegment, Segment, SegmentLists, StepSegment};
pub use table::{BadTable, MAX_TABLE_BYTES};

use alloc::{string::String, vec, vec::Vec};
use compact::{choices, settings};
use stepscope_motion::moves::Axis;
use stepscope_peripheral::{
    config::{Bus, Protocol, SerialLine},
    units::Instant,
    wire::{Schedule, frame::encode_frame},
};

/// The scenario version that this crate writes, and the newest that it reads.
pub const VERSION: u32 = 2;

settings! {
    /// One experiment: the peripheral, the line to it, and what is sent.
    pub struct Scenario {
        /// Version of this format; 2.
        pub version: u32 = VERSION,
        /// A name to show, up to 120 characters.
        pub title: String = String::new(),
        /// What to look at and where it comes from, up to 2000 characters.
        pub note: String = String::new(),
        /// Clock of the peripheral in Hz, 1 to 1 000 000 000. All `_cycles` count it.
        pub clock_hz: u32 = 16_000_000,
        /// Timing of the driver bus and its queue (DESIGN A7).
        pub bus: Bus = Bus::default(),
        /// The serial line between host and peripheral (DESIGN A4).
        pub line: Line = Line::default(),
        /// What the host sends.
        pub source: Source = Source::default(),
        /// Length of the run in cycles; without it the run ends when nothing can change any more.
        pub run_cycles: Option<u64> = None,
        /// What the spectrum is taken of.
        pub analysis: Analysis = Analysis::default(),
        /// Further controllers on the line, up to 31; `bus` and `line.address` describe the first.
        pub controllers: Vec<Controller> = Vec::new(),
        /// The driver that the pulses are checked against; without it they are not checked.
        pub driver_timing: Option<DriverTiming> = None,
    }
}

settings! {
    /// A further controller on the line (DESIGN A9).
    pub struct Controller {
        /// Its address, 0 to 254, which no other controller has.
        pub address: u8 = 1,
        /// Bit rate of its receiver and its replies in baud, where its clock differs from the host's.
        pub receiver_baud: Option<u32> = None,
        /// Its driver bus and queue; paced packets need ticks of the same length on all controllers.
        pub bus: Bus = Bus::default(),
        /// What its axes do, where the source is a motion.
        pub axes: Vec<Axis> = Vec::new(),
        /// Its packets, one a tick, where the source is packets.
        pub packets: Vec<Hex> = Vec::new(),
    }
}

impl Controller {
    /// Whether it has something to do.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.axes.is_empty() || !self.packets.is_empty()
    }
}

settings! {
    /// The serial line, 8N1 (DESIGN A4, A5).
    pub struct Line {
        /// Bit rate of the host in baud.
        pub baud: u32 = 115_200,
        /// Bit rate of the receiver in baud where its clock differs from the host's.
        pub receiver_baud: Option<u32> = None,
        /// The controller's address, 0 to 254, if packets begin with one. 255 addresses all. On a
        /// framed line a controller always has one: 0 if none is given.
        pub address: Option<u8> = None,
        /// What stands around the orders.
        pub protocol: Protocol = Protocol::Raw,
        /// How the host of a framed line behaves.
        pub host: Host = Host::default(),
        /// Random faults of the line.
        pub noise: Noise = Noise::default(),
        /// Levels forced on the line whatever is sent; where two overlap the later entry wins.
        pub glitches: Vec<Glitch> = Vec::new(),
    }
}

settings! {
    /// How the host of a framed line behaves: one frame, its reply, the next (DESIGN A9).
    pub struct Host {
        /// Most ticks in one frame, 1 to 32; at most half of the queue is sent at once.
        pub ticks_per_frame: u8 = 8,
        /// How long a reply is waited for, from the end of the frame to that of the reply, in cycles, 1 to
        /// 4 294 967 295; without it 256 bit times. Ten bit times later the frame is sent again.
        pub reply_timeout_cycles: Option<u32> = None,
        /// How often one frame is sent before the host gives up, 1 to 255.
        pub attempts: u8 = 10,
    }
}

settings! {
    /// Random faults of the line and of the host, each in millionths (0 to 1 000 000). The same seed
    /// gives the same faults.
    pub struct Noise {
        /// Where the random numbers begin.
        pub seed: u32 = 0,
        /// Bits that are flipped, of all bits of all bytes, both ways.
        pub flipped_bits_ppm: u32 = 0,
        /// Bytes that are left out, of all bytes, both ways.
        pub lost_bytes_ppm: u32 = 0,
        /// Bytes that come twice, of all bytes, both ways.
        pub duplicated_bytes_ppm: u32 = 0,
        /// Levels forced on the line for up to two bit times, of all bytes of the host.
        pub glitches_ppm: u32 = 0,
        /// Replies that the host does not hear, of all replies.
        pub lost_replies_ppm: u32 = 0,
        /// Frames (on a raw line: packets) within which the host crashes, of all of them. It restarts and
        /// remembers nothing but its orders.
        pub host_crashes_ppm: u32 = 0,
    }
}

settings! {
    /// A level forced on the line: a glitch, a break, a broken bit (DESIGN A4).
    pub struct Glitch {
        /// First forced cycle, from 1.
        pub start_cycle: u64 = 1,
        /// How many cycles, from 1.
        pub length_cycles: u64 = 1,
        /// 0 or 1.
        pub level: u8 = 0,
    }
}

choices! {
    /// What the host sends.
    pub enum Source {
        /// Motions of the axes, made into one packet a tick (DESIGN Part B, A9).
        Motion(Motion) = "motion",
        /// The packets themselves, one a tick (DESIGN A9).
        Packets(Packets) = "packets",
        /// Bytes at cycles: a recorded or hand-made line (DESIGN A9).
        Line(LineScript) = "line",
        /// Nothing is sent: the peripheral runs lists of segments by itself (DESIGN A8).
        Segments(SegmentLists) = "segments",
    }
}

impl Default for Source {
    fn default() -> Self {
        Self::Motion(Motion::default())
    }
}

settings! {
    /// A motion for each axis; axis i drives channel i.
    pub struct Motion {
        /// 1 to 16 axes, no more than `bus.channels`.
        pub axes: Vec<Axis> = vec![Axis::default()],
        /// What runs it.
        pub engine: MotionEngine = MotionEngine::Ticks,
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

impl Source {
    /// Whether the host sends ticks of it.
    #[must_use]
    pub const fn is_ticks(&self) -> bool {
        !matches!(self, Self::Line(_)) && !self.runs_segments()
    }

    /// Whether segments run it, and not ticks.
    #[must_use]
    pub const fn runs_segments(&self) -> bool {
        matches!(self, Self::Segments(_) | Self::Motion(Motion { engine: MotionEngine::Segments, .. }))
    }
}

settings! {
    /// Packets, one a tick, as they stand on the line.
    pub struct Packets {
        /// Each `channels` bytes, one more (the address, first) on an addressed line.
        pub packets: Vec<Hex> = Vec::new(),
    }
}

settings! {
    /// Bytes at cycles.
    pub struct LineScript {
        /// Rising in time, not overlapping.
        pub sends: Vec<ScriptedSend> = Vec::new(),
    }
}

settings! {
    /// Bytes that are sent back to back from a cycle on (DESIGN A4's sender).
    pub struct ScriptedSend {
        /// Cycle in which the first start bit falls, from 1.
        pub start_cycle: u64 = 1,
        /// The bytes in hex.
        pub bytes: Hex = Hex::default(),
        /// In place of bytes: a frame's address, kind and body in hex; check, COBS and end mark are
        /// added (DESIGN A6).
        pub frame: Option<Hex> = None,
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

settings! {
    /// What the spectrum is taken of.
    pub struct Analysis {
        /// The axis (of a motion), or the channel.
        pub axis: u8 = 0,
        /// Highest harmonic that counts for the distortion, 2 to 1000.
        pub order: u16 = 40,
        /// Length of the transform a period of the motion, 16 to 65536.
        pub fft_length: u32 = 4096,
        /// Bandwidth (-3 dB, first order) in Hz of the sensor that feels the acceleration, 0.001 to 1e9;
        /// without it nothing is felt.
        pub sensor_hz: Option<f64> = None,
    }
}
