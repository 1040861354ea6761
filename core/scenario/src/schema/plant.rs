//! Drivers, motors, supply and sensors behind the bus (F9).

use crate::schema::{OWN, PATENT, label, rows::settings};
use alloc::vec::Vec;
use stepscope_motion::motor::Motor;
use stepscope_plant::limits;

settings! {
    /// A plant behind the bus of each controller: [plant.md](plant.md) says what it models. Channel i has the motor of axis
    /// i, with its mechanics' angle and microsteps; where there is no such axis, or it has no motor, entry i of `motors`
    /// (the last one where there are fewer), and without that the default motor.
    ///
    /// `supply_v` of all motors of one plant must be equal. A grid that is too coarse for a motor is refused with the
    /// numbers.
    pub struct PlantSettings {
        /// Cycles of a grid step.
        pub step_cycles: Option<u32> = None => label("Grid step")
            .unit("cycles").whole(limits::STEP_CYCLES).empty("5 us, where a driver chops 1 us").from(OWN),
        /// Resistance of the source, of effect with a buffer.
        pub source_ohm: f64 = 0.1 => label("Source").unit("Ω").number(limits::SOURCE_OHM).from(OWN),
        /// Capacitance at the drivers.
        pub buffer_uf: Option<f64> = None => label("Buffer")
            .unit("µF").number(limits::BUFFER_UF).empty("the bus has the source's voltage").from(OWN),
        /// Whether the source takes current back.
        pub source_sinks: bool = false => label("Source takes current back").from(OWN),
        /// Current that each driver draws for itself.
        pub idle_ma: f64 = 0.0 => label("Idle current").unit("mA").number(limits::IDLE_MA).from(OWN),
        /// Time that a run without `run_cycles` goes on after its last step.
        pub tail_s: f64 = 0.1 => label("Tail").unit("s").number(limits::TAIL_S).from(OWN),
        /// What measures the supply current.
        pub current_sensor: CurrentSensor = CurrentSensor::default() => label("Current sensor"),
        /// On each rotor, 4096 codes a turn.
        pub encoder: Encoder = Encoder::default() => label("Encoder"),
        /// Stops the controller when the supply current is too great for too long.
        pub protection: Option<Protection> = None => label("Protection").empty("none").from(PATENT),
        /// Whether the controller measures the settling time in its self-test, and staggers by it.
        pub self_test: bool = false => label("Self-test measures").from(PATENT),
        /// Motors of channels that no axis gives one.
        pub motors: Vec<PlantMotor> = Vec::new() => label("Motors").length(0..=16, "motors"),
    }
}

settings! {
    /// Low passes and a converter.
    pub struct CurrentSensor {
        /// Bandwidth of each low pass.
        pub bandwidth_hz: f64 = 3000.0 => label("Bandwidth").unit("Hz").number(limits::BANDWIDTH_HZ).from(PATENT),
        /// Low passes.
        pub poles: u8 = 1 => label("Poles").whole(limits::POLES).from(OWN),
        /// Grid steps from conversion to conversion.
        pub adc_steps: u32 = 1 => label("Conversion").unit("grid steps").whole(limits::PERIOD_STEPS).from(OWN),
        /// Step of the converter.
        pub lsb_a: f64 = 0.024_414_062_5 => label("Step").unit("A").number(limits::LSB).from(OWN),
        /// Its greatest code; the least is its negative.
        pub adc_max: u32 = 2047 => label("Greatest code").whole(limits::ADC_MAX).from(OWN),
    }
}

settings! {
    /// As the AS5600.
    pub struct Encoder {
        /// Grid steps from code to code.
        pub period_steps: u32 = 1000 => label("Period").unit("grid steps").whole(limits::PERIOD_STEPS).from(OWN),
        /// Code of place 0.
        pub offset_lsb: f64 = 0.0 => label("Offset").number(limits::OFFSET_LSB).from(OWN),
        /// Greatest noise.
        pub noise_lsb: f64 = 0.0 => label("Noise").number(limits::NOISE_LSB).from(OWN),
        /// Half of its play.
        pub hysteresis_lsb: f64 = 0.0 => label("Hysteresis").number(limits::NOISE_LSB).from(OWN),
        /// Where the noise begins.
        pub seed: u64 = 0 => label("Seed").whole(limits::SEED).from(OWN),
    }
}

settings! {
    /// So many conversions in a row at or above the threshold stop the controller (fault OVERLOAD).
    pub struct Protection {
        /// From this current on.
        pub threshold_a: f64 = 2.0 => label("Threshold").unit("A").number(limits::THRESHOLD_A).from(PATENT),
        /// Conversions in a row.
        pub samples: u32 = 4 => label("Conversions").whole(limits::SAMPLES).from(PATENT),
    }
}

settings! {
    /// A motor without an axis.
    pub struct PlantMotor {
        /// Full step.
        pub full_step_deg: f64 = 1.8 => label("Full step").unit("°").number(stepscope_motion::limits::FULL_STEP_DEG).from(OWN),
        /// Microsteps in a full step.
        pub microsteps: u16 = 16 => label("Microsteps").whole(1..=512).from(OWN),
        /// The motor, its driver and its load.
        pub motor: Motor = Motor::default() => label("Motor"),
    }
}
