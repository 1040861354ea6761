//! What can be wrong with a scenario: every problem with its path, what was given, what is
//! allowed, and what to change.

use crate::segment::{FRACTION_BITS, LAST_CYCLE, PulseTimes};
use alloc::string::String;
use core::fmt;

/// One problem of a scenario, at the path of the field that has to change.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Path of the field, such as `source.motion.axes[0].moves[2].cosine.ramp_s`; empty for the
    /// whole.
    pub path: String,
    /// What is wrong.
    pub cause: Cause,
}

impl Problem {
    /// A problem at `path`.
    #[must_use]
    pub fn new(path: impl Into<String>, cause: Cause) -> Self {
        Self { path: path.into(), cause }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.path.is_empty() {
            write!(f, "{}", self.cause)
        } else {
            write!(f, "{}: {}", self.path, self.cause)
        }
    }
}

impl core::error::Error for Problem {}

/// What is wrong, with the numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// Not JSON.
    Syntax {
        /// Where the reader stopped, from 1.
        line: usize,
        /// Column in that line, from 1.
        column: usize,
        /// What it met.
        detail: String,
    },
    /// JSON of another type or name than the field's.
    Type {
        /// What was met and what was expected.
        detail: String,
    },
    /// Written by a newer Stepscope.
    NewerVersion {
        /// The scenario's version.
        given: u64,
        /// The newest that is read here.
        newest: u32,
    },
    /// A number out of its range.
    Range {
        /// The number.
        given: f64,
        /// Least allowed.
        least: f64,
        /// Greatest allowed.
        most: f64,
        /// Unit of all three, empty for a plain count.
        unit: &'static str,
    },
    /// A text, list or byte string of a length that is not allowed.
    Length {
        /// Its length.
        given: usize,
        /// Least allowed.
        least: usize,
        /// Greatest allowed.
        most: usize,
        /// What is counted: `characters`, `bytes`, `axes`, …
        of: &'static str,
    },
    /// A quantity in a unit that the axis's mechanics do not have.
    NoSuchUnit {
        /// The number.
        given: f64,
        /// Its unit.
        unit: &'static str,
        /// The kind of the mechanics.
        mechanics: &'static str,
    },
    /// The receiver's bit time is too short (A4).
    BitTooShort {
        /// Cycles a bit.
        bit_cycles: u64,
        /// Receiver's rate.
        baud: u32,
        /// Clock of the peripheral.
        clock_hz: u32,
        /// Highest rate that this clock can hear.
        most_baud: u32,
    },
    /// The pulses of a slot do not fit in it (A7).
    PulseTooLong {
        /// W.
        width: u64,
        /// D.
        setup: u64,
        /// H.
        hold: u64,
        /// L = W + max(D + H, 1), of one pulse.
        needed: u64,
        /// Pulses that have to follow each other in a slot.
        pulses: u64,
        /// Which these are.
        of: &'static str,
        /// Ts.
        period: u64,
    },
    /// Staggered pulses with a common DIR line are closer than one lasts (A7).
    SettleTooShort {
        /// dp.
        settle: u64,
        /// W.
        width: u64,
        /// D.
        setup: u64,
        /// H.
        hold: u64,
        /// L = W + max(D + H, 1).
        needed: u64,
    },
    /// A send begins before the one before it has ended (A9).
    Overlap {
        /// Its start.
        start: u64,
        /// First cycle after the send before it.
        free_from: u64,
    },
    /// Ramps longer than the move (B4).
    RampTooLong {
        /// Ramp in s.
        ramp_s: f64,
        /// Move in s.
        duration_s: f64,
    },
    /// A top speed under the start speed (B2).
    TopBelowStart {
        /// Top speed in steps/s.
        top: f64,
        /// Start speed in steps/s.
        start: f64,
    },
    /// A top speed above the table's greatest (B3).
    TopAboveTable {
        /// Top speed in steps/s.
        top: f64,
        /// Greatest speed of the table in steps/s.
        most: f64,
    },
    /// A rate that the table's timer cannot give (B2).
    TimerTooSlow {
        /// Rate in steps/s.
        rate: f64,
        /// Timer's clock in Hz.
        timer_hz: u32,
    },
    /// A speed that follows from the numbers and is beyond any driver.
    TooFast {
        /// Rate in steps/s.
        rate: f64,
        /// Greatest allowed.
        most: f64,
    },
    /// Slices so short that at top speed none has a step (B4).
    SliceTooShort {
        /// Top speed in steps/s.
        rate: f64,
        /// A slice in s.
        slice_s: f64,
    },
    /// Slices that cannot have all steps, however high the rate (B4).
    SlicesTooFew {
        /// How many slices.
        slices: u64,
        /// A slice in s.
        slice_s: f64,
        /// Steps of the move.
        steps: u64,
        /// The highest rate that was tried, in steps/s.
        rate: f64,
    },
    /// A distance that is less than a step.
    NoSteps {
        /// The distance in steps, before rounding.
        steps: f64,
    },
    /// A point whose time does not come after that of the one before (B6).
    NotRising {
        /// Its time in s.
        given: f64,
        /// That of the point before.
        before: f64,
        /// The least time between both.
        least: f64,
    },
    /// A tick that needs more steps than it has slots (B7).
    TooManySteps {
        /// The first such tick, from 0.
        tick: u64,
        /// Steps it needs.
        steps: u64,
        /// Slots it has.
        slots: u8,
        /// The rate it needs in steps/s.
        rate: f64,
        /// The rate that the bus can give in steps/s.
        limit: f64,
    },
    /// A line that cannot carry a packet a tick (A9).
    LineTooSlow {
        /// Cycles that one tick's packet takes.
        packet_cycles: u64,
        /// Cycles of a tick.
        tick_cycles: u64,
        /// The line's rate.
        baud: u32,
        /// The least rate that does.
        needed_baud: u64,
        /// The highest rate that the receiver can hear with this clock.
        most_baud: u64,
    },
    /// A segment of no steps (A8).
    NoSegmentSteps,
    /// An interval that a step of a segment uses is out of its range (A8).
    SegmentInterval {
        /// The first such step, from 0.
        step: u32,
        /// Its interval in 1/65536 cycle.
        interval: i128,
        /// What decides the least.
        pulse: PulseTimes,
    },
    /// The time of a segment list leaves 64 bits (A8).
    SegmentEnd {
        /// Time after the segment, in 1/65536 cycle.
        next: i128,
    },
    /// A step of a motion comes too soon after the one before (A8).
    StepTooSoon {
        /// The step, from 1.
        step: u64,
        /// Cycles after the step before, or after the start of the motion.
        interval: u64,
        /// What decides the least.
        pulse: PulseTimes,
    },
    /// Two controllers of one address.
    SameAddress {
        /// The address.
        address: u8,
    },
    /// Controllers of one raw line whose packets have different lengths: each consumes those for
    /// others by its own (A5).
    OtherPackets {
        /// This one's channels.
        channels: u8,
        /// The first one's.
        first_channels: u8,
    },
    /// Controllers that are paced together and have ticks of different lengths (A9).
    OtherTick {
        /// This one's tick in cycles.
        tick_cycles: u64,
        /// The first one's.
        first_cycles: u64,
    },
    /// Fields that do not go together.
    Conflict {
        /// Which, why, and what to do.
        detail: &'static str,
    },
    /// More work than one run may be.
    TooMuch {
        /// How much.
        given: f64,
        /// How much is allowed.
        most: f64,
        /// Of what: `ticks`, `cycles`, `table rows`, …
        of: &'static str,
    },
}

