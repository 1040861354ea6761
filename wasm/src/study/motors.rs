//! Limits of the motors of a plant, searched in pieces by several workers; and lists of motors and drivers.

use crate::convert::{field, numbers, object};
use crate::scenario::{ValidatedScenario, listed};
use js_sys::Object;
use serde::Serialize;
use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{
    inspect::{
        motion::torque::{Machine, TorqueCurve},
        plant::{
            log::{CycleWindow, PlantLog},
            motors::{DRIVES, MOTORS},
            outcome::settling,
            report::PlantReport,
        },
        trace::stored_run::{RECORDS_PER_CHECK, check_records},
    },
    plant::{
        Refused,
        parameters::Setup,
        rates::{pulls, resonance, search, starts},
        settling::SHARE,
    },
    scenario::{Scenario, to_json},
    sim::RunLimits,
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Sheet {
    id: &'static str,
    name: &'static str,
    source: &'static str,
    typical: &'static [&'static str],
}

#[derive(Serialize)]
struct Sheets {
    motors: Vec<Sheet>,
    drives: Vec<Sheet>,
}

/// Listed motors and drivers.
#[wasm_bindgen]
pub fn sheets() -> Result<JsValue, JsError> {
    let motors =
        MOTORS.iter().map(|&m| Sheet { id: m.id, name: m.name, source: m.source, typical: m.typical });
    let drives =
        DRIVES.iter().map(|d| Sheet { id: d.id, name: d.name, source: d.source, typical: d.typical });
    object(&Sheets { motors: motors.collect(), drives: drives.collect() })
}

/// The scenario with a plant and a listed motor and driver. Unknown names change nothing.
#[wasm_bindgen]
pub fn with_motor(json: &str, motor: &str, drive: &str) -> String {
    let (mut scenario, _) = Scenario::from_json_lenient(json);
    scenario.plant.get_or_insert_default();
    if let Some(sheet) = stepscope_core::inspect::plant::motors::motor(motor) {
        sheet.apply_to(&mut scenario);
    }
    if let Some(sheet) = stepscope_core::inspect::plant::motors::drive(drive) {
        sheet.apply_to(&mut scenario);
    }
    to_json(&scenario)
}

#[wasm_bindgen]
impl ValidatedScenario {
    /// Start-stop rate of a motor in steps/s, for one turn; undefined below 500.
    /// Errors: if the scenario has problems, or no such motor.
    pub fn start_stop(&self, controller: usize, channel: usize) -> Result<Option<f64>, JsError> {
        let setup = self.motor(controller, channel)?;
        let steps = setup.motors[0].steps_per_turn();
        search(|rate| starts(&setup, rate, steps)).map_err(refused)
    }

    /// Pull-out rate in steps/s with a ramp of `ramp` steps/s^2.
    /// Errors: if the scenario has problems, or no such motor.
    pub fn pull_out(&self, controller: usize, channel: usize, ramp: f64) -> Result<Option<f64>, JsError> {
        let setup = self.motor(controller, channel)?;
        search(|rate| pulls(&setup, rate, ramp)).map_err(refused)
    }

    /// Available and needed torque at each rate up to `most` steps/s, in mN*m: `{rate, available, needed}`; `needed` is empty
    /// without a plan. Errors: if the scenario has problems, or no such motor.
    pub fn torque_of_motor(&self, controller: usize, channel: usize, most: f64) -> Result<Object, JsError> {
        let setup = self.motor(controller, channel)?;
        let experiment = self.0.experiment().map_err(listed)?;
        let plan = experiment.plans_of(controller).get(channel);
        let machine = Machine::of_plant(&setup.motors[0], setup.supply.supply_v);
        let curve = TorqueCurve::up_to(&machine, plan, most.max(1.0));
        let result = Object::new();
        numbers(&result, "rate", &curve.rate);
        numbers(&result, "available", &curve.available);
        numbers(&result, "needed", &curve.needed);
        Ok(result)
    }

