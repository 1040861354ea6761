//! Plans a jerk-limited move (DESIGN B6), between two speeds or from rest to rest.

use crate::curves::jerk_limited::{JerkLimited, Limits};
use crate::curves::phases::Phases;
use crate::curves::{between_speeds::MoveLimits, numeric::Numeric};
use crate::planners::start::{EdgeSpeeds, Planned, Start, check_edges};
use crate::{moves, planners::quantities::Quantities, problem::Cause};

pub(super) fn plan(
    quantities: &mut Quantities<'_>,
    given: &moves::JerkLimited,
    start: Start,
) -> Option<Planned<JerkLimited, Numeric<Phases>>> {
    let steps = quantities.distance("distance", &given.distance);
    let speed = quantities.speed("max_speed", &given.max_speed);
    let acceleration = quantities.acceleration("max_acceleration", &given.max_acceleration);
    let deceleration =
        quantities.acceleration_or("max_deceleration", given.max_deceleration.as_ref(), acceleration);
    let jerk = quantities.jerk("max_jerk", &given.max_jerk);
    let edges = start.edges(quantities, steps, given.start_speed.as_ref(), given.end_speed.as_ref());
    let (steps, speed, acceleration, deceleration) = (steps?, speed?, acceleration?, deceleration?);
    let (jerk, edges) = (jerk?, edges?);
    check_edges(quantities, edges, speed)?;
    if edges.are_rest() && start.offset == 0.0 && acceleration == deceleration {
        let mechanics = quantities.mechanics();
        let limits = Limits {
            speed: given.max_speed.exact_in_steps(mechanics).ok()?,
            acceleration: given.max_acceleration.exact_in_steps(mechanics).ok()?,
            jerk: given.max_jerk.exact_in_steps(mechanics).ok()?,
        };
        return Some(Planned::FromRest(JerkLimited::from_exact(steps, limits)));
    }
    let limits = MoveLimits { speed, acceleration, deceleration, jerk };
    between(quantities, &limits, (steps, start.offset), edges).map(Planned::General)
}

/// A move between two speeds from a position to whole steps; refuses a distance shorter than the ramp.
pub(super) fn between(
    quantities: &mut Quantities<'_>,
    limits: &MoveLimits,
    (steps, from): (i64, f64),
    edges: EdgeSpeeds,
) -> Option<Numeric<Phases>> {
    let to = steps as f64;
    let Some(phases) = limits.plan(from, to, edges.start, edges.end) else {
        let EdgeSpeeds { start, end } = edges;
        let cause = Cause::TooShortForRamp {
            steps: libm::fabs(to - from),
            needed: limits.ramp_steps(start, end),
            from: start,
            to: end,
            acceleration: limits.of_ramp(start, end),
            jerk: limits.jerk,
        };
        quantities.refuse("distance", cause);
        return None;
    };
    Some(Numeric::of_phases(phases, from))
}
