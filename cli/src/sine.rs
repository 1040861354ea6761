//! `stepscope sine`: which segments make a sine with least distortion, as tables (CSV).

use crate::{
    failure::Failure,
    json::Tables,
    output::{self, Outputs},
    progress::Progress,
};
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use std::{
    io::{self, Write},
    path::PathBuf,
};
use stepscope_core::inspect::{
    sine_optimum::{Freedom, MAX_SEGMENTS, optimum},
    sine_polyline::{self, Bounds, Distinct, Row},
};

/// What `stepscope sine` does.
#[derive(Subcommand)]
pub(crate) enum Command {
    /// What each largest deviation d1 of a range gives: segments, distortion, Euclidean distance.
    Sweep {
        #[command(flatten)]
        range: Range,
        /// How many values of d1, from one end of the range to the other.
        #[arg(long, value_name = "N", default_value = "500", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
        points: u32,
    },
    /// The d1 with least distortion in a range; all polylines that the range has are compared.
    Best {
        #[command(flatten)]
        range: Range,
        /// Of those with so many segments a quarter.
        #[arg(long, value_name = "N")]
        segments: Option<usize>,
    },
    /// The vertices of so many segments a quarter that give least distortion, on the curve or free.
    Vertices {
        /// Segments of a quarter.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=MAX_SEGMENTS as i64))]
        segments: u8,
        /// Vertices may leave the curve.
        #[arg(long)]
        free: bool,
        #[command(flatten)]
        common: Common,
    },
}

/// A range of d1.
#[derive(Args)]
pub(crate) struct Range {
    /// Least d1, in parts of the amplitude.
    #[arg(long, value_name = "D1", default_value = "0.002", value_parser = part)]
    from: f64,
    /// Greatest d1.
    #[arg(long, value_name = "D1", default_value = "0.06", value_parser = part)]
    to: f64,
    /// Bandwidth (-3 dB, first order) of the accelerometer on the rig, in Hz: one more column tells the
    /// distortion of the acceleration that it feels.
    #[arg(long, value_name = "HZ", value_parser = positive, requires = "period_s")]
    sensor_hz: Option<f64>,
    /// Time of one period in s, which the sensor's bandwidth is held against.
    #[arg(long, value_name = "S", value_parser = positive, requires = "sensor_hz")]
    period_s: Option<f64>,
    #[command(flatten)]
    common: Common,
}

impl Range {
    fn bounds(&self) -> Bounds {
        let sensor = self.sensor_hz.zip(self.period_s).map(|(sensor_hz, period_s)| sensor_hz * period_s);
        Bounds { order: self.common.order, sensor }
    }
}

/// What all of them take.
#[derive(Args)]
pub(crate) struct Common {
    /// Highest harmonic of the distortion.
    #[arg(long, value_name = "K", default_value = "399", value_parser = clap::value_parser!(u16).range(3..=9999))]
    order: u16,
    /// Where the table goes (`-`: standard output).
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    /// Write it as JSON: one object of tables (docs/command.md).
    #[arg(long)]
    json: bool,
}

fn part(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|error| format!("{error}"))?;
    if (1e-6..=1.0).contains(&value) { Ok(value) } else { Err("give 0.000001 to 1".to_owned()) }
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|error| format!("{error}"))?;
    if (1e-6..=1e9).contains(&value) { Ok(value) } else { Err("give 0.000001 to 1e9".to_owned()) }
}

/// Writes the table.
pub(crate) fn sine(command: &Command) -> Result<(), Failure> {
    let common = match command {
        Command::Sweep { range, .. } | Command::Best { range, .. } => &range.common,
        Command::Vertices { common, .. } => common,
    };
    let outputs = Outputs::judge(None, [common.out.as_path()])?;
    output::write_whole(outputs, &common.out, |out| match command {
        Command::Sweep { range, points } => sweep(range, *points, out),
        Command::Best { range, segments } => {
            let rows = Distinct::new(range.from, range.to, range.bounds());
            let asked = |row: &Row| segments.is_none_or(|segments| segments == row.segments);
            let best = sine_polyline::best(rows.filter(asked));
            if common.json {
                return json_of("sine best", "polylines", best.iter().map(cells)).write(out);
            }
            head(range, out)?;
            best.iter().try_for_each(|best| row(best, out))
        }
        Command::Vertices { segments, free, common } => {
            let freedom = if *free { Freedom::Free } else { Freedom::OnCurve };
            vertices((*segments).into(), freedom, common, out)
        }
    })
}

fn json_of(command: &'static str, table: &str, rows: impl IntoIterator<Item = Value>) -> Tables {
    Tables::of(command).with(table, rows)
}

fn sweep(range: &Range, points: u32, out: &mut impl Write) -> io::Result<()> {
    let mut progress = Progress::new("sweep", false);
    let rows = sine_polyline::sweep(range.from, range.to, points, range.bounds());
    if range.common.json {
        let rows = (1..).zip(rows).map(|(done, found)| {
            progress.tell(done, points.into());
            cells(&found)
        });
        return json_of("sine sweep", "polylines", rows).write(out);
    }
    head(range, out)?;
    for (done, found) in (1..).zip(rows) {
        row(&found, out)?;
        progress.tell(done, points.into());
    }
    Ok(())
}

fn head(range: &Range, out: &mut impl Write) -> io::Result<()> {
    let filtered = if range.sensor_hz.is_some() { ",thd_acceleration_filtered_percent" } else { "" };
    writeln!(
        out,
        "d1,segments,thd_position_percent,thd_speed_percent,thd_acceleration_percent,euclidean_distance{filtered}"
    )
}

fn row(row: &Row, out: &mut impl Write) -> io::Result<()> {
    let distortion = row.distortion;
    let [position, speed, acceleration] =
        [distortion.position, distortion.speed, distortion.acceleration].map(|ratio| ratio * 100.0);
    write!(
        out,
        "{},{},{position:.6},{speed:.6},{acceleration:.6},{:.9}",
        row.d1, row.segments, row.euclidean
    )?;
    if let Some(filtered) = distortion.acceleration_filtered {
        write!(out, ",{:.6}", filtered * 100.0)?;
    }
    writeln!(out)
}

/// A row as JSON.
fn cells(row: &Row) -> Value {
    let distortion = row.distortion;
    json!({
        "d1": row.d1,
        "segments": row.segments,
        "thd_position_percent": 100.0 * distortion.position,
        "thd_speed_percent": 100.0 * distortion.speed,
        "thd_acceleration_percent": 100.0 * distortion.acceleration,
        "thd_acceleration_filtered_percent": distortion.acceleration_filtered.map(|ratio| 100.0 * ratio),
        "euclidean_distance": row.euclidean,
    })
}

fn vertices(segments: usize, freedom: Freedom, common: &Common, out: &mut impl Write) -> io::Result<()> {
    let found = optimum(segments, freedom, common.order)
        .ok_or_else(|| io::Error::other("no such number of segments"))?;
    let percent = found.distortion.position * 100.0;
    if common.json {
        let rows = found.vertices.iter().enumerate().map(|(index, vertex)| {
            let angle_deg = vertex.angle.to_degrees();
            json!({ "vertex": index, "angle_deg": angle_deg, "height": vertex.height, "thd_position_percent": percent })
        });
        return json_of("sine vertices", "vertices", rows).write(out);
    }
    writeln!(out, "vertex,angle_deg,height,thd_position_percent")?;
    for (index, vertex) in found.vertices.iter().enumerate() {
        writeln!(out, "{index},{:.9},{:.9},{percent:.6}", vertex.angle.to_degrees(), vertex.height)?;
    }
    Ok(())
}
