//! Plans groups: moves of several axes that start and end at the same time.

use crate::curves::between_speeds::MoveLimits;
use crate::curves::constant_velocity::Dwell;
use crate::curves::curve::{greater, lesser};
use crate::curves::way_points::{Joint, Misfit, MisfitKind, course};
use crate::curves::{numeric::Numeric, stretched::Stretched};
use crate::groups::{Group, LineGroup, TimeGroup, WayPoint, WayPointGroup};
use crate::moves::{Axis, LimitedProfile, Move};
use crate::planners::budget::{Budget, MAX_WAY_POINTS, exceeded};
use crate::planners::chain::Chain;
use crate::planners::retarget::Limits;
use crate::planners::{quantities::Quantities, start::Start};
use crate::problem::{Cause, ValueError};
use crate::timing::{Exact, F106, Schedule};
use crate::{Problems, Profile, Validator, limits};
use alloc::{boxed::Box, format, string::ToString, vec::Vec};

/// Relative part by which roundings may shorten a group's duration.
const TIME_TOLERANCE: f64 = 1e-12;

/// An axis, its planned moves and its limits.
#[derive(Debug)]
pub(crate) struct Member<'a> {
    pub(crate) axis: &'a Axis,
    pub(crate) chain: Chain,
    pub(crate) limits: Limits,
}

/// The move of each axis in a group; `None` if the axis stands still.
type Parts = Vec<Option<Profile>>;

