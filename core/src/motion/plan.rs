//! From a scenario's axis to its plan, or to every problem that it has.
//!
//! A number is judged where it stands, with the path of its field; what only follows from several
//! (a top speed, a table's length) is judged when the curve is made.

mod motor;
mod points;
mod staircase;
mod timed;

use super::{
    AxisPlan, Curve, MOST_SPEED, Profile,
    acceleration_table::AccelerationTable,
    asked::Asked,
    jerk_limited::{JerkLimited, Limits},
    sine::Sine,
    sine_segments::SineSegments,
    steady::{Constant, Dwell},
    trapezoid::Trapezoid,
    trapezoid_table::{NoTable, TrapezoidTable},
};
use crate::{
    scenario::{self, Axis, Cause, Move, Problem, TrapezoidMethod},
    signal::MAX_CHANNELS,
};
use alloc::{format, string::String, vec::Vec};

/// Most moves of an axis.
const MOST_MOVES: usize = 64;
/// Most rows that all acceleration tables of a scenario may have together.
const MOST_TABLE_ROWS: u64 = 1_000_000;
/// Most segments that the quarters of all sines of a scenario may have together.
const MOST_SEGMENTS: usize = 65_536;
/// Most slices that all sliced cosines of a scenario may have together.
const MOST_SLICES: u64 = 100_000;
/// Longest time of an axis in s.
const MOST_DURATION_S: f64 = 1e6;
/// Most periods of a sine.
const MOST_PERIODS: f64 = 1e6;

/// What the axes of a scenario may still ask of memory and work.
struct Left {
    table_rows: u64,
    segments: usize,
    slices: u64,
}

impl Default for Left {
    fn default() -> Self {
        Self { table_rows: MOST_TABLE_ROWS, segments: MOST_SEGMENTS, slices: MOST_SLICES }
    }
}

/// Plans several lists of axes, one for each controller, each with its path.
///
/// Each axis is as [`plan_axis`] says; the tables and the sines of all together have to stay under
/// its bounds.
///
/// # Errors
/// Every problem of every axis, each with its path.
pub fn plan_lists<'a>(
    lists: impl IntoIterator<Item = (String, &'a [Axis])>,
) -> Result<Vec<Vec<AxisPlan>>, Vec<Problem>> {
    let (mut plans, mut problems, mut left) = (Vec::new(), Vec::new(), Left::default());
    for (path, axes) in lists {
        let mut list = Vec::new();
        // More axes than that are refused by their number.
        for (index, axis) in axes.iter().take(MAX_CHANNELS).enumerate() {
            match plan_within(axis, &format!("{path}[{index}]"), &mut left) {
                Ok(plan) => list.push(plan),
                Err(found) => problems.extend(found),
            }
        }
        plans.push(list);
    }
    if problems.is_empty() { Ok(plans) } else { Err(problems) }
}

/// Plans an axis; `path` is where it stands in the scenario, such as `source.motion.axes[0]`.
///
/// Distances are rounded half up to whole steps; an axis has at most 64 moves and 1e6 s, its
/// acceleration tables 1e6 rows and the quarters of its sines 65536 segments.
///
/// # Errors
/// Every problem of the axis, each with its path.
pub fn plan_axis(axis: &Axis, path: &str) -> Result<AxisPlan, Vec<Problem>> {
    plan_within(axis, path, &mut Left::default())
}

fn plan_within(axis: &Axis, path: &str, left: &mut Left) -> Result<AxisPlan, Vec<Problem>> {
    let mut asked = Asked::new(&axis.mechanics, &format!("{path}.mechanics"));
    motor::judge(&mut asked, axis, path);
    let moves_path = format!("{path}.moves");
    let given = axis.moves.len();
    if !(1..=MOST_MOVES).contains(&given) {
        let cause = Cause::Length { given, least: 1, most: MOST_MOVES, of: "moves" };
        asked.refuse(moves_path.as_str(), cause);
    }
    let mut profiles = Vec::new();
    // Past the most moves none is planned: the list's length is refused already.
    for (index, each) in axis.moves.iter().take(MOST_MOVES).enumerate() {
        let at = format!("{moves_path}[{index}]");
        if let Some(profile) = plan_move(&mut asked, each, &at, left) {
            profiles.push(profile);
        }
    }
    let plan = AxisPlan::of(profiles);
    if plan.duration_s() > MOST_DURATION_S {
        let cause = Cause::TooMuch { given: plan.duration_s(), most: MOST_DURATION_S, of: "seconds" };
        asked.refuse(moves_path, cause);
    }
    if asked.problems.is_empty() { Ok(plan) } else { Err(asked.problems) }
}

