//! Drivers, motors, supply and sensors behind the bus (F9).

use crate::schema::{OWN, PATENT, label, rows::settings};
use alloc::vec::Vec;
use stepscope_motion::motor::Motor;
use stepscope_plant::limits;

settings! {
    /// Motors, drivers and supply behind the bus of each controller. The model: [plant.md](plant.md). The motor of channel i
    /// is, in this order: the motor of axis i (with the full step and microsteps of its mechanics); entry i of `motors`; the
    /// last entry of `motors`; the default motor.
    ///
    /// `supply_v` of all motors of one controller must be equal. A grid that is too coarse for a motor is an error.
    pub struct PlantSettings {
        /// Grid step of the simulation.
        pub step_cycles: Option<u32> = None => label("Grid step")
            .unit("cycles").whole(limits::STEP_CYCLES).null_means("5 us, with a chopper 1 us").from(OWN),
        /// Resistance of the source; only used with a buffer.
        pub source_ohm: f64 = 0.1 => label("Source resistance").unit("Ω").number(limits::SOURCE_OHM).from(OWN),
        /// Buffer capacitance at the drivers.
        pub buffer_uf: Option<f64> = None => label("Buffer")
            .unit("µF").number(limits::BUFFER_UF).null_means("no buffer, constant voltage").from(OWN),
        /// Whether the source accepts current from the drivers.
        pub source_sinks: bool = false => label("Supply accepts reverse current").from(OWN),
        /// Supply current of each driver without its motor.
        pub idle_ma: f64 = 0.0 => label("Driver supply current").unit("mA").number(limits::IDLE_MA).from(OWN),
        /// Simulated time after the last step, if `run_cycles` is not set.
        pub tail_s: f64 = 0.1 => label("Time after last step").unit("s").number(limits::TAIL_S).from(OWN),
        /// Sensor of the supply current.
        pub current_sensor: CurrentSensor = CurrentSensor::default() => label("Current sensor"),
        /// Encoder on each rotor, 4096 codes per turn.
        pub encoder: Encoder = Encoder::default() => label("Encoder"),
        /// Overload protection by the supply current.
        pub protection: Option<Protection> = None => label("Protection").null_means("none").from(PATENT),
        /// Whether the self-test measures the settling time for staggered pulses.
        pub self_test: bool = false => label("Self-test measures settling").from(PATENT),
        /// Motors of channels whose axis has none.
        pub motors: Vec<PlantMotor> = Vec::new() => label("Motors").length(0..=16, "motors"),
    }
}

settings! {
    /// Low-pass filters and an ADC.
    pub struct CurrentSensor {
        /// Bandwidth of each low-pass filter.
        pub bandwidth_hz: f64 = 3000.0 => label("Bandwidth").unit("Hz").number(limits::BANDWIDTH_HZ).from(PATENT),
        /// Number of low-pass filters.
        pub poles: u8 = 1 => label("Poles").whole(limits::POLES).from(OWN),
        /// Grid steps between conversions.
        pub adc_steps: u32 = 1 => label("Conversion interval").unit("grid steps").whole(limits::PERIOD_STEPS).from(OWN),
        /// Resolution of the ADC.
        pub lsb_a: f64 = 0.024_414_062_5 => label("Resolution").unit("A").number(limits::LSB).from(OWN),
        /// Maximum code; the minimum is its negative.
        pub adc_max: u32 = 2047 => label("Max code").whole(limits::ADC_MAX).from(OWN),
    }
}

settings! {
    /// Modeled on the AS5600.
    pub struct Encoder {
        /// Grid steps between codes.
        pub period_steps: u32 = 1000 => label("Period").unit("grid steps").whole(limits::PERIOD_STEPS).from(OWN),
        /// Code of position 0.
        pub offset_lsb: f64 = 0.0 => label("Offset").number(limits::OFFSET_LSB).from(OWN),
        /// Maximum noise.
        pub noise_lsb: f64 = 0.0 => label("Noise").number(limits::NOISE_LSB).from(OWN),
        /// Hysteresis on each side.
        pub hysteresis_lsb: f64 = 0.0 => label("Hysteresis").number(limits::NOISE_LSB).from(OWN),
        /// Random seed.
        pub seed: u64 = 0 => label("Seed").whole(limits::SEED).from(OWN),
    }
}

settings! {
    /// `samples` consecutive conversions at or above `threshold_a` stop the controller (fault OVERLOAD).
    pub struct Protection {
        /// Minimum current of an overload.
        pub threshold_a: f64 = 2.0 => label("Threshold").unit("A").number(limits::THRESHOLD_A).from(PATENT),
        /// Consecutive conversions.
        pub samples: u32 = 4 => label("Samples above threshold").whole(limits::SAMPLES).from(PATENT),
    }
}

settings! {
    /// Motor of a channel whose axis does not define one.
    pub struct PlantMotor {
        /// Angle of a full step.
        pub full_step_deg: f64 = 1.8 => label("Full step").unit("°").number(stepscope_motion::limits::FULL_STEP_DEG).from(OWN),
        /// Microsteps per full step.
        pub microsteps: u16 = 16 => label("Microsteps").whole(1..=512).from(OWN),
        /// Motor, driver and load.
        pub motor: Motor = Motor::default() => label("Motor"),
    }
}
