//! From a scenario's axis to its moves one after another, or to every problem that it has.
//!
//! ```text
//! position  |        _____ _        each move begins where and when the one before has ended;
//!           |      /       \        before the first an axis stands at 0, after the last at the
//!           |____/          \___    sum of all
//!            dwell cosine  constant
//! ```

use super::{
    Curve, MOST_SPEED, Peaks, Profile,
    asked::Asked,
    cosine::Cosine,
    round_half_up,
    sine_segments::SineSegments,
    steady::{Constant, Dwell},
    trapezoid::Trapezoid,
    trapezoid_table::{NoTable, TrapezoidTable},
};
use crate::scenario::{self, Axis, Cause, Move, Problem, TrapezoidMethod};
use alloc::{format, vec::Vec};

/// Most moves of an axis.
const MOST_MOVES: usize = 64;
/// Most rows that the acceleration tables of one axis may have together.
const MOST_TABLE_ROWS: u64 = 1_000_000;
/// Longest time of an axis in s.
const MOST_DURATION_S: f64 = 1e6;
/// Most periods of a sine.
const MOST_PERIODS: f64 = 1e6;

/// A move in its place on the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMove {
    /// When it starts, in s.
    pub start_s: f64,
    /// Where it starts, in steps.
    pub start_steps: i64,
    /// Its curve, from 0.
    pub profile: Profile,
}

/// The whole motion of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisPlan {
    /// Invariant: at least one; each starts when and where the one before ends.
    moves: Vec<PlannedMove>,
    duration_s: f64,
    steps: i64,
}

impl AxisPlan {
    fn of(profiles: Vec<Profile>) -> Self {
        let (mut start_s, mut start_steps) = (0.0, 0);
        let moves = profiles
            .into_iter()
            .map(|profile| {
                let planned = PlannedMove { start_s, start_steps, profile };
                start_s += planned.profile.duration_s();
                start_steps += planned.profile.steps();
                planned
            })
            .collect();
        Self { moves, duration_s: start_s, steps: start_steps }
    }

    /// The moves, in order.
    #[must_use]
    pub fn moves(&self) -> &[PlannedMove] {
        &self.moves
    }

    /// How long all moves last, in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Where the axis ends, in steps from where it began.
    #[must_use]
    pub fn steps(&self) -> i64 {
        self.steps
    }

    /// The move at `t` and the time in it; of moves that begin at the same time the last.
    fn at(&self, t: f64) -> Option<(&PlannedMove, f64)> {
        let after = self.moves.partition_point(|planned| planned.start_s <= t);
        let planned = self.moves.get(after.saturating_sub(1))?;
        Some((planned, t - planned.start_s))
    }

    /// Position at `t` s in steps, not rounded.
    #[must_use]
    pub fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s {
            return self.steps as f64;
        }
        self.at(t).map_or(0.0, |(planned, t)| planned.start_steps as f64 + planned.profile.position(t))
    }

    /// Steps due by `t` s: B1's rounding of the position.
    ///
    /// A move starts at a whole step, so only its own part is rounded.
    #[must_use]
    pub fn steps_due(&self, t: f64) -> i64 {
        if t >= self.duration_s {
            return self.steps;
        }
        self.at(t).map_or(0, |(planned, t)| {
            planned.start_steps.saturating_add(round_half_up(planned.profile.position(t)))
        })
    }

    /// Speed at `t` s in steps/s; 0 before the start and from the end on.
    #[must_use]
    pub fn speed(&self, t: f64) -> f64 {
        self.while_moving(t, Profile::speed)
    }

    /// Acceleration at `t` s in steps/s^2; 0 before the start, from the end on, and where the
    /// speed jumps.
    #[must_use]
    pub fn acceleration(&self, t: f64) -> f64 {
        self.while_moving(t, Profile::acceleration)
    }

    fn while_moving(&self, t: f64, of: fn(&Profile, f64) -> f64) -> f64 {
        if t < 0.0 || t >= self.duration_s {
            return 0.0;
        }
        self.at(t).map_or(0.0, |(planned, t)| of(&planned.profile, t))
    }

    /// The greatest magnitudes of the whole axis, with the jumps at and between the moves' ends.
    #[must_use]
    pub fn peaks(&self) -> Peaks {
        let (mut peaks, mut speed) = (Peaks::default(), 0.0);
        for PlannedMove { profile, .. } in &self.moves {
            let jump = libm::fabs(profile.speed(0.0) - speed);
            peaks = peaks.or(profile.peaks()).or(Peaks { jump, ..Peaks::default() });
            speed = profile.speed(profile.duration_s());
        }
        peaks.or(Peaks { jump: libm::fabs(speed), ..Peaks::default() })
    }
}

