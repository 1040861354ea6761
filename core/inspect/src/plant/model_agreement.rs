//! Compares the torque curve with the plant, and explains differences.
//!
//! The curve ([`torque`](crate::motion::torque)) does not include friction, ringing and jumps of speed. It assumes a sine
//! where a driver at its voltage limit makes a square wave.

use crate::motion::torque::{Demand, Machine};
use crate::plant::outcome::verdict;
use alloc::{format, string::String};
use stepscope_motion::grouped;
use stepscope_peripheral::signal::MAX_CHANNELS;
use stepscope_plant::measures::{MotorResult, PlantResult};
use stepscope_plant::parameters::{MotorModel, Setup};
use stepscope_plant::{Observer, Plant, Slip, stability::Natural};

/// Steps over which a rate is measured.
const STEPS: usize = 16;
/// Maximum gain of the driver's square wave over the curve's sine.
const SQUARE_WAVE: f64 = 1.28;
/// A rate in full steps/s up to this multiple of the natural frequency can resonate, with at most this many microsteps.
const RESONANCE: f64 = 1.5;
const RESONANT_MICROSTEPS: u16 = 4;
/// A slip up to this multiple of the maximum jump of speed is due to the jump.
const JUMPED: f64 = 2.0;
/// A bus below this part of the supply has sagged.
const SAG: f64 = 0.95;

/// The step rate at the first slip, per channel.
#[derive(Clone, Debug, Default)]
pub struct FirstSlips {
    channels: [Steps; MAX_CHANNELS],
}

#[derive(Clone, Copy, Debug, Default)]
struct Steps {
    cycles: [u64; STEPS],
    count: usize,
    interval: Option<f64>,
}

impl FirstSlips {
    /// The step rate in steps/s at the first slip of a channel.
    pub fn rate(&self, channel: usize, clock_hz: u32) -> Option<f64> {
        self.channels.get(channel)?.interval.map(|cycles| f64::from(clock_hz) / cycles)
    }
}

impl Observer for FirstSlips {
    #[inline(always)]
    fn point(&mut self, _: &Plant) {}

    fn slip(&mut self, channel: usize, _: Slip) {
        let Some(steps) = self.channels.get_mut(channel) else { return };
        let count = steps.count.min(STEPS);
        if steps.interval.is_some() || count < 2 {
            return;
        }
        let at = |step: usize| steps.cycles.get(step % STEPS).copied().unwrap_or_default();
        let cycles = at(steps.count - 1) - at(steps.count - count);
        steps.interval = Some(cycles as f64 / (count - 1) as f64);
    }

    fn steps(&mut self, cycle: u64, rises: u16, _: u16) {
        for (channel, steps) in self.channels.iter_mut().enumerate() {
            if rises >> channel & 1 != 0 {
                if let Some(slot) = steps.cycles.get_mut(steps.count % STEPS) {
                    *slot = cycle;
                }
                steps.count += 1;
            }
        }
    }
}

/// Comparison of the torque-speed curve with the plant.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    pub plant: String,
    /// Whether curve and plant agree; `None` where the run does not decide it.
    pub agrees: Option<bool>,
    pub why: Option<String>,
}

/// Compares the plant's motor with the curve. `overload` is the cycle in which a protection stopped the controller.
pub fn agreement(
    machine: &Machine,
    demand: &Demand,
    setup: &Setup,
    channel: usize,
    result: &PlantResult,
    overload: Option<u64>,
    slips: &FirstSlips,
) -> Agreement {
    let (Some(motor), Some(found)) = (setup.motors.get(channel), result.motors.get(channel)) else {
        let why = format!("the controller has no channel {channel}");
        return Agreement { plant: "not run".into(), agrees: None, why: Some(why) };
    };
    let clock_hz = setup.clock_hz;
    let plant = verdict(found, clock_hz, None);
    if let Some(cycle) = overload {
        let ms = cycle as f64 / f64::from(clock_hz) * 1e3;
        let why = format!("an overload stops the controller at {ms:.2} ms, which the curve does not include");
        return Agreement { plant, agrees: None, why: Some(why) };
    }
    let (enough, follows) = (demand.shortage_count == 0, found.slip_count == 0);
    let why = match (enough, follows) {
        (true, true) | (false, false) => None,
        (true, false) => {
            let rate = slips.rate(channel, clock_hz);
            Some(why_it_slips(machine, demand, motor, rate, (result.supply_v.min, setup.supply.supply_v)))
        }
        (false, true) => Some(why_it_follows(machine, demand, found)),
    };
    Agreement { plant, agrees: Some(enough == follows), why }
}

