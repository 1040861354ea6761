//! Plans a jerk-limited move (DESIGN B6).

use crate::curves::jerk_limited::{JerkLimited, Limits};
use crate::{moves, planners::quantities::Quantities};

pub(super) fn plan(quantities: &mut Quantities<'_>, given: &moves::JerkLimited) -> Option<JerkLimited> {
    let steps = quantities.distance("distance", &given.distance);
    let speed = quantities.speed("max_speed", &given.max_speed);
    let acceleration = quantities.acceleration("max_acceleration", &given.max_acceleration);
    let jerk = quantities.jerk("max_jerk", &given.max_jerk);
    let (steps, _, _, _) = (steps?, speed?, acceleration?, jerk?);
    let mechanics = quantities.mechanics();
    let limits = Limits {
        speed: given.max_speed.exact_in_steps(mechanics).ok()?,
        acceleration: given.max_acceleration.exact_in_steps(mechanics).ok()?,
        jerk: given.max_jerk.exact_in_steps(mechanics).ok()?,
    };
    Some(JerkLimited::from_exact(steps, limits))
}
