//! The results of `stepscope torque` as text.

use super::axis_demand::{AxisDemand, MotionSource};
use std::io::{self, Write};
use stepscope_core::inspect::motion::torque::{Demand, Machine, Moment, Ramps};
use stepscope_core::inspect::plant::model_agreement::Agreement;
use stepscope_core::motion::PlannedMove;

const MAX_SHOWN: usize = 20;
/// Maximum time of a move, in s (docs/scenario.md).
const MAX_DURATION_S: f64 = 86_400.0;

pub(crate) fn report(axis_demand: &AxisDemand, out: &mut impl Write) -> io::Result<()> {
    let AxisDemand { axis, machine, source, demand, agreement } = axis_demand;
    match source {
        MotionSource::Plan(_) => writeln!(out, "axis {axis}")?,
        MotionSource::Steps => {
            let period_ms = machine.natural_period_s() * 1e3;
            writeln!(
                out,
                "channel {axis}: the scenario has no motion, so the steps themselves are checked, over the rotor's natural period of {period_ms:.3} ms"
            )?;
        }
    }
    let standing = machine.available_mn_m(0.0);
    match machine.corner_rate() {
        Some(0.0) => writeln!(
            out,
            "  standing torque  {standing:.1} mN*m; the supply is too low for the whole current at any rate"
        )?,
        corner => writeln!(out, "  full torque      {standing:.1} mN*m, up to {}", rate(corner))?,
    }
    let load_mn_m = machine.load_mn_m();
    match machine.torque_rate() {
        None => writeln!(out, "  maximum rate     not limited by torque (load {load_mn_m:.1} mN*m)")?,
        limit => writeln!(out, "  maximum rate     {} with a load of {load_mn_m:.1} mN*m", rate(limit))?,
    }
    if let Some(stated) = machine.working_rate() {
        writeln!(out, "  working rate     {stated:.0} steps/s, as specified")?;
    }
    if let Some(least) = &demand.min_margin {
        let margin = least.margin_mn_m();
        writeln!(out, "  minimum margin   {margin:.1} mN*m: {}", moment(least))?;
    }
    if demand.jump > 0.0 {
        let jump = demand.jump;
        let higher = "the start-stop rate must be higher";
        match source {
            MotionSource::Plan(_) => writeln!(out, "  jump of speed    {jump:.0} steps/s at once; {higher}")?,
            MotionSource::Steps => {
                writeln!(out, "  jump of speed    {jump:.0} steps/s next to a stop or a reversal; {higher}")?;
            }
        }
    }
    shortages(demand, machine, out)?;
    if let Some(Agreement { plant, agrees, why }) = agreement {
        let agrees = match agrees {
            Some(true) => "; both models agree",
            Some(false) => "; the models differ",
            None => "",
        };
        writeln!(out, "  plant            {plant}{agrees}")?;
        if let Some(why) = why {
            writeln!(out, "    {why}")?;
        }
    }
    let MotionSource::Plan(plan) = source else { return Ok(()) };
    for (index, planned) in plan.moves().iter().enumerate() {
        if let Some(found) = Ramps::of(machine, &planned.profile) {
            ramps(index, planned, &found, out)?;
        }
    }
    Ok(())
}

fn rate(found: Option<f64>) -> String {
    match found {
        None => "any rate".to_owned(),
        Some(0.0) => "none".to_owned(),
        Some(rate) => format!("{rate:.0} steps/s"),
    }
}

fn moment(moment: &Moment) -> String {
    format!(
        "at {:.6} s, {:.0} steps/s, {:.1} needed of {:.1} mN*m",
        moment.at_s, moment.rate, moment.needed_mn_m, moment.available_mn_m
    )
}

fn shortages(demand: &Demand, machine: &Machine, out: &mut impl Write) -> io::Result<()> {
    if demand.is_met() {
        return writeln!(out, "  enough torque throughout");
    }
    if let (Some(given), Some(most)) = (demand.over_working_rate, machine.working_rate()) {
        writeln!(
            out,
            "  warning: {given:.0} steps/s are above the working rate of {most:.0} steps/s; allow more time, or use shorter ramps"
        )?;
    }
    if demand.shortage_count == 0 {
        return Ok(());
    }
    writeln!(
        out,
        "  warning: too little torque in {} interval{}; allow more time, or use gentler ramps, less load or a higher supply voltage",
        demand.shortage_count,
        if demand.shortage_count == 1 { "" } else { "s" }
    )?;
    for found in demand.shortages.iter().take(MAX_SHOWN) {
        let (from, to, short) = (found.from_s, found.to_s, -found.worst.margin_mn_m());
        write!(out, "    {from:.6} to {to:.6} s: {short:.1} mN*m short {}", moment(&found.worst))?;
        match found.times {
            times if times > 1.0 => writeln!(out, "; in {times:.0} periods")?,
            _ => writeln!(out)?,
        }
    }
    match demand.shortage_count.saturating_sub(MAX_SHOWN as u64) {
        0 => Ok(()),
        more => writeln!(out, "    and {more} more"),
    }
}

fn ramps(index: usize, planned: &PlannedMove, found: &Ramps, out: &mut impl Write) -> io::Result<()> {
    let (steps, duration_s) = (planned.profile.steps(), planned.profile.duration_s());
    writeln!(out, "  move {index:<11} {} steps in {duration_s} s", steps.unsigned_abs())?;
    if found.max_rate == Some(0.0) {
        return writeln!(
            out,
            "    the load needs more torque than the motor has at any rate; reduce the load"
        );
    }
    if let Some(greatest) = found.max_rate {
        write!(out, "    under {greatest:.0} steps/s  ")?;
        match found.longest_s {
            Some(longest_s) if longest_s > found.room_s => {
                let room_s = found.room_s;
                writeln!(out, "a ramp of at most {longest_s:.4} s; the longest possible is {room_s:.4} s")?;
            }
            Some(longest_s) => writeln!(out, "a ramp of at most {longest_s:.4} s")?,
            None => {
                write!(out, "even without ramps the move is faster; ")?;
                match steps.unsigned_abs() as f64 / greatest {
                    least_s if least_s <= MAX_DURATION_S => writeln!(out, "allow at least {least_s:.4} s")?,
                    _ => writeln!(
                        out,
                        "reduce the distance or the load, because the move would take longer than is allowed"
                    )?,
                }
            }
        }
    }
    if let Some((shortest, longest)) = found.enough_s {
        return writeln!(out, "    enough torque with ramps of {shortest:.4} to {longest:.4} s");
    }
    if found.without_ramps {
        writeln!(out, "    enough torque without ramps, if the motor starts and stops at that rate")?;
    }
    match found.too_fast_s {
        Some((shortest, longest)) => writeln!(
            out,
            "    the torque would suffice for ramps of {shortest:.4} to {longest:.4} s, but those exceed the working rate; allow more time"
        ),
        None => writeln!(out, "    no ramp leaves enough torque; allow more time or reduce the load"),
    }
}
