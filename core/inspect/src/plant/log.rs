//! A plant's run as minimum and maximum per interval. Shorter windows are computed again from snapshots of the plant,
//! bit for bit.
//!
//! ```text
//! points   . . . . . . . . . . . . . . . .     one per grid step, up to 10^8
//! bins     [   ][   ][   ][   ][   ][         minimum and maximum of several points; merged in pairs if there are too many
//! snapshots  ^                 ^              the plant, and its number of processed records
//! ```

use alloc::{vec, vec::Vec};
use stepscope_peripheral::signal::Record;
use stepscope_plant::{Observer, Plant};

/// Values of the whole plant: bus voltage in V, supply current and its sensor's reading in A.
pub const SUPPLY: [&str; 3] = ["bus_v", "load_a", "sensor_a"];
/// Values of each motor: full steps, full steps/s, phase currents in A, encoder code.
pub const MOTOR: [&str; 7] = ["command", "rotor", "error", "speed", "phase_a_a", "phase_b_a", "encoder"];

const BINS: usize = 8192;
/// Minimum bins of a window; with fewer, its points are computed again.
const MIN_BINS: u64 = 512;
const MAX_SNAPSHOTS: usize = 64;
const POINTS_PER_COLUMN: u64 = 2;

/// Simulated points of a plant, compressed to minima and maxima per bin.
#[derive(Clone, Debug)]
pub struct PlantLog {
    step_cycles: u64,
    points_per_bin: u64,
    points_in_last_bin: u64,
    min: Vec<f64>,
    max: Vec<f64>,
    latest: Vec<f64>,
    snapshots: Vec<Snapshot>,
    min_spacing: u64,
}

#[derive(Clone, Debug)]
struct Snapshot {
    plant: Plant,
    records: usize,
}

/// A range of cycles, divided into pixel columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CycleWindow {
    pub from: u64,
    pub to: u64,
    pub columns: usize,
}

/// Minimum and maximum of a quantity over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Cycles of points, or of the middles of intervals.
    pub cycle: Vec<f64>,
    pub min: Vec<f64>,
    pub max: Vec<f64>,
}

impl Observer for PlantLog {
    #[inline]
    fn point(&mut self, plant: &Plant) {
        read(plant, &mut self.latest);
        if self.points_in_last_bin == self.points_per_bin || self.min.is_empty() {
            if self.min.len() == BINS * self.values() {
                self.merge_bins();
            }
            self.points_in_last_bin = 0;
            self.min.extend_from_slice(&self.latest);
            self.max.extend_from_slice(&self.latest);
        } else {
            let last = self.min.len() - self.latest.len();
            let bins = self.min[last..].iter_mut().zip(&mut self.max[last..]);
            for ((min, max), &value) in bins.zip(&self.latest) {
                *min = min.min(value);
                *max = max.max(value);
            }
        }
        self.points_in_last_bin += 1;
    }
}

fn read(plant: &Plant, values: &mut [f64]) {
    let (supply, motors) = values.split_at_mut(SUPPLY.len());
    supply.copy_from_slice(&[plant.supply_v(), plant.supply_a(), plant.current_sensor().filtered()]);
    for (channel, values) in motors.chunks_exact_mut(MOTOR.len()).enumerate() {
        let Some(state) = plant.state(channel) else { continue };
        let (command, code) = (plant.command(channel), f64::from(plant.encoder(channel)));
        values.copy_from_slice(&[command, state.x, command - state.x, state.w, state.i_a, state.i_b, code]);
    }
}

impl PlantLog {
    /// An empty log of a plant that has not run yet.
    pub fn new(plant: &Plant) -> Self {
        Self {
            step_cycles: plant.step_cycles(),
            points_per_bin: 1,
            points_in_last_bin: 0,
            min: Vec::new(),
            max: Vec::new(),
            latest: vec![0.0; SUPPLY.len() + plant.motors() * MOTOR.len()],
            snapshots: vec![Snapshot { plant: plant.clone(), records: 0 }],
            min_spacing: 1,
        }
    }

    /// Takes a snapshot of a plant that has processed the first `records` records; between slices of a run only.
    pub fn snapshot(&mut self, plant: &Plant, records: usize) {
        let step = plant.step_cycles();
        let last = self.snapshots.last().map_or(0, |snapshot| snapshot.plant.cycle());
        if plant.cycle() >= last + self.min_spacing * step {
            self.snapshots.push(Snapshot { plant: plant.clone(), records });
        }
        if self.snapshots.len() > MAX_SNAPSHOTS {
            let mut index = 0;
            self.snapshots.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.min_spacing = (plant.cycle() / step / MAX_SNAPSHOTS as u64).max(1) * 2;
        }
    }

    /// Index of the first value of a motor, in the order of [`MOTOR`].
    pub const fn motor_index(channel: usize) -> usize {
        SUPPLY.len() + channel * MOTOR.len()
    }

    const fn values(&self) -> usize {
        self.latest.len()
    }

    fn merge_bins(&mut self) {
        let values = self.values();
        for (bins, take) in [(&mut self.min, f64::min as fn(f64, f64) -> f64), (&mut self.max, f64::max)] {
            for at in 0..BINS / 2 * values {
                let (bin, value) = (at / values, at % values);
                bins[at] = take(bins[2 * bin * values + value], bins[(2 * bin + 1) * values + value]);
            }
            bins.truncate(BINS / 2 * values);
        }
        self.points_per_bin *= 2;
    }

