//! The experiment itself, and its analysis.

use crate::schema::PlantSettings;
use crate::schema::{Controller, DriverTiming, Line, OWN, PATENT, SINE, Source, label, rows::settings};
use crate::{END_OF_TIME, MAX_CONTROLLERS, VERSION};
use alloc::{string::String, vec::Vec};
use stepscope_peripheral::config::{Bus, limits};

settings! {
    /// A scenario is one experiment as JSON. Files, share links and the page's form hold it. Every field has a default, so
    /// `{}` is a valid scenario. Unknown and duplicate fields are errors. Names contain the unit: `_cycles` counts the
    /// peripheral's clock, `_s` is seconds, `_hz` is hertz; torques are written as in a data sheet (`_mN_m`). A choice is an
    /// object with one key that names it: `{ "mm": 250 }`, `{ "cosine": { … } }`. A whole number may also be written as
    /// `16000000.0` or `16e6`.
    ///
    /// All problems of a scenario are reported at once, each with its path, the value and the allowed values. Versions 1 and
    /// 2, which had other names for some fields, can still be read. Without `version`, the names of all versions are
    /// accepted. Directions may be written as 1 (positive) and 0 (negative).
    pub struct Scenario {
        /// Version of this format.
        pub version: u32 = VERSION => label("Version").range_text("1 to 3"),
        /// Name of the experiment; part of the link.
        pub title: String = String::new() => label("Name").length(0..=120, "characters")
            .term("Name", "Name of the experiment. It is part of the link."),
        /// What to inspect, and the source of the values.
        pub note: String = String::new() => label("Note").length(0..=2000, "characters")
            .term("Note", "What the person who opens the link should see and try."),
        /// Clock of the peripheral. All `_cycles` fields count periods of this clock.
        pub clock_hz: u32 = 16_000_000 => label("Clock").unit("Hz").whole(limits::CLOCK_HZ)
            .term("Clock", "Clock of the controller. One period is a cycle, and everything happens in whole cycles.")
            .from(PATENT),
        /// The sequencer and its driver bus.
        pub bus: Bus = Bus::default() => label("Driver bus"),
        /// Serial line between host and peripheral.
        pub line: Line = Line::default() => label("Serial line"),
        /// What the host sends, or what the peripheral runs without a host.
        pub source: Source = Source::default() => label("Source"),
        /// Length of the run: cycles 0 to `run_cycles` - 1.
        pub run_cycles: Option<u64> = None => label("Run length").unit("cycles").whole(1..=END_OF_TIME)
            .null_means("until the last change")
            .term("Run length", "When the run stops. Without it the run ends after the last change."),
        /// Settings of the spectrum.
        pub analysis: Analysis = Analysis::default() => label("Spectrum"),
        /// Additional controllers on the line.
        pub controllers: Vec<Controller> = Vec::new() => label("Additional controllers")
            .length(0..=MAX_CONTROLLERS - 1, "additional controllers"),
        /// Driver whose timing the pulses are checked against. It does not affect the run.
        pub driver_timing: Option<DriverTiming> = None => label("Driver timing").null_means("not checked"),
        /// Motors with their drivers, supply and sensors, driven by the pulses.
        pub plant: Option<PlantSettings> = None => label("Motors and supply").only_if_set().null_means("no motors, only the bus is simulated"),
    }
}

settings! {
    /// Spectrum of one axis, over whole periods.
    pub struct Analysis {
        /// Axis of the motion, or channel.
        pub axis: u8 = 0 => label("Axis")
            .range_text("0 to the number of axes - 1 (of channels if there are no axes)")
            .term("Axis", "Axis of the spectrum. Axis 0 drives channel 0."),
        /// Highest harmonic included in the distortion.
        pub max_harmonic: u16 = 40 => label("Max harmonic").whole(2..=1000)
            .term("Max harmonic", "Highest harmonic that the distortion (THD) includes.")
            .from(SINE),
        /// Samples per period of the ideal curve. Every length gives a coherent spectrum; powers of two are fastest.
        pub fft_length: u32 = 4096 => label("Samples per period").whole(16..=65_536)
            .term("Samples", "Samples per period for the Fourier transform. They span exactly one period, so there is no leakage.")
            .from(SINE),
        /// Bandwidth (−3 dB, first order) of the accelerometer on the rig: |H| = 1/√(1 + (f/f_b)²). Adds the
        /// filtered acceleration to the spectrum.
        pub sensor_hz: Option<f64> = None => label("Sensor bandwidth").unit("Hz").number(1e-3..=1e9)
            .null_means("no sensor")
            .term("Sensor bandwidth", "An accelerometer is a low-pass filter: at this frequency it measures 71 % of the acceleration, |H| = 1/√(1 + (f/f_b)²). The distortion it measures therefore does not grow with the number of harmonics.")
            .from(OWN),
    }
}
