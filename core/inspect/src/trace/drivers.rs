//! Drivers and the timing that their data sheets require.
//!
//! Values are minimum times in ns, at the slowest clock that the data sheet allows. [`DataSheet::source`] names values
//! that no data sheet confirms.

use crate::trace::timing::TimingCheck;
use stepscope_scenario::{DriverModel, DriverTiming, Scenario, TimingRules};

/// A driver's timing rules, with their source.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSheet {
    pub model: DriverModel,
    pub id: &'static str,
    pub name: &'static str,
    /// The data sheet, and the values it does not confirm.
    pub source: &'static str,
    pub rules: TimingRules,
}

/// Minima in ns: STEP high and low, set-up and hold of DIR, wake-up from EN.
const fn times(
    [step_high_ns, step_low_ns, dir_setup_ns, dir_hold_ns, enable_wake_ns]: [u32; 5],
) -> TimingRules {
    TimingRules { step_high_ns, step_low_ns, dir_setup_ns, dir_hold_ns, enable_wake_ns }
}

pub const DRIVERS: [&DataSheet; 6] = [&A4988, &A4979, &DRV8825, &TMC2209, &TMC262, &TB6600_CLASS];

/// Allegro A4988, data sheet 4988-DS, "Logic interface timing": t_A and t_B 1 us, t_C and t_D 200 ns. No
/// minimum time from ENABLE to STEP is specified; 1 ms is the wake-up from SLEEP.
pub const A4988: DataSheet = DataSheet {
    model: DriverModel::A4988,
    id: "a4988",
    name: "Allegro A4988",
    source: "data sheet 4988-DS: t_A, t_B, t_C, t_D; no minimum time from ENABLE to STEP is specified (1 ms from SLEEP)",
    rules: times([1000, 1000, 200, 200, 0]),
};

/// Allegro A4979: STEP high 1 us (Zephyr's binding). Other times are the A4988's, **not confirmed** by its data sheet.
pub const A4979: DataSheet = DataSheet {
    model: DriverModel::A4979,
    id: "a4979",
    name: "Allegro A4979",
    source: "only STEP high is confirmed (Zephyr's binding); the other times are the A4988's: check your sheet",
    rules: A4988.rules,
};

/// Texas Instruments DRV8825, SLVSA73, "Timing requirements": t_WH(STEP) and t_WL(STEP) 1.9 us, t_SU(STEP), t_H(STEP)
/// and t_ENBL 650 ns. t_WAKE, 1.7 ms, is from nSLEEP.
pub const DRV8825: DataSheet = DataSheet {
    model: DriverModel::Drv8825,
    id: "drv8825",
    name: "Texas Instruments DRV8825",
    source: "data sheet SLVSA73: t_WH, t_WL, t_SU, t_H, t_ENBL (1.7 ms from nSLEEP)",
    rules: times([1900, 1900, 650, 650, 650]),
};

/// Trinamic TMC2209, data sheet revision 1.09, "STEP/DIR interface": t_SH and t_SL max(t_FILTSD, t_CLK + 20 ns), t_DSU
/// and t_DSH 20 ns. Its oscillator has at least 11.5 MHz, so 87 + 20 ns; 270 ns at 4 MHz. No
/// minimum time from ENN to STEP is specified.
pub const TMC2209: DataSheet = DataSheet {
    model: DriverModel::Tmc2209,
    id: "tmc2209",
    name: "Trinamic TMC2209",
    source: "data sheet rev. 1.09: t_SH, t_SL = t_CLK + 20 ns at 11.5 MHz, the minimum of its oscillator; \
             t_DSU, t_DSH; no minimum time from ENN to STEP is specified",
    rules: times([107, 107, 20, 20, 0]),
};

/// Trinamic TMC262: TMC2100 formula, t_CLK + 20 ns, with the TMC2660's minimum clock of 10 MHz; **not confirmed** by its
/// data sheet.
pub const TMC262: DataSheet = DataSheet {
    model: DriverModel::Tmc262,
    id: "tmc262",
    name: "Trinamic TMC262",
    source: "TMC2100 formula, t_CLK + 20 ns, with the TMC2660's minimum clock of 10 MHz; not confirmed by the \
             TMC262's data sheet: check your sheet",
    rules: times([120, 120, 20, 20, 0]),
};

/// Opto-isolated drivers such as TB6600 boxes, DM542, DM556, AM882, after the Leadshine AM882 manual: pulse high and
/// low 2.5 us, DIR 5 us before the pulse, ENA 5 us before DIR. No hold time. Models differ: **check your driver's
/// sheet**.
pub const TB6600_CLASS: DataSheet = DataSheet {
    model: DriverModel::Tb6600Class,
    id: "tb6600_class",
    name: "Opto-isolated, class of TB6600, DM542, AM882",
    source: "class figures (Leadshine AM882 manual, t1 to t4), ENA 5 us before DIR and DIR 5 us \
             before PUL; models differ: check your driver's sheet",
    rules: times([2500, 2500, 5000, 0, 10_000]),
};

pub fn sheet(model: DriverModel) -> &'static DataSheet {
    DRIVERS.into_iter().find(|sheet| sheet.model == model).unwrap_or(&A4988)
}

/// The check that a scenario requests; it lists at most `max_listed` violations.
pub fn check(scenario: &Scenario, max_listed: usize) -> Option<TimingCheck> {
    let rules = scenario.driver_timing.as_ref().map(rules)?;
    Some(TimingCheck::new(&rules, scenario.clock_hz, max_listed))
}

/// The minimum times of a scenario's driver.
pub fn rules(driver: &DriverTiming) -> TimingRules {
    match driver {
        DriverTiming::Preset(model) => sheet(*model).rules.clone(),
        DriverTiming::Rules(rules) => rules.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_scenario::{Compact, Scenario};

    #[test]
    fn every_driver_is_found_by_its_id() {
        for listed in DRIVERS {
            assert_eq!(sheet(listed.model), listed);
            assert_eq!(listed.model.compact(), listed.id);
            let json = alloc::format!(r#"{{"driver":{{"preset":"{}"}}}}"#, listed.id);
            let scenario = Scenario::from_json(&json).expect("reads");
            assert_eq!(scenario.driver_timing.as_ref().map(rules), Some(listed.rules.clone()));
            let own = Scenario {
                driver_timing: Some(DriverTiming::Rules(listed.rules.clone())),
                ..Scenario::default()
            };
            assert!(own.check().is_ok(), "{} exceeds the range of a rule", listed.id);
        }
    }

    #[test]
    fn only_slow_drivers_need_pulses_over_1_us() {
        let slow = DRIVERS.iter().filter(|sheet| sheet.rules.step_high_ns > 1000).map(|sheet| sheet.id);
        assert_eq!(slow.collect::<Vec<_>>(), ["drv8825", "tb6600_class"]);
    }
}
