//! `stepscope torque`: does a motor have what a plan asks of it, and which ramps can it follow?

use crate::{
    failure::Failure,
    json::Tables,
    output::{self, Outputs},
    progress::Progress,
    scenarios,
};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::{
    io::{self, Write},
    path::PathBuf,
};
use stepscope_core::{
    inspect::{
        model_agreement::{Agreement, FirstSlips, agreement},
        torque::{Demand, Machine, Moment, Ramps},
    },
    motion::{AxisPlan, Curve, PlannedMove, plan_lists},
    peripheral::{trace::Digest, units::Cycles},
    scenario::{Motion, Problem, Scenario, Source, ValueError, of_motion},
    sim::{BUDGET_MOTOR_STEPS, Experiment, plant_run::PlantRun},
};

/// Shortages that the screen shows of an axis.
const MAX_SHOWN: usize = 20;
/// The most time in s that a move may have (docs/scenario.md).
const MAX_DURATION_S: f64 = 86_400.0;
/// Cycles between two looks at how far the plant's run is.
const SLICE: Cycles = Cycles(1 << 22);
/// Rates of the curve.
const POINTS: u32 = 201;

/// What `stepscope torque` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario, whose source is a motion with a motor: a JSON file, or a preset's name; `-` reads standard input.
    scenario: PathBuf,
    /// Only this axis, from 0; the curve is of axis 0 without it.
    #[arg(long, value_name = "K")]
    axis: Option<usize>,
    /// What is written: what each axis asks of its motor, or the curve of one motor as CSV.
    #[arg(long, value_enum, default_value = "text")]
    format: Written,
    /// Where it goes (`-`: standard output).
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    /// Run the plant, too, also where the scenario has none or the run is long, and say whether both models agree.
    #[arg(long, conflicts_with = "format")]
    plant: bool,
    /// Write it as JSON: one object of tables (docs/command.md).
    #[arg(long, conflicts_with = "format")]
    json: bool,
}

/// What is written.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Written {
    /// Words and numbers.
    Text,
    /// The torque-speed curve: available torque at each rate.
    Csv,
}

/// An axis with a motor.
struct Driven {
    axis: usize,
    machine: Machine,
    plan: AxisPlan,
    demand: Demand,
    /// What the plant says, where it was run.
    agreement: Option<Agreement>,
}

/// Writes what the motors have and what is asked of them.
pub(crate) fn torque(arguments: &Arguments) -> Result<(), Failure> {
    let outputs = Outputs::judge(Some(&arguments.scenario), [arguments.out.as_path()])?;
    let scenario = scenarios::read(&arguments.scenario)?;
    let mut driven = driven(arguments, &scenario)?;
    if arguments.format == Written::Text {
        hold_against_plant(arguments, scenario, &mut driven)?;
    }
    output::write_whole(outputs, &arguments.out, |out| match arguments.format {
        _ if arguments.json => tables(&driven).write(out),
        Written::Text => driven.iter().try_for_each(|driven| report(driven, out)),
        Written::Csv => driven.first().map_or(Ok(()), |driven| curve(driven, out)),
    })
}

