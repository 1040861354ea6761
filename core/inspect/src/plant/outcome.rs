//! Results of a plant as text and series, and the settling time of a motor's supply current (PLANT F8).

use alloc::string::{String, ToString};
use alloc::{format, vec, vec::Vec};
use core::fmt::Write as _;
use stepscope_peripheral::signal::{Levels, Record};
use stepscope_peripheral::units::Instant;
use stepscope_plant::measures::{MotorResult, Peak};
use stepscope_plant::settling::{REST_STEPS, SensorLog, StepResponse};
use stepscope_plant::{Plant, Refused, parameters::Setup};

/// Following error in full steps from which the verdict reports it.
const LARGE_ERROR: f64 = 2.0;

/// Half an electrical period in full steps; a rotor that moves farther in one grid step is not simulated correctly.
const HALF_PERIOD: f64 = 2.0;
const TURN_DEG: f64 = 360.0;

/// A warning if rotor or load moved more than half a period in one grid step, so that the result is meaningless.
pub fn too_coarse(setup: &Setup, channel: usize, found: &MotorResult) -> Option<String> {
    let motor = setup.motors.get(channel)?;
    let step_s = f64::from(setup.grid_cycles()) / f64::from(setup.clock_hz);
    let Peak { value: fastest, cycle } = found.max_speed;
    let (rotor, load) = (fastest * step_s, found.max_load_speed * step_s);
    let half_period = 0.5 * TURN_DEG / motor.full_step_deg / motor.sine_per_turn;
    let problem = if rotor > HALF_PERIOD {
        format!(
            "the rotor moves {rotor:.1} full steps per grid step, more than half an electrical period (2)"
        )
    } else if motor.sine_torque_mn_m != 0.0 && load > half_period {
        format!(
            "the load moves {load:.3} full steps per grid step, more than half a period of its position-dependent torque ({half_period:.3})"
        )
    } else {
        return None;
    };
    let ms = cycle as f64 / f64::from(setup.clock_hz) * 1e3;
    Some(format!(
        "{problem}, at {ms:.2} ms, so the result is meaningless; use a smaller step_cycles than {}",
        setup.grid_cycles()
    ))
}

/// Maximum share of unaccounted energy.
const MAX_ENERGY_ERROR: f64 = 1e-3;

/// A warning if more than 0.1 % of the energy is unaccounted for.
pub fn energy_left_over(found: &MotorResult) -> Option<String> {
    let error = found.energy.error();
    (error > MAX_ENERGY_ERROR).then(|| {
        format!("{:.2} % of the energy is unaccounted for; use a smaller step_cycles", 100.0 * error)
    })
}

/// Whether a motor follows, slips or loses steps, as text. After an overload no motor follows: the drivers are off.
pub fn verdict(motor: &MotorResult, clock_hz: u32, overload: Option<u64>) -> String {
    let lost = motor.lost.unsigned_abs();
    let ms = |cycle: u64| cycle as f64 / f64::from(clock_hz) * 1e3;
    let step = motor.steps_until_first_slip.unwrap_or(0);
    match motor.slips.first() {
        None if overload.is_some() => {
            format!("has no current from {:.2} ms on", ms(overload.unwrap_or_default()))
        }
        Some(slip) if lost == 0 => {
            format!("slips and recovers; first at {:.2} ms in step {step}", ms(slip.cycle))
        }
        Some(slip) => format!("loses {lost} full steps, first at {:.2} ms in step {step}", ms(slip.cycle)),
        None if motor.following_error.value.abs() >= LARGE_ERROR => {
            format!("follows, up to {:.2} full steps behind", motor.following_error.value.abs())
        }
        None => "follows".to_string(),
    }
}

/// Names with units, in the order of [`values`].
pub fn names(plant: &Plant) -> Vec<String> {
    let mut names: Vec<String> = ["bus_v", "load_a", "sensor_a", "sensor_code"].map(String::from).into();
    for channel in 0..plant.motors() {
        let of_motor = ["command", "rotor", "speed", "phase_a_a", "phase_b_a", "lost", "encoder"];
        names.extend(of_motor.map(|name| format!("{name}{channel}")));
    }
    names
}

/// The plant's values at its point, in V, A, codes, full steps and full steps/s.
pub fn values(plant: &Plant) -> Vec<f64> {
    let sensor = plant.current_sensor();
    let mut values = vec![plant.supply_v(), plant.supply_a(), sensor.filtered(), f64::from(sensor.code())];
    for channel in 0..plant.motors() {
        let Some(state) = plant.state(channel) else { continue };
        let (command, lost) = (plant.command(channel), plant.lost(channel) as f64);
        values.extend([command, state.x, state.w, state.i_a, state.i_b, lost, plant.encoder(channel).into()]);
    }
    values
}