fn why_it_slips(
    machine: &Machine,
    demand: &Demand,
    motor: &MotorModel,
    rate: Option<f64>,
    (min_v, supply_v): (f64, f64),
) -> String {
    let rate = rate.unwrap_or(demand.jump);
    let full_steps = rate / f64::from(motor.microsteps);
    let natural = Natural::of(motor).frequency_hz;
    if motor.microsteps <= RESONANT_MICROSTEPS && full_steps <= RESONANCE * natural {
        return format!(
            "{full_steps:.0} full steps/s are near the rotor's natural frequency of {natural:.0} Hz: it resonates, which the curve \
             does not include; use more microsteps or another rate"
        );
    }
    if rate <= JUMPED * demand.jump {
        return format!(
            "the speed jumps by {} steps/s at once, which the curve does not include: compare it with the start-stop rate \
             (stepscope limits)",
            grouped(demand.jump)
        );
    }
    if min_v < SAG * supply_v {
        return format!("the bus falls to {min_v:.1} V, but the curve assumes {supply_v} V");
    }
    if machine.corner_rate().is_some_and(|corner| rate > corner) {
        return format!(
            "at {} steps/s, above the corner rate, the rotor's ringing is hardly damped, so it can lose steps below the curve, \
             which does not include ringing",
            grouped(rate)
        );
    }
    format!(
        "the curve does not include friction ({} mN*m and {} uN*m*s), detent torque, the bridge and the rotor's ringing; its minimum \
         margin is {:.1} mN*m",
        motor.friction_mn_m,
        motor.viscous_un_m_s,
        demand.min_margin.map_or(0.0, |min| min.margin_mn_m())
    )
}

fn why_it_follows(machine: &Machine, demand: &Demand, found: &MotorResult) -> String {
    let Some(worst) = demand.min_margin else { return String::new() };
    let needed = worst.needed_mn_m;
    let above = machine.corner_rate().is_some_and(|corner| worst.rate > corner);
    if above && needed.abs() <= SQUARE_WAVE * worst.available_mn_m {
        return format!(
            "above the corner rate the driver's square wave gives 5 to 28 % more torque than the curve's sine; only {:.0} % \
             are missing",
            100.0 * (needed.abs() / worst.available_mn_m - 1.0)
        );
    }
    if needed < 0.0 {
        return "the largest shortage is while the motor brakes; friction and losses help there, and the curve does not include them"
            .into();
    }
    let lasts: f64 = demand.shortages.iter().map(|short| (short.to_s - short.from_s) * short.times).sum();
    format!(
        "the shortage lasts {:.2} ms in total; the rotor is up to {:.2} full steps behind, but recovers before it loses \
         steps",
        1e3 * lasts,
        found.following_error.value.abs()
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::expect_used, reason = "a missing file or program fails the test")]

    use super::*;
    use stepscope_peripheral::trace::Digest;
    use stepscope_scenario::{Scenario, Source};
    use stepscope_sim::{Experiment, plant_run::PlantRun};

    /// The agreement of both models for axis 0.
    fn of(json: &str) -> Agreement {
        let scenario = Scenario::from_json(json).expect("reads");
        let experiment = Experiment::new(&scenario).unwrap_or_else(|problems| panic!("{problems:?}"));
        let Source::Motion(motion) = &scenario.source else { panic!("no motion") };
        let machine = Machine::of(&motion.axes[0]).expect("a motor");
        let demand = Demand::of(&machine, &experiment.plans()[0]);
        let mut run =
            PlantRun::new(&experiment, vec![(Digest::default(), FirstSlips::default())]).expect("a plant");
        run.finish();
        let (results, overload) = (run.results(), run.overload(0));
        let slips = run.into_parts().remove(0).1;
        let setup = &experiment.plants().expect("a plant").setups[0];
        agreement(&machine, &demand, setup, 0, &results[0], overload, &slips)
    }

    fn moved(moves: &str, motor: &str) -> String {
        format!(
            r#"{{"plant":{{}},"source":{{"motion":{{"engine":"segments","axes":[{{"moves":[{moves}],"motor":{motor}}}]}}}}}}"#
        )
    }

    #[test]
    fn different_results_are_explained() {
        let preset = |id: &str| -> String {
            let all = stepscope_scenario::presets::PLANT_PRESETS;
            all.iter().find(|preset| preset.id == id).expect("it is there").json.into()
        };
        let ramp = |top: u32, distance: u32| {
            format!(
                r#"{{"trapezoid":{{"distance":{{"steps":{distance}}},"start_speed":{{"steps_s":1000}},"method":"exact","top_speed":{{"steps_s":{top}}},"acceleration":{{"steps_s2":200000}}}}}}"#
            )
        };
        let rows: &[(String, Option<bool>, &str)] = &[
            (preset("song-2021-motor"), Some(true), ""),
            (preset("song-2021-stall"), Some(false), "at once, which the curve does not include"),
            (
                preset("resonance-full-steps"),
                Some(false),
                "232 full steps/s are near the rotor's natural frequency",
            ),
            // Both lack torque.
            (moved(&ramp(60_000, 60_000), r#"{"load_torque_mn_m":250}"#), Some(true), ""),
            // Above the corner: slightly above the curve for a short time, and far below it without a load.
            (
                moved(
                    &ramp(60_000, 12_000),
                    r#"{"load_torque_mn_m":225,"friction_mn_m":0,"viscous_un_m_s":0}"#,
                ),
                Some(false),
                "above the corner rate the driver's",
            ),
            (moved(&ramp(128_000, 200_000), "{}"), Some(false), "above the corner rate, the rotor's ringing"),
        ];
        for (json, agrees, why) in rows {
            let found = of(json);
            let text = found.why.clone().unwrap_or_default();
            assert_eq!((found.agrees, text.is_empty()), (*agrees, why.is_empty()), "{json}\n{found:?}");
            assert!(text.contains(why), "{text}");
        }
    }
}
