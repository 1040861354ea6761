//! The experiment itself, and its analysis.

use crate::schema::PlantSettings;
use crate::{
    END_OF_TIME, MAX_CONTROLLERS, VERSION,
    schema::{Controller, DriverTiming, Line, OWN, PATENT, SINE, Source, label, rows::settings},
};
use alloc::{string::String, vec::Vec};
use stepscope_peripheral::config::{Bus, limits};

settings! {
    /// A scenario is one experiment as JSON: what a file, a share link and the page's form hold. Every
    /// field has a default, so `{}` is a scenario; unknown fields, and fields that are given twice, are
    /// refused. Units stand in the names: `_cycles` counts the peripheral's clock, `_s` is seconds, `_hz`
    /// hertz. A choice is a map of one key that names it: `{ "mm": 250 }`, `{ "cosine": { … } }`. A whole
    /// number may be written as `16000000.0` or `16e6`, too.
    ///
    /// All problems of a scenario are reported at once, each with its path, the value, and what is allowed.
    /// Files and links of version 1, which had other names for a few fields, are read too.
    pub struct Scenario {
        /// Version of this format.
        pub version: u32 = VERSION => label("Version").follows("1 or 2"),
        /// A name to show, which goes with the link.
        pub title: String = String::new() => label("Name")
            .length(0..=120, "characters")
            .term("Name", "A name for the experiment, that travels with its link."),
        /// What to look at, and where it comes from.
        pub note: String = String::new() => label("Note")
            .length(0..=2000, "characters")
            .term("Note", "What to look at, for whom you send the link to."),
        /// Clock of the peripheral; all cycles count it.
        pub clock_hz: u32 = 16_000_000 => label("Clock")
            .unit("Hz")
            .whole(limits::CLOCK_HZ)
            .term("Clock", "All that the controller does happens on a beat of this clock; one beat is a cycle, and times are counted in whole cycles.")
            .from(PATENT),
        /// The sequencer and its driver bus.
        pub bus: Bus = Bus::default() => label("Driver bus"),
        /// The serial line between host and peripheral.
        pub line: Line = Line::default() => label("Serial line"),
        /// What the host sends, or what the peripheral runs by itself.
        pub source: Source = Source::default() => label("What the host sends"),
        /// Length of the run: cycles 0 to `run_cycles` - 1.
        pub run_cycles: Option<u64> = None => label("Length of the run")
            .unit("cycles")
            .whole(1..=END_OF_TIME)
            .empty("until nothing can change any more")
            .term("Length of the run", "When to stop looking. By itself a run ends when nothing can change any more."),
        /// What the spectrum is taken of.
        pub analysis: Analysis = Analysis::default() => label("Spectrum"),
        /// Additional controllers on the line.
        pub controllers: Vec<Controller> = Vec::new() => label("Additional controllers")
            .length(0..=MAX_CONTROLLERS - 1, "additional controllers"),
        /// The driver that the pulses are checked against; it changes nothing in a run.
        pub driver_timing: Option<DriverTiming> = None => label("Driver timing").empty("not checked"),
        /// What the edges drive: motors with their drivers, a supply, sensors.
        pub plant: Option<PlantSettings> = None => label("Motors and supply").only_if_set().empty("none: a run ends at the bus"),
    }
}

settings! {
    /// The spectrum is taken of one axis, over whole periods.
    pub struct Analysis {
        /// Axis of the motion, or the channel.
        pub axis: u8 = 0 => label("Axis")
            .follows("0 to below the number of axes (of channels, where there are none)")
            .term("Axis", "Which axis the spectrum is taken of; axis 0 drives channel 0."),
        /// Highest harmonic that counts for the distortion.
        pub order: u16 = 40 => label("Order")
            .whole(2..=1000)
            .term("Order", "Up to which harmonic the distortion is summed.")
            .from(SINE),
        /// Samples of one period of the ideal curve; any number is coherent, powers of two are quickest.
        pub fft_length: u32 = 4096 => label("Samples a period")
            .whole(16..=65_536)
            .term("Samples", "Points at which one period is looked at for the transform; they fill the period, so nothing leaks, whatever their number.")
            .from(SINE),
        /// Bandwidth (−3 dB, first order) of the accelerometer on the rig: |H| = 1/√(1 + (f/f_b)²). With it the
        /// spectrum also has the acceleration after the sensor.
        pub sensor_hz: Option<f64> = None => label("Sensor's bandwidth")
            .unit("Hz")
            .number(1e-3..=1e9)
            .empty("no sensor")
            .term("Sensor's bandwidth", "An accelerometer is a low pass: at this frequency it feels 71 % of the acceleration, |H| = 1/√(1 + (f/f_b)²). So the distortion it feels does not grow with the order.")
            .from(OWN),
    }
}