/// The least interval of a pulse, and what it is made of.
struct Least(PulseTimes);

impl fmt::Display for Least {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PulseTimes { width, setup, hold } = self.0;
        let least = self.0.least_interval().0;
        write!(
            f,
            "a pulse needs width {} + max(hold {} + setup {}, 1) = {least} cycles",
            width.0, hold.0, setup.0
        )
    }
}

/// Prints a number without needless digits.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        let magnitude = libm::fabs(value);
        if value == libm::trunc(value) && magnitude < 1e17 {
            write!(f, "{value:.0}")
        } else if (1e-3..1e6).contains(&magnitude) {
            let text = alloc::format!("{value:.4}");
            f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
        } else {
            let text = alloc::format!("{value:.5e}");
            match text.split_once('e') {
                Some((digits, power)) => {
                    write!(f, "{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
                }
                None => f.write_str(&text),
            }
        }
    }
}

/// A unit as people write it.
fn shown(unit: &str) -> &str {
    match unit {
        "steps_s" => "steps/s",
        "mm_s" => "mm/s",
        "deg_s" => "deg/s",
        "steps_s2" => "steps/s^2",
        "mm_s2" => "mm/s^2",
        "deg_s2" => "deg/s^2",
        "steps_s3" => "steps/s^3",
        "mm_s3" => "mm/s^3",
        "deg_s3" => "deg/s^3",
        other => other,
    }
}

