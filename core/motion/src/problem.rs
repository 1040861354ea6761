//! Problems of a motion, each with the path, the value given, the allowed values, and the remedy (DESIGN B1).
//!
//! ```
//! use stepscope_motion::Validator;
//!
//! let mut validator: Validator = Validator::default();
//! validator.range("axis.speed", 12_000.0, 1.0..=10_000.0, "steps/s");
//! let problems = validator.end(()).unwrap_err();
//! assert_eq!(problems[0].path, "axis.speed");
//! assert!(problems[0].to_string().starts_with("axis.speed: 12000 steps/s"), "{}", problems[0]);
//! ```

use alloc::string::String;
use core::fmt;
use stepscope_peripheral::segment::{FRACTION_BITS, LAST_CYCLE, PulseTimes};

#[derive(Clone, Debug, PartialEq)]
pub struct Problem<C = Cause> {
    /// Such as `source.motion.axes[0].moves[2].cosine.ramp_s`; empty for the whole.
    pub path: String,
    pub cause: C,
}

impl<C> Problem<C> {
    #[must_use]
    pub fn new(path: impl Into<String>, cause: impl Into<C>) -> Self {
        Self { path: path.into(), cause: cause.into() }
    }

    #[must_use]
    pub fn widen<D: From<C>>(self) -> Problem<D> {
        Problem { path: self.path, cause: self.cause.into() }
    }
}

impl<C: fmt::Display> fmt::Display for Problem<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.path.is_empty() {
            write!(f, "{}", self.cause)
        } else {
            write!(f, "{}: {}", self.path, self.cause)
        }
    }
}

impl<C: fmt::Debug + fmt::Display> core::error::Error for Problem<C> {}

#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ValueError {
    /// A number is out of its range. The unit is empty for a plain count.
    Range { given: f64, least: f64, most: f64, unit: &'static str },
    /// A text, list or byte string is too short or too long; `of` is `characters`, `bytes`, `axes`, …
    Length { given: usize, least: usize, most: usize, of: &'static str },
    /// Fields do not go together; the detail has which, why, and the remedy.
    Conflict { detail: &'static str },
    /// More work than a run may have; `of` is `ticks`, `cycles`, `table rows`, …
    TooMuch { given: f64, most: f64, of: &'static str },
}

impl ValueError {
    pub(crate) fn too_much(given: u64, most: u64, of: &'static str) -> Self {
        Self::TooMuch { given: given as f64, most: most as f64, of }
    }
}

impl fmt::Display for ValueError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
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
                    "motor-steps of the plant" =>
                        "give a shorter run, fewer channels or a greater step_cycles",
                    "bytes of all frames and their repetitions" => {
                        "give a shorter motion, longer ticks, more ticks a frame or fewer attempts"
                    }
                    _ => "give a shorter motion or longer ticks",
                }
            ),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    Value(ValueError),
    /// The axis' mechanics, of this kind, do not have the unit.
    NoSuchUnit {
        given: f64,
        unit: &'static str,
        mechanics: &'static str,
    },
    /// Two ramps are longer than the move.
    RampTooLong {
        ramp_s: f64,
        duration_s: f64,
    },
    /// The top speed is below the start speed.
    TopBelowStart {
        top: f64,
        start: f64,
    },
    /// The top speed is above the maximum of the table.
    TopAboveTable {
        top: f64,
        most: f64,
    },
    /// The table's timer is slower than the rate.
    TimerTooSlow {
        rate: f64,
        timer_hz: u32,
    },
    /// A speed that follows from other numbers is too high.
    TooFast {
        rate: f64,
        most: f64,
    },
    /// Slices are so short that none has a step, even at top speed.
    SliceTooShort {
        rate: f64,
        slice_s: f64,
    },
    /// Slices cannot contain all steps, even at the maximum rate.
    SlicesTooFew {
        slices: u64,
        slice_s: f64,
        steps: u64,
        rate: f64,
    },
    NoSteps {
        steps: f64,
    },
    /// The time of a point is not later than that of the point before by at least `least`.
    NotRising {
        given: f64,
        before: f64,
        least: f64,
    },
    /// A tick (from 0) needs more steps than it has slots, and a higher rate than the bus' limit.
    TooManySteps {
        tick: u64,
        steps: u64,
        slots: u8,
        rate: f64,
        limit: f64,
    },
    NoSegmentSteps,
    /// The interval of a segment's step (from 0), in 1/65536 cycle, is out of its range.
    SegmentInterval {
        step: u32,
        interval: i128,
        pulse: PulseTimes,
    },
    /// The time after a segment, in 1/65536 cycle, exceeds 64 bits.
    SegmentEnd {
        next: i128,
    },
    /// A step (from 1) of a motion is too soon after the one before, or after the start.
    StepTooSoon {
        step: u64,
        interval: u64,
        pulse: PulseTimes,
    },
}

impl From<ValueError> for Cause {
    fn from(error: ValueError) -> Self {
        Self::Value(error)
    }
}

impl Cause {
    /// Whether it follows from several fields, so that it is meaningless if one of them is invalid.
    #[must_use]
    pub const fn joins_fields(&self) -> bool {
        !matches!(self, Self::Value(ValueError::Range { .. }) | Self::NoSteps { .. } | Self::NoSegmentSteps)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(error) => error.fmt(f),
            Self::NoSuchUnit { given, unit, mechanics } => write!(
                f,
                "{} {unit}, but mechanics of kind {mechanics} have no such unit; give steps, or choose mechanics that have it",
                Short(*given),
                unit = shown(unit)
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
            Self::NoSegmentSteps => f.write_str("no steps; give a count of at least 1, or a dwell"),
            Self::SegmentInterval { step, interval, pulse } => {
                write!(f, "step {step} has an interval of {interval}/65536 cycles")?;
                if *interval > u64::MAX.into() {
                    write!(f, "; give at most {}", u64::MAX)
                } else {
                    let least = pulse.min_interval().0 << FRACTION_BITS;
                    write!(
                        f,
                        ", {}; give at least {least}, or shorter times of the pulse",
                        MinInterval(*pulse)
                    )
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
                MinInterval(*pulse)
            ),
        }
    }
}

struct MinInterval(PulseTimes);

impl fmt::Display for MinInterval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PulseTimes { width, setup, hold } = self.0;
        let least = self.0.min_interval().0;
        write!(
            f,
            "a pulse needs width {} + max(hold {} + setup {}, 1) = {least} cycles",
            width.0, hold.0, setup.0
        )
    }
}

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