    /// Values by index over a window: at most two points per column, and one more at each end.
    pub fn curves(&self, records: &[Record], window: CycleWindow, values: &[usize]) -> Vec<Band> {
        let mut bands = vec![Band::default(); values.len()];
        if self.min.is_empty() || window.to < window.from {
            return bands;
        }
        let bin_cycles = self.points_per_bin * self.step_cycles;
        let points = (window.to - window.from) / self.step_cycles;
        let few = POINTS_PER_COLUMN * window.columns.max(1) as u64;
        if self.points_per_bin > 1 && points / self.points_per_bin >= MIN_BINS {
            let bins = self.min.len() / self.values();
            // A bin ends with the point in the cycle of its edge.
            let (first, last) = (window.from.saturating_sub(1) / bin_cycles, window.to / bin_cycles + 1);
            let mut columns = Columns::new(&mut bands, (last - first).div_ceil(few));
            for bin in first as usize..(last as usize).min(bins) {
                // The first bin begins with the point after cycle 0.
                let cycle = (bin as f64 + 0.5) * bin_cycles as f64;
                let row = bin * self.values();
                columns
                    .add(cycle, values.iter().map(|&value| (self.min[row + value], self.max[row + value])));
            }
            return bands;
        }
        let mut columns = Columns::new(&mut bands, points.div_ceil(few));
        let mut watched = Watched {
            from: window.from.saturating_sub(self.step_cycles),
            values,
            columns: &mut columns,
            point: self.latest.clone(),
        };
        self.replay(records, window.from, window.to.saturating_add(self.step_cycles), &mut watched);
        bands
    }

    pub fn at(&self, records: &[Record], cycle: u64) -> Vec<f64> {
        let mut values = vec![0.0; self.values()];
        if let Some(plant) = self.replay(records, cycle, cycle, &mut ()) {
            read(&plant, &mut values);
        }
        values
    }

    /// Runs the plant again from the last snapshot before `from`, up to `to`.
    fn replay(&self, records: &[Record], from: u64, to: u64, observer: &mut dyn Observer) -> Option<Plant> {
        // A snapshot is taken after its point.
        let before = from.saturating_sub(2 * self.step_cycles);
        let snapshot = self
            .snapshots
            .iter()
            .rev()
            .find(|snapshot| snapshot.plant.cycle() <= before)
            .or(self.snapshots.first())?;
        let mut plant = snapshot.plant.clone();
        for &record in records.iter().skip(snapshot.records).take_while(|record| record.cycle.0 <= to) {
            plant.record(record, observer);
        }
        plant.advance(to, observer);
        Some(plant)
    }
}

struct Columns<'a> {
    bands: &'a mut [Band],
    per_column: u64,
    in_last: u64,
    first: f64,
}

impl<'a> Columns<'a> {
    fn new(bands: &'a mut [Band], per_column: u64) -> Self {
        Self { bands, per_column: per_column.max(1), in_last: 0, first: 0.0 }
    }

    fn add(&mut self, cycle: f64, values: impl Iterator<Item = (f64, f64)>) {
        let is_new = self.in_last == 0;
        if is_new {
            self.first = cycle;
        }
        for (band, (low, high)) in self.bands.iter_mut().zip(values) {
            match (band.min.last_mut(), band.max.last_mut(), band.cycle.last_mut()) {
                (Some(min), Some(max), Some(middle)) if !is_new => {
                    *min = min.min(low);
                    *max = max.max(high);
                    *middle = 0.5 * (self.first + cycle);
                }
                _ => {
                    band.min.push(low);
                    band.max.push(high);
                    band.cycle.push(cycle);
                }
            }
        }
        self.in_last = (self.in_last + 1) % self.per_column;
    }
}

struct Watched<'a, 'b> {
    from: u64,
    values: &'a [usize],
    columns: &'a mut Columns<'b>,
    point: Vec<f64>,
}

impl Observer for Watched<'_, '_> {
    fn point(&mut self, plant: &Plant) {
        if plant.cycle() < self.from {
            return;
        }
        read(plant, &mut self.point);
        let point = &self.point;
        self.columns.add(plant.cycle() as f64, self.values.iter().map(|&value| (point[value], point[value])));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::StoredRun;
    use stepscope_peripheral::units::Instant;
    use stepscope_sim::{Experiment, RunLimits};

    #[test]
    fn curves_end_at_the_final_position() {
        let experiment = Experiment::from_json(r#"{ "plant": {} }"#).expect("it is valid");
        let mut run = experiment.start();
        let mut recording = StoredRun::default();
        let mut log = PlantLog::new(run.plant(0).expect("it has one"));
        while !run.advance_observed(
            RunLimits { cycle: Instant(run.cycles().0 + 100_000), ..RunLimits::default() },
            &mut [&mut recording],
            &mut [&mut log],
        ) {
            log.snapshot(run.plant(0).expect("it has one"), recording.trace.len());
        }
        let (rotor, end) = (PlantLog::motor_index(0) + 1, run.cycles().0);
        let window = CycleWindow { from: 0, to: end, columns: 600 };
        let curves = log.curves(&recording.trace, window, &[rotor]);
        assert!((curves[0].max.last().expect("columns") - 200.0).abs() < 0.1);
        assert!((log.at(&recording.trace, end)[rotor] - 200.0).abs() < 0.1);
    }
}
