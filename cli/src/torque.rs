//! `stepscope torque`: compares available torque with the demand, and reports feasible ramps.

mod arguments;
mod axis_demand;
pub(crate) mod tables;
pub(crate) mod text;
mod unplanned;

use crate::failure::{Failure, Numbered};
use crate::{output, progress::Progress, scenarios};
pub(crate) use arguments::Arguments;
use arguments::Written;
pub(crate) use axis_demand::AxisDemand;
use axis_demand::MotionSource;
use std::io::{self, Write};
use stepscope_core::inspect::motion::torque::{Demand, Machine};
use stepscope_core::inspect::plant::model_agreement::{Agreement, FirstSlips, agreement};
use stepscope_core::motion::plan_lists;
use stepscope_core::peripheral::{trace::Digest, units::Cycles};
use stepscope_core::scenario::{Motion, Problem, Scenario, Source, ValueError, of_motion};
use stepscope_core::sim::{BUDGET_MOTOR_GRID_STEPS, Experiment, plant_run::PlantRun};

/// Cycles between progress reports.
const SLICE: Cycles = Cycles(1 << 22);
const POINTS: u32 = 201;

pub(crate) fn torque(arguments: &Arguments) -> Result<(), Failure> {
    let mut scenario = scenarios::read(&arguments.scenario)?;
    if arguments.plant {
        scenario.plant.get_or_insert_default();
    }
    arguments.named.apply_to(&mut scenario);
    let mut demands = match &scenario.source {
        Source::Motion(motion) => planned(arguments, motion)?,
        _ => unplanned::demands(arguments, &scenario)?,
    };
    if arguments.format == Written::Text {
        compare_with_plant(arguments, scenario, &mut demands)?;
    }
    output::write_new(&arguments.out.out, |out| match arguments.format {
        _ if arguments.json.json => tables::tables(&demands).write(out),
        Written::Text => demands.iter().try_for_each(|demand| text::report(demand, out)),
        Written::Csv => demands.first().map_or(Ok(()), |demand| curve(demand, out)),
    })
}

/// The selected axes with a motor: at least one.
fn planned(arguments: &Arguments, motion: &Motion) -> Result<Vec<AxisDemand>, Failure> {
    let axes = &motion.axes;
    let path = &arguments.scenario;
    let wrong = |problems| Failure::Scenario(path.clone(), problems);
    if arguments.named.microsteps.is_some() {
        let what = "--microsteps: the axes of a motion have their own microsteps; set them in the axis's mechanics, or omit the option";
        return Err(Failure::Invalid(path.clone(), what.to_owned()));
    }
    let only = match (arguments.axis, arguments.format) {
        (None, Written::Csv) => Some(0),
        (axis, _) => axis,
    };
    if let Some(axis) = only
        && axis >= axes.len()
    {
        return Err(Failure::index(
            path,
            Numbered::Axes,
            axis,
            axes.len(),
            arguments.format == Written::Text,
        ));
    }
    let mut selected = axes.iter().enumerate().filter(|(axis, _)| only.is_none_or(|only| only == *axis));
    if !axes.is_empty() && selected.all(|(_, given)| given.motor.is_none()) {
        let detail =
            "the axis has no motor; use --motor, or \"motor\": {} for the motor of Song, Han and Lu 2021";
        let field = format!("source.motion.axes[{}].motor", only.unwrap_or(0));
        return Err(wrong(Problem::new(field, ValueError::Conflict { detail }).into()));
    }
    let plans = plan_lists([motion.axis_list()]).map_err(of_motion).map_err(wrong)?;
    let all = axes.iter().zip(plans.into_iter().flatten()).enumerate();
    let selected = all.filter(|(axis, _)| only.is_none_or(|only| only == *axis));
    let found = selected.filter_map(|(axis, (given, plan))| {
        let machine = Machine::of(given)?;
        let demand = Demand::of(&machine, &plan);
        Some(AxisDemand { axis, machine, source: MotionSource::Plan(plan), demand, agreement: None })
    });
    Ok(found.collect())
}

/// Runs the plant if there is one or it is requested, and compares it with the torque curve.
fn compare_with_plant(
    arguments: &Arguments,
    mut scenario: Scenario,
    demands: &mut [AxisDemand],
) -> Result<(), Failure> {
    if scenario.plant.is_none() && !arguments.plant {
        return Ok(());
    }
    scenario.plant.get_or_insert_default();
    let mut not_run = |why: String| {
        for demand in &mut *demands {
            let plant = format!("not run: {why}");
            demand.agreement = Some(Agreement { plant, agrees: None, why: None });
        }
        Ok(())
    };
    let experiment = match Experiment::new(&scenario) {
        Ok(experiment) => experiment,
        Err(problems) if arguments.plant => {
            return Err(Failure::Scenario(arguments.scenario.clone(), problems));
        }
        Err(_) => return not_run("the scenario has problems, which --plant lists".to_owned()),
    };
    let motor_grid_steps = experiment.cost().motor_grid_steps;
    if motor_grid_steps > BUDGET_MOTOR_GRID_STEPS && !arguments.plant {
        return not_run(format!(
            "the simulation takes {motor_grid_steps} grid steps of all motors; use --plant to run it anyway"
        ));
    }
    let parts = (0..experiment.controllers()).map(|_| <(Digest, FirstSlips)>::default()).collect();
    let Some(mut run) = PlantRun::new(&experiment, parts) else { return Ok(()) };
    let mut progress = Progress::new("torque", false);
    while !run.advance(SLICE) {
        progress.update(run.now().0, experiment.cost().end_cycle);
    }
    progress.end(format_args!("{} cycles", run.now().0), &[]);
    let (results, overload) = (run.results(), run.overload(0));
    let parts = run.into_parts();
    let setup = experiment.plants().and_then(|plants| plants.setups.first());
    if let (Some(setup), Some(result), Some((_, slips))) = (setup, results.first(), parts.first()) {
        for AxisDemand { axis, machine, demand, agreement: found, .. } in demands {
            *found = Some(agreement(machine, demand, setup, *axis, result, overload, slips));
        }
    }
    Ok(())
}

fn curve(axis: &AxisDemand, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "rate_hz,available_mn_m")?;
    let most = axis.machine.shown_rate(axis.demand.max_rate);
    axis.machine
        .curve(most, POINTS)
        .try_for_each(|(rate, available)| writeln!(out, "{rate:.3},{available:.6}"))
}
