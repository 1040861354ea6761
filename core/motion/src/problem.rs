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

use alloc::{format, string::String};
use core::fmt;
use stepscope_peripheral::segment::{FRACTION_BITS, LAST_CYCLE, PulseTimes};

/// A problem of one value, shown as `path: cause`.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem<C = Cause> {
    /// Such as `source.motion.axes[0].moves[2].cosine.ramp_s`; empty for the whole scenario.
    pub path: String,
    /// What is wrong with the value, and how to fix it.
    pub cause: C,
}

impl<C> Problem<C> {
    /// A problem of the value at `path`.
    pub fn new(path: impl Into<String>, cause: impl Into<C>) -> Self {
        Self { path: path.into(), cause: cause.into() }
    }

    /// The same problem with the cause type of a crate further up, such as a scenario's.
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

/// What is wrong with a value of any kind.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ValueError {
    /// A number is out of its range. The unit is empty for a plain count.
    Range { given: f64, min: f64, max: f64, unit: &'static str },
    /// A text, list or byte string is too short or too long; `of` is `characters`, `bytes`, `axes`, …
    Length { given: usize, min: usize, max: usize, of: &'static str },
    /// Fields do not go together; the detail has which, why, and the remedy.
    Conflict { detail: &'static str },
    /// More work than a run may have; `of` is `ticks`, `cycles`, `table rows`, …
    TooMuch { given: f64, max: f64, of: &'static str },
}

impl ValueError {
    pub(crate) fn too_much(given: u64, max: u64, of: &'static str) -> Self {
        Self::TooMuch { given: given as f64, max: max as f64, of }
    }
}

impl fmt::Display for ValueError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range { given, min, max, unit } => {
                let (unit, space) = (unit_symbol(unit), if unit.is_empty() { "" } else { " " });
                write!(f, "{}{space}{unit} is out of range; use {}", Short(*given), Short(*min))?;
                if min < max {
                    write!(f, " to {}", Short(*max))?;
                }
                write!(f, "{space}{unit}")
            }
            Self::Length { given, min, max, of } => {
                write!(f, "{given} {}; use {min}", noun(*given, of))?;
                if min < max { write!(f, " to {max}") } else { Ok(()) }
            }
            Self::Conflict { detail } => f.write_str(detail),
            Self::TooMuch { given, max, of } => {
                let (given, max) = (Short(*given), Short(*max));
                write!(f, "{given} {of} exceed the maximum of {max}; use {}", smaller_load(of))
            }
        }
    }
}

fn noun(number: usize, plural: &str) -> &str {
    match (number, plural) {
        (1, "axes") => "axis",
        (1, "entries") => "entry",
        (1, _) => plural.strip_suffix('s').unwrap_or(plural),
        _ => plural,
    }
}

fn smaller_load(of: &str) -> &'static str {
    match of {
        "table rows" => "a higher acceleration or a lower top speed",
        "steps" => "a shorter motion, or run it by ticks",
        "steps of a table" => "a shorter motion, or a table for each part of it",
        "steps to be measured" | "seconds" | "cycles" => "a shorter motion",
        "slices" => "longer slices, a shorter duration or the exact method",
        "sine segments" => "a larger maximum deviation or fewer sines",
        "entries" => "a shorter motion or a larger tolerance",
        "cycles of tolerance" => "a smaller tolerance",
        "motor-steps of the plant" => "a shorter run, fewer channels or a larger step_cycles",
        "bytes of all frames and their repetitions" => {
            "a shorter motion, longer ticks, more ticks per frame or fewer attempts"
        }
        _ => "a shorter motion or longer ticks",
    }
}

