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

use alloc::{format, string::String, string::ToString};
use core::fmt;
use core::ops::{Range, RangeInclusive};
use stepscope_peripheral::segment::{FRACTION_BITS, LAST_CYCLE, PulseTimes, Refusal};

/// A problem of one value, shown as `path: cause`.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem<C = Cause> {
    /// Such as `source.motion.axes[0].moves[2].cosine.ramp_s`; empty for the whole scenario.
    pub path: String,
    pub cause: C,
}

impl<C> Problem<C> {
    pub fn new(path: impl Into<String>, cause: impl Into<C>) -> Self {
        Self { path: path.into(), cause: cause.into() }
    }

    /// The same problem with the cause type of a crate that depends on this one, such as a scenario's.
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
                let (given, shown_min) = (outside(*given, *min..=*max), rounded_up(*min));
                write!(f, "{given}{space}{unit} is out of range; use {shown_min}")?;
                if min < max {
                    write!(f, " to {}", rounded_down(*max))?;
                }
                write!(f, "{space}{unit}")
            }
            Self::Length { given, min, max, of } => {
                write!(f, "{given} {}; use {min}", noun(*given, of))?;
                if min < max { write!(f, " to {max}") } else { Ok(()) }
            }
            Self::Conflict { detail } => f.write_str(detail),
            Self::TooMuch { given, max, of } => {
                let (given, max) = (outside(*given, 0.0..=*max), rounded_down(*max));
                write!(f, "{given} {of} exceed the maximum of {max}; use {}", remedy_for(of))
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

/// What makes a quantity, as named in [`ValueError::TooMuch`], smaller.
fn remedy_for(quantity: &str) -> &'static str {
    match quantity {
        "table rows" => "a higher acceleration or a lower top speed",
        "steps" => "a shorter motion, or run it by ticks",
        "steps of a table" => "a shorter motion, or a table for each part of it",
        "steps to be measured" | "seconds" | "cycles" => "a shorter motion",
        "changes of a shaped curve" => "fewer moves, periods or points, or no input shaper",
        "waypoints of all axes" => "fewer points",
        "slices" => "longer slices, a shorter duration or the exact method",
        "sine segments" => "a larger maximum deviation or fewer sines",
        "entries" => "a shorter motion or a larger tolerance",
        "cycles of tolerance" => "a smaller tolerance",
        "grid steps of all motors" => "a shorter run, fewer channels or a larger step_cycles",
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
    /// A value of any kind is wrong.
    Value(ValueError),
    /// The unit is not available for this kind of mechanics.
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
    /// A distance rounds to 0 steps.
    NoSteps {
        steps: f64,
    },
    /// The time of a point is not at least `min` later than the previous point's time; all in s.
    NotRising {
        given: f64,
        before: f64,
        min: f64,
    },
    /// A speed at the start or the end of a move, in steps/s, is above the move's maximum.
    EdgeAboveMax {
        speed: f64,
        max: f64,
    },
    /// A speed along the axis in steps/s points against the travel of a move.
    SpeedAgainstMove {
        speed: f64,
        steps: i64,
    },
    /// A move is shorter than the ramp between its start and end speeds; distances in steps, the jerk may be infinite.
    TooShortForRamp {
        steps: f64,
        needed: f64,
        from: f64,
        to: f64,
        acceleration: f64,
        jerk: f64,
    },
    /// A move in a given time would have to stop or reverse between its start and end speeds.
    NoPlateau {
        steps: f64,
        needed: f64,
        plateau: f64,
        start: f64,
        end: f64,
    },
    /// The speed in steps/s jumps at the start or the end of a move by more than the start-stop speed.
    JumpTooHigh {
        before: f64,
        after: f64,
        jump: f64,
        max: f64,
        at: &'static str,
    },
    /// A move follows a table instead of a curve.
    FollowsTable {
        what: &'static str,
        remedy: &'static str,
    },
    /// A move that needs a whole step begins at this position in steps.
    BetweenSteps {
        position: f64,
    },
    /// A new target without a move before it.
    NothingToRetarget,
    /// A cut after the end of the move; both in s.
    CutTooLate {
        at_s: f64,
        duration_s: f64,
    },
    RetargetInGroup,
    /// A group ends before its slowest move; both in s.
    GroupTooShort {
        duration_s: f64,
        needed_s: f64,
    },
    /// A speed in steps/s is given at a point where the axis starts, ends, reverses or rests.
    SpeedWhereAxisStands {
        speed: f64,
    },
    /// A section takes so long that an axis would have to slow down between the given speeds in steps/s.
    SectionTooSlow {
        duration_s: f64,
        max_s: f64,
        from: f64,
        to: f64,
    },
    /// Tick `tick` (from 0) needs more steps than its slots allow: `rate` instead of `limit` in steps/s.
    TooManySteps {
        tick: u64,
        steps: u64,
        slots: u8,
        rate: f64,
        limit: f64,
    },
    /// A segment of steps has a count of 0.
    EmptySegment,
    /// The interval of a segment's step (from 1), in 1/65536 cycle, is out of its range.
    SegmentInterval {
        step: u64,
        interval: i128,
        pulse: PulseTimes,
    },
    /// The end of a segment, in 1/65536 cycle, exceeds 64 bits.
    SegmentEndTooLate {
        end: i128,
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
    /// The cause for a refused list of segments.
    pub fn of_refusal(refusal: Refusal, pulse: PulseTimes) -> Self {
        match refusal {
            Refusal::Interval { step, interval } => {
                Self::SegmentInterval { step: u64::from(step) + 1, interval, pulse }
            }
            Refusal::End { next } => Self::SegmentEndTooLate { end: next },
            Refusal::NoSteps | Refusal::NoChannel | Refusal::Start => Self::EmptySegment,
        }
    }

    /// Whether the check used several fields. Such a problem is skipped if one of them is unreadable.
    pub const fn depends_on_several_fields(&self) -> bool {
        !matches!(self, Self::Value(ValueError::Range { .. }) | Self::NoSteps { .. } | Self::EmptySegment)
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
                outside(*ramp_s, 0.0..=duration_s / 2.0),
                Short(*duration_s),
                rounded_down(duration_s / 2.0)
            ),
            Self::TopBelowStart { top, start } => write!(
                f,
                "a top speed of {} steps/s is below the start speed of {} steps/s; use a higher top speed or a lower start speed",
                outside(*top, *start..=f64::MAX),
                Short(*start)
            ),
            Self::TopAboveTable { top, max } => write!(
                f,
                "a top speed of {} steps/s is above the table's maximum of {} steps/s; use a lower top speed or a higher maximum",
                outside(*top, 0.0..=*max),
                Short(*max)
            ),
            Self::TimerTooSlow { rate, timer_hz } => {
                let (shown_rate, min) =
                    (outside(*rate, 0.0..=f64::from(*timer_hz)), Short(libm::ceil(*rate)));
                write!(
                    f,
                    "a timer of {timer_hz} Hz is too slow for {shown_rate} steps/s; use at least {min} Hz"
                )
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
                outside(*slice_s, 1.0 / rate..=f64::MAX),
                outside(rate * slice_s, 1.0..=f64::MAX),
                Short(*rate),
                rounded_up(1.0 / rate)
            ),
            Self::SlicesTooFew { slices, slice_s, steps, rate } => write!(
                f,
                "{slices} slice{} of {} s cannot contain {steps} steps, even at {} steps/s, because a slice has the rate at its start; use shorter slices or the exact method",
                if *slices == 1 { "" } else { "s" },
                Short(*slice_s),
                Short(*rate)
            ),
            Self::NoSteps { steps } => {
                let steps = outside(*steps, 1.0..=f64::MAX);
                write!(f, "{steps} steps is less than one step; use at least one step, or a dwell")
            }
            Self::NotRising { given, before, min } => write!(
                f,
                "a time of {} s is not at least {} s after the previous time of {} s; use rising times",
                Short(*given),
                Short(*min),
                Short(*before)
            ),
            Self::EdgeAboveMax { speed, max } => write!(
                f,
                "{} steps/s is above the maximum speed of {} steps/s; use at most {} steps/s",
                outside(*speed, 0.0..=*max),
                Short(*max),
                rounded_down(*max)
            ),
            Self::SpeedAgainstMove { speed, steps } => write!(
                f,
                "a speed of {} steps/s points against the travel of {steps} steps; use a speed of 0, or retarget",
                Short(*speed)
            ),
            Self::TooShortForRamp { steps, needed, from, to, acceleration, jerk } => {
                let change = if to > from { "speed up" } else { "slow down" };
                let jerk =
                    if jerk.is_finite() { format!(" and {} steps/s^3", Short(*jerk)) } else { String::new() };
                write!(
                    f,
                    "{} steps are too short to {change} from {} to {} steps/s: that takes {} steps at {} steps/s^2{jerk}; use at least {} steps",
                    outside(*steps, *needed..=f64::MAX),
                    Short(*from),
                    Short(*to),
                    Short(*needed),
                    Short(*acceleration),
                    Short(libm::ceil(*needed))
                )
            }
            Self::NoPlateau { steps, needed, plateau, start, end } => write!(
                f,
                "{} steps from {} to {} steps/s need a plateau of {} steps/s, which is not above 0; use more than {} steps, or shorter ramps",
                Short(*steps),
                Short(*start),
                Short(*end),
                Short(*plateau),
                Short(libm::ceil(*needed))
            ),
            Self::JumpTooHigh { before, after, jump, max, at } => write!(
                f,
                "the speed jumps from {} to {} steps/s at the {at} of the move, and {} steps/s is above the start-stop speed of {} steps/s; use a jump of at most {} steps/s, or a higher start-stop speed",
                Short(*before),
                Short(*after),
                outside(*jump, 0.0..=*max),
                Short(*max),
                rounded_down(*max)
            ),
            Self::FollowsTable { what, remedy } => {
                write!(f, "a move that follows a table {what}; use {remedy}")
            }
            Self::BetweenSteps { position } => write!(
                f,
                "the move begins at {position} steps, between two steps, which its kind cannot; use a jerk_limited, trapezoid, cosine, ramps or constant move first, or retarget to a position"
            ),
            Self::NothingToRetarget => {
                f.write_str("there is no previous move to retarget; use a move before it")
            }
            Self::CutTooLate { at_s, duration_s } => write!(
                f,
                "a cut at {} s is after the end of the previous move, which takes {} s; use at most {} s",
                outside(*at_s, 0.0..=*duration_s),
                Short(*duration_s),
                rounded_down(*duration_s)
            ),
            Self::RetargetInGroup => {
                f.write_str("a move of a group cannot be retargeted; use a move of its own kind")
            }
            Self::GroupTooShort { duration_s, needed_s } => write!(
                f,
                "{} s are too short for the slowest move, which takes {} s; use at least {} s, or null",
                outside(*duration_s, *needed_s..=f64::MAX),
                Short(*needed_s),
                rounded_up(*needed_s)
            ),
            Self::SpeedWhereAxisStands { speed } => write!(
                f,
                "{} steps/s is given at a point where the axis starts, ends, reverses or rests; use 0 or null",
                Short(*speed)
            ),
            Self::SectionTooSlow { duration_s, max_s, from, to } => write!(
                f,
                "the section takes {} s, but with {} and {} steps/s at its ends this axis can take at most {} s; use lower speeds or null",
                outside(*duration_s, 0.0..=*max_s),
                Short(*from),
                Short(*to),
                Short(*max_s)
            ),
            Self::TooManySteps { tick, steps, slots, rate, limit } => write!(
                f,
                "tick {tick} needs {steps} steps ({} steps/s), but its {slots} slots allow {} steps/s; use a slower motion or a shorter step period",
                Short(*rate),
                Short(*limit)
            ),
            Self::EmptySegment => f.write_str("0 steps; use at least 1 step, or a dwell"),
            Self::SegmentInterval { step, interval, pulse } => {
                let (min, max) = (pulse.min_interval().0, LAST_CYCLE.0);
                let given = outside(*interval as f64 / PARTS_PER_CYCLE, min as f64..=max as f64);
                write!(f, "step {step} follows after {given} cycle{}", if given == "1" { "" } else { "s" })?;
                if *interval > u64::MAX.into() {
                    write!(f, "; use at most {max} cycles")
                } else {
                    let min = counted(min, "cycles");
                    write!(f, ", {}; use at least {min}, or shorter pulse times", pulse_needs(*pulse))
                }
            }
            Self::SegmentEndTooLate { end } => write!(
                f,
                "the segment ends too late, in cycle {}; use at most cycle {}",
                end >> FRACTION_BITS,
                LAST_CYCLE.0
            ),
            Self::StepTooSoon { step, interval, pulse } => write!(
                f,
                "step {step} comes {} after {}, {}; use a slower motion or shorter pulse times",
                counted(*interval, "cycles"),
                if *step == 1 { "the start" } else { "the previous step" },
                pulse_needs(*pulse)
            ),
        }
    }
}

