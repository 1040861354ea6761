//! Plans an axis of a scenario, or reports all its problems. What follows from several numbers (a top speed, a table's
//! length) is checked with the curve.

mod motor;

use crate::curves::{curve::signed, numeric::Numeric, shaped::Part, shaped::Shaped, shaped::TooManyChanges};
use crate::groups::Group;
use crate::moves::{Axis, Move};
use crate::planners::budget::{Budget, MAX_SHAPED_CHANGES};
use crate::planners::retarget::{self, Limits};
use crate::planners::{chain::Chain, groups, quantities::Quantities};
use crate::problem::{Cause, Problem, ValueError};
use crate::shaper::{InputShaper, Shaper};
use crate::{AxisPlan, Problems, Profile, limits, mechanics::Mechanics};
use alloc::{boxed::Box, format, string::String, vec::Vec};
use stepscope_peripheral::signal::MAX_CHANNELS;

const MAX_DURATION_S: f64 = 1e6;
/// Relative part by which roundings may exceed the start-stop speed.
const SPEED_TOLERANCE: f64 = 1e-9;

/// The axes of one controller.
#[derive(Clone, Debug)]
pub struct AxisList<'a> {
    /// Their location in the scenario, such as `source.motion.axes`.
    pub path: String,
    pub axes: &'a [Axis],
    /// Groups after the axes' own moves; their location is `groups` instead of `axes`.
    pub groups: &'a [Group],
}

/// Plans lists of axes with their paths, one per controller. They share the limits of tables and sines of [`plan_axis`].
/// Errors: every problem of every axis, each with its path.
pub fn plan_lists<'a>(lists: impl IntoIterator<Item = AxisList<'a>>) -> Result<Vec<Vec<AxisPlan>>, Problems> {
    let (mut plans, mut problems, mut budget) = (Vec::new(), Vec::new(), Budget::default());
    for AxisList { path, axes, groups } in lists {
        // The scenario checks the number of axes.
        let axes = axes.get(..MAX_CHANNELS).unwrap_or(axes);
        match plan_together(axes, groups, &path, |index| format!("{path}[{index}]"), &mut budget) {
            Ok(list) => plans.push(list),
            Err(found) => problems.extend(found),
        }
    }
    Problems::check(problems).map(|()| plans)
}

/// Plans a single move with the default mechanics; `path` is its location in the scenario.
/// Errors: every problem of the move, each with its path.
pub fn plan_move(motion: &Move, path: &str) -> Result<AxisPlan, Problems> {
    let mechanics = Mechanics::default();
    let mut quantities = Quantities::new(&mechanics, path);
    let mut chain = Chain::default();
    push(&mut quantities, &mut chain, motion, None, &mut Budget::default());
    quantities.validator.end(chain.into_plan())
}

/// Plans an axis; `path` is its location in the scenario, such as `source.motion.axes[0]`.
/// Distances are rounded half up to whole steps. An axis has at most 64 moves, 1e6 s, 1e6 rows of acceleration tables, and
/// 65536 segments of sine quarters.
/// Errors: every problem of the axis, each with its path.
pub fn plan_axis(axis: &Axis, path: &str) -> Result<AxisPlan, Problems> {
    let axes = core::slice::from_ref(axis);
    let plans = plan_together(axes, &[], path, |_| path.into(), &mut Budget::default())?;
    Ok(plans.into_iter().next().unwrap_or_else(|| Chain::default().into_plan()))
}

