//! What can be wrong with a motion: every problem with its path, what was given, what is allowed, and what to change;
//! and the one collector of problems, which the scenario shares.
//!
//! ```
//! use stepscope_motion::problem::{Validator, ValueError};
//!
//! let mut validator: Validator = Validator::default();
//! validator.range("axis.speed", 12_000.0, 1.0..=10_000.0, "steps/s");
//! let problems = validator.end(()).unwrap_err();
//! assert_eq!(problems[0].path, "axis.speed");
//! assert!(problems[0].to_string().starts_with("axis.speed: 12000 steps/s"), "{}", problems[0]);
//! ```

use alloc::string::String;
use alloc::vec::Vec;
use core::{
    fmt::{self, Write as _},
    ops::RangeInclusive,
};
use stepscope_peripheral::segment::{FRACTION_BITS, LAST_CYCLE, PulseTimes};

/// Maximum problems of one scenario that are listed.
pub const MAX_PROBLEMS: usize = 100;

/// One problem, at the path of the field that has to change.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem<C = Cause> {
    /// Path of the field, such as `source.motion.axes[0].moves[2].cosine.ramp_s`; empty for the whole.
    pub path: String,
    /// What is wrong.
    pub cause: C,
}

impl<C> Problem<C> {
    /// A problem at `path`.
    #[must_use]
    pub fn new(path: impl Into<String>, cause: impl Into<C>) -> Self {
        Self { path: path.into(), cause: cause.into() }
    }

    /// The same problem among causes of a wider kind.
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

/// Collects problems, lists [`MAX_PROBLEMS`] of them at most and counts all, and knows the way to the value that is being judged: a path is made
/// where its problem is found, and never rewritten.
///
/// A `step` is what stands one step further in: the name of a field or several with dots between them; empty is the
/// value itself.
#[derive(Clone, Debug)]
pub struct Validator<C = Cause> {
    path: String,
    /// The first of them.
    problems: Vec<Problem<C>>,
    /// How many there are: what is not listed is wrong all the same.
    found: usize,
}

impl<C> Default for Validator<C> {
    fn default() -> Self {
        Self::within(String::new())
    }
}

impl<C> Validator<C> {
    /// A collector for a part that stands at `path` in the whole.
    #[must_use]
    pub fn within(path: impl Into<String>) -> Self {
        Self { path: path.into(), problems: Vec::new(), found: 0 }
    }

    /// Goes a step further in; gives what [`Self::leave`] takes to come back.
    #[must_use = "leave takes it"]
    pub fn enter(&mut self, step: &str) -> usize {
        let outside = self.path.len();
        if outside > 0 && !step.is_empty() {
            self.path.push('.');
        }
        self.path.push_str(step);
        outside
    }

    /// Goes into an entry of a list.
    #[must_use = "leave takes it"]
    pub fn enter_entry(&mut self, index: usize) -> usize {
        let outside = self.path.len();
        // Writing to a text cannot fail.
        let _ = write!(self.path, "[{index}]");
        outside
    }

    /// Comes back to where an `enter` stood.
    pub fn leave(&mut self, outside: usize) {
        self.path.truncate(outside);
    }

    /// Does something one step further in, and comes back.
    pub fn at<T>(&mut self, step: &str, what: impl FnOnce(&mut Self) -> T) -> T {
        let outside = self.enter(step);
        let made = what(self);
        self.leave(outside);
        made
    }

    /// Does something in an entry of a list, and comes back.
    pub fn at_entry<T>(&mut self, index: usize, what: impl FnOnce(&mut Self) -> T) -> T {
        let outside = self.enter_entry(index);
        let made = what(self);
        self.leave(outside);
        made
    }

    /// The way to the value that is being judged.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Whether something is wrong a `step` further in already.
    #[must_use]
    pub fn has(&mut self, step: &str) -> bool {
        self.at(step, |here| here.problems.iter().any(|problem| problem.path == here.path))
    }
}

impl<C: From<ValueError>> Validator<C> {
    /// Adds a problem of what stands a `step` further in.
    pub fn add(&mut self, step: &str, cause: impl Into<C>) {
        self.found += 1;
        if self.problems.len() < MAX_PROBLEMS {
            let outside = self.enter(step);
            self.problems.push(Problem::new(self.path.as_str(), cause));
            self.leave(outside);
        }
    }

    /// Adds problems whose paths are whole already, such as those of a plan; they may be of a narrower kind.
    pub fn extend<D: Into<C>>(&mut self, problems: impl IntoIterator<Item = Problem<D>>) {
        for Problem { path, cause } in problems {
            self.found += 1;
            if self.problems.len() < MAX_PROBLEMS {
                self.problems.push(Problem { path, cause: cause.into() });
            }
        }
    }