const PARTS_PER_CYCLE: f64 = (1_u64 << FRACTION_BITS) as f64;

/// Such as `2 cycles`.
fn counted(number: u64, plural: &str) -> String {
    format!("{number} {}", noun(usize::try_from(number).unwrap_or(usize::MAX), plural))
}

fn pulse_needs(pulse: PulseTimes) -> String {
    let min = counted(pulse.min_interval().0, "cycles");
    let PulseTimes { width, setup, hold } = pulse;
    let (width, setup, hold) = (width.0, setup.0, hold.0);
    format!("but a pulse needs {min} (width {width} + max(hold {hold} + setup {setup}, 1))")
}

/// A value outside a range, with as many digits as are needed to see that it is outside.
fn outside(value: f64, range: RangeInclusive<f64>) -> String {
    if range.contains(&Short(value).shown()) { value.to_string() } else { Short(value).to_string() }
}

/// A minimum that is still allowed as it is shown.
fn rounded_up(min: f64) -> Short {
    let magnitude = libm::fabs(min);
    let last_place = if FIXED_POINT.contains(&magnitude) { 1e-4 } else { magnitude * 1e-5 };
    if Short(min).shown() < min { Short(min + last_place) } else { Short(min) }
}

/// A maximum that is still allowed as it is shown.
fn rounded_down(max: f64) -> Short {
    Short(-rounded_up(-max).0)
}