/// What the text says, as tables.
fn tables(driven: &[Driven]) -> Tables {
    let axis = |Driven { axis, machine, demand, agreement, .. }: &Driven| {
        let least = demand.least.as_ref();
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
            "shortages": demand.total,
            "enough": demand.is_met(),
            "plant": agreement.as_ref().map(|found| &found.plant),
            "models_agree": agreement.as_ref().and_then(|found| found.agrees),
            "models_differ_because": agreement.as_ref().and_then(|found| found.why.as_ref()),
        })
    };
    let shortages = driven.iter().flat_map(|driven| {
        driven.demand.shortages.iter().map(|found| {
            json!({
                "axis": driven.axis,
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
    });
    let ramps = driven.iter().flat_map(|Driven { axis, machine, plan, .. }| {
        plan.moves().iter().enumerate().filter_map(move |(index, planned)| {
            let found = Ramps::of(machine, &planned.profile)?;
            Some(json!({
                "axis": axis,
                "move": index,
                "steps": planned.profile.steps(),
                "duration_s": planned.profile.duration_s(),
                "greatest_rate_steps_s": found.greatest_rate,
                "longest_ramp_s": found.longest_s,
                "longest_possible_ramp_s": found.room_s,
                "enough_torque_from_ramp_s": found.enough_s.map(|(shortest, _)| shortest),
                "enough_torque_to_ramp_s": found.enough_s.map(|(_, longest)| longest),
                "enough_torque_without_ramps": found.without_ramps,
            }))
        })
    });
    let axes: Vec<Value> = driven.iter().map(axis).collect();
    Tables::of("torque").with("axes", axes).with("shortages", shortages).with("ramps", ramps)
}

/// The axes that are asked for and have a motor: at least one.
fn driven(arguments: &Arguments, scenario: &Scenario) -> Result<Vec<Driven>, Failure> {
    let path = &arguments.scenario;
    let wrong = |problems| Failure::Scenario(path.clone(), problems);
    let refused = |path: String, detail| wrong(vec![Problem::new(path, ValueError::Conflict { detail })]);
    let Source::Motion(Motion { axes, .. }) = &scenario.source else {
        let detail = "no motion, so no motor is asked for anything; give a scenario with source.motion";
        return Err(refused("source".to_owned(), detail));
    };
    let plans =
        plan_lists([("source.motion.axes".to_owned(), axes.as_slice())]).map_err(of_motion).map_err(wrong)?;
    let only = match (arguments.axis, arguments.format) {
        (None, Written::Csv) => Some(0),
        (axis, _) => axis,
    };
    if let Some(axis) = only
        && axis >= axes.len()
    {
        return Err(Failure::Axis(path.clone(), axis, axes.len()));
    }
    let all = axes.iter().zip(plans.into_iter().flatten()).enumerate();
    let asked = all.filter(|(axis, _)| only.is_none_or(|only| only == *axis));
    let found: Vec<Driven> = asked
        .filter_map(|(axis, (given, plan))| {
            let machine = Machine::of(given)?;
            let demand = Demand::of(&machine, &plan);
            Some(Driven { axis, machine, plan, demand, agreement: None })
        })
        .collect();
    if found.is_empty() {
        let detail = "no motor; give one, such as \"motor\": {} for that of Song, Han and Lu 2021";
        return Err(refused(format!("source.motion.axes[{}].motor", only.unwrap_or(0)), detail));
    }
    Ok(found)
}

/// Runs the plant, where there is one or one is asked for, and holds it against the curve.
fn hold_against_plant(
    arguments: &Arguments,
    mut scenario: Scenario,
    driven: &mut [Driven],
) -> Result<(), Failure> {
    if scenario.plant.is_none() && !arguments.plant {
        return Ok(());
    }
    scenario.plant.get_or_insert_default();
    let mut not_run = |why: String| {
        for driven in &mut *driven {
            let plant = format!("not run: {why}");
            driven.agreement = Some(Agreement { plant, agrees: None, why: None });
        }
        Ok(())
    };
    let experiment = match Experiment::new(&scenario) {
        Ok(experiment) => experiment,
        Err(problems) if arguments.plant => {
            return Err(Failure::Scenario(arguments.scenario.clone(), problems));
        }
        Err(_) => return not_run("the scenario has problems, which --plant tells".to_owned()),
    };
    let motor_steps = experiment.cost().motor_steps;
    if motor_steps > BUDGET_MOTOR_STEPS && !arguments.plant {
        return not_run(format!("it takes {motor_steps} motor-steps; --plant runs it all the same"));
    }
    let parts = (0..experiment.controllers()).map(|_| <(Digest, FirstSlips)>::default()).collect();
    let Some(mut run) = PlantRun::new(&experiment, parts) else { return Ok(()) };
    let mut progress = Progress::new("torque", false);
    while !run.advance(SLICE) {
        progress.tell(run.now().0, experiment.cost().end_cycle);
    }
    drop(progress);
    let (results, overload) = (run.results(), run.overload(0));
    let parts = run.into_parts();
    let setup = experiment.plants().and_then(|plants| plants.setups.first());
    if let (Some(setup), Some(result), Some((_, slips))) = (setup, results.first(), parts.first()) {
        for Driven { axis, machine, demand, agreement: found, .. } in driven {
            *found = Some(agreement(machine, demand, setup, *axis, result, overload, slips));
        }
    }
    Ok(())
}

fn curve(driven: &Driven, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "rate_hz,available_mn_m")?;
    let most = driven.machine.shown_rate(driven.plan.peaks().speed);
    driven
        .machine
        .curve(most, POINTS)
        .try_for_each(|(rate, available)| writeln!(out, "{rate:.3},{available:.6}"))
}

fn report(driven: &Driven, out: &mut impl Write) -> io::Result<()> {
    let Driven { axis, machine, plan, demand, agreement } = driven;
    writeln!(out, "axis {axis}")?;
    let standing = machine.available_mn_m(0.0);
    match machine.corner_rate() {
        Some(0.0) => writeln!(
            out,
            "  standing torque  {standing:.1} mN*m; the supply is too low for the whole current at any rate"
        )?,
        corner => writeln!(out, "  full torque      {standing:.1} mN*m, up to {}", rate(corner))?,
    }
    writeln!(
        out,
        "  greatest rate    {} with a load of {:.1} mN*m",
        rate(machine.torque_rate()),
        machine.load_mn_m()
    )?;
    if let Some(stated) = machine.working_rate() {
        writeln!(out, "  working rate     {stated:.0} steps/s, as stated")?;
    }
    if let Some(least) = &demand.least {
        let margin = least.margin_mn_m();
        writeln!(out, "  least margin     {margin:.1} mN*m: {}", moment(least))?;
    }
    if demand.jump > 0.0 {
        let jump = demand.jump;
        writeln!(
            out,
            "  jump of speed    {jump:.0} steps/s at once; the motor's start-stop rate has to be higher"
        )?;
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
            "  warning: {given:.0} steps/s are above the working rate of {most:.0} steps/s; give more time, or shorter ramps"
        )?;
    }
    if demand.total == 0 {
        return Ok(());
    }
    writeln!(
        out,
        "  warning: too little torque in {} interval{}; give more time, gentler ramps, less load, or a higher supply voltage",
        demand.total,
        if demand.total == 1 { "" } else { "s" }
    )?;
    for found in demand.shortages.iter().take(MAX_SHOWN) {
        let (from, to, short) = (found.from_s, found.to_s, -found.worst.margin_mn_m());
        write!(out, "    {from:.6} to {to:.6} s: {short:.1} mN*m short {}", moment(&found.worst))?;
        match found.times {
            times if times > 1.0 => writeln!(out, "; so in {times:.0} periods")?,
            _ => writeln!(out)?,
        }
    }
    match demand.total.saturating_sub(MAX_SHOWN as u64) {
        0 => Ok(()),
        more => writeln!(out, "    and {more} more"),
    }
}

fn ramps(index: usize, planned: &PlannedMove, found: &Ramps, out: &mut impl Write) -> io::Result<()> {
    let (steps, duration_s) = (planned.profile.steps(), planned.profile.duration_s());
    writeln!(out, "  move {index:<11} {} steps in {duration_s} s", steps.unsigned_abs())?;
    if found.greatest_rate == Some(0.0) {
        return writeln!(
            out,
            "    the load needs more torque than the motor has at any rate; give less load"
        );
    }
    if let Some(greatest) = found.greatest_rate {
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
                    least_s if least_s <= MAX_DURATION_S => writeln!(out, "give at least {least_s:.4} s")?,
                    _ => {
                        writeln!(out, "give less distance or less load: no move may take the time it needs")?
                    }
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
            "    the torque would suffice for ramps of {shortest:.4} to {longest:.4} s, but they are above the working rate; give more time"
        ),
        None => writeln!(out, "    no ramp leaves enough torque; give more time or less load"),
    }
}