/// Plans an axis; `path` is where it stands in the scenario, such as `source.motion.axes[0]`.
///
/// Distances are rounded half up to whole steps; an axis has at most 64 moves, 1e6 s and 1e6 rows
/// of acceleration tables.
///
/// # Errors
/// Every problem of the axis, each with its path.
pub fn plan_axis(axis: &Axis, path: &str) -> Result<AxisPlan, Vec<Problem>> {
    let mut asked = Asked::new(&axis.mechanics, &format!("{path}.mechanics"));
    let moves_path = format!("{path}.moves");
    let given = axis.moves.len();
    if !(1..=MOST_MOVES).contains(&given) {
        let cause = Cause::Length { given, least: 1, most: MOST_MOVES, of: "moves" };
        asked.refuse(moves_path.as_str(), cause);
    }
    let mut rows_left = MOST_TABLE_ROWS;
    let mut profiles = Vec::new();
    // Past the most moves none is planned: the list's length is refused already.
    for (index, each) in axis.moves.iter().take(MOST_MOVES).enumerate() {
        let at = format!("{moves_path}[{index}]");
        if let Some(profile) = plan_move(&mut asked, each, &at, &mut rows_left) {
            profiles.push(profile);
        }
    }
    let plan = AxisPlan::of(profiles);
    if plan.duration_s > MOST_DURATION_S {
        let cause = Cause::TooMuch { given: plan.duration_s, most: MOST_DURATION_S, of: "seconds" };
        asked.refuse(moves_path, cause);
    }
    if asked.problems.is_empty() { Ok(plan) } else { Err(asked.problems) }
}

fn plan_move(asked: &mut Asked<'_>, given: &Move, path: &str, rows_left: &mut u64) -> Option<Profile> {
    match given {
        Move::Trapezoid(given) => plan_trapezoid(asked, given, &format!("{path}.trapezoid"), rows_left),
        Move::Cosine(given) => plan_cosine(asked, given, &format!("{path}.cosine")),
        Move::SineSegments(given) => plan_sine(asked, given, &format!("{path}.sine_segments")),
        Move::Constant(given) => {
            let steps = asked.distance(format!("{path}.constant.distance"), &given.distance);
            let speed = asked.speed(format!("{path}.constant.speed"), &given.speed);
            Some(Profile::Constant(Constant::new(steps?, speed?)))
        }
        Move::Dwell(given) => {
            let duration_s = asked.pause(format!("{path}.dwell.duration_s"), given.duration_s);
            Some(Profile::Dwell(Dwell::new(duration_s?)))
        }
    }
}