fn plan_move(asked: &mut Asked<'_>, given: &Move, path: &str, left: &mut Left) -> Option<Profile> {
    match given {
        Move::Trapezoid(given) => plan_trapezoid(asked, given, &format!("{path}.trapezoid"), left),
        Move::Staircase(given) => staircase::plan(asked, given, &format!("{path}.staircase"), left),
        Move::Cosine(given) => timed::plan_cosine(asked, given, &format!("{path}.cosine"), left),
        Move::Ramps(given) => timed::plan_ramps(asked, given, &format!("{path}.ramps")),
        Move::SineSegments(given) => plan_sine(asked, given, &format!("{path}.sine_segments"), left),
        Move::Sine(given) => plan_exact_sine(asked, given, &format!("{path}.sine")),
        Move::JerkLimited(given) => plan_jerk_limited(asked, given, &format!("{path}.jerk_limited")),
        Move::Points(given) => points::plan(asked, given, &format!("{path}.points")),
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
    left: &mut Left,
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
    let table = AccelerationTable::new(start, top, acceleration, given.timer_hz);
    match TrapezoidTable::new(steps, table, left.table_rows) {
        Ok(table) => {
            left.table_rows -= table.kept_rows();
            Some(Profile::TrapezoidTable(table))
        }
        Err(NoTable::Rows { needed }) => {
            let (given, most) = ((MOST_TABLE_ROWS - left.table_rows).saturating_add(needed), MOST_TABLE_ROWS);
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

fn plan_sine(
    asked: &mut Asked<'_>,
    given: &scenario::SineSegments,
    path: &str,
    left: &mut Left,
) -> Option<Profile> {
    let amplitude = asked.distance(format!("{path}.amplitude"), &given.amplitude);
    let period_s = asked.duration(format!("{path}.period_s"), given.period_s);
    let periods = asked.range(format!("{path}.periods"), given.periods.into(), 1.0, MOST_PERIODS, "");
    let deviation = asked.range(format!("{path}.max_deviation"), given.max_deviation, 0.0, 1.0, "");
    let (amplitude, period_s, deviation) = (amplitude?, period_s?, deviation?);
    periods?;
    let curve = SineSegments::new(amplitude, period_s, given.periods, deviation);
    let segments = curve.segments().len();
    let Some(still_left) = left.segments.checked_sub(segments) else {
        let (given, most) = (MOST_SEGMENTS - left.segments + segments, MOST_SEGMENTS);
        let cause = Cause::TooMuch { given: given as f64, most: most as f64, of: "sine segments" };
        asked.refuse(path, cause);
        return None;
    };
    left.segments = still_left;
    hold_speed(asked, format!("{path}.period_s"), curve.peaks().speed)?;
    Some(Profile::SineSegments(curve))
}

fn plan_exact_sine(asked: &mut Asked<'_>, given: &scenario::Sine, path: &str) -> Option<Profile> {
    let amplitude = asked.distance(format!("{path}.amplitude"), &given.amplitude);
    let period_s = asked.duration(format!("{path}.period_s"), given.period_s);
    asked.range(format!("{path}.periods"), given.periods.into(), 1.0, MOST_PERIODS, "")?;
    let curve = Sine::new(amplitude?, period_s?, given.periods);
    hold_speed(asked, format!("{path}.period_s"), curve.peaks().speed)?;
    Some(Profile::Sine(curve))
}

fn plan_jerk_limited(asked: &mut Asked<'_>, given: &scenario::JerkLimited, path: &str) -> Option<Profile> {
    let steps = asked.distance(format!("{path}.distance"), &given.distance);
    let speed = asked.speed(format!("{path}.max_speed"), &given.max_speed);
    let acceleration = asked.acceleration(format!("{path}.max_acceleration"), &given.max_acceleration);
    let jerk = asked.jerk(format!("{path}.max_jerk"), &given.max_jerk);
    let limits = Limits { speed: speed?, acceleration: acceleration?, jerk: jerk? };
    Some(Profile::JerkLimited(JerkLimited::new(steps?, limits)))
}

/// Refuses a speed that no one gave but that follows from the numbers.
fn hold_speed(asked: &mut Asked<'_>, path: String, rate: f64) -> Option<()> {
    if rate <= MOST_SPEED {
        return Some(());
    }
    asked.refuse(path, Cause::TooFast { rate, most: MOST_SPEED });
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Scenario, Source};
    use alloc::{string::ToString, vec};

    fn axis(json: &str) -> Axis {
        let text = format!(r#"{{"source":{{"motion":{{"axes":[{json}]}}}}}}"#);
        let Ok(Source::Motion(motion)) = Scenario::from_json(&text).map(|s| s.source) else {
            panic!("{json} does not read");
        };
        motion.axes.into_iter().next().unwrap()
    }

    fn plan(json: &str) -> Result<AxisPlan, Vec<Problem>> {
        plan_axis(&axis(json), "axis")
    }

    fn check(json: &str, expected: &[&str]) {
        let found: Vec<String> =
            plan(json).err().unwrap_or_default().iter().map(ToString::to_string).collect();
        assert_eq!(found, expected, "{json}");
    }

    #[test]
    fn every_problem_is_told_with_its_path() {
        check("{}", &[]);
        check(r#"{"moves":[]}"#, &["axis.moves: 0 moves; give 1 to 64"]);
        check(
            r#"{"moves":[{"cosine":{"distance":{"mm":3},"duration_s":0,"ramp_s":-1}},{"dwell":{"duration_s":1e300}}]}"#,
            &[
                "axis.moves[0].cosine.distance: 3 mm, but mechanics of kind rotary have no such unit; give steps, or choose mechanics that have it",
                "axis.moves[0].cosine.duration_s: 0 s is out of range; give 1e-6 to 86400 s",
                "axis.moves[0].cosine.ramp_s: -1 s is out of range; give 0 to 86400 s",
                "axis.moves[1].dwell.duration_s: 1e300 s is out of range; give 0 to 86400 s",
            ],
        );
        check(
            r#"{"moves":[{"cosine":{"duration_s":0.3,"ramp_s":0.2}},{"cosine":{"distance":{"steps":0.4}}},{"cosine":{"distance":{"steps":1e9}}}]}"#,
            &[
                "axis.moves[0].cosine.ramp_s: two ramps of 0.2 s do not fit in 0.3 s; give a ramp of at most 0.15 s",
                "axis.moves[1].cosine.distance: 0.4 steps is less than one step; give at least one step, or a dwell",
                "axis.moves[2].cosine.duration_s: this needs 5000000000 steps/s, at most 10000000 are allowed; give more time or less distance",
            ],
        );
        check(
            r#"{"moves":[{"trapezoid":{"start_speed":{"steps_s":5000},"timer_hz":0}},{"trapezoid":{"timer_hz":3999}},{"trapezoid":{"start_speed":{"steps_s":0}}},{"trapezoid":{"start_speed":{"steps_s":0},"method":"exact"}}]}"#,
            &[
                "axis.moves[0].trapezoid.timer_hz: 0 Hz is out of range; give 1 to 4294967295 Hz",
                "axis.moves[0].trapezoid.top_speed: a top speed of 4000 steps/s is under the start speed of 5000 steps/s; give a higher top speed or a lower start speed",
                "axis.moves[1].trapezoid.timer_hz: a timer of 3999 Hz cannot make 4000 steps/s; give a timer of at least that rate",
                "axis.moves[2].trapezoid.start_speed: 0 steps/s is out of range; give 0.5 to 10000000 steps/s",
            ],
        );
        check(
            r#"{"mechanics":{"wheel":{"microsteps":0,"radius_mm":-1}},"moves":[{"constant":{"distance":{"mm":1},"speed":{"steps_s":-2}}}]}"#,
            &[
                "axis.mechanics.wheel.microsteps: 0 is out of range; give 1 to 512",
                "axis.mechanics.wheel.radius_mm: -1 mm is out of range; give 1e-6 to 1000000 mm",
                "axis.moves[0].constant.speed: -2 steps/s is out of range; give 1e-6 to 10000000 steps/s",
            ],
        );
        check(
            r#"{"mechanics":{"direct":{"step_mm":0.5}},"moves":[{"sine_segments":{"amplitude":{"mm":1e9},"periods":0,"max_deviation":2}},{"sine_segments":{"amplitude":{"mm":50000},"period_s":0.01}}]}"#,
            &[
                "axis.moves[0].sine_segments.amplitude: 1000000000 mm is out of range; give -500000000 to 500000000 mm",
                "axis.moves[0].sine_segments.periods: 0 is out of range; give 1 to 1000000",
                "axis.moves[0].sine_segments.max_deviation: 2 is out of range; give 0 to 1",
                "axis.moves[1].sine_segments.period_s: this needs 61870287 steps/s, at most 10000000 are allowed; give more time or less distance",
            ],
        );
    }

    #[test]
    fn an_axis_has_bounds_on_time_and_tables() {
        check(
            r#"{"moves":[{"sine_segments":{"period_s":10,"periods":99999}},{"constant":{"speed":{"steps_s":0.01}}}]}"#,
            &[
                "axis.moves: 1099990 seconds are more than one run may have; at most 1000000 are allowed: give a shorter motion or longer ticks",
            ],
        );
        let table = r#"{"trapezoid":{"distance":{"steps":1400000},"top_speed":{"steps_s":1e6},"acceleration":{"steps_s2":1}}}"#;
        let text = format!(r#"{{"moves":[{table},{table}]}}"#);
        check(
            &text,
            &[
                "axis.moves[1].trapezoid: 1400000 table rows are more than one run may have; at most 1000000 are allowed: give a higher acceleration or a lower top speed",
            ],
        );
        let moves = format!(r#"{{"moves":[{}{{"dwell":{{}}}}]}}"#, r#"{"dwell":{}},"#.repeat(64));
        check(&moves, &["axis.moves: 65 moves; give 1 to 64"]);
    }

    #[test]
    fn axes_share_the_bounds_on_tables_and_segments() {
        let problems = |each: &str, axes: usize| {
            let axes = vec![axis(each); axes];
            let found = super::plan_lists([(String::from("source.motion.axes"), &axes[..])])
                .err()
                .unwrap_or_default();
            found.iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        let table = r#"{"moves":[{"trapezoid":{"distance":{"steps":800000},"top_speed":{"steps_s":1e6},"acceleration":{"steps_s2":1}}}]}"#;
        assert_eq!(problems(table, 2), [""; 0]);
        assert_eq!(
            problems(table, 3),
            [
                "source.motion.axes[2].moves[0].trapezoid: 1200000 table rows are more than one run may have; at most 1000000 are allowed: give a higher acceleration or a lower top speed",
            ]
        );
        let sine = r#"{"sine_segments":{"max_deviation":0}}"#;
        let sines = format!(r#"{{"moves":[{sine}{}]}}"#, format!(",{sine}").repeat(63));
        assert_eq!(problems(&sines, 2), [""; 0]);
        assert_eq!(problems(&sines, 3).len(), 64);
        assert_eq!(
            problems(&sines, 3)[0],
            "source.motion.axes[2].moves[0].sine_segments: 66048 sine segments are more than one run may have; at most 65536 are allowed: give a greater largest deviation or fewer sines"
        );
        // The preset of the document has six: a sweep of ten on each of 16 axes is no trouble.
        let sweep = sines.replace(r#""max_deviation":0"#, r#""max_deviation":0.0054"#);
        assert_eq!(problems(&sweep, 16), [""; 0]);
    }

    #[test]
    fn the_documents_table_comes_out_in_its_own_units() {
        let plan = plan(
            r#"{"mechanics":{"direct":{"step_mm":0.393}},"moves":[{"trapezoid":{"distance":{"mm":100},
            "start_speed":{"mm_s":100},"top_speed":{"mm_s":500},"acceleration":{"mm_s2":3500}}}]}"#,
        )
        .unwrap();
        let Profile::TrapezoidTable(table) = &plan.moves()[0].profile else { panic!("{plan:?}") };
        let rates: Vec<u64> = (0..8).map(|row| table.table().rate(row)).collect();
        assert_eq!(rates, [254, 287, 317, 344, 369, 392, 414, 435]);
        assert_eq!(plan.steps(), 254);
    }

    #[test]
    fn moves_follow_one_another_in_time_and_place() {
        let plan = plan(
            r#"{"moves":[{"dwell":{"duration_s":0.5}},{"cosine":{"distance":{"steps":600},"duration_s":1,"ramp_s":0.5}},
            {"dwell":{"duration_s":0}},{"constant":{"distance":{"steps":-1000},"speed":{"steps_s":500}}}]}"#,
        )
        .unwrap();
        let starts: Vec<(f64, i64)> = plan.moves().iter().map(|m| (m.start_s, m.start_steps)).collect();
        assert_eq!(starts, [(0.0, 0), (0.5, 0), (1.5, 600), (1.5, 600)]);
        assert_eq!((plan.duration_s(), plan.steps()), (3.5, -400));
        // (t, position, speed)
        let rows = [
            (-1.0, 0.0, 0.0),
            (0.25, 0.0, 0.0),
            (1.0, 300.0, 1200.0),
            (1.5, 600.0, -500.0),
            (2.5, 100.0, -500.0),
            (3.5, -400.0, 0.0),
            (1e9, -400.0, 0.0),
        ];
        for (t, position, speed) in rows {
            assert!((plan.position(t) - position).abs() < 1e-9, "position at {t}");
            assert!((plan.speed(t) - speed).abs() < 1e-9, "speed at {t}");
            assert_eq!(plan.steps_due(t), position as i64, "steps due at {t}");
        }
        let peaks = plan.peaks();
        assert!((peaks.speed - 1200.0).abs() < 1e-9 && (peaks.jump - 500.0).abs() < 1e-9, "{peaks:?}");
        assert!((peaks.acceleration - 1200.0 * core::f64::consts::PI).abs() < 1e-9, "{peaks:?}");
    }
}