    /// What a part gives, or its problems.
    pub fn take<T, D: Into<C>>(&mut self, result: Result<T, Vec<Problem<D>>>) -> Option<T> {
        result.map_err(|problems| self.extend(problems)).ok()
    }

    /// A number, if it lies in its range.
    pub fn range(
        &mut self,
        step: &str,
        given: f64,
        range: RangeInclusive<f64>,
        unit: &'static str,
    ) -> Option<f64> {
        if range.contains(&given) {
            return Some(given);
        }
        let (least, most) = range.into_inner();
        self.add(step, ValueError::Range { given, least, most, unit });
        None
    }

    /// Judges a whole number; it is told as f64, which is exact for all that is allowed.
    pub fn whole(
        &mut self,
        step: &str,
        given: impl Into<u64>,
        range: RangeInclusive<u64>,
        unit: &'static str,
    ) {
        let given = given.into();
        if !range.contains(&given) {
            let (given, least, most) = (given as f64, *range.start() as f64, *range.end() as f64);
            self.add(step, ValueError::Range { given, least, most, unit });
        }
    }

    /// Judges how many `of` something there are.
    pub fn length(&mut self, step: &str, given: usize, range: RangeInclusive<usize>, of: &'static str) {
        if !range.contains(&given) {
            let (least, most) = range.into_inner();
            self.add(step, ValueError::Length { given, least, most, of });
        }
    }

    /// How many problems there are so far, those that are not listed among them.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.found
    }

    /// Whether nothing is wrong so far.
    #[must_use]
    pub const fn is_ok(&self) -> bool {
        self.found == 0
    }

    /// The problems that are listed.
    #[must_use]
    pub fn problems(self) -> Vec<Problem<C>> {
        self.problems
    }

    /// The value, or the problems that are listed.
    ///
    /// # Errors
    /// If there is a problem.
    pub fn end<T>(self, value: T) -> Result<T, Vec<Problem<C>>> {
        if self.is_ok() { Ok(value) } else { Err(self.problems) }
    }
}

/// What can be wrong with a value by itself.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ValueError {
    /// A number out of its range.
    Range {
        /// The number.
        given: f64,
        /// Minimum allowed.
        least: f64,
        /// Maximum allowed.
        most: f64,
        /// Unit of all three, empty for a plain count.
        unit: &'static str,
    },
    /// A text, list or byte string of a length that is not allowed.
    Length {
        /// Its length.
        given: usize,
        /// Minimum allowed.
        least: usize,
        /// Maximum allowed.
        most: usize,
        /// What is counted: `characters`, `bytes`, `axes`, …
        of: &'static str,
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

/// What is wrong with a motion, with the numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// A value by itself.
    Value(ValueError),
    /// A quantity in a unit that the axis's mechanics do not have.
    NoSuchUnit {
        /// The number.
        given: f64,
        /// Its unit.
        unit: &'static str,
        /// The kind of the mechanics.
        mechanics: &'static str,
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
        /// Maximum speed of the table in steps/s.
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
        /// Maximum allowed.
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
}

impl From<ValueError> for Cause {
    fn from(error: ValueError) -> Self {
        Self::Value(error)
    }
}

impl Cause {
    /// Whether it follows from several fields together, so that it means nothing while one of them cannot be read.
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
        }
    }
}

struct Least(PulseTimes);

impl fmt::Display for Least {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_whose_paths_are_whole_are_listed_after_those_before_them() {
        let mut validator = Validator::<Cause>::default();
        validator.add("a", Cause::NoSegmentSteps);
        validator.extend([Problem::<Cause>::new("b.c", Cause::NoSegmentSteps)]);
        assert_eq!(validator.count(), 2);
        let paths: Vec<_> = validator.problems().into_iter().map(|problem| problem.path).collect();
        assert_eq!(paths, ["a", "b.c"]);
    }

    #[test]
    fn what_is_not_listed_any_more_is_wrong_all_the_same() {
        let mut validator = Validator::<Cause>::default();
        for _ in 0..MAX_PROBLEMS {
            validator.add("a", Cause::NoSegmentSteps);
        }
        let before = validator.count();
        validator.add("b", Cause::NoSegmentSteps);
        assert_eq!(validator.count(), before + 1);
        validator.extend([Problem::<Cause>::new("c", Cause::NoSegmentSteps)]);
        assert_eq!((validator.count(), validator.is_ok()), (before + 2, false));
        let problems = validator.problems();
        assert_eq!(problems.len(), MAX_PROBLEMS);
        assert!(problems.iter().all(|problem| problem.path == "a"));
    }
}
