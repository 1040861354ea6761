//! `stepscope sine`: segments of sines and their distortion (CSV).

use crate::failure::{Failure, Numbered};
use crate::options::{Json, Out};
use crate::quantity::{AmplitudePart, Hertz, Seconds, whole};
use crate::{json::Tables, output, parallel, progress::Progress, scenarios};
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use stepscope_core::inspect::motion::sine_optimum::{Freedom, MAX_SEGMENTS, optimum};
use stepscope_core::inspect::motion::sine_polyline::{
    self, Bounds, Distinct, Distortion, Measure, Row, swept,
};
use stepscope_core::motion::curves::{Memory, Segment, SineSegments};
use stepscope_core::motion::{Profile, moves::Move};
use stepscope_core::scenario::{Analysis, Problem, Scenario, Source, ValueError};

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Report segments and distortion for a range of maximum deviations d1
    Sweep {
        #[command(flatten)]
        range: Range,
        /// Number of values of d1 in the range
        #[arg(long, value_name = "N", default_value = "500", value_parser = whole::<u32>(2..=1_000_000))]
        points: u32,
    },
    /// Find the maximum deviation d1 with the minimum distortion
    ///
    /// Compares every distinct polyline in the range.
    Best {
        #[command(flatten)]
        range: Range,
        /// Number of segments per quarter (default: any)
        #[arg(long, value_name = "N", value_parser = whole::<usize>(1..=u64::MAX))]
        segments: Option<usize>,
    },
    /// Find the vertices with the minimum distortion for a given number of segments
    Vertices {
        /// Number of segments per quarter
        #[arg(long, value_name = "N", value_parser = whole::<u8>(1..=MAX_SEGMENTS as u64))]
        segments: u8,
        /// Allow vertices off the curve
        #[arg(long)]
        free: bool,
        #[command(flatten)]
        common: Common,
    },
    /// Report the segments of a scenario's sines
    ///
    /// Lists vertices, steps, rates and bytes for a quarter of each sine.
    Segments {
        /// Scenario with a motion: a JSON file or a preset's name; `-` reads standard input
        scenario: PathBuf,
        /// Axis, from 0 (default: all)
        #[arg(long, value_name = "K", value_parser = whole::<usize>(0..=u64::MAX))]
        axis: Option<usize>,
        #[command(flatten)]
        written: Written,
    },
}

#[derive(Args)]
pub(crate) struct Range {
    /// Start of the range of d1, as a fraction of the amplitude
    #[arg(long, value_name = "D1", default_value = "0.002")]
    from: AmplitudePart,
    /// End of the range of d1
    #[arg(long, value_name = "D1", default_value = "0.06")]
    to: AmplitudePart,
    /// Bandwidth of an accelerometer, in Hz; adds the distortion after its low-pass filter
    ///
    /// A first-order low-pass filter (-3 dB).
    #[arg(long, value_name = "HZ", requires = "period_s")]
    sensor_hz: Option<Hertz>,
    /// Period of the sine, in s, for --sensor-hz
    #[arg(long, value_name = "S", requires = "sensor_hz")]
    period_s: Option<Seconds>,
    #[command(flatten)]
    common: Common,
}

impl Range {
    fn ends(&self) -> Result<(f64, f64), Failure> {
        let (from, to) = (self.from.get(), self.to.get());
        if from <= to {
            return Ok((from, to));
        }
        let why = format!("--to: {to} is below --from {from}; use --to {from} to 1, or a lower --from");
        Err(Failure::Option(why))
    }

    fn bounds(&self) -> Bounds {
        let sensor =
            self.sensor_hz.zip(self.period_s).map(|(sensor_hz, period_s)| sensor_hz.get() * period_s.get());
        Bounds { order: self.common.max_harmonic, sensor }
    }
}

#[derive(Args)]
pub(crate) struct Common {
    /// Highest harmonic included in the distortion
    #[arg(long, alias = "order", value_name = "K", default_value_t = Analysis::default().max_harmonic,
          value_parser = whole::<u16>(3..=9999))]
    max_harmonic: u16,
    #[command(flatten)]
    written: Written,
}

#[derive(Args)]
pub(crate) struct Written {
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    out: Out,
}