/// Plans the axes of a controller and their groups; `path_of` is the location of an axis.
fn plan_together(
    axes: &[Axis],
    groups: &[Group],
    path: &str,
    path_of: impl Fn(usize) -> String,
    budget: &mut Budget,
) -> Result<Vec<AxisPlan>, Problems> {
    let (mut members, mut problems) = (Vec::new(), Vec::new());
    for (index, axis) in axes.iter().enumerate() {
        match plan_moves(axis, &path_of(index), !groups.is_empty(), budget) {
            Ok((chain, limits)) => members.push(groups::Member { axis, chain, limits }),
            Err(found) => problems.extend(found),
        }
    }
    let groups_path = format!("{}groups", path.strip_suffix("axes").unwrap_or(path));
    if problems.is_empty() {
        problems.extend(groups::add(&mut members, groups, &groups_path, budget).into_iter().flatten());
    }
    Problems::check(core::mem::take(&mut problems))?;
    let end_s = groups::end_s(&members);
    let mut plans = Vec::new();
    for (index, mut member) in members.into_iter().enumerate() {
        // With groups an axis may have no moves: it stands still.
        if member.chain.last().is_none() {
            member.chain.push_dwell(end_s);
        }
        match finish(member, &path_of(index)) {
            Ok(plan) => plans.push(plan),
            Err(found) => problems.extend(found),
        }
    }
    Problems::check(problems).map(|()| plans)
}

/// Plans an axis' own moves.
fn plan_moves(
    axis: &Axis,
    path: &str,
    has_groups: bool,
    budget: &mut Budget,
) -> Result<(Chain, Limits), Problems> {
    let mut quantities = Quantities::new(&axis.mechanics, path);
    motor::check(&mut quantities, axis);
    let axis_limits = Limits::plan(&mut quantities, &axis.limits);
    check_shaper(&mut quantities, axis);
    let (min, max) = limits::MOVES.into_inner();
    let allowed = if has_groups { 0..=max } else { min..=max };
    quantities.validator.length("moves", axis.moves.len(), allowed, "moves");
    let mut chain = Chain::default();
    // More moves already have a problem.
    for (index, given) in axis.moves.iter().take(max).enumerate() {
        quantities.at("moves", |quantities| {
            quantities.at_entry(index, |here| push(here, &mut chain, given, axis_limits, budget));
        });
    }
    check_duration(&mut quantities, chain.duration_s());
    quantities.validator.end(())?;
    let detail = "the limits are not valid; use other numbers";
    let invalid = || Problem::new(format!("{path}.limits"), ValueError::Conflict { detail });
    Ok((chain, axis_limits.ok_or_else(invalid)?))
}

fn check_duration(quantities: &mut Quantities<'_>, duration_s: f64) {
    if duration_s > MAX_DURATION_S {
        let cause = ValueError::TooMuch { given: duration_s, max: MAX_DURATION_S, of: "seconds" };
        quantities.refuse("moves", cause);
    }
}

/// Plans a move and appends it.
fn push(
    here: &mut Quantities<'_>,
    chain: &mut Chain,
    given: &Move,
    axis_limits: Option<Limits>,
    budget: &mut Budget,
) {
    let path = String::from(here.validator.path());
    let planned = match given {
        Move::Retarget(target) => here.at("retarget", |here| {
            let previous = chain.moves().last().map(|(last, _)| (&last.profile, last.start_steps));
            if previous.is_none() && !chain.is_broken {
                here.refuse("", Cause::NothingToRetarget);
            }
            let previous = previous.filter(|_| !chain.is_broken);
            let retargeted = retarget::plan(here, target, axis_limits, previous)?;
            let (_, cut_path) = chain.pop()?;
            chain.push(retargeted.cut, cut_path, 0.0);
            Some((retargeted.profile, retargeted.end_speed))
        }),
        given => {
            let (start, at) = (chain.start(), chain.position());
            let profile = Profile::plan(here, given, start, budget);
            let profile = profile.filter(|profile| {
                let can_start = start.offset == 0.0 || profile.starts_between_steps();
                if !can_start {
                    here.refuse("", Cause::BetweenSteps { position: at });
                }
                can_start
            });
            profile.map(|profile| {
                let end_speed = given_end_speed(given, here);
                let end_speed = signed(profile.steps(), end_speed);
                (profile, end_speed)
            })
        }
    };
    match planned {
        Some((profile, end_speed)) => chain.push(profile, path, end_speed),
        None => chain.is_broken = true,
    }
}

