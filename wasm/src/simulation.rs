//! A run in the worker: made in slices, kept for the views' questions.

use crate::convert::{field, numbers, object, words};
use js_sys::{Int32Array, Object};
use serde::Serialize;
use stepscope_core::{
    analysis::{
        curves::{self, Window},
        timing::TimingCheck,
    },
    run::{Experiment, Run},
    scenario::Scenario,
    signal::{Levels, Record},
    trace::{Recording, Step, Verdict, columns, steps},
    wire::packet::Order,
};
use wasm_bindgen::prelude::*;

/// Most records that a page keeps; 16 bytes each.
const MOST_RECORDS: usize = 40_000_000;

/// One scenario's run.
#[wasm_bindgen]
pub struct Simulation {
    pub(crate) scenario: Scenario,
    pub(crate) experiment: Experiment,
    run: Run,
    recording: Recording,
    /// The pulses against the scenario's driver, if it names one.
    pub(crate) timing: Option<TimingCheck>,
    /// Steps of each channel, as far as they were asked for after the end.
    steps: Vec<Option<Vec<Step>>>,
}

#[derive(Serialize)]
struct Progress {
    done: bool,
    cycle: u64,
    end_cycle: u64,
    records: u64,
}

#[derive(Serialize)]
struct Row {
    index: usize,
    start_cycle: u64,
    end_cycle: u64,
    hex: String,
    fields: String,
    outcome: String,
    tick_start_cycle: Option<u64>,
    tick_end_cycle: Option<u64>,
}

#[derive(Serialize)]
struct Rows {
    total: usize,
    rows: Vec<Row>,
}

#[wasm_bindgen]
impl Simulation {
    /// Prepares a run.
    ///
    /// # Errors
    /// If the scenario has problems; `check` lists them.
    #[wasm_bindgen(constructor)]
    pub fn new(json: &str) -> Result<Simulation, JsError> {
        let listed = |problems: Vec<_>| {
            let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
            JsError::new(&lines.join("\n"))
        };
        let scenario = Scenario::from_json(json).map_err(listed)?;
        let experiment = Experiment::new(&scenario).map_err(listed)?;
        let run = experiment.start();
        let steps = vec![None; usize::from(experiment.config().channels())];
        let timing = crate::timing::check(&scenario);
        Ok(Self { scenario, experiment, run, recording: Recording::default(), timing, steps })
    }

    /// Runs on for about `max_records` records: `{done, cycle, end_cycle, records}`.
    ///
    /// # Errors
    /// If the run makes more records than a page can keep.
    pub fn advance(&mut self, max_records: u32) -> Result<JsValue, JsError> {
        let mut sink = (&mut self.recording, self.timing.as_mut());
        let done = self.run.advance(u64::from(max_records.max(1)), &mut sink);
        if self.recording.trace.len() > MOST_RECORDS {
            return Err(JsError::new(&format!(
                "the run makes more than {MOST_RECORDS} edges, which is more than a page can keep; shorten the motion, or run it with the stepscope command"
            )));
        }
        if done {
            self.recording.packets.finish();
        }
        let cycle = self.run.cycles().0;
        object(&Progress {
            done,
            cycle,
            end_cycle: if done { cycle } else { self.experiment.cost().end_cycle.max(cycle) },
            records: self.recording.digest.records(),
        })
    }