impl Cause {
    /// Whether it follows from several fields together, so that it means nothing while one of them
    /// cannot be read.
    #[must_use]
    pub const fn joins_fields(&self) -> bool {
        !matches!(
            self,
            Self::Syntax { .. }
                | Self::Type { .. }
                | Self::NewerVersion { .. }
                | Self::Range { .. }
                | Self::NoSteps { .. }
                | Self::NoSegmentSteps
        )
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax { line, column, detail } => {
                write!(f, "not JSON at line {line}, column {column}: {detail}")
            }
            Self::Type { detail } => f.write_str(detail),
            Self::NewerVersion { given, newest } => write!(
                f,
                "version {given} was made with a newer Stepscope; this one reads up to version {newest}"
            ),
            Self::Range { given, least, most, unit } => {
                let (unit, space) = (shown(unit), if unit.is_empty() { "" } else { " " });
                write!(f, "{}{space}{unit} is out of range; give {}", Short(*given), Short(*least))?;
                if least < most {
                    write!(f, " to {}", Short(*most))?;
                }
                write!(f, "{space}{unit}")
            }
            Self::Length { given, least, most, of } if least == most => {
                write!(f, "{given} {of}; give {least}")
            }
            Self::Length { given, least, most, of } => {
                write!(f, "{given} {of}; give {least} to {most}")
            }
            Self::NoSuchUnit { given, unit, mechanics } => write!(
                f,
                "{} {unit}, but mechanics of kind {mechanics} have no such unit; give steps, or choose mechanics that have it",
                Short(*given),
                unit = shown(unit)
            ),
            Self::BitTooShort { bit_cycles, baud, clock_hz, most_baud } => write!(
                f,
                "{baud} baud at {clock_hz} Hz is {bit_cycles} cycles a bit, the receiver needs 11; give at most {most_baud} baud or a faster clock"
            ),
            Self::PulseTooLong { width, setup, hold, needed, pulses, of, period } => write!(
                f,
                "a pulse needs width {width} + max(setup {setup} + hold {hold}, 1) = {needed} cycles, {pulses} in a slot ({of}), the slot has {period}; give a step period of at least {} or shorter times",
                needed * pulses
            ),
            Self::SettleTooShort { settle, width, setup, hold, needed } => write!(
                f,
                "{settle} cycles from pulse to pulse, but one needs width {width} + max(setup {setup} + hold {hold}, 1) = {needed} on a common DIR line; give at least {needed} or shorter times"
            ),
            Self::Overlap { start, free_from } => write!(
                f,
                "starts at cycle {start} while the bytes before it last to cycle {}; start at {free_from} or later",
                free_from - 1
            ),
            Self::RampTooLong { ramp_s, duration_s } => write!(
                f,
                "two ramps of {} s do not fit in {} s; give a ramp of at most {} s",
                Short(*ramp_s),
                Short(*duration_s),
                Short(duration_s / 2.0)
            ),
            Self::TopBelowStart { top, start } => write!(
                f,
                "a top speed of {} steps/s is under the start speed of {} steps/s; give a higher top speed or a lower start speed",
                Short(*top),
                Short(*start)
            ),
            Self::TopAboveTable { top, most } => write!(
                f,
                "a top speed of {} steps/s is above the table's greatest of {} steps/s; give a lower top speed or a higher table",
                Short(*top),
                Short(*most)
            ),
            Self::TimerTooSlow { rate, timer_hz } => write!(
                f,
                "a timer of {timer_hz} Hz cannot make {} steps/s; give a timer of at least that rate",
                Short(*rate)
            ),
            Self::TooFast { rate, most } => write!(
                f,
                "this needs {} steps/s, at most {} are allowed; give more time or less distance",
                Short(libm::ceil(*rate)),
                Short(*most)
            ),
            Self::NoSteps { steps } => {
                write!(f, "{} steps is less than one step; give at least one step, or a dwell", Short(*steps))
            }
            Self::NotRising { given, before, least } => write!(
                f,
                "a time of {} s after one of {} s; give times that rise by {} s at least",
                Short(*given),
                Short(*before),
                Short(*least)
            ),
            Self::TooManySteps { tick, steps, slots, rate, limit } => write!(
                f,
                "tick {tick} needs {steps} steps ({} steps/s), its {slots} slots give at most {} steps/s; slow the motion, or give a shorter step period",
                Short(*rate),
                Short(*limit)
            ),
            Self::LineTooSlow { packet_cycles, tick_cycles, baud, needed_baud, most_baud } => {
                write!(
                    f,
                    "at {baud} baud what is sent for a tick takes {packet_cycles} cycles, a tick has {tick_cycles}; give "
                )?;
                if needed_baud <= most_baud {
                    write!(
                        f,
                        "at least {needed_baud} baud, longer ticks or fewer channels; on a framed line also more ticks a frame and a deeper queue"
                    )
                } else {
                    write!(
                        f,
                        "longer ticks or fewer channels: it would need {needed_baud} baud, and this clock hears at most {most_baud}"
                    )
                }
            }
            Self::NoSegmentSteps => f.write_str("no steps; give a count of at least 1, or a dwell"),
            Self::SegmentInterval { step, interval, pulse } => {
                write!(f, "step {step} has an interval of {interval}/65536 cycles")?;
                if *interval > u64::MAX.into() {
                    write!(f, "; give at most {}", u64::MAX)
                } else {
                    let least = pulse.least_interval().0 << FRACTION_BITS;
                    write!(f, ", {}; give at least {least}, or shorter times of the pulse", Least(*pulse))
                }
            }
            Self::SegmentEnd { next } => write!(
                f,
                "ends at {next}/65536 cycles; give less time, at most {}/65536 (cycle {})",
                u64::MAX,
                LAST_CYCLE.0
            ),
            Self::StepTooSoon { step, interval, pulse } => write!(
                f,
                "step {step} comes {interval} cycles after {}, {}; slow the motion, or give shorter times of the pulse",
                if *step == 1 { "the start" } else { "the one before" },
                Least(*pulse)
            ),
            Self::SameAddress { address } => {
                write!(f, "another controller has address {address} already; give each its own, 0 to 254")
            }
            Self::OtherPackets { channels, first_channels } => write!(
                f,
                "{channels} channels beside {first_channels} on the first controller; a raw packet has a byte a channel and no end mark, so all controllers of a raw line need as many: change one of them, or choose the framed protocol"
            ),
            Self::OtherTick { tick_cycles, first_cycles } => write!(
                f,
                "ticks of {tick_cycles} cycles beside ticks of {first_cycles} on the first controller; paced packets need one length (slots x step period): change one of them, or choose the framed protocol"
            ),
            Self::SliceTooShort { rate, slice_s } => write!(
                f,
                "at the top speed of {} steps/s a slice of {} s has {} steps, so none would have one; give slices of at least {} s, more distance or less time, or choose the exact method",
                Short(*rate),
                Short(*slice_s),
                Short(rate * slice_s),
                Short(1.0 / rate)
            ),
            Self::SlicesTooFew { slices, slice_s, steps, rate } => write!(
                f,
                "slices of {} s, of which there are {slices}, never have {steps} steps together, not even at {} steps/s: a slice has the rate of its start; give shorter slices, or choose the exact method",
                Short(*slice_s),
                Short(*rate)
            ),
            Self::Conflict { detail } => f.write_str(detail),
            Self::TooMuch { given, most, of } => write!(
                f,
                "{} {of} are more than one run may have; at most {} are allowed: {}",
                Short(*given),
                Short(*most),
                match *of {
                    "table rows" => "give a higher acceleration or a lower top speed",
                    "moves" => "give fewer moves",
                    "steps" => "give a shorter motion, or run it by ticks",
                    "steps of a table" => "give a shorter motion, or make a table of each part of it",
                    "steps to be measured" => "give a shorter motion",
                    "slices" => "give longer slices or less time, or choose the exact method",
                    "sine segments" => "give a greater largest deviation or fewer sines",
                    "bytes of all frames and their repetitions" => {
                        "give a shorter motion, longer ticks, more ticks a frame or fewer attempts"
                    }
                    _ => "give a shorter motion or longer ticks",
                }
            ),
        }
    }
}
