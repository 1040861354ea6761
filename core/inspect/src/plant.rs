//! What a plant did, in words and as series, and the settling time of a motor's supply current (PLANT F8).
//!
//! ```
//! use stepscope_inspect::plant::{settling, verdict};
//! use stepscope_sim::{Experiment, plant_run::PlantRun};
//!
//! let experiment = Experiment::from_json(r#"{ "plant": {} }"#).expect("no problem");
//! let mut run = PlantRun::new(&experiment, vec![(Vec::new(), ())]).expect("a plant");
//! run.finish();
//! assert_eq!(verdict(&run.results()[0].motors[0], 16_000_000), "follows");
//! let setup = &experiment.plants().expect("a plant").setups[0];
//! assert!(settling(setup, 0, 32_768, 0.2).expect("it is made").rest_a > 0.0);
//! ```

use alloc::{
    format,
    string::{String, ToString},
    vec,
    vec::Vec,
};
use core::fmt::Write as _;
use stepscope_peripheral::{
    signal::{Levels, Record},
    units::Instant,
};
use stepscope_plant::{
    Plant, Refused,
    measures::MotorResult,
    parameters::Setup,
    settling::{REST_STEPS, SensorLog, StepResponse},
};

/// Following errors from here on, in full steps, are more than a motor's own: the field hardly holds it.
const FAR: f64 = 2.0;

/// Whether a motor follows its pulses, in words.
#[must_use]
pub fn verdict(motor: &MotorResult, clock_hz: u32) -> String {
    let lost = motor.lost.unsigned_abs();
    let ms = |cycle: u64| cycle as f64 / f64::from(clock_hz) * 1e3;
    let step = motor.first_slip_step.unwrap_or(0);
    match motor.slips.first() {
        Some(slip) if lost == 0 => {
            format!("slips and comes back; first at {:.2} ms in step {step}", ms(slip.cycle))
        }
        Some(slip) => format!("loses {lost} full steps, first at {:.2} ms in step {step}", ms(slip.cycle)),
        None if motor.following_error.0.abs() >= FAR => {
            format!("follows, but by {:.2} full steps behind", motor.following_error.0.abs())
        }
        None => "follows".to_string(),
    }
}

/// Names of the analogue values of a plant, in the order of [`values`]; units are in the names.
#[must_use]
pub fn names(plant: &Plant) -> Vec<String> {
    let mut names: Vec<String> = ["bus_v", "load_a", "sensor_a", "sensor_code"].map(String::from).into();
    for channel in 0..plant.motors() {
        let of_motor = ["command", "rotor", "speed", "phase_a_a", "phase_b_a", "lost", "encoder"];
        names.extend(of_motor.map(|name| format!("{name}{channel}")));
    }
    names
}

/// What a plant's values are at its point: V, A, codes, full steps and full steps/s.
#[must_use]
pub fn values(plant: &Plant) -> Vec<f64> {
    let sensor = plant.current_sensor();
    let mut values = vec![plant.bus_v(), plant.load_a(), sensor.filtered(), f64::from(sensor.code())];
    for channel in 0..plant.motors() {
        let Some(state) = plant.state(channel) else { continue };
        let (command, lost) = (plant.command(channel), plant.lost(channel) as f64);
        values.extend([command, state.x, state.w, state.i_a, state.i_b, lost, plant.encoder(channel).into()]);
    }
    values
}

/// The head of a table of points.
#[must_use]
pub fn table_head(plant: &Plant) -> String {
    format!("cycle,time_s,{}\n", names(plant).join(","))
}

/// A row of it.
#[must_use]
pub fn table_row(plant: &Plant) -> String {
    let cycle = plant.cycle();
    let mut row = format!("{cycle},{}", cycle as f64 / plant.clock_hz());
    for value in values(plant) {
        // Writing to a text cannot fail.
        let _ = write!(row, ",{value}");
    }
    row.push('\n');
    row
}

/// The supply current around one step to the right of the motor of `channel` alone, which rested for ten `t_step` cycles.
///
/// # Errors
/// Those of the plant; none at all where there is no such channel or no sample.
pub fn settling(
    setup: &Setup,
    channel: usize,
    t_step: u64,
    share: f64,
) -> Result<StepResponse, Vec<Refused>> {
    let motors = setup.motors.get(channel).cloned().into_iter().collect();
    let mut plant = Plant::new(&Setup { motors, protection: None, ..setup.clone() })?;
    let mut log = SensorLog::default();
    // As the self-test has it: S = 1.
    let (from, rise) = (1, 1 + REST_STEPS * t_step);
    let levels = Levels(Levels::RESET.0 | 1 << Levels::DIR_SHIFT | 1);
    plant.record(Record { cycle: Instant(rise), levels }, &mut log);
    plant.advance(rise + t_step, &mut log);
    StepResponse::of(&log.samples, from, rise, t_step, share).ok_or_else(Vec::new)
}
