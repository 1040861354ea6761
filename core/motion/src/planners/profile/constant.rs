//! Plans a constant rate and a dwell (DESIGN B6).

use crate::curves::constant_velocity::{ConstantVelocity, Dwell};
use crate::{limits, moves, planners::quantities::Quantities};

pub(super) fn constant(quantities: &mut Quantities<'_>, given: &moves::Constant) -> Option<ConstantVelocity> {
    let steps = quantities.distance("distance", &given.distance);
    let speed = quantities.speed("speed", &given.speed);
    let (steps, _) = (steps?, speed?);
    Some(ConstantVelocity::from_exact(steps, given.speed.exact_in_steps(quantities.mechanics()).ok()?))
}

pub(super) fn dwell(quantities: &mut Quantities<'_>, given: &moves::Dwell) -> Option<Dwell> {
    quantities.range("duration_s", given.duration_s, limits::PAUSE_S, "s").map(Dwell::new)
}
