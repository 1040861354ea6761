//! Plans moves over a distance in a given time: the cosine S-curve and shaped ramps (DESIGN B4).

use crate::curves::sliced::{NotSliced, Sliced};
use crate::curves::{cosine::Cosine, ramp::Ramp, ramps::Ramps};
use crate::moves::{self, RampShape};
use crate::planners::budget::{Budget, MAX_SLICES, check_speed, exceeded};
use crate::{MAX_SPEED, limits, mechanics::Distance, planners::quantities::Quantities, problem::Cause};

/// Relative tolerance of a slice's rate. The decimal length of a slice is seldom exact in binary, so a rate at the maximum
/// may exceed it by a rounding.
const RATE_TOLERANCE: f64 = 1e-12;
/// Shorter ramps in s count as none: one cycle of the fastest clock.
const MIN_RAMP_S: f64 = 1e-9;

pub(super) fn cosine(quantities: &mut Quantities<'_>, given: &moves::Cosine) -> Option<Cosine> {
    let (steps, duration_s, ramp_s) =
        distance_and_times(quantities, &given.distance, given.duration_s, given.ramp_s)?;
    let curve = Cosine::new(steps, duration_s, ramp_s);
    check_speed(quantities, "duration_s", curve.top_speed())?;
    Some(curve)
}

/// Plans the curve in slices. The exact curve must be valid, too.
pub(super) fn sliced(
    quantities: &mut Quantities<'_>,
    given: &moves::Cosine,
    budget: &mut Budget,
) -> Option<Sliced> {
    let distance_and_times = distance_and_times(quantities, &given.distance, given.duration_s, given.ramp_s);
    let slice_s = quantities.range("slice_s", given.slice_s, limits::SLICE_S, "s");
    let (steps, duration_s, ramp_s) = distance_and_times?;
    let slice_s = slice_s?;
    check_speed(quantities, "duration_s", Cosine::new(steps, duration_s, ramp_s).top_speed())?;
    let cause = match Sliced::new(steps, duration_s, ramp_s, slice_s, budget.slices) {
        Ok(curve) => {
            budget.slices -= curve.slice_count();
            let rate = curve.top_rate();
            let rate =
                if rate <= MAX_SPEED * (1.0 + RATE_TOLERANCE) { libm::fmin(rate, MAX_SPEED) } else { rate };
            check_speed(quantities, "duration_s", rate)?;
            return Some(curve);
        }
        Err(NotSliced::Slices { needed }) => exceeded(MAX_SLICES, budget.slices, needed, "slices").into(),
        Err(NotSliced::TooShort { rate }) => Cause::SliceTooShort { rate, slice_s },
        Err(NotSliced::TooFew { slices }) => {
            Cause::SlicesTooFew { slices, slice_s, steps: steps.unsigned_abs(), rate: MAX_SPEED }
        }
    };
    quantities.refuse("slice_s", cause);
    None
}

pub(super) fn ramps(quantities: &mut Quantities<'_>, given: &moves::Ramps) -> Option<Ramps> {
    let distance_and_times = distance_and_times(quantities, &given.distance, given.duration_s, given.ramp_s);
    let mut parameter = |key: &str, value: f64| quantities.range(key, value, limits::RAMP_PARAMETER, "");
    let ramp = match given.shape {
        RampShape::Sigmoid => Ramp::sigmoid(parameter("sigmoid_range", given.sigmoid_range)?),
        RampShape::Bezier => Ramp::Bezier,
        RampShape::Straight => Ramp::Straight,
        RampShape::Exponential => Ramp::exponential(parameter("time_constants", given.time_constants)?),
    };
    let (steps, duration_s, ramp_s) = distance_and_times?;
    let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
    check_speed(quantities, "duration_s", curve.top_speed())?;
    Some(curve)
}

fn distance_and_times(
    quantities: &mut Quantities<'_>,
    distance: &Distance,
    duration_s: f64,
    ramp_s: f64,
) -> Option<(i64, f64, f64)> {
    let steps = quantities.distance("distance", distance);
    let duration_s = quantities.range("duration_s", duration_s, limits::DURATION_S, "s");
    let ramp_s = quantities.range("ramp_s", ramp_s, limits::PAUSE_S, "s");
    let (steps, duration_s, ramp_s) = (steps, duration_s?, ramp_s?);
    if ramp_s > duration_s / 2.0 {
        quantities.refuse("ramp_s", Cause::RampTooLong { ramp_s, duration_s });
        return None;
    }
    Some((steps?, duration_s, if ramp_s < MIN_RAMP_S { 0.0 } else { ramp_s }))
}
