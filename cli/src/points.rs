//! `stepscope points`: converts a table of times and positions to a scenario.

use crate::{failure::Failure, options::Out, quantity::Millimeters, scenario_file, scenarios};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use stepscope_core::motion::mechanics::{Direct, Mechanics};
use stepscope_core::motion::moves::{Axis, Interpolation, Move, PointUnit, Points};
use stepscope_core::motion::plan_axis;
use stepscope_core::scenario::{Motion, Scenario, Source, of_motion, points_of_table};

#[derive(Args)]
pub(crate) struct Arguments {
    /// CSV table of time in s and position, with or without a header; `-` reads standard input
    table: PathBuf,
    /// Unit of the positions
    #[arg(long, value_enum, default_value = "steps")]
    unit: UnitName,
    /// Travel per step, in mm, for positions in mm
    #[arg(long, value_name = "MM", required_if_eq("unit", "mm"))]
    step_mm: Option<Millimeters>,
    /// Connect the points by straight lines (default: a smooth curve that starts and ends at rest)
    #[arg(long)]
    straight: bool,
    #[command(flatten)]
    out: Out,
}

#[derive(Clone, Copy, ValueEnum)]
enum UnitName {
    Steps,
    Mm,
    Deg,
}

pub(crate) fn points(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.table;
    let points = points_of_table(&scenarios::text(path)?)
        .map_err(|error| Failure::Invalid(path.clone(), error.to_string()))?;
    let unit = match arguments.unit {
        UnitName::Steps => PointUnit::Steps,
        UnitName::Mm => PointUnit::Millimeters,
        UnitName::Deg => PointUnit::Degrees,
    };
    let interpolation = if arguments.straight { Interpolation::Straight } else { Interpolation::Smooth };
    let mechanics = match arguments.step_mm {
        Some(step_mm) => Mechanics::Direct(Direct { step_mm: step_mm.get() }),
        None => Mechanics::default(),
    };
    let moves = vec![Move::Points(Points { unit, interpolation, points })];
    let axis = Axis { mechanics, moves, ..Axis::default() };
    plan_axis(&axis, "source.motion.axes[0]")
        .map_err(|problems| Failure::Scenario(path.clone(), of_motion(problems)))?;
    let title =
        path.file_name().map_or_else(String::new, |name| name.to_string_lossy().chars().take(120).collect());
    let source = Source::Motion(Motion { axes: vec![axis], ..Motion::default() });
    let scenario = Scenario { title, source, ..Scenario::default() };
    scenario_file::write(&arguments.out.out, path, &scenario, "use fewer points")
}