/// End of the last axis in s.
pub(crate) fn end_s(members: &[Member<'_>]) -> f64 {
    members.iter().fold(0.0, |end_s, member| greater(end_s, member.chain.duration_s()))
}

/// Appends the groups, one after another; returns their problems. Positions after a group with problems are unknown, so
/// later groups are not checked.
pub(crate) fn add(
    members: &mut [Member<'_>],
    groups: &[Group],
    path: &str,
    budget: &mut Budget,
) -> Option<Problems> {
    let mut all = Validator::within(path);
    all.length("", groups.len(), limits::GROUPS, "groups");
    for (index, group) in groups.iter().take(*limits::GROUPS.end()).enumerate() {
        let outer_len = all.enter_entry(index);
        let mut planner = Planner { members, validator: &mut all, budget };
        let parts = match group {
            Group::Time(time) => planner.at("time", |here| here.time(time)),
            Group::Line(line) => planner.at("line", |here| here.line(line)),
            Group::WayPoints(group) => planner.at("way_points", |here| here.way_points(group)),
        };
        let group_path = all.path().to_string();
        all.leave(outer_len);
        let Some(parts) = parts else { break };
        let start_s = end_s(members);
        for (member, part) in members.iter_mut().zip(parts) {
            if let Some(profile) = part {
                member.chain.pause_until(start_s);
                member.chain.push(profile, group_path.clone(), 0.0);
            }
        }
    }
    all.problems()
}

struct Planner<'p, 'a> {
    members: &'p [Member<'a>],
    validator: &'p mut Validator,
    budget: &'p mut Budget,
}

impl Planner<'_, '_> {
    fn at<T>(&mut self, field: &str, plan: impl FnOnce(&mut Self) -> T) -> T {
        let outer_len = self.validator.enter(field);
        let result = plan(self);
        self.validator.leave(outer_len);
        result
    }

    /// Checks a quantity in the units of an axis.
    fn quantity<T>(
        &mut self,
        axis: usize,
        check: impl FnOnce(&mut Quantities<'_>) -> Option<T>,
    ) -> Option<T> {
        let member = self.members.get(axis)?;
        let mut quantities = Quantities::new(&member.axis.mechanics, self.validator.path());
        let found = check(&mut quantities);
        self.validator.extend(quantities.validator.problems().into_iter().flatten());
        found
    }

    /// Refuses a list without one entry per axis.
    fn one_per_axis(&mut self, field: &str, given: usize) -> Option<()> {
        let axes = self.members.len();
        self.validator.length(field, given, axes..=axes, "entries");
        (given == axes).then_some(())
    }

    fn time(&mut self, given: &TimeGroup) -> Option<Parts> {
        let duration_s = match given.duration_s {
            Some(given) => self.validator.range("duration_s", given, limits::DURATION_S, "s").map(Some),
            None => Some(None),
        };
        self.validator.length("moves", given.moves.len(), 1..=self.members.len().max(1), "moves");
        let mut parts: Parts = self.members.iter().map(|_| None).collect();
        let mut is_valid = given.moves.len() <= self.members.len() && !given.moves.is_empty();
        for (index, group_move) in given.moves.iter().take(self.members.len()).enumerate() {
            let axis = usize::from(group_move.axis);
            let field = format!("moves[{index}]");
            let planned = self.at(&field, |here| here.member_move(axis, &parts, &group_move.r#move));
            match (planned, parts.get_mut(axis)) {
                (Some(profile), Some(part)) => *part = Some(profile),
                _ => is_valid = false,
            }
        }
        let duration_s = duration_s?;
        if !is_valid {
            return None;
        }
        let own = |profile: &Profile| profile.duration(1).double();
        let longest = parts.iter().flatten().map(own).fold(F106::default(), |a, b| if b > a { b } else { a });
        let duration = duration_s.map_or(longest, |given| Exact::of(given).double());
        if duration.high < longest.high * (1.0 - TIME_TOLERANCE) {
            let cause = Cause::GroupTooShort { duration_s: duration.high, needed_s: longest.high };
            self.validator.add("duration_s", cause);
            return None;
        }
        let stretched = |profile: Profile| stretch(profile, duration);
        Some(parts.into_iter().map(|part| part.map(stretched)).collect())
    }

    /// The own move of an axis in a group.
    fn member_move(&mut self, axis: usize, parts: &Parts, given: &Move) -> Option<Profile> {
        let (Some(part), Some(member)) = (parts.get(axis), self.members.get(axis)) else {
            let max = self.members.len().saturating_sub(1) as u64;
            self.validator.whole("axis", axis as u64, 0..=max, "");
            return None;
        };
        if part.is_some() {
            let detail = "the axis already has a move in this group; use one move per axis";
            self.validator.add("axis", ValueError::Conflict { detail });
            return None;
        }
        let Start { offset, .. } = member.chain.start();
        let position = member.chain.position();
        let mut quantities = Quantities::new(&member.axis.mechanics, self.validator.path());
        let profile = quantities.at("move", |here| {
            if matches!(given, Move::Retarget(_)) {
                here.refuse("retarget", Cause::RetargetInGroup);
                return None;
            }
            let profile = Profile::plan(here, given, Start { offset, speed: 0.0 }, self.budget)?;
            let cause = if profile.follows_table() {
                Cause::FollowsTable { what: "cannot be in a group", remedy: "the exact method" }
            } else if offset != 0.0 && !profile.starts_between_steps() {
                Cause::BetweenSteps { position }
            } else {
                return Some(profile);
            };
            here.refuse("", cause);
            None
        });
        self.validator.extend(quantities.validator.problems().into_iter().flatten());
        profile
    }

    fn line(&mut self, given: &LineGroup) -> Option<Parts> {
        self.one_per_axis("distances", given.distances.len())?;
        let mut targets = Vec::new();
        for (axis, distance) in given.distances.iter().enumerate() {
            let field = format!("distances[{axis}]");
            targets.push(self.at(&field, |here| here.quantity(axis, |axis| axis.position("", distance))));
        }
        let targets: Vec<i64> = targets.into_iter().collect::<Option<_>>()?;
        let travels: Vec<f64> = targets
            .iter()
            .zip(self.members)
            .map(
                |(steps, member)| if *steps == 0 { 0.0 } else { *steps as f64 - member.chain.start().offset },
            )
            .collect();
        let Some(limits) = line_limits(self.members, &travels, given.profile) else {
            self.validator.add("distances", Cause::NoSteps { steps: 0.0 });
            return None;
        };
        let line = limits.plan(0.0, 1.0, 0.0, 0.0)?;
        let part = |(member, travel): (&Member<'_>, &f64)| {
            let start = member.chain.start().offset;
            let curve = || Numeric::of_phases(line.clone().scaled(*travel, start), start);
            (*travel != 0.0).then(|| Profile::Phases(curve()))
        };
        Some(self.members.iter().zip(&travels).map(part).collect())
    }

    fn way_points(&mut self, given: &WayPointGroup) -> Option<Parts> {
        let count = given.points.len();
        self.validator.length("points", count, limits::WAY_POINTS, "points");
        let needed = count as u64 * self.members.len() as u64;
        let Some(left) = self.budget.way_points.checked_sub(needed) else {
            let cause = exceeded(MAX_WAY_POINTS, self.budget.way_points, needed, "waypoints of all axes");
            self.validator.add("points", cause);
            return None;
        };
        self.budget.way_points = left;
        let mut joints: Vec<Joint> = self
            .members
            .iter()
            .map(|member| Joint {
                positions: Vec::from([member.chain.start().offset]),
                given: Vec::from([None]),
                limits: member.limits.of(LimitedProfile::JerkLimited),
            })
            .collect();
        let mut is_valid = count > 0;
        for (index, point) in given.points.iter().enumerate() {
            let field = format!("points[{index}]");
            is_valid &= self.at(&field, |here| here.way_point(point, &mut joints)).is_some();
        }
        if !is_valid || !self.given_speeds_fit(&joints) {
            return None;
        }
        if joints.iter().all(|joint| joint.positions.windows(2).all(|pair| pair.first() == pair.last())) {
            self.validator.add("points", Cause::NoSteps { steps: 0.0 });
            return None;
        }
        match course(&joints) {
            Ok(course) => {
                let starts = joints.iter().map(|joint| joint.positions.first().copied().unwrap_or(0.0));
                let curves = course.curves.into_iter().zip(starts);
                let part = |(curve, start)| Some(Profile::Phases(Numeric::of_phases(curve, start)));
                Some(curves.map(part).collect())
            }
            Err(Misfit { axis, section, kind }) => {
                let limits = joints.get(axis)?.limits;
                let field = format!("points[{}].speeds[{axis}]", section - 1);
                let cause = match kind {
                    MisfitKind::TooShort { steps, needed, from, to } => Cause::TooShortForRamp {
                        steps,
                        needed,
                        from,
                        to,
                        acceleration: limits.of_ramp(from, to),
                        jerk: limits.jerk,
                    },
                    MisfitKind::TooSlow { duration_s, max_s, from, to } => {
                        Cause::SectionTooSlow { duration_s, max_s, from, to }
                    }
                };
                self.validator.add(&field, cause);
                None
            }
        }
    }

    /// Adds a point to the axes.
    fn way_point(&mut self, point: &WayPoint, joints: &mut [Joint]) -> Option<()> {
        let positions_fit = self.one_per_axis("positions", point.positions.len());
        if let Some(speeds) = &point.speeds {
            self.one_per_axis("speeds", speeds.len())?;
        }
        positions_fit?;
        let mut is_valid = true;
        for (axis, (position, joint)) in point.positions.iter().zip(joints).enumerate() {
            let start_steps = self.members.get(axis)?.chain.steps();
            let field = format!("positions[{axis}]");
            let whole = self.at(&field, |here| here.quantity(axis, |axis| axis.position("", position)));
            let given = point.speeds.as_ref().and_then(|speeds| speeds.get(axis)?.as_ref());
            let speed = match given {
                Some(given) => {
                    let field = format!("speeds[{axis}]");
                    let range = limits::SIGNED_SPEED_STEPS_S;
                    let speed = self
                        .at(&field, |here| here.quantity(axis, |axis| axis.speed_within("", given, range)));
                    is_valid &= speed.is_some();
                    speed
                }
                None => None,
            };
            is_valid &= whole.is_some();
            joint.positions.push(whole.unwrap_or(0).saturating_sub(start_steps) as f64);
            joint.given.push(speed);
        }
        is_valid.then_some(())
    }

    /// Refuses given speeds where the axis stands, against its travel or above its limit.
    fn given_speeds_fit(&mut self, joints: &[Joint]) -> bool {
        let mut all_fit = true;
        for (axis, joint) in joints.iter().enumerate() {
            let stands = joint.stands();
            let points = joint.given.iter().zip(&stands).zip(joint.positions.windows(2)).enumerate();
            // The last position has no travel after it; the axis stands there.
            let last = joint.given.last().zip(stands.last()).map(|pair| (joint.given.len() - 1, pair, 0.0));
            let inner = points.map(|(point, (pair, travel))| {
                let travel = travel.last().zip(travel.first()).map_or(0.0, |(to, from)| to - from);
                (point, pair, travel)
            });
            for (point, (given, stands), travel) in inner.chain(last) {
                let Some(speed) = *given else { continue };
                let (size, max) = (libm::fabs(speed), joint.limits.speed);
                let cause = if *stands && speed != 0.0 {
                    Cause::SpeedWhereAxisStands { speed }
                } else if speed * travel < 0.0 {
                    Cause::SpeedAgainstMove { speed, steps: travel as i64 }
                } else if size > max {
                    Cause::EdgeAboveMax { speed: size, max }
                } else {
                    continue;
                };
                all_fit = false;
                self.validator.add(&format!("points[{}].speeds[{axis}]", point.saturating_sub(1)), cause);
            }
        }
        all_fit
    }
}

/// The move, or a slower one that lasts `duration` s.
fn stretch(profile: Profile, duration: F106) -> Profile {
    let own_s = profile.duration_s();
    if libm::fabs(duration.high - own_s) <= TIME_TOLERANCE * duration.high {
        profile
    } else if own_s > 0.0 && !matches!(profile, Profile::Dwell(_)) {
        Profile::Stretched(Box::new(Stretched::new(profile, duration)))
    } else {
        Profile::Dwell(Dwell::new(duration.high))
    }
}

/// The limits of a line of length 1 that no axis exceeds; `None` if no axis moves.
fn line_limits(members: &[Member<'_>], travels: &[f64], profile: LimitedProfile) -> Option<MoveLimits> {
    let moving = members.iter().zip(travels).filter(|(_, travel)| **travel != 0.0);
    moving
        .map(|(member, travel)| {
            let (MoveLimits { speed, acceleration, deceleration, jerk }, n) =
                (member.limits.of(profile), libm::fabs(*travel));
            MoveLimits {
                speed: speed / n,
                acceleration: acceleration / n,
                deceleration: deceleration / n,
                jerk: jerk / n,
            }
        })
        .reduce(|a, b| MoveLimits {
            speed: lesser(a.speed, b.speed),
            acceleration: lesser(a.acceleration, b.acceleration),
            deceleration: lesser(a.deceleration, b.deceleration),
            jerk: lesser(a.jerk, b.jerk),
        })
}