    /// The result: digest, counts, positions, faults.
    ///
    /// # Errors
    /// Never in practice.
    pub fn summary(&self) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Faults {
            bits: u16,
            names: Vec<&'static str>,
        }
        #[derive(Serialize)]
        struct Summary {
            digest: String,
            records: u64,
            edges: u64,
            end_cycle: u64,
            end_s: f64,
            clock_hz: u32,
            channels: u8,
            faults: Faults,
            ticks_done: u32,
            /// Bits of the signals that change at all.
            changing: Vec<u8>,
        }
        let faults = self.run.faults();
        let config = self.experiment.config();
        let summary = object(&Summary {
            digest: format!("{:016x}", self.recording.digest.value()),
            records: self.recording.digest.records(),
            edges: edges(&self.recording.trace),
            end_cycle: self.run.cycles().0,
            end_s: self.run.cycles().0 as f64 / f64::from(config.clock_hz()),
            clock_hz: config.clock_hz(),
            channels: config.channels(),
            faults: Faults { bits: faults.bits(), names: faults.names().collect() },
            ticks_done: self.run.ticks_done(),
            changing: changing(&self.recording.trace),
        })?;
        let positions = self.run.positions();
        let used = positions.get(..usize::from(config.channels())).unwrap_or_default();
        field(summary.unchecked_ref(), "positions", &Int32Array::from(used));
        Ok(summary)
    }

    /// Position, speed and acceleration of an axis over a stretch of time, in columns.
    #[must_use]
    pub fn motion(&mut self, axis: u8, t0_s: f64, t1_s: f64, columns: u32) -> Object {
        let window = Window { start_s: t0_s, end_s: t1_s, columns: columns.clamp(1, 10_000) as usize };
        let clock_hz = self.experiment.config().clock_hz();
        let result = Object::new();
        let centres: Vec<f64> = (0..window.columns).map(|column| window.centre_s(column)).collect();
        numbers(&result, "x", &centres);
        let plan = self.experiment.plans().get(usize::from(axis));
        field(&result, "has_ideal", &plan.is_some().into());
        if let Some(plan) = plan {
            let zero_s = self.recording.first_tick().map_or(0.0, |start| start.seconds(clock_hz));
            let ideal = curves::ideal(plan, zero_s, window);
            for (name, band) in
                [("position", ideal.position), ("speed", ideal.speed), ("acceleration", ideal.acceleration)]
            {
                numbers(&result, &format!("{name}_min"), &band.min);
                numbers(&result, &format!("{name}_max"), &band.max);
            }
        }
        self.count_steps(axis);
        let steps = self.steps.get(usize::from(axis)).and_then(Option::as_deref).unwrap_or_default();
        let made = curves::made(&self.recording, steps, axis, self.experiment.config(), window);
        for (name, band) in [("made_position", made.position), ("made_speed", made.speed)] {
            numbers(&result, &format!("{name}_min"), &band.min);
            numbers(&result, &format!("{name}_max"), &band.max);
        }
        result
    }

    /// The signals over a stretch of cycles, in columns: `{high, low, last}`, two words a column.
    #[must_use]
    pub fn pulses(&self, start_cycle: f64, end_cycle: f64, columns_asked: u32) -> Object {
        let count = columns_asked.clamp(1, 10_000) as usize;
        let found =
            columns(&self.recording.trace, start_cycle.max(0.0) as u64, end_cycle.max(1.0) as u64, count);
        let result = Object::new();
        words(&result, "high", &found.high);
        words(&result, "low", &found.low);
        words(&result, "last", &found.last);
        result
    }

    /// Cycle of the next edge of signal `bit` after (or the last before) `cycle`; kind is `any`,
    /// `rise` or `fall`.
    #[must_use]
    pub fn next_edge(&self, bit: u8, cycle: f64, forward: bool, kind: &str) -> Option<f64> {
        let mask = 1_u64 << bit.min(63);
        let trace = &self.recording.trace;
        let is_edge = |index: usize| {
            let now = trace.get(index).map_or(Levels(0), |record| record.levels).has(mask);
            let before = trace.get(index - 1).map_or(Levels(0), |record| record.levels).has(mask);
            now != before && (kind == "any" || (kind == "rise") == now)
        };
        let at = cycle.max(0.0) as u64;
        let found = if forward {
            let first = trace.partition_point(|record| record.cycle.0 <= at).max(1);
            (first..trace.len()).find(|&index| is_edge(index))
        } else {
            let after = trace.partition_point(|record| record.cycle.0 < at);
            (1..after).rev().find(|&index| is_edge(index))
        };
        found.and_then(|index| trace.get(index)).map(|record| record.cycle.0 as f64)
    }

    /// Rows `from..from + count` of the packets: `{total, rows}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packets(&self, from: u32, count: u32) -> Result<JsValue, JsError> {
        let rows = (from as usize..).take(count as usize).map_while(|index| self.row(index));
        object(&Rows { total: self.recording.packets.rows().len(), rows: rows.collect() })
    }

    /// The first `limit` packets whose time on the line or in the sequencer touches a stretch of cycles:
    /// `{rows, more}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packets_in(&self, start_cycle: f64, end_cycle: f64, limit: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Touching {
            rows: Vec<Row>,
            more: bool,
        }
        let (start, end) = (start_cycle.max(0.0) as u64, end_cycle.max(0.0) as u64);
        let all = self.recording.packets.rows();
        let until = all.partition_point(|row| row.start.0 <= end);
        // No search for the first: a packet that waits in the queue ends after a later one that was dropped.
        let mut touching = (0..until).filter(|&index| {
            all.get(index).is_some_and(|row| row.end.max(row.tick_end.unwrap_or(row.end)).0 >= start)
        });
        let rows = touching.by_ref().take(limit as usize).filter_map(|index| self.row(index)).collect();
        object(&Touching { rows, more: touching.next().is_some() })
    }

    /// Spectra of the ideal motion and of the pulses, for the axis that the scenario's analysis
    /// names.
    ///
    /// # Errors
    /// Never in practice.
    pub fn spectrum(&mut self) -> Result<JsValue, JsError> {
        let axis = self.scenario.analysis.axis;
        self.count_steps(axis);
        let steps = self.steps.get(usize::from(axis)).and_then(Option::as_deref).unwrap_or_default();
        crate::spectrum::spectrum(&self.scenario, &self.experiment, &self.recording, steps)
    }

    fn count_steps(&mut self, channel: u8) {
        if let Some(place) = self.steps.get_mut(usize::from(channel))
            && place.is_none()
        {
            *place = Some(steps(&self.recording.trace, channel));
        }
    }

    /// A packet as the page shows it.
    fn row(&self, index: usize) -> Option<Row> {
        let row = self.recording.packets.rows().get(index)?;
        let bytes = self.recording.packets.bytes(index);
        let hex: Vec<String> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Some(Row {
            index,
            start_cycle: row.start.0,
            end_cycle: row.end.0,
            hex: hex.join(" "),
            fields: self.fields(bytes, row.verdict),
            outcome: row.verdict.to_string(),
            tick_start_cycle: row.tick_start.map(|at| at.0),
            tick_end_cycle: row.tick_end.map(|at| at.0),
        })
    }

    /// A packet's bytes in words.
    fn fields(&self, bytes: &[u8], verdict: Verdict) -> String {
        if !matches!(verdict, Verdict::Packet(_)) {
            return String::new();
        }
        let mut words = Vec::new();
        let mut orders = bytes;
        if self.experiment.config().address().is_some()
            && let Some((address, rest)) = bytes.split_first()
        {
            words.push(if *address == 255 { "to all".to_owned() } else { format!("to {address}") });
            orders = rest;
        }
        for (channel, byte) in orders.iter().enumerate() {
            let Order { right, steps } = Order::parse(*byte);
            if steps > 0 {
                words.push(format!("ch{channel} {}{steps}", if right { '+' } else { '\u{2212}' }));
            }
        }
        if words.is_empty() { "no steps".to_owned() } else { words.join(", ") }
    }
}

/// Changes of single signals in a trace.
fn edges(trace: &[Record]) -> u64 {
    trace
        .windows(2)
        .map(|pair| match pair {
            [a, b] => u64::from((a.levels.0 ^ b.levels.0).count_ones()),
            _ => 0,
        })
        .sum()
}

/// Bits of the signals that are not the same in all records.
fn changing(trace: &[Record]) -> Vec<u8> {
    let first = trace.first().map_or(0, |record| record.levels.0);
    let mask = trace.iter().fold(0, |mask, record| mask | (record.levels.0 ^ first));
    (0..64).filter(|bit| mask >> bit & 1 == 1).collect()
}
