//! The driver that the pulses are checked against: a model by name, or rules of one's own.
//!
//! The models' figures stand in `inspect::drivers`, the check in
//! `inspect::timing`. A driver changes nothing in a run.

use crate::{
    Validator,
    compact::{choices, settings},
};

/// Longest time that a rule may ask for, in ns: one second.
const MAX_NS: u64 = 1_000_000_000;

choices! {
    /// What the pulses are checked against.
    pub enum DriverTiming {
        /// A driver whose data sheet is known.
        Preset(DriverModel) = "preset",
        /// Rules of one's own.
        Rules(TimingRules) = "rules",
    }
}

/// A driver whose data sheet is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriverModel {
    /// Allegro A4988.
    A4988,
    /// Allegro A4979.
    A4979,
    /// Texas Instruments DRV8825.
    Drv8825,
    /// Trinamic TMC2209.
    Tmc2209,
    /// Trinamic TMC262.
    Tmc262,
    /// Opto-isolated drivers in the class of the TB6600 boxes.
    Tb6600Class,
}

settings! {
    /// The least times that a driver asks for, in ns, 0 to 1 000 000 000; 0 asks for nothing.
    pub struct TimingRules {
        /// How long STEP is high.
        pub step_high_ns: u32 = 0,
        /// How long STEP is low between two pulses.
        pub step_low_ns: u32 = 0,
        /// How long DIR has been stable when STEP rises.
        pub dir_setup_ns: u32 = 0,
        /// How long DIR stays stable after STEP has risen.
        pub dir_hold_ns: u32 = 0,
        /// From EN, or from reset, to the first rise of STEP.
        pub enable_wake_ns: u32 = 0,
    }
}

impl DriverTiming {
    /// Judges the rules' ranges; a model has none to validator.
    pub(super) fn check(&self, validator: &mut Validator) {
        let Self::Rules(rules) = self else { return };
        validator.whole("driver_timing.rules.step_high_ns", rules.step_high_ns, 0, MAX_NS, "ns");
        validator.whole("driver_timing.rules.step_low_ns", rules.step_low_ns, 0, MAX_NS, "ns");
        validator.whole("driver_timing.rules.dir_setup_ns", rules.dir_setup_ns, 0, MAX_NS, "ns");
        validator.whole("driver_timing.rules.dir_hold_ns", rules.dir_hold_ns, 0, MAX_NS, "ns");
        validator.whole("driver_timing.rules.enable_wake_ns", rules.enable_wake_ns, 0, MAX_NS, "ns");
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
            let (scenario, mut problems) = Scenario::from_json_lenient(json);
            problems.extend(scenario.check().err().unwrap_or_default());
            let mut paths: Vec<String> = problems.into_iter().map(|problem| problem.path).collect();
            paths.sort();
            assert_eq!(paths, *expected, "{json}");
        }
    }

    #[test]
    fn the_canonical_form_leaves_out_what_is_not_asked_for() {
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
