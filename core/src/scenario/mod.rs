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

mod check;
mod compact;
mod config;
mod drive;
mod hex;
mod judge;
pub mod link;
mod motor;
mod points;
pub mod presets;
mod problem;
mod quantity;
mod read;
mod recorded;
mod segments;
mod table;
mod tracked;

pub(crate) use check::MOST_FURTHER;
pub use check::{Checked, END_OF_TIME, Forced, line_time};
pub use compact::Compact;
pub use config::Config;
pub(crate) use config::most_baud;
pub use drive::{Driver, DriverModel, TimingRules};
pub use hex::Hex;
pub use motor::{MOST_PEAK_CURRENT, Motor};
pub(crate) use points::MOST_POINTS;
pub use points::{Interpolation, Point, PointUnit, Points};
pub use problem::{Cause, Problem};
pub use quantity::{
    Acceleration, Direct, Distance, Jerk, Mechanics, NoSuchUnit, Rotary, Screw, Speed, Wheel,
};
pub use segments::{ChannelSegments, DwellSegment, Segment, SegmentLists, StepSegment};
pub use table::{BadTable, MOST_TABLE_BYTES};

use alloc::{string::String, vec, vec::Vec};
use compact::{choices, settings};
use serde::{Deserialize, Serialize};

/// The scenario version that this crate writes, and the newest that it reads.
pub const VERSION: u32 = 1;

settings! {
    /// One experiment: the peripheral, the line to it, and what is sent.
    pub struct Scenario {
        /// Version of this format; 1.
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
        pub driver: Option<Driver> = None,
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
    /// The tick sequencer and its driver bus (DESIGN A7).
    pub struct Bus {
        /// Channels in use, 1 to 16; a packet has one byte for each.
        pub channels: u8 = 1,
        /// Slots in a tick, 1 to 127: the most steps a channel can make in one tick.
        pub slots: u8 = 100,
        /// Length of a slot in cycles; a tick lasts `slots` times as long.
        pub step_period_cycles: u32 = 320,
        /// How long STEP stays high, in cycles.
        pub pulse_width_cycles: u32 = 40,
        /// From the start of a slot (DIR changes there) to the rise of STEP, in cycles.
        pub dir_setup_cycles: u32 = 40,
        /// How long DIR is held after STEP has fallen, in cycles.
        pub dir_hold_cycles: u32 = 0,
        /// Where in a tick the steps go.
        pub distribution: Distribution = Distribution::Spread,
        /// How many DIR lines the controller has.
        pub dir_line: DirLine = DirLine::PerChannel,
        /// When the pulses of one slot come.
        pub pulses: Pulses = Pulses::Simultaneous,
        /// Settling time of the drivers' supply current after a step, in cycles (the patent's
        /// delta t_p): staggered pulses are at most so far apart.
        pub settle_cycles: u32 = 0,
        /// Ticks that the queue holds, 1 to 255.
        pub queue_depth: u8 = 16,
        /// Self-test after reset in cycles; packets that end within it are dropped.
        pub boot_cycles: u32 = 1600,
    }
}

/// Where in a tick a channel's steps go (DESIGN A7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// The first `count` slots of the tick, as in RU 2704486.
    Burst,
    /// Evenly over the tick.
    #[default]
    Spread,
}

/// How many DIR lines the controller has (DESIGN A7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DirLine {
    /// One a channel; they change when a tick starts.
    #[default]
    PerChannel,
    /// One for all channels; it changes within each slot.
    Common,
}

/// When the pulses of one slot come (DESIGN A7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pulses {
    /// All at once.
    #[default]
    Simultaneous,
    /// One after another, so that the drivers' current peaks do not meet.
    Staggered,
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

/// What stands around the orders on the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Protocol {
    /// Nothing: bytes, and pauses between packets, as in RU 2704486 (DESIGN A5).
    #[default]
    Raw,
    /// Frames with a check, sequence numbers and replies (DESIGN A6).
    Framed,
}