/// Magnitudes that are shown without an exponent; whole numbers are up to 1e17.
const FIXED_POINT: Range<f64> = 1e-3..1e6;

/// A number with four decimals or six digits, rounded to nearest.
struct Short(f64);

impl Short {
    /// The number as the text states it.
    fn shown(&self) -> f64 {
        self.to_string().parse().unwrap_or(self.0)
    }
}

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        let magnitude = libm::fabs(value);
        if value == libm::trunc(value) && magnitude < 1e17 {
            write!(f, "{value:.0}")
        } else if FIXED_POINT.contains(&magnitude) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_peripheral::units::Cycles;

    fn pulse() -> PulseTimes {
        PulseTimes { width: Cycles(1), setup: Cycles(1), hold: Cycles(0) }
    }

    #[test]
    fn a_value_out_of_range_is_not_shown_as_its_bound() {
        let rows = [
            (1.000_01, 0.0, 1.0, "1.00001 is out of range; use 0 to 1"),
            (1_000_000.4, 1.0, 1e6, "1000000.4 is out of range; use 1 to 1000000"),
            (2.5, 0.0, 1.0, "2.5 is out of range; use 0 to 1"),
            (1e300, 0.0, 1.0, "1e300 is out of range; use 0 to 1"),
        ];
        for (given, min, max, expected) in rows {
            assert_eq!(ValueError::Range { given, min, max, unit: "" }.to_string(), expected);
        }
        let top = Cause::TopAboveTable { top: 100.000_01, max: 100.0 }.to_string();
        assert!(top.starts_with("a top speed of 100.00001 steps/s is above"), "{top}");
    }

    #[test]
    fn suggested_bounds_are_allowed() {
        let ramp = Cause::RampTooLong { ramp_s: 0.002, duration_s: 0.003_35 }.to_string();
        assert!(ramp.ends_with("use a ramp of at most 0.0016 s"), "{ramp}");
        let slice = Cause::SliceTooShort { rate: 9000.0, slice_s: 1e-4 }.to_string();
        assert!(slice.contains("use slices of at least 1.11112e-4 s"), "{slice}");
        let timer = Cause::TimerTooSlow { rate: 3_999.000_01, timer_hz: 3999 }.to_string();
        assert_eq!(timer, "a timer of 3999 Hz is too slow for 3999.00001 steps/s; use at least 4000 Hz");
        for bound in [1.0 / 3.0, 2.0 / 3.0, 1e-7 / 3.0, 2e-7 / 3.0, 1e9 / 7.0, 0.0, 5.0, -1.0 / 3.0] {
            assert!(rounded_up(bound).shown() >= bound, "{bound}");
            assert!(rounded_down(bound).shown() <= bound, "{bound}");
        }
    }

    #[test]
    fn intervals_of_segments_are_in_cycles() {
        let interval = |interval| Cause::SegmentInterval { step: 3, interval, pulse: pulse() }.to_string();
        assert_eq!(
            interval(1 << 16),
            "step 3 follows after 1 cycle, but a pulse needs 2 cycles (width 1 + max(hold 0 + setup 1, 1)); \
             use at least 2 cycles, or shorter pulse times"
        );
        assert_eq!(
            interval(1 << 64),
            "step 3 follows after 281474976710656 cycles; use at most 281474976710655 cycles"
        );
    }

    #[test]
    fn steps_are_counted_from_1() {
        let refusal = Refusal::Interval { step: 0, interval: 1 << 16 };
        let text = Cause::of_refusal(refusal, pulse()).to_string();
        assert!(text.starts_with("step 1 follows"), "{text}");
    }
}
