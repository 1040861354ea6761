//! Plans the sines, exact and by segments (DESIGN B5, B6).

use crate::curves::{sine::Sine, sine_segments::SineSegments};
use crate::planners::budget::{Budget, MAX_SEGMENTS, check_speed, exceeded};
use crate::{Curve, limits, moves, planners::quantities::Quantities};

pub(super) fn sine(quantities: &mut Quantities<'_>, given: &moves::Sine) -> Option<Sine> {
    let amplitude = quantities.distance("amplitude", &given.amplitude);
    let period_s = quantities.range("period_s", given.period_s, limits::DURATION_S, "s");
    quantities.range("periods", given.periods.into(), limits::PERIODS, "")?;
    let curve = Sine::new(amplitude?, period_s?, given.periods);
    check_speed(quantities, "period_s", curve.peaks().speed)?;
    Some(curve)
}

pub(super) fn segments(
    quantities: &mut Quantities<'_>,
    given: &moves::SineSegments,
    budget: &mut Budget,
) -> Option<SineSegments> {
    let amplitude = quantities.distance("amplitude", &given.amplitude);
    let period_s = quantities.range("period_s", given.period_s, limits::DURATION_S, "s");
    let periods = quantities.range("periods", given.periods.into(), limits::PERIODS, "");
    let deviation = quantities.range("max_deviation", given.max_deviation, limits::MAX_DEVIATION, "");
    let (amplitude, period_s, deviation) = (amplitude?, period_s?, deviation?);
    periods?;
    let curve = SineSegments::new(amplitude, period_s, given.periods, deviation);
    let segments = curve.segments().len() as u64;
    let Some(left) = budget.segments.checked_sub(segments) else {
        quantities.refuse("", exceeded(MAX_SEGMENTS, budget.segments, segments, "sine segments"));
        return None;
    };
    budget.segments = left;
    check_speed(quantities, "period_s", curve.peaks().speed)?;
    Some(curve)
}
