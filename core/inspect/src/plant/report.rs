//! The results of a run's plant, for the command and the page.

use crate::plant::outcome::{energy_left_over, too_coarse, verdict};
use alloc::{format, string::String, vec::Vec};
use serde::Serialize;
use stepscope_plant::measures::{MotorResult, Peak, PlantResult};
use stepscope_plant::parameters::Setup;
use stepscope_sim::{Experiment, Run};

/// Results of a plant as tables.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlantReport {
    pub plant: PlantSummary,
    pub motors: Vec<Motor>,
    pub slips: Vec<Slip>,
    pub self_test: Vec<SelfTest>,
}

/// Results of the supply and its sensor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlantSummary {
    pub controller: usize,
    pub digest: String,
    pub cycle: u64,
    pub load_least_a: f64,
    pub load_greatest_a: f64,
    pub load_rms_a: f64,
    /// Maximum change of the sensor's reading, if enough steps were made.
    pub deviation_above_a: Option<f64>,
    pub deviation_below_a: Option<f64>,
    pub bus_least_v: f64,
    pub bus_greatest_v: f64,
    pub collapsed_at_s: Option<f64>,
    pub overload_cycle: Option<u64>,
}

/// Results of one motor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Motor {
    pub channel: usize,
    pub verdict: String,
    pub command_full_steps: f64,
    pub rotor_full_steps: f64,
    pub lost_full_steps: i64,
    pub slips: u64,
    pub following_error_full_steps: f64,
    pub following_error_at_s: f64,
    pub overshoot_full_steps: Option<f64>,
    pub settling_s: Option<f64>,
    pub phase_peak_a: f64,
    pub phase_rms_a: f64,
    pub bus_j: f64,
    pub copper_j: f64,
    pub friction_j: f64,
    pub viscous_j: f64,
    pub diodes_j: f64,
    pub load_j: f64,
    pub stored_j: f64,
    /// Unaccounted energy, in parts of the total.
    pub energy_error: f64,
    pub fastest_full_steps_s: f64,
    pub grid_too_coarse: Option<String>,
    pub energy_left_over: Option<String>,
}

/// A slip by four full steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Slip {
    pub channel: usize,
    pub cycle: u64,
    pub behind: bool,
}

/// The settling time that the self-test measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SelfTest {
    pub channel: usize,
    pub settling_cycles: Option<u64>,
}

impl PlantReport {
    /// `None` if the controller has no plant.
    pub fn of(experiment: &Experiment, run: &Run, controller: usize) -> Option<Self> {
        let setup = experiment.plants()?.setups.get(controller)?;
        let clock_hz = f64::from(setup.clock_hz);
        let result = run.results().into_iter().nth(controller)?;
        let overload = run.overload(controller);
        let found = run.self_test(controller).iter().enumerate();
        let motors = result.motors.iter().enumerate();
        Some(Self {
            plant: summary_of(&result, controller, clock_hz, overload),
            motors: motors
                .clone()
                .map(|(channel, motor)| motor_of(channel, motor, setup, overload))
                .collect(),
            slips: motors
                .flat_map(|(channel, motor)| {
                    motor.slips.iter().map(move |slip| Slip {
                        channel,
                        cycle: slip.cycle,
                        behind: slip.is_behind,
                    })
                })
                .collect(),
            self_test: found
                .map(|(channel, &settling_cycles)| SelfTest { channel, settling_cycles })
                .collect(),
        })
    }
}

fn summary_of(
    result: &PlantResult,
    controller: usize,
    clock_hz: f64,
    overload_cycle: Option<u64>,
) -> PlantSummary {
    let (current, voltage) = (&result.supply_a, &result.supply_v);
    PlantSummary {
        controller,
        digest: format!("{:016x}", result.digest),
        cycle: result.cycle,
        load_least_a: current.min,
        load_greatest_a: current.max,
        load_rms_a: current.rms(),
        deviation_above_a: result.deviation.map(|found| found.above_a),
        deviation_below_a: result.deviation.map(|found| found.below_a),
        bus_least_v: voltage.min,
        bus_greatest_v: voltage.max,
        collapsed_at_s: result.collapsed.map(|cycle| cycle as f64 / clock_hz),
        overload_cycle,
    }
}

fn motor_of(channel: usize, motor: &MotorResult, setup: &Setup, overload: Option<u64>) -> Motor {
    let clock_hz = f64::from(setup.clock_hz);
    let Peak { value: error, cycle: at } = motor.following_error;
    let energy = &motor.energy;
    Motor {
        channel,
        verdict: verdict(motor, setup.clock_hz, overload),
        command_full_steps: motor.command,
        rotor_full_steps: motor.state.x,
        lost_full_steps: motor.lost,
        slips: motor.slip_count,
        following_error_full_steps: error,
        following_error_at_s: at as f64 / clock_hz,
        overshoot_full_steps: motor.overshoot,
        settling_s: motor.settling.map(|cycles| cycles as f64 / clock_hz),
        phase_peak_a: motor.phase_peak_a,
        phase_rms_a: motor.phase_rms_a,
        bus_j: energy.bus,
        copper_j: energy.copper,
        friction_j: energy.friction,
        viscous_j: energy.viscous,
        diodes_j: energy.diodes,
        load_j: energy.load,
        stored_j: energy.stored,
        energy_error: energy.error(),
        fastest_full_steps_s: motor.max_speed.value,
        grid_too_coarse: too_coarse(setup, channel, motor),
        energy_left_over: energy_left_over(motor),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use stepscope_sim::plant_run::PlantRun;

    #[test]
    fn a_motor_that_follows_loses_no_steps() {
        let experiment = Experiment::from_json(r#"{ "plant": {} }"#).expect("it is valid");
        let mut run = PlantRun::new(&experiment, vec![(Vec::new(), ())]).expect("it has a plant");
        run.finish();
        let report = PlantReport::of(&experiment, &run, 0).expect("the controller has a plant");
        let motor = &report.motors[0];
        assert_eq!((motor.verdict.as_str(), motor.lost_full_steps, motor.slips), ("follows", 0, 0));
        assert_eq!(PlantReport::of(&experiment, &run, 1), None);
    }
}