    /// Oscillation at each rate in full steps/s: `{oscillation, loses}`; `loses` is 1 if it loses steps.
    /// Errors: if the scenario has problems, or no such motor.
    pub fn resonance(
        &self,
        controller: usize,
        channel: usize,
        from: f64,
        step: f64,
        count: u32,
    ) -> Result<Object, JsError> {
        let setup = self.motor(controller, channel)?;
        let microsteps = f64::from(setup.motors[0].microsteps);
        let rates = (0..count).map(|index| (from + f64::from(index) * step) * microsteps);
        let found: Vec<_> =
            rates.map(|rate| resonance(&setup, rate)).collect::<Result<_, _>>().map_err(refused)?;
        let result = Object::new();
        numbers(&result, "oscillation", &found.iter().map(|rate| rate.peak_to_peak).collect::<Vec<_>>());
        numbers(
            &result,
            "loses",
            &found.iter().map(|rate| f64::from(u8::from(rate.loses_steps))).collect::<Vec<_>>(),
        );
        Ok(result)
    }

    /// The supply current around one step (RU 2704486, figure 1), for a slot of the bus or 2 ms:
    /// `{rest_a, least_a, greatest_a, reached_cycles, settled_cycles, slot_cycles, x, y}`, x in s after the step.
    /// Errors: if the scenario has problems, or no such motor.
    pub fn settling(&self, controller: usize, channel: usize) -> Result<Object, JsError> {
        let setup = self.motor(controller, channel)?;
        let experiment = self.0.experiment().map_err(listed)?;
        let config = crate::scenario::config(experiment, controller);
        let slot = (config.tick().0 / u64::from(config.slots())).max(u64::from(config.clock_hz()) / 500);
        let (found, samples) = settling(&setup, 0, slot, SHARE).map_err(refused)?;
        let hz = f64::from(config.clock_hz());
        let result = Object::new();
        let cycles = |cycles: Option<u64>| cycles.map(|cycles| cycles as f64);
        for (name, value) in [
            ("rest_a", Some(found.rest_a)),
            ("least_a", Some(found.min_a)),
            ("greatest_a", Some(found.max_a)),
            ("reached_cycles", cycles(found.reached)),
            ("settled_cycles", cycles(found.settled)),
            ("slot_cycles", Some(slot as f64)),
        ] {
            field(&result, name, &value.map_or(JsValue::NULL, JsValue::from));
        }
        numbers(&result, "x", &samples.iter().map(|(cycle, _)| cycle / hz).collect::<Vec<_>>());
        numbers(&result, "y", &samples.iter().map(|(_, current)| *current).collect::<Vec<_>>());
        Ok(result)
    }

    /// The measured supply current of a run (RU 2704486, figure 2): `{x, min, max, above_a, below_a}`, x in s; the deviations
    /// are null with too few steps. Errors: if the scenario has problems, or no plant.
    pub fn supply_current(&self, controller: usize, columns: usize) -> Result<Object, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        let mut run = experiment.start();
        let mut logs = Vec::new();
        while let Some(plant) = run.plant(logs.len()) {
            logs.push(PlantLog::new(plant));
        }
        let mut recordings: Vec<StoredRun> = logs.iter().map(|_| StoredRun::default()).collect();
        let limits = RunLimits { records: RECORDS_PER_CHECK, ..RunLimits::default() };
        while !run.advance_observed(limits, &mut recordings, &mut logs) {
            check_records(&recordings).map_err(|error| JsError::new(&error.to_string()))?;
        }
        let (Some(log), Some(report), Some(recording)) =
            (logs.get(controller), PlantReport::of(experiment, &run, controller), recordings.get(controller))
        else {
            return Err(JsError::new("the scenario has no motors; add them under Motors and supply"));
        };
        let hz = f64::from(experiment.config().clock_hz());
        let window = CycleWindow { from: 0, to: run.cycles().0, columns };
        let result = Object::new();
        // Value 2 of the supply is the sensor.
        for band in log.curves(&recording.trace, window, &[2]) {
            numbers(&result, "x", &band.cycle.iter().map(|cycle| cycle / hz).collect::<Vec<_>>());
            numbers(&result, "min", &band.min);
            numbers(&result, "max", &band.max);
        }
        for (name, value) in
            [("above_a", report.plant.deviation_above_a), ("below_a", report.plant.deviation_below_a)]
        {
            field(&result, name, &value.map_or(JsValue::NULL, JsValue::from));
        }
        Ok(result)
    }
}

impl ValidatedScenario {
    fn motor(&self, controller: usize, channel: usize) -> Result<Setup, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        let setup =
            experiment.plants().and_then(|plants| plants.setups.get(controller)?.single_motor(channel));
        setup.ok_or_else(|| JsError::new("this channel has no motor; select another channel"))
    }
}

fn refused(all: Vec<Refused>) -> JsError {
    JsError::new(&all.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
}