/// The CSV header of [`table_row`].
pub fn table_head(plant: &Plant) -> String {
    format!("cycle,time_s,{}\n", names(plant).join(","))
}

/// The plant's values at its point as a CSV row.
pub fn table_row(plant: &Plant) -> String {
    let cycle = plant.cycle();
    let mut row = format!("{cycle},{}", cycle as f64 / plant.clock_hz());
    for value in values(plant) {
        // Writing to a string cannot fail.
        let _ = write!(row, ",{value}");
    }
    row.push('\n');
    row
}

/// A reading of the current sensor: cycles after STEP's rise, and A.
pub type CurrentAt = (f64, f64);

/// Settling of the supply current to `share` of its change after one step, following a rest of ten `t_step` cycles, and
/// the sensor's readings from `t_step` cycles before the step on. Fails with an empty list without such a channel.
pub fn settling(
    setup: &Setup,
    channel: usize,
    t_step: u64,
    share: f64,
) -> Result<(StepResponse, Vec<CurrentAt>), Vec<Refused>> {
    let mut plant = Plant::new(&setup.single_motor(channel).ok_or_else(Vec::new)?)?;
    let mut log = SensorLog::default();
    // As in the self-test: S = 1.
    let (from, rise) = (1, 1 + REST_STEPS * t_step);
    let levels = Levels(Levels::RESET.0 | 1 << Levels::DIR_SHIFT | 1);
    plant.record(Record { cycle: Instant(rise), levels }, &mut log);
    plant.advance(rise + t_step, &mut log);
    let response = StepResponse::of(&log.samples, from, rise, t_step, share).ok_or_else(Vec::new)?;
    let shown = log.samples.iter().skip_while(|sample| sample.cycle + t_step < rise);
    Ok((response, shown.map(|sample| (sample.cycle as f64 - rise as f64, sample.current)).collect()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::expect_used, reason = "a missing file or program fails the test")]

    use super::*;
    use stepscope_sim::{Experiment, plant_run::PlantRun};

    /// The warning on the grid of a run with this plant and motor.
    fn warned(plant: &str, motor: &str) -> Option<String> {
        let json = format!(
            r#"{{"plant":{plant},"source":{{"motion":{{"engine":"segments","axes":[{{"motor":{motor}}}]}}}}}}"#
        );
        let experiment = Experiment::from_json(&json).expect("no problem");
        let mut run = PlantRun::new(&experiment, vec![(Vec::new(), ())]).expect("a plant");
        run.finish();
        too_coarse(&experiment.plants().expect("a plant").setups[0], 0, &run.results()[0].motors[0])
    }

    #[test]
    fn a_finer_grid_removes_the_warning_on_fast_rotors() {
        let thrown = r#"{"sine_torque_mn_m":1000000,"sine_per_turn":1000}"#;
        let warning = warned("{}", thrown).expect("it is thrown");
        assert!(
            warning.starts_with("the rotor moves 15.3 full steps per grid step, more than half an"),
            "{warning}"
        );
        assert!(
            warning.ends_with("so the result is meaningless; use a smaller step_cycles than 80"),
            "{warning}"
        );
        assert_eq!(warned(r#"{"step_cycles":8}"#, thrown), None);
        // At about 1000 full steps/s half a period, 0.1 full steps, takes 0.1 ms; a grid step is 0.15 ms.
        let fine = r#"{"sine_torque_mn_m":0.001,"sine_per_turn":1000}"#;
        assert_eq!(warned("{}", fine), None);
        let warning = warned(r#"{"step_cycles":2000}"#, fine);
        assert!(warning.expect("too coarse").starts_with("the load moves 0.1"));
        assert_eq!(warned("{}", "{}"), None);
    }

    #[test]
    fn results_are_written_as_text() {
        use crate::plant::outcome::{settling, verdict};
        use stepscope_sim::{Experiment, plant_run::PlantRun};

        let experiment = Experiment::from_json(r#"{ "plant": {} }"#).expect("no problem");
        let mut run = PlantRun::new(&experiment, vec![(Vec::new(), ())]).expect("a plant");
        run.finish();
        let motor = &run.results()[0].motors[0];
        assert_eq!(verdict(motor, 16_000_000, None), "follows");
        assert_eq!(verdict(motor, 16_000_000, Some(12_000)), "has no current from 0.75 ms on");
        let setup = &experiment.plants().expect("a plant").setups[0];
        assert!(settling(setup, 0, 32_768, 0.2).expect("it is made").0.rest_a > 0.0);
    }
}
