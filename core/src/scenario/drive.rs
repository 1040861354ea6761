//! The driver that the pulses are checked against: a model by name, or rules of one's own.
//!
//! The models' figures stand in [`crate::analysis::drivers`], the check in
//! [`crate::analysis::timing`]. A driver changes nothing in a run.

use super::{
    compact::{choices, settings},
    judge::Judge,
};
use serde::{Deserialize, Serialize};

/// Longest time that a rule may ask for, in ns: one second.
const MOST_NS: u64 = 1_000_000_000;

choices! {
    /// What the pulses are checked against.
    pub enum Driver {
        /// A driver whose data sheet is known.
        Preset(DriverModel) = "preset",
        /// Rules of one's own.
        Rules(TimingRules) = "rules",
    }
}

/// A driver whose data sheet is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
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

impl Driver {
    /// Judges the rules' ranges; a model has none to judge.
    pub(super) fn judge(&self, judge: &mut Judge) {
        let Self::Rules(rules) = self else { return };
        judge.range("driver.rules.step_high_ns", rules.step_high_ns, 0, MOST_NS, "ns");
        judge.range("driver.rules.step_low_ns", rules.step_low_ns, 0, MOST_NS, "ns");
        judge.range("driver.rules.dir_setup_ns", rules.dir_setup_ns, 0, MOST_NS, "ns");
        judge.range("driver.rules.dir_hold_ns", rules.dir_hold_ns, 0, MOST_NS, "ns");
        judge.range("driver.rules.enable_wake_ns", rules.enable_wake_ns, 0, MOST_NS, "ns");
    }
}

#[cfg(test)]
mod tests {
    use crate::scenario::{Compact, Scenario};
    use alloc::{string::String, vec::Vec};

    #[test]
    fn a_driver_is_a_model_or_rules_and_its_problems_have_paths() {
        let rows: &[(&str, &[&str])] = &[
            (r#"{"driver":null}"#, &[]),
            (r#"{"driver":{"preset":"drv8825"}}"#, &[]),
            (r#"{"driver":{"preset":"tb6600_class"}}"#, &[]),
            (r#"{"driver":{"rules":{}}}"#, &[]),
            (r#"{"driver":{"rules":{"step_high_ns":1000000000}}}"#, &[]),
            (
                r#"{"driver":{"rules":{"dir_setup_ns":1000000001,"enable_wake_ns":4294967295}}}"#,
                &["driver.rules.dir_setup_ns", "driver.rules.enable_wake_ns"],
            ),
            (r#"{"driver":{"preset":"drv8826"},"clock_hz":"x"}"#, &["clock_hz", "driver.preset"]),
            (r#"{"driver":"a4988"}"#, &["driver"]),
            (r#"{"driver":{"rules":{"step_high_us":1}}}"#, &["driver.rules.step_high_us"]),
            (r#"{"driver":{"rules":{"step_high_ns":-1}}}"#, &["driver.rules.step_high_ns"]),
            (r#"{"driver":{"rules":[1,1]}}"#, &["driver.rules"]),
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
            (r#"{"driver":null}"#, "{}"),
            (r#"{"driver":{"preset":"tmc2209"}}"#, r#"{"driver":{"preset":"tmc2209"}}"#),
            (
                r#"{"driver":{"rules":{"dir_hold_ns":0,"step_low_ns":5}}}"#,
                r#"{"driver":{"rules":{"step_low_ns":5}}}"#,
            ),
        ] {
            let scenario = Scenario::from_json(json).expect("reads");
            assert_eq!(scenario.compact().to_string(), expected);
            assert_eq!(Scenario::from_json(expected).as_ref(), Ok(&scenario));
            assert_eq!(Scenario::from_json(&scenario.to_json()), Ok(scenario));
        }
    }
}