settings! {
    /// How the host of a framed line behaves: one frame, its reply, the next (DESIGN A9).
    pub struct Host {
        /// Most ticks in one frame, 1 to 32; at most half of the queue is sent at once.
        pub ticks_a_frame: u8 = 8,
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
        /// Bits that are turned over, of all bits of all bytes, both ways.
        pub flipped_bits_ppm: u32 = 0,
        /// Bytes that are left out, of all bytes, both ways.
        pub lost_bytes_ppm: u32 = 0,
        /// Bytes that come twice, of all bytes, both ways.
        pub doubled_bytes_ppm: u32 = 0,
        /// Levels forced on the line for up to two bit times, of all bytes of the host.
        pub glitches_ppm: u32 = 0,
        /// Replies that the host does not hear, of all replies.
        pub lost_replies_ppm: u32 = 0,
        /// Frames (on a raw line: packets) within which the host dies, of all of them. It comes back and
        /// remembers nothing but its orders.
        pub deaths_ppm: u32 = 0,
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
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
    /// One axis: its mechanics and the moves that it makes one after another.
    pub struct Axis {
        /// What one step is (DESIGN B1).
        pub mechanics: Mechanics = Mechanics::default(),
        /// Up to 64 moves.
        pub moves: Vec<Move> = vec![Move::default()],
        /// Its motor, driver supply and load; without it nothing is said of torque.
        pub motor: Option<Motor> = None,
    }
}

choices! {
    /// One move of an axis (DESIGN Part B).
    pub enum Move {
        /// Uniform acceleration by table (B2).
        Trapezoid(Trapezoid) = "trapezoid",
        /// Fixed length by a staircase of rates (B3).
        Staircase(Staircase) = "staircase",
        /// Cosine S-curve with exact distance and exact time (B4).
        Cosine(Cosine) = "cosine",
        /// Ramps of another shape with exact distance and exact time (B4).
        Ramps(Ramps) = "ramps",
        /// Sine as segments of fixed rate (B5).
        SineSegments(SineSegments) = "sine_segments",
        /// Sine with every step in its place (B6).
        Sine(Sine) = "sine",
        /// Seven phases from rest to rest (B6).
        JerkLimited(JerkLimited) = "jerk_limited",
        /// A curve through points (B6).
        Points(Points) = "points",
        /// One rate from end to end (B6).
        Constant(Constant) = "constant",
        /// Standing still (B6).
        Dwell(Dwell) = "dwell",
    }
}

impl Default for Move {
    fn default() -> Self {
        Self::Cosine(Cosine::default())
    }
}

settings! {
    /// Trapezoid by acceleration table (B2, Sonobe 2011).
    pub struct Trapezoid {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(2000.0),
        /// Speed of the first step.
        pub start_speed: Speed = Speed::StepsPerSecond(250.0),
        /// Speed of the plateau.
        pub top_speed: Speed = Speed::StepsPerSecond(4000.0),
        /// Acceleration and deceleration.
        pub acceleration: Acceleration = Acceleration::StepsPerSecond2(9000.0),
        /// Whose step times.
        pub method: TrapezoidMethod = TrapezoidMethod::Table,
        /// Clock of the timer whose reload the table holds, in Hz; only the table uses it.
        pub timer_hz: u32 = 1_000_000,
    }
}

/// Whose step times a trapezoid has (B2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrapezoidMethod {
    /// The document's: a table of whole pulse rates, one a step, and a timer's whole reload.
    #[default]
    Table,
    /// Every step where the ideal curve crosses its half-integer (B1).
    Exact,
}

settings! {
    /// Fixed length by a staircase of rates (B3, Zhang 2012).
    pub struct Staircase {
        /// How far, the document's L; negative is left.
        pub distance: Distance = Distance::Steps(10_000.0),
        /// Speed of the plateau, f_s; at or below the start speed that of the whole move.
        pub top_speed: Speed = Speed::StepsPerSecond(5000.0),
        /// Acceleration level 1 to 5: 1000 to 5000 steps/s^2.
        pub level: u8 = 3,
        /// What becomes of a move that is too short to reach its top speed.
        pub short_move: ShortMove = ShortMove::Document,
        /// First rate of the table, f_1.
        pub start_speed: Speed = Speed::StepsPerSecond(1000.0),
        /// The table ends with the first rate above this, f_max; no top speed may be above it.
        pub max_speed: Speed = Speed::StepsPerSecond(20_000.0),
    }
}

/// What becomes of a move that is too short to reach its top speed (B3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShortMove {
    /// The document's: the whole move at the start speed.
    #[default]
    Document,
    /// Up as many rows of the table as there is room for, and down again.
    TurnRound,
}