pub(crate) fn sine(command: &Command) -> Result<(), Failure> {
    let written = match command {
        Command::Sweep { range, .. } | Command::Best { range, .. } => &range.common.written,
        Command::Vertices { common, .. } => &common.written,
        Command::Segments { written, .. } => written,
    };
    let (mut sines, mut rows) = (Vec::new(), Vec::new());
    match command {
        Command::Segments { scenario, axis, .. } => sines = self::sines(scenario, *axis)?,
        Command::Sweep { range, points } => rows = sweep(range, *points)?,
        Command::Best { range, segments } => rows = vec![best(range, *segments)?],
        Command::Vertices { .. } => {}
    }
    output::write_new(&written.out.out, |out| match command {
        Command::Sweep { range, .. } => polylines("sine sweep", range, &rows, out),
        Command::Best { range, .. } => polylines("sine best", range, &rows, out),
        Command::Vertices { segments, free, common } => {
            let freedom = if *free { Freedom::Free } else { Freedom::OnCurve };
            vertices((*segments).into(), freedom, common, out)
        }
        Command::Segments { written, .. } => segments(&sines, written.json.json, out),
    })
}

struct ScenarioSine {
    axis: usize,
    index: usize,
    sine: SineSegments,
}

fn sines(scenario: &Path, only: Option<usize>) -> Result<Vec<ScenarioSine>, Failure> {
    let (_, experiment) = scenarios::validated_after(scenario, |given| has_sines(scenario, given, only))?;
    let plans = experiment.plans();
    let axes = plans.iter().enumerate().filter(|(axis, _)| only.is_none_or(|only| only == *axis));
    let found: Vec<ScenarioSine> = axes
        .flat_map(|(axis, plan)| {
            plan.moves().iter().enumerate().filter_map(move |(index, planned)| match &planned.profile {
                Profile::SineSegments(sine) => Some(ScenarioSine { axis, index, sine: sine.clone() }),
                _ => None,
            })
        })
        .collect();
    Ok(found)
}

fn has_sines(path: &Path, scenario: &Scenario, only: Option<usize>) -> Result<(), Failure> {
    let axes = match &scenario.source {
        Source::Motion(motion) => motion.axes.as_slice(),
        _ => &[],
    };
    if let Some(axis) = only.filter(|axis| *axis >= axes.len()) {
        return Err(Failure::index(path, Numbered::Axes, axis, axes.len(), true));
    }
    let selected = axes.iter().enumerate().filter(|(axis, _)| only.is_none_or(|only| only == *axis));
    if selected.flat_map(|(_, axis)| &axis.moves).any(|each| matches!(each, Move::SineSegments(_))) {
        return Ok(());
    }
    let detail = "no move is a sine of segments; use a move sine_segments, as in the preset sine-2022-d00054";
    let problem = Problem::new("source", ValueError::Conflict { detail });
    Err(Failure::Scenario(path.to_owned(), problem.into()))
}

/// The segments of a quarter of each sine; the other quarters follow by symmetry (DESIGN B5).
fn segments(sines: &[ScenarioSine], as_json: bool, out: &mut impl Write) -> io::Result<()> {
    let rows = sines.iter().flat_map(|sine| {
        let Memory { segments: segment_bytes, intervals } = sine.sine.memory();
        sine.sine
            .segments()
            .iter()
            .enumerate()
            .map(move |(number, segment)| (sine, number, *segment, segment_bytes, intervals))
    });
    if as_json {
        let rows =
            rows.map(|(ScenarioSine { axis, index, .. }, number, segment, segment_bytes, interval_bytes)| {
                json!({
                    "axis": axis,
                    "move": index,
                    "segment": number,
                    "from_point": segment.from,
                    "to_point": segment.to,
                    "from_deg": segment.from_deg,
                    "to_deg": segment.to_deg,
                    "steps": segment.steps,
                    "rate_steps_s": segment.rate,
                    "duration_s": segment.duration_s,
                    "quarter_bytes": segment_bytes,
                    "quarter_bytes_as_intervals": interval_bytes,
                })
            });
        return table("sine segments", "segments", rows).write(out);
    }
    writeln!(
        out,
        "axis,move,segment,from_point,to_point,from_deg,to_deg,steps,rate_steps_s,duration_s,quarter_bytes,quarter_bytes_as_intervals"
    )?;
    for (ScenarioSine { axis, index, .. }, number, segment, segment_bytes, interval_bytes) in rows {
        let Segment { from, to, from_deg, to_deg, steps, rate, duration_s, .. } = segment;
        writeln!(
            out,
            "{axis},{index},{number},{from},{to},{from_deg},{to_deg},{steps},{rate},{duration_s},{segment_bytes},{interval_bytes}"
        )?;
    }
    Ok(())
}

