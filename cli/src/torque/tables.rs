//! The results of `stepscope torque` as tables.

use super::axis_demand::{AxisDemand, MotionSource};
use crate::json::Tables;
use serde_json::{Value, json};
use stepscope_core::inspect::motion::torque::{Moment, Ramps};

pub(crate) fn axes(demands: &[AxisDemand]) -> impl Iterator<Item = Value> + '_ {
    demands.iter().map(|AxisDemand { axis, machine, source, demand, agreement }| {
        let least = demand.min_margin.as_ref();
        json!({
            "axis": axis,
            "standing_torque_mn_m": machine.available_mn_m(0.0),
            "full_torque_up_to_steps_s": machine.corner_rate(),
            "greatest_rate_steps_s": machine.torque_rate(),
            "load_mn_m": machine.load_mn_m(),
            "working_rate_steps_s": machine.working_rate(),
            "least_margin_mn_m": least.map(Moment::margin_mn_m),
            "least_margin_at_s": least.map(|least| least.at_s),
            "speed_jump_steps_s": demand.jump,
            "over_working_rate_steps_s": demand.over_working_rate,
            "shortages": demand.shortage_count,
            "enough": demand.is_met(),
            "plant": agreement.as_ref().map(|found| &found.plant),
            "models_agree": agreement.as_ref().and_then(|found| found.agrees),
            "models_differ_because": agreement.as_ref().and_then(|found| found.why.as_ref()),
            "window_s": matches!(source, MotionSource::Steps).then(|| machine.natural_period_s()),
        })
    })
}

pub(crate) fn shortages(demands: &[AxisDemand]) -> impl Iterator<Item = Value> + '_ {
    demands.iter().flat_map(|axis| {
        axis.demand.shortages.iter().map(|found| {
            json!({
                "axis": axis.axis,
                "from_s": found.from_s,
                "to_s": found.to_s,
                "times": found.times,
                "short_mn_m": -found.worst.margin_mn_m(),
                "worst_at_s": found.worst.at_s,
                "worst_rate_steps_s": found.worst.rate,
                "needed_mn_m": found.worst.needed_mn_m,
                "available_mn_m": found.worst.available_mn_m,
            })
        })
    })
}

pub(super) fn tables(demands: &[AxisDemand]) -> Tables {
    let ramps = demands.iter().flat_map(|AxisDemand { axis, machine, source, .. }| {
        let moves = match source {
            MotionSource::Plan(plan) => plan.moves(),
            MotionSource::Steps => &[],
        };
        moves.iter().enumerate().filter_map(move |(index, planned)| {
            let found = Ramps::of(machine, &planned.profile)?;
            Some(json!({
                "axis": axis,
                "move": index,
                "steps": planned.profile.steps(),
                "duration_s": planned.profile.duration_s(),
                "greatest_rate_steps_s": found.max_rate,
                "longest_ramp_s": found.longest_s,
                "longest_possible_ramp_s": found.room_s,
                "enough_torque_from_ramp_s": found.enough_s.map(|(shortest, _)| shortest),
                "enough_torque_to_ramp_s": found.enough_s.map(|(_, longest)| longest),
                "enough_torque_without_ramps": found.without_ramps,
            }))
        })
    });
    let all = Tables::of("torque").with("axes", axes(demands)).with("shortages", shortages(demands));
    all.with("ramps", ramps)
}
