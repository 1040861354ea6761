//! Plans a constant rate and a dwell (DESIGN B6).

use crate::{
    curves::constant_velocity::{Constant, Dwell},
    moves,
    planners::quantities::Quantities,
};

pub(super) fn constant(quantities: &mut Quantities<'_>, given: &moves::Constant) -> Option<Constant> {
    let steps = quantities.distance("distance", &given.distance);
    let speed = quantities.speed("speed", &given.speed);
    let (steps, _) = (steps?, speed?);
    Some(Constant::within(steps, given.speed.exact_in_steps(quantities.mechanics()).ok()?))
}

pub(super) fn dwell(quantities: &mut Quantities<'_>, given: &moves::Dwell) -> Option<Dwell> {
    quantities.pause("duration_s", given.duration_s).map(Dwell::new)
}