settings! {
    /// Cosine S-curve (B4, Song, Han, Lu 2021): so many steps in so much time.
    pub struct Cosine {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(3200.0),
        /// Time of the whole move in s.
        pub duration_s: f64 = 0.4,
        /// Time of each ramp in s, at most half of the duration.
        pub ramp_s: f64 = 0.2,
        /// Whose step times.
        pub method: CosineMethod = CosineMethod::Exact,
        /// Length of a slice in s, the document's TS, 0.00001 to 0.1; only `sliced` uses it.
        pub slice_s: f64 = 0.001,
    }
}

/// Whose step times a cosine S-curve has (B4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CosineMethod {
    /// Every step where the ideal curve crosses its half-integer (B1).
    #[default]
    Exact,
    /// The document's: slices of whole steps, compensated until their sum is right.
    Sliced,
}

settings! {
    /// Ramps of a shape (B4): so many steps in so much time, as the cosine S-curve has it.
    pub struct Ramps {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(3200.0),
        /// Time of the whole move in s.
        pub duration_s: f64 = 0.4,
        /// Time of each ramp in s, at most half of the duration.
        pub ramp_s: f64 = 0.2,
        /// What the ramps look like.
        pub shape: RampShape = RampShape::Sigmoid,
        /// The x of 1/(1 + e^-x) goes from minus to plus this over a ramp, 0.1 to 20; only the sigmoid uses it.
        pub sigmoid_range: f64 = 6.0,
        /// Time constants of the exponential within a ramp, 0.1 to 20; only the exponential uses it.
        pub time_constants: f64 = 4.0,
    }
}

/// What a ramp looks like (B4; Song, Han, Lu 2021, table 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RampShape {
    /// The middle of 1/(1 + e^-x), shifted and stretched so that it begins at rest and ends at top speed: one that
    /// is only cut off never gets there.
    #[default]
    Sigmoid,
    /// 3x^2 - 2x^3: a cubic Bezier curve with the control values 0, 0, 1, 1.
    Bezier,
    /// Uniform acceleration, a trapezoid.
    Straight,
    /// The approach of an exponential: steep at first, as a motor's torque falls with its rate.
    Exponential,
}

settings! {
    /// Sine as segments of fixed rate (B5), from the right extreme to the left one and back.
    pub struct SineSegments {
        /// From the middle to an extreme.
        pub amplitude: Distance = Distance::Steps(1000.0),
        /// Time of one period in s.
        pub period_s: f64 = 0.5,
        /// How many whole periods.
        pub periods: u32 = 4,
        /// Largest deviation of a segment from the sine, d1, in parts of the amplitude.
        pub max_deviation: f64 = 0.006,
    }
}

settings! {
    /// Exact sine (B6, B1's rule), from the right extreme to the left one and back.
    pub struct Sine {
        /// From the middle to an extreme.
        pub amplitude: Distance = Distance::Steps(1000.0),
        /// Time of one period in s.
        pub period_s: f64 = 0.5,
        /// How many whole periods.
        pub periods: u32 = 4,
    }
}

settings! {
    /// Jerk-limited move of seven phases (B6): from rest to rest as fast as its limits let it.
    pub struct JerkLimited {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(3200.0),
        /// Greatest speed.
        pub max_speed: Speed = Speed::StepsPerSecond(10_000.0),
        /// Greatest acceleration and deceleration.
        pub max_acceleration: Acceleration = Acceleration::StepsPerSecond2(100_000.0),
        /// Greatest change of the acceleration in a second.
        pub max_jerk: Jerk = Jerk::StepsPerSecond3(2_000_000.0),
    }
}

settings! {
    /// One rate from end to end (B6).
    pub struct Constant {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(1000.0),
        /// How fast.
        pub speed: Speed = Speed::StepsPerSecond(1000.0),
    }
}

settings! {
    /// Standing still (B6).
    pub struct Dwell {
        /// How long, in s.
        pub duration_s: f64 = 0.1,
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

impl ScriptedSend {
    /// The bytes that go over the line.
    #[must_use]
    pub fn wire(&self) -> Vec<u8> {
        self.frame
            .as_ref()
            .map_or_else(|| self.bytes.0.clone(), |Hex(content)| crate::protocol::seal(content))
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
