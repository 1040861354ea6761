//! Timing limits of a driver: a known model or custom rules. They do not affect a run.

use crate::schema::rows::{choices, settings, word_enums};
use crate::schema::{SHEETS, label};
use core::ops::RangeInclusive;

const NS: RangeInclusive<u64> = 0..=1_000_000_000;

choices! {
    /// A driver by name, `{ "preset": "drv8825" }`, or custom rules:
    ///
    /// ```json
    /// { "driver_timing": { "rules": { "step_high_ns": 2500, "step_low_ns": 2500, "dir_setup_ns": 5000 } } }
    /// ```
    ///
    /// `stepscope drivers` prints the times of each driver with their source in the data sheet. Waking from sleep takes
    /// longer (A4988 1 ms, DRV8825 1.7 ms): if SLEEP is connected to EN, use custom rules.
    pub enum DriverTiming {
        /// A driver with a known data sheet.
        Preset(DriverModel) = "preset" => label("a driver").from(SHEETS),
        /// Custom rules.
        Rules(TimingRules) = "rules" => label("custom rules").from(SHEETS),
    }
}

word_enums! {
    /// A driver with a known data sheet.
    pub enum DriverModel {
        /// Allegro, data sheet 4988-DS
        A4988 = "a4988" => label("A4988");
        /// Allegro; only STEP high is confirmed, the other times are the A4988's
        A4979 = "a4979" => label("A4979");
        /// Texas Instruments, data sheet SLVSA73
        Drv8825 = "drv8825" => label("DRV8825");
        /// Trinamic, data sheet rev. 1.09, at the minimum internal clock of 11.5 MHz
        Tmc2209 = "tmc2209" => label("TMC2209");
        /// Trinamic; unconfirmed: formula of the TMC2100 at 10 MHz
        Tmc262 = "tmc262" => label("TMC262");
        /// opto-isolated, like TB6600, DM542, AM882: typical figures; check the data sheet of your driver
        Tb6600Class = "tb6600_class" => label("TB6600 class");
    }
}

settings! {
    /// Minimum times of a driver; 0 is not checked.
    pub struct TimingRules {
        /// From the rise of STEP to its fall.
        pub step_high_ns: u32 = 0 => label("STEP high").unit("ns").whole(NS)
            .term("STEP high", "From the rise of STEP to its fall.")
            .from(SHEETS),
        /// From the fall of STEP to its next rise.
        pub step_low_ns: u32 = 0 => label("STEP low").unit("ns").whole(NS)
            .term("STEP low", "From the fall of STEP to its next rise.")
            .from(SHEETS),
        /// From the last change of DIR to the rise of STEP.
        pub dir_setup_ns: u32 = 0 => label("DIR set-up").unit("ns").whole(NS)
            .term("DIR set-up", "From the last change of DIR to the rise of STEP.")
            .from(SHEETS),
        /// From the rise of STEP to the next change of DIR.
        pub dir_hold_ns: u32 = 0 => label("DIR hold").unit("ns").whole(NS)
            .term("DIR hold", "From the rise of STEP to the next change of DIR.")
            .from(SHEETS),
        /// From the rise of EN, or from reset, to the first rise of STEP of a channel.
        pub enable_wake_ns: u32 = 0 => label("EN wake-up").unit("ns").whole(NS)
            .term("EN wake-up", "From the rise of EN, or from reset, to the first step.")
            .from(SHEETS),
    }
}

#[cfg(test)]
mod tests {
    use crate::{Compact, Scenario};
    use alloc::{string::String, vec::Vec};

    #[test]
    fn a_driver_is_a_model_or_rules_and_its_problems_have_paths() {
        let rows: &[(&str, &[&str])] = &[
            (r#"{"driver_timing":null}"#, &[]),
            (r#"{"driver_timing":{"preset":"drv8825"}}"#, &[]),
            (r#"{"driver_timing":{"preset":"tb6600_class"}}"#, &[]),
            (r#"{"driver_timing":{"rules":{}}}"#, &[]),
            (r#"{"driver_timing":{"rules":{"step_high_ns":1000000000}}}"#, &[]),
            (
                r#"{"driver_timing":{"rules":{"dir_setup_ns":1000000001,"enable_wake_ns":4294967295}}}"#,
                &["driver_timing.rules.dir_setup_ns", "driver_timing.rules.enable_wake_ns"],
            ),
            (
                r#"{"driver_timing":{"preset":"drv8826"},"clock_hz":"x"}"#,
                &["clock_hz", "driver_timing.preset"],
            ),
            (r#"{"driver_timing":"a4988"}"#, &["driver_timing"]),
            (r#"{"driver_timing":{"rules":{"step_high_us":1}}}"#, &["driver_timing.rules.step_high_us"]),
            (r#"{"driver_timing":{"rules":{"step_high_ns":-1}}}"#, &["driver_timing.rules.step_high_ns"]),
            (r#"{"driver_timing":{"rules":[1,1]}}"#, &["driver_timing.rules"]),
        ];
        for (json, expected) in rows {
            let (scenario, unreadable) = Scenario::from_json_lenient(json);
            let problems: Vec<_> = unreadable.into_iter().chain(scenario.check().err()).flatten().collect();
            let mut paths: Vec<String> = problems.into_iter().map(|problem| problem.path).collect();
            paths.sort();
            assert_eq!(paths, *expected, "{json}");
        }
    }

    #[test]
    fn the_canonical_form_omits_defaults() {
        for (json, expected) in [
            (r#"{"driver_timing":null}"#, "{}"),
            (r#"{"driver_timing":{"preset":"tmc2209"}}"#, r#"{"driver_timing":{"preset":"tmc2209"}}"#),
            (
                r#"{"driver_timing":{"rules":{"dir_hold_ns":0,"step_low_ns":5}}}"#,
                r#"{"driver_timing":{"rules":{"step_low_ns":5}}}"#,
            ),
        ] {
            let scenario = Scenario::from_json(json).expect("reads");
            assert_eq!(scenario.compact().to_string(), expected);
            assert_eq!(Scenario::from_json(expected).as_ref(), Ok(&scenario));
            assert_eq!(Scenario::from_json(&scenario.to_json()), Ok(scenario));
        }
    }
}
