//! Random valid cases from a seed: slow clocks, short waits, many inputs; short enough for many cases.
//!
//! A script is drawn in two steps: a story of presses in meaningful sequences, and after its run entries in
//! cycles in which something happens in that run.

mod aim;
mod programs;
mod script;
mod setup;

use super::parameters::{Case, Controller, Group, Initial};
use super::refusals::refused;
use super::run::{Outcome, run_up_to};
use script::Script;

/// Longer runs get `run_cycles`.
const MAX_CYCLES: u64 = 1_000_000;
/// So do runs with more cycles that cannot be skipped.
const MAX_STEPS: u64 = 60_000;

/// SplitMix64.
#[derive(Debug, Clone)]
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

/// A valid case.
pub fn random_case(seed: u64) -> Case {
    let mut dice = Dice(SplitMix64(seed ^ 0x57E9_5C09_E000_0000));
    loop {
        let case = dice.case();
        if refused(&case).is_empty() {
            return case;
        }
    }
}

/// Draws random values.
struct Dice(SplitMix64);

impl Dice {
    /// 0..n; 0 if n is 0.
    fn below(&mut self, n: u64) -> u64 {
        self.0.bits() % n.max(1)
    }

    /// min..=max.
    fn between(&mut self, least: u64, most: u64) -> u64 {
        least + self.below(most.saturating_sub(least) + 1)
    }

    /// min..=max.
    fn whole(&mut self, least: i64, most: i64) -> i64 {
        least + self.below((most - least).max(0) as u64 + 1) as i64
    }

    fn chance(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }

    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u64) as usize].clone()
    }

    /// Equally likely in each doubling.
    fn doublings(&mut self, least: u64, most: u64) -> u64 {
        let mut value = least;
        for _ in 0..self.below(64 - u64::from((most / least).leading_zeros())) {
            value *= 2;
        }
        self.between(value, most.min(2 * value))
    }

    fn case(&mut self) -> Case {
        let clock_hz = self.doublings(1000, 200_000);
        let w = self.pick(&[1, 1, 2, 3, 5, 8]);
        let d = self.pick(&[0, 0, 1, 2, 6]);
        let h = self.pick(&[0, 0, 1, 3, 7]);
        let controllers = self.pick(&[1, 1, 1, 1, 1, 2, 2, 3]);
        let mut case = Case {
            clock_hz,
            channels: (controllers + self.below(3)).min(16) as usize,
            w,
            d,
            h,
            run_cycles: None,
            controllers: Vec::new(),
        };
        let mut scripts = Vec::new();
        for index in 0..controllers as usize {
            let controller = self.controller(&case);
            let mut script = Script::new(index == 0, &case, &controller);
            self.tell(&mut script, &controller);
            case.controllers.push(controller);
            scripts.push(script);
        }
        self.write(&mut case, &scripts);
        if self.chance(70)
            && let Some(outcome) = self.outcome(&mut case)
        {
            self.aim(&mut scripts, &case, &outcome);
            self.write(&mut case, &scripts);
        }
        let _ = self.outcome(&mut case);
        if case.run_cycles.is_none() && self.chance(20) {
            case.run_cycles = Some(self.doublings(100, 200_000));
        }
        case
    }

    fn write(&mut self, case: &mut Case, scripts: &[Script]) {
        for (controller, script) in case.controllers.iter_mut().zip(scripts) {
            controller.inputs = script.entries();
            // In any order.
            if self.chance(20) && controller.inputs.len() > 1 {
                let at = self.below(controller.inputs.len() as u64) as usize;
                controller.inputs.rotate_left(at);
            }
        }
    }

    /// The run; one that is too long gets an end.
    fn outcome(&mut self, case: &mut Case) -> Option<Outcome> {
        let outcome = run_up_to(case, MAX_CYCLES, MAX_STEPS);
        if outcome.is_some() {
            return outcome;
        }
        case.run_cycles = Some(self.doublings(10_000, 300_000));
        run_up_to(case, MAX_CYCLES, MAX_CYCLES)
    }

    /// A controller's memory at reset: journal and banks made by the encoder, sometimes damaged.
    fn initial(&mut self, controller: &Controller) -> Initial {
        match self.below(10) {
            0 | 1 => Initial::Blank,
            2..=5 => Initial::Factory,
            _ => Initial::Bytes(self.memory_bytes(controller)),
        }
    }
}

/// Whether a program has a `home`.
fn homes(groups: &[Group]) -> bool {
    groups.contains(&Group::Home)
}
