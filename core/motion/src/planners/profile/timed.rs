//! Plans moves over a distance in a given time: the cosine S-curve and shaped ramps (DESIGN B4).

use crate::curves::sliced::{NotSliced, Sliced};
use crate::curves::speed_ramps::{SpeedRamps, SpeedShape};
use crate::curves::{cosine::Cosine, numeric::Numeric, ramp::Ramp, ramps::Ramps};
use crate::moves::{self, RampShape};
use crate::planners::budget::{Budget, MAX_SLICES, check_speed, exceeded};
use crate::planners::start::{EdgeSpeeds, Planned, Start, refuse_edges};
use crate::{MAX_SPEED, limits, mechanics::Distance, planners::quantities::Quantities};
use crate::{problem::Cause, timing::Exact};

/// Relative tolerance of a slice's rate. The decimal length of a slice is seldom exact in binary, so a rate at the maximum
/// may exceed it by a rounding.
const RATE_TOLERANCE: f64 = 1e-12;
/// Shorter ramps in s count as none: one cycle of the fastest clock.
const MIN_RAMP_S: f64 = 1e-9;

pub(super) fn cosine(
    quantities: &mut Quantities<'_>,
    given: &moves::Cosine,
    start: Start,
) -> Option<Planned<Cosine, Numeric<SpeedRamps>>> {
    let timed = distance_and_times(quantities, &given.distance, given.duration_s, given.ramp_s);
    let steps = timed.map(|(steps, _, _)| steps);
    let edges = start.edges(quantities, steps, given.start_speed.as_ref(), given.end_speed.as_ref());
    let (timed, edges) = (timed?, edges?);
    if !edges.are_rest() || start.offset != 0.0 {
        return between_speeds(quantities, timed, start, edges, SpeedShape::Cosine).map(Planned::General);
    }
    let (steps, duration_s, ramp_s) = timed;
    let curve = Cosine::new(steps, duration_s, ramp_s);
    check_speed(quantities, "duration_s", curve.top_speed())?;
    Some(Planned::FromRest(curve))
}

/// A move in a given time between two speeds, or from a position between two steps.
fn between_speeds(
    quantities: &mut Quantities<'_>,
    (steps, duration_s, ramp_s): (i64, f64, f64),
    start: Start,
    EdgeSpeeds { start: start_speed, end: end_speed }: EdgeSpeeds,
    shape: SpeedShape,
) -> Option<Numeric<SpeedRamps>> {
    let (from, to) = (start.offset, steps as f64);
    let curve = SpeedRamps { from, to, start_speed, end_speed, duration_s, ramp_s, shape };
    let plateau = curve.plateau_speed();
    if plateau <= 0.0 {
        let needed = (start_speed + end_speed) * ramp_s * (1.0 - shape.area());
        let cause = Cause::NoPlateau {
            steps: libm::fabs(to - from),
            needed,
            plateau,
            start: start_speed,
            end: end_speed,
        };
        quantities.refuse("distance", cause);
        return None;
    }
    check_speed(quantities, "duration_s", plateau)?;
    Some(Numeric::new(curve, from, Exact::of(duration_s).double()))
}

/// Plans the curve in slices. The exact curve must be valid, too.
pub(super) fn sliced(
    quantities: &mut Quantities<'_>,
    given: &moves::Cosine,
    start: Start,
    budget: &mut Budget,
) -> Option<Sliced> {
    let fields =
        [("start_speed", given.start_speed.is_some()), ("end_speed", given.end_speed.is_some()), ("", false)];
    let fits = refuse_edges(quantities, start, fields);
    let distance_and_times = distance_and_times(quantities, &given.distance, given.duration_s, given.ramp_s);
    let slice_s = quantities.range("slice_s", given.slice_s, limits::SLICE_S, "s");
    let (steps, duration_s, ramp_s) = distance_and_times?;
    let slice_s = slice_s?;
    fits?;
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

pub(super) fn ramps(
    quantities: &mut Quantities<'_>,
    given: &moves::Ramps,
    start: Start,
) -> Option<Planned<Ramps, Numeric<SpeedRamps>>> {
    let distance_and_times = distance_and_times(quantities, &given.distance, given.duration_s, given.ramp_s);
    let mut parameter = |key: &str, value: f64| quantities.range(key, value, limits::RAMP_PARAMETER, "");
    let ramp = match given.shape {
        RampShape::Sigmoid => Ramp::sigmoid(parameter("sigmoid_range", given.sigmoid_range)?),
        RampShape::Bezier => Ramp::Bezier,
        RampShape::Straight => Ramp::Straight,
        RampShape::Exponential => Ramp::exponential(parameter("time_constants", given.time_constants)?),
    };
    let steps = distance_and_times.map(|(steps, _, _)| steps);
    let edges = start.edges(quantities, steps, given.start_speed.as_ref(), given.end_speed.as_ref());
    let (timed, edges) = (distance_and_times?, edges?);
    if !edges.are_rest() || start.offset != 0.0 {
        return between_speeds(quantities, timed, start, edges, SpeedShape::Ramp(ramp)).map(Planned::General);
    }
    let (steps, duration_s, ramp_s) = timed;
    let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
    check_speed(quantities, "duration_s", curve.top_speed())?;
    Some(Planned::FromRest(curve))
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