fn table(command: &'static str, table: &str, rows: impl IntoIterator<Item = Value>) -> Tables {
    Tables::of(command).with(table, rows)
}

fn sweep(range: &Range, points: u32) -> Result<Vec<Row>, Failure> {
    let (from, to) = range.ends()?;
    let (mut progress, measure) = (Progress::new("sine sweep", false), Measure::new(range.bounds()));
    let row = |index: u64| measure.row(swept(from, to, points, index as u32));
    let rows = parallel::each(points.into(), None, &mut progress, row).map_err(Failure::threads)?;
    progress.end(format_args!("{points} polylines"), &[]);
    Ok(rows)
}

fn best(range: &Range, only: Option<usize>) -> Result<Row, Failure> {
    let (from, to) = range.ends()?;
    let (mut min, mut max) = (usize::MAX, 0);
    let rows = Distinct::new(from, to, range.bounds()).inspect(|row| {
        (min, max) = (min.min(row.segments), max.max(row.segments));
    });
    let best = sine_polyline::best(rows.filter(|row| only.is_none_or(|only| only == row.segments)));
    best.ok_or_else(|| {
        let given = only.unwrap_or(0);
        let why = format!(
            "--segments: {given} is out of range for deviations from {from} to {to}; use {min} to {max}, or another range"
        );
        Failure::Option(why)
    })
}

fn polylines(command: &'static str, range: &Range, rows: &[Row], out: &mut impl Write) -> io::Result<()> {
    if range.common.written.json.json {
        return table(command, "polylines", rows.iter().map(json_row)).write(out);
    }
    let filtered = if range.sensor_hz.is_some() { ",acceleration_filtered_thd" } else { "" };
    writeln!(out, "d1,segments,position_thd,speed_thd,acceleration_thd,euclidean_distance{filtered}")?;
    rows.iter().try_for_each(|row| print_row(row, out))
}

fn print_row(row: &Row, out: &mut impl Write) -> io::Result<()> {
    let Distortion { position, speed, acceleration, acceleration_filtered } = row.distortion;
    write!(
        out,
        "{},{},{position:.8},{speed:.8},{acceleration:.8},{:.9}",
        row.d1, row.segments, row.euclidean
    )?;
    if let Some(filtered) = acceleration_filtered {
        write!(out, ",{filtered:.8}")?;
    }
    writeln!(out)
}

fn json_row(row: &Row) -> Value {
    let distortion = row.distortion;
    json!({
        "d1": row.d1,
        "segments": row.segments,
        "position_thd": distortion.position,
        "speed_thd": distortion.speed,
        "acceleration_thd": distortion.acceleration,
        "acceleration_filtered_thd": distortion.acceleration_filtered,
        "euclidean_distance": row.euclidean,
    })
}

fn vertices(segments: usize, freedom: Freedom, common: &Common, out: &mut impl Write) -> io::Result<()> {
    let found = optimum(segments, freedom, common.max_harmonic)
        .ok_or_else(|| io::Error::other("no polyline has this number of segments"))?;
    let distortion = found.distortion.position;
    if common.written.json.json {
        let rows = found.vertices.iter().enumerate().map(|(index, vertex)| {
            let angle_deg = vertex.angle.to_degrees();
            json!({ "vertex": index, "angle_deg": angle_deg, "height": vertex.height, "position_thd": distortion })
        });
        return table("sine vertices", "vertices", rows).write(out);
    }
    writeln!(out, "vertex,angle_deg,height,position_thd")?;
    for (index, vertex) in found.vertices.iter().enumerate() {
        writeln!(out, "{index},{:.9},{:.9},{distortion:.8}", vertex.angle.to_degrees(), vertex.height)?;
    }
    Ok(())
}