fn plan_trapezoid(
    asked: &mut Asked<'_>,
    given: &scenario::Trapezoid,
    path: &str,
    rows_left: &mut u64,
) -> Option<Profile> {
    // The table's first rate has to round to a pulse a second; the exact curve may start from rest.
    let least_start = match given.method {
        TrapezoidMethod::Table => 0.5,
        TrapezoidMethod::Exact => 0.0,
    };
    let steps = asked.distance(format!("{path}.distance"), &given.distance);
    let start = asked.speed_from(format!("{path}.start_speed"), &given.start_speed, least_start);
    let top = asked.speed(format!("{path}.top_speed"), &given.top_speed);
    let acceleration = asked.acceleration(format!("{path}.acceleration"), &given.acceleration);
    let timer_hz = match given.method {
        TrapezoidMethod::Table => {
            asked.range(format!("{path}.timer_hz"), given.timer_hz.into(), 1.0, u32::MAX.into(), "Hz")
        }
        TrapezoidMethod::Exact => Some(0.0),
    };
    if let (Some(start), Some(top)) = (start, top)
        && top < start
    {
        asked.refuse(format!("{path}.top_speed"), Cause::TopBelowStart { top, start });
        return None;
    }
    let (steps, start, top, acceleration) = (steps?, start?, top?, acceleration?);
    timer_hz?;
    if given.method == TrapezoidMethod::Exact {
        return Some(Profile::Trapezoid(Trapezoid::new(steps, start, top, acceleration)));
    }
    match TrapezoidTable::new(steps, (start, top, acceleration), given.timer_hz, *rows_left) {
        Ok(table) => {
            *rows_left -= table.kept_rows();
            Some(Profile::TrapezoidTable(table))
        }
        Err(NoTable::Rows { needed }) => {
            let (given, most) = ((MOST_TABLE_ROWS - *rows_left).saturating_add(needed), MOST_TABLE_ROWS);
            let cause = Cause::TooMuch { given: given as f64, most: most as f64, of: "table rows" };
            asked.refuse(path, cause);
            None
        }
        Err(NoTable::Timer { rate }) => {
            let cause = Cause::TimerTooSlow { rate, timer_hz: given.timer_hz };
            asked.refuse(format!("{path}.timer_hz"), cause);
            None
        }
    }
}

fn plan_cosine(asked: &mut Asked<'_>, given: &scenario::Cosine, path: &str) -> Option<Profile> {
    let steps = asked.distance(format!("{path}.distance"), &given.distance);
    let duration_s = asked.duration(format!("{path}.duration_s"), given.duration_s);
    let ramp_s = asked.pause(format!("{path}.ramp_s"), given.ramp_s);
    let (steps, duration_s, ramp_s) = (steps, duration_s?, ramp_s?);
    if ramp_s > duration_s / 2.0 {
        asked.refuse(format!("{path}.ramp_s"), Cause::RampTooLong { ramp_s, duration_s });
        return None;
    }
    let curve = Cosine::new(steps?, duration_s, ramp_s);
    hold_speed(asked, format!("{path}.duration_s"), curve.top_speed())?;
    Some(Profile::Cosine(curve))
}

fn plan_sine(asked: &mut Asked<'_>, given: &scenario::SineSegments, path: &str) -> Option<Profile> {
    let amplitude = asked.distance(format!("{path}.amplitude"), &given.amplitude);
    let period_s = asked.duration(format!("{path}.period_s"), given.period_s);
    let periods = asked.range(format!("{path}.periods"), given.periods.into(), 1.0, MOST_PERIODS, "");
    let deviation = asked.range(format!("{path}.max_deviation"), given.max_deviation, 0.0, 1.0, "");
    let (amplitude, period_s, deviation) = (amplitude?, period_s?, deviation?);
    periods?;
    let curve = SineSegments::new(amplitude, period_s, given.periods, deviation);
    hold_speed(asked, format!("{path}.period_s"), curve.peaks().speed)?;
    Some(Profile::SineSegments(curve))
}

/// Refuses a speed that no one gave but that follows from the numbers.
fn hold_speed(asked: &mut Asked<'_>, path: alloc::string::String, rate: f64) -> Option<()> {
    if rate <= MOST_SPEED {
        return Some(());
    }
    asked.refuse(path, Cause::TooFast { rate, most: MOST_SPEED });
    None
}