/// What is wrong with a motion.
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
    /// The top speed is below the start speed; both in steps/s.
    TopBelowStart {
        top: f64,
        start: f64,
    },
    /// The top speed is above the maximum of the table; both in steps/s.
    TopAboveTable {
        top: f64,
        max: f64,
    },
    /// The table's timer is slower than the rate in steps/s.
    TimerTooSlow {
        rate: f64,
        timer_hz: u32,
    },
    /// A speed that follows from other numbers is too high; both in steps/s.
    TooFast {
        rate: f64,
        max: f64,
    },
    /// Slices are so short that none has a step, even at the top speed of `rate` steps/s.
    SliceTooShort {
        rate: f64,
        slice_s: f64,
    },
    /// Slices cannot contain all steps, even at the maximum rate in steps/s.
    SlicesTooFew {
        slices: u64,
        slice_s: f64,
        steps: u64,
        rate: f64,
    },
    NoSteps {
        steps: f64,
    },
    /// The time of a point is not later than that of the previous point by at least `min`; all in s.
    NotRising {
        given: f64,
        before: f64,
        min: f64,
    },
    /// A tick (from 0) needs more steps than it has slots, so a rate above the limit of the bus; both in steps/s.
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
    /// A step (from 1) of a motion follows the previous step, or the start, after too few cycles.
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
                "{} {} is not available with {mechanics} mechanics; use steps or other mechanics",
                Short(*given),
                unit_symbol(unit)
            ),
            Self::RampTooLong { ramp_s, duration_s } => write!(
                f,
                "two ramps of {} s do not fit in {} s; use a ramp of at most {} s",
                Short(*ramp_s),
                Short(*duration_s),
                Short(duration_s / 2.0)
            ),
            Self::TopBelowStart { top, start } => write!(
                f,
                "a top speed of {} steps/s is below the start speed of {} steps/s; use a higher top speed or a lower start speed",
                Short(*top),
                Short(*start)
            ),
            Self::TopAboveTable { top, max } => write!(
                f,
                "a top speed of {} steps/s is above the table's maximum of {} steps/s; use a lower top speed or a higher maximum",
                Short(*top),
                Short(*max)
            ),
            Self::TimerTooSlow { rate, timer_hz } => {
                let rate = Short(*rate);
                write!(f, "a timer of {timer_hz} Hz is too slow for {rate} steps/s; use at least {rate} Hz")
            }
            Self::TooFast { rate, max } => write!(
                f,
                "the motion needs {} steps/s, above the maximum of {}; use more time or less distance",
                Short(libm::ceil(*rate)),
                Short(*max)
            ),
            Self::SliceTooShort { rate, slice_s } => write!(
                f,
                "a slice of {} s has only {} steps at the top speed of {} steps/s; use slices of at least {} s, more distance, less time or the exact method",
                Short(*slice_s),
                Short(rate * slice_s),
                Short(*rate),
                Short(1.0 / rate)
            ),
            Self::SlicesTooFew { slices, slice_s, steps, rate } => write!(
                f,
                "{slices} slice{} of {} s cannot contain {steps} steps, even at {} steps/s, because a slice has the rate at its start; use shorter slices or the exact method",
                if *slices == 1 { "" } else { "s" },
                Short(*slice_s),
                Short(*rate)
            ),
            Self::NoSteps { steps } => {
                write!(f, "{} steps is less than one step; use at least one step, or a dwell", Short(*steps))
            }
            Self::NotRising { given, before, min } => write!(
                f,
                "a time of {} s is not at least {} s after the previous time of {} s; use rising times",
                Short(*given),
                Short(*min),
                Short(*before)
            ),
            Self::TooManySteps { tick, steps, slots, rate, limit } => write!(
                f,
                "tick {tick} needs {steps} steps ({} steps/s), but its {slots} slots allow {} steps/s; use a slower motion or a shorter step period",
                Short(*rate),
                Short(*limit)
            ),
            Self::NoSegmentSteps => f.write_str("0 steps; use at least 1 step, or a dwell"),
            Self::SegmentInterval { step, interval, pulse } => {
                write!(f, "step {step} has an interval of {interval}/65536 cycles")?;
                if *interval > u64::MAX.into() {
                    write!(f, "; use at most {}", u64::MAX)
                } else {
                    let min = pulse.min_interval().0 << FRACTION_BITS;
                    write!(f, ", {}; use at least {min}, or shorter pulse times", pulse_needs(*pulse))
                }
            }
            Self::SegmentEnd { next } => write!(
                f,
                "the segment ends too late, at {next}/65536 cycles; use at most {}/65536 (cycle {})",
                u64::MAX,
                LAST_CYCLE.0
            ),
            Self::StepTooSoon { step, interval, pulse } => write!(
                f,
                "step {step} comes {interval} cycles after {}, {}; use a slower motion or shorter pulse times",
                if *step == 1 { "the start" } else { "the previous step" },
                pulse_needs(*pulse)
            ),
        }
    }
}

fn pulse_needs(pulse: PulseTimes) -> String {
    let PulseTimes { width, setup, hold } = pulse;
    let min = pulse.min_interval().0;
    let (width, setup, hold) = (width.0, setup.0, hold.0);
    format!("but a pulse needs {min} (width {width} + max(hold {hold} + setup {setup}, 1))")
}

struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        let magnitude = libm::fabs(value);
        if value == libm::trunc(value) && magnitude < 1e17 {
            write!(f, "{value:.0}")
        } else if (1e-3..1e6).contains(&magnitude) {
            let text = format!("{value:.4}");
            f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
        } else {
            let text = format!("{value:.5e}");
            match text.split_once('e') {
                Some((digits, power)) => {
                    write!(f, "{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
                }
                None => f.write_str(&text),
            }
        }
    }
}

/// The symbol of a JSON unit: `steps/s` for `steps_s`.
fn unit_symbol(unit: &str) -> &str {
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
