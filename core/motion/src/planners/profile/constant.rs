//! Plans a constant rate and a dwell (DESIGN B6).

use crate::curves::constant_velocity::{ConstantVelocity, Dwell};
use crate::curves::{curve::signed, numeric::Numeric, phases::Phase, phases::Phases};
use crate::planners::start::{Planned, Start};
use crate::{limits, moves, planners::quantities::Quantities};

pub(super) fn constant(
    quantities: &mut Quantities<'_>,
    given: &moves::Constant,
    start: Start,
) -> Option<Planned<ConstantVelocity, Numeric<Phases>>> {
    let steps = quantities.distance("distance", &given.distance);
    let speed = quantities.speed("speed", &given.speed);
    let (steps, speed) = (steps?, speed?);
    if start.offset == 0.0 {
        let speed = given.speed.exact_in_steps(quantities.mechanics()).ok()?;
        return Some(Planned::FromRest(ConstantVelocity::from_exact(steps, speed)));
    }
    let travel = steps as f64 - start.offset;
    let signed_speed = signed(steps, speed);
    let cruise = Phase::cruise(travel / signed_speed);
    let phases = Phases::new(start.offset, signed_speed, [cruise]).ending_at(steps as f64, signed_speed);
    Some(Planned::General(Numeric::of_phases(phases, start.offset)))
}

pub(super) fn dwell(quantities: &mut Quantities<'_>, given: &moves::Dwell) -> Option<Dwell> {
    quantities.range("duration_s", given.duration_s, limits::PAUSE_S, "s").map(Dwell::new)
}