/// The end speed that a move gives, along the move; 0 if it gives none.
fn given_end_speed(given: &Move, quantities: &Quantities<'_>) -> f64 {
    let end_speed = match given {
        Move::Trapezoid(given) => given.end_speed.as_ref(),
        Move::JerkLimited(given) => given.end_speed.as_ref(),
        Move::Cosine(given) => given.end_speed.as_ref(),
        Move::Ramps(given) => given.end_speed.as_ref(),
        _ => None,
    };
    end_speed.and_then(|speed| speed.in_steps(quantities.mechanics()).ok()).unwrap_or(0.0)
}

fn check_shaper(quantities: &mut Quantities<'_>, axis: &Axis) {
    let Some(given) = &axis.input_shaper else { return };
    let (kind, settings) = given.parts();
    quantities.at("input_shaper", |here| {
        here.at(kind.name(), |here| {
            here.range("frequency_hz", settings.frequency_hz, limits::SHAPER_HZ, "Hz");
            here.range("damping_ratio", settings.damping_ratio, kind.damping_ratios(), "");
        });
    });
}

/// Checks what depends on all moves and groups, and shapes the axis.
fn finish(member: groups::Member<'_>, path: &str) -> Result<AxisPlan, Problems> {
    let groups::Member { axis, chain, limits } = member;
    let mut quantities = Quantities::new(&axis.mechanics, path);
    check_duration(&mut quantities, chain.duration_s());
    quantities.validator.end(())?;
    if let Some(max) = limits.start_stop_speed {
        Problems::check(check_jumps(&chain, max))?;
    }
    let Some(shaper) = axis.input_shaper.as_ref().map(InputShaper::shaper) else {
        return Ok(chain.into_plan());
    };
    let table = chain.moves().find(|(planned, _)| planned.profile.follows_table());
    if let Some((_, move_path)) = table {
        let remedy = "the exact method, or no input shaper";
        return Err(Problem::new(move_path, Cause::FollowsTable { what: "cannot be shaped", remedy }).into());
    }
    shape(chain, &shaper).map_err(|TooManyChanges(needed)| {
        let cause = ValueError::too_much(needed, MAX_SHAPED_CHANGES, "changes of a shaped curve");
        Problem::new(format!("{path}.input_shaper"), cause).into()
    })
}

fn shape(chain: Chain, shaper: &Shaper) -> Result<AxisPlan, TooManyChanges> {
    let ends = (chain.duration_s(), chain.position());
    let parts = chain.into_moves().into_iter().map(|planned| Part {
        start_s: planned.start_s,
        start_steps: planned.start_steps,
        curve: planned.profile,
    });
    let shaped = Shaped::new(parts.collect(), ends, shaper.impulses(), MAX_SHAPED_CHANGES)?;
    let duration_s = shaped.duration_s();
    let mut chain = Chain::default();
    let curve = Numeric::new(shaped, 0.0, duration_s.into());
    chain.push(Profile::Shaped(Box::new(curve)), String::new(), 0.0);
    Ok(chain.into_plan())
}

/// Refuses jumps of the speed above the start-stop speed `max` at the start, between moves and at the end.
fn check_jumps(chain: &Chain, max: f64) -> Vec<Problem> {
    let (mut before, mut problems, mut last_path) = (0.0, Vec::new(), "");
    let mut check = |before: f64, after: f64, path: &str, at: &'static str| {
        let reverses = before * after < 0.0;
        let (before_size, after_size) = (libm::fabs(before), libm::fabs(after));
        let jump = if reverses { before_size.max(after_size) } else { libm::fabs(after - before) };
        if jump > max * (1.0 + SPEED_TOLERANCE) {
            problems.push(Problem::new(path, Cause::JumpTooHigh { before, after, jump, max, at }));
        }
    };
    for (planned, path) in chain.moves() {
        let path = if path.is_empty() { last_path } else { path };
        check(before, planned.profile.speed(0.0), path, "start");
        before = planned.profile.speed(planned.profile.duration_s());
        last_path = path;
    }
    check(before, 0.0, last_path, "end");
    problems
}
