//! The timing check of a run, and the known drivers.

use crate::{convert::object, scenario::config, view::simulation::Simulation};
use serde::Serialize;
use stepscope_core::inspect::trace::drivers::{self, DRIVERS};
use stepscope_core::inspect::trace::timing::{RuleResult, Violation};
use stepscope_core::peripheral::units::Instant;
use stepscope_core::scenario::{DriverTiming, TimingRules};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Listed {
    id: &'static str,
    name: &'static str,
    source: &'static str,
    rules: Rules,
}

#[derive(Serialize)]
struct Rules {
    step_high_ns: u32,
    step_low_ns: u32,
    dir_setup_ns: u32,
    dir_hold_ns: u32,
    enable_wake_ns: u32,
}

impl From<&TimingRules> for Rules {
    fn from(rules: &TimingRules) -> Self {
        let TimingRules { step_high_ns, step_low_ns, dir_setup_ns, dir_hold_ns, enable_wake_ns } = *rules;
        Self { step_high_ns, step_low_ns, dir_setup_ns, dir_hold_ns, enable_wake_ns }
    }
}

/// All known drivers.
#[wasm_bindgen]
pub fn drivers() -> Result<JsValue, JsError> {
    let listed: Vec<Listed> = DRIVERS
        .iter()
        .map(|sheet| Listed {
            id: sheet.id,
            name: sheet.name,
            source: sheet.source,
            rules: (&sheet.rules).into(),
        })
        .collect();
    object(&listed)
}

#[derive(Serialize)]
struct Timing {
    /// Null for custom rules.
    driver: Option<&'static str>,
    total: u64,
    rules: Vec<RuleRow>,
    violations: Vec<ViolationRow>,
}

#[derive(Serialize)]
struct RuleRow {
    rule: &'static str,
    required_ns: u32,
    required_cycles: u64,
    shortest: Option<ShortestRow>,
    violations: u64,
    by_channel: Vec<u64>,
}

#[derive(Serialize)]
struct ShortestRow {
    measured_cycles: u64,
    cycle: u64,
    channel: u8,
}

#[derive(Serialize)]
struct ViolationRow {
    cycle: u64,
    channel: u8,
    rule: &'static str,
    measured_cycles: u64,
    required_cycles: u64,
}

#[wasm_bindgen]
impl Simulation {
    /// Timing check of the selected controller, with the first 1000 violations; null without a driver.
    pub fn timing(&self) -> Result<JsValue, JsError> {
        let Some(check) = &self.selected().timing else { return Ok(JsValue::NULL) };
        let channels = usize::from(config(&self.experiment, self.selected).channels());
        object(&Timing {
            driver: match &self.scenario.driver_timing {
                Some(DriverTiming::Preset(model)) => Some(drivers::sheet(*model).id),
                _ => None,
            },
            total: check.total(),
            rules: check.results().iter().map(|result| rule_row(result, channels)).collect(),
            violations: check.violations().iter().map(violation_row).collect(),
        })
    }

    /// Index of the next or previous violation in `timing().violations`.
    pub fn next_violation(&self, cycle: f64, forward: bool) -> Option<u32> {
        let at = Instant(cycle.max(0.0) as u64);
        self.selected().timing.as_ref()?.next(at, forward).map(|index| index as u32)
    }
}

fn rule_row(result: &RuleResult, channels: usize) -> RuleRow {
    RuleRow {
        rule: result.rule.name(),
        required_ns: result.nanos,
        required_cycles: result.required.0,
        shortest: result.shortest.map(|shortest| ShortestRow {
            measured_cycles: shortest.measured.0,
            cycle: shortest.at.0,
            channel: shortest.channel,
        }),
        violations: result.total(),
        by_channel: result.violations.iter().take(channels).copied().collect(),
    }
}

fn violation_row(violation: &Violation) -> ViolationRow {
    ViolationRow {
        cycle: violation.at.0,
        channel: violation.channel,
        rule: violation.rule.name(),
        measured_cycles: violation.measured.0,
        required_cycles: violation.required.0,
    }
}
