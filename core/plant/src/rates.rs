//! Searches for a motor's limits: start-stop rate, pull-out rate, resonance (PLANT F8). Each trial is a plant with one
//! motor and its own edges.
//!
//! ```text
//! start-stop   | | | | | |            steps at one rate, then 0.2 s of rest
//! pull-out     |   |  | ||||||||||    s(t) = a*t^2/2 up to the rate, then 0.1 s of it
//! resonance    | | | | | | | | |      0.6 s of one rate; the second half is measured
//! ```
//!
//! ```
//! use stepscope_plant::{parameters::{MotorModel, Setup}, rates::{search, starts}};
//!
//! let setup = Setup { motors: vec![MotorModel::default()], ..Setup::default() };
//! let found = search(|rate| starts(&setup, rate, 3200)).expect("a plant");
//! assert!((found.expect("it starts") - 34_700.0).abs() < 400.0);
//! ```

use crate::plant::{Observer, Plant};
use crate::{parameters::Setup, refusal::Refused, root::square_root};
use alloc::vec::Vec;
use stepscope_peripheral::signal::{Levels, Record};
use stepscope_peripheral::units::Instant;

const FIRST_STEP: u64 = 1600;
/// Rest after a start-stop trial, in s.
const REST_S: f64 = 0.2;
/// Time at the end rate of a ramp, in s.
const HOLD_S: f64 = 0.1;
/// Default acceleration of a ramp in steps/s^2.
pub const RAMP_STEPS_S2: f64 = 200_000.0;
/// Time per rate of the resonance map, in s.
pub const RESONANCE_S: f64 = 0.6;

// Rates in steps/s.
const FIRST_RATE: f64 = 4000.0;
const MIN_RATE: f64 = 500.0;
const MAX_RATE: f64 = 5e6;
/// The search ends when the lowest failing rate is at most this factor above the highest passing one.
const PRECISION: f64 = 1.002;

/// A search for the highest rate that holds: doubled until one fails, then bisected geometrically.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Search {
    holds: Option<f64>,
    fails: Option<f64>,
}

impl Search {
    /// The next rate to try in steps/s; `None` at the end.
    pub fn rate(&self) -> Option<f64> {
        match (self.holds, self.fails) {
            (None, None) => Some(FIRST_RATE),
            (None, Some(fails)) => (fails > MIN_RATE).then_some(MIN_RATE),
            (Some(holds), None) => (holds < MAX_RATE).then_some(2.0 * holds),
            (Some(holds), Some(fails)) => (fails > PRECISION * holds).then(|| square_root(holds * fails)),
        }
    }

    /// Reports whether the rate of [`Self::rate`] holds.
    pub fn report(&mut self, holds: bool) {
        let Some(rate) = self.rate() else { return };
        if holds {
            self.holds = Some(rate);
        } else {
            self.fails = Some(rate);
        }
    }

    /// The highest rate that held in steps/s; `None` if not even 500 did.
    pub const fn found(&self) -> Option<f64> {
        self.holds
    }

    /// Progress of the search, 0..=1.
    pub fn progress(&self) -> f64 {
        match (self.holds, self.fails) {
            // A factor of two needs nine to ten bisections.
            (Some(holds), Some(fails)) => (0.3 + 0.7 * (1.0 - (fails / holds - 1.0) / 7.0)).clamp(0.3, 1.0),
            _ => 0.1,
        }
    }
}

/// The highest rate that holds in steps/s; `None` if not even 500 does.
/// Errors: the first error of a trial.
pub fn search<E>(mut holds: impl FnMut(f64) -> Result<bool, E>) -> Result<Option<f64>, E> {
    let mut search = Search::default();
    while let Some(rate) = search.rate() {
        search.report(holds(rate)?);
    }
    Ok(search.found())
}

/// Cycles of the rises of STEP at a constant rate in steps/s: the k-th is round(k*clock_hz/rate) cycles after the first.
pub fn even(clock_hz: u32, rate: f64, steps: u64) -> impl Iterator<Item = u64> {
    let cycles = f64::from(clock_hz);
    (0..steps).map(move |k| FIRST_STEP + (k as f64 * cycles / rate + 0.5) as u64)
}

/// Cycles of the rises of STEP on a ramp of `a` steps/s^2 to a rate that is held for `hold_s`: step k where s(t) = k - 1/2.
pub fn ramp(clock_hz: u32, rate: f64, a: f64, hold_s: f64) -> impl Iterator<Item = u64> {
    let (cycles, ramp_s) = (f64::from(clock_hz), rate / a);
    let ramp_steps = 0.5 * a * ramp_s * ramp_s;
    (0_u64..)
        .map(move |k| {
            let s = k as f64 + 0.5;
            if s <= ramp_steps { square_root(2.0 * s / a) } else { ramp_s + (s - ramp_steps) / rate }
        })
        .take_while(move |&t| t <= ramp_s + hold_s)
        .map(move |t| FIRST_STEP + (t * cycles + 0.5) as u64)
}

/// Runs a plant with these rises of STEP to the right, and `after` cycles after the last.
fn trial<O: Observer>(
    setup: &Setup,
    rises: impl Iterator<Item = u64>,
    after: u64,
    observer: &mut O,
) -> Result<Plant, Vec<Refused>> {
    let mut plant = Plant::new(setup)?;
    let right = Levels(Levels::RESET.0 | 1 << Levels::DIR_SHIFT);
    let high = Levels(right.0 | 1);
    let mut last = 0;
    for rise in rises {
        if rise > last + 1 {
            // The plant ignores falling edges, so any cycle before the next rise will do.
            plant.record(Record { cycle: Instant(last + 1), levels: right }, observer);
        }
        plant.record(Record { cycle: Instant(rise), levels: high }, observer);
        plant.record(Record { cycle: Instant(rise), levels: right }, observer);
        last = rise;
    }
    plant.advance(last + after, observer);
    Ok(plant)
}

fn cycles_of(setup: &Setup, seconds: f64) -> u64 {
    (f64::from(setup.clock_hz) * seconds + 0.5) as u64
}

/// Whether the motor of channel 0 makes `steps` at a constant rate from rest and stops at the commanded position.
/// Errors: the plant refuses the setup.
pub fn starts(setup: &Setup, rate: f64, steps: u64) -> Result<bool, Vec<Refused>> {
    let mut slipped = Slipped::default();
    let after = cycles_of(setup, REST_S);
    let plant = trial(setup, even(setup.clock_hz, rate, steps), after, &mut slipped)?;
    let error = plant.command(0) - plant.state(0).map_or(0.0, |state| state.x);
    Ok(!slipped.has_slipped && error.abs() < 1.0)
}

/// Whether the motor of channel 0 follows a ramp of `a` steps/s^2 to a rate, and holds this rate.
/// Errors: the plant refuses the setup.
pub fn pulls(setup: &Setup, rate: f64, a: f64) -> Result<bool, Vec<Refused>> {
    let mut slipped = Slipped::default();
    trial(setup, ramp(setup.clock_hz, rate, a, HOLD_S), 0, &mut slipped)?;
    Ok(!slipped.has_slipped)
}

/// Oscillation of a motor at one rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Peak-to-peak value of rate*t - x in the second half, in full steps.
    pub peak_to_peak: f64,
    pub loses_steps: bool,
}

/// Runs the motor of channel 0 at a constant rate in steps/s for 0.6 s.
/// Errors: the plant refuses the setup.
pub fn resonance(setup: &Setup, rate: f64) -> Result<Resonance, Vec<Refused>> {
    let microsteps = setup.motors.first().map_or(1.0, |motor| f64::from(motor.microsteps));
    // Steps continue to the end, so that the motor does not stop before.
    let steps = (rate * RESONANCE_S) as u64 + 1;
    let from = FIRST_STEP + cycles_of(setup, 0.5 * RESONANCE_S);
    let to = FIRST_STEP + cycles_of(setup, RESONANCE_S);
    let mut observer = Oscillation {
        per_cycle: rate / microsteps / f64::from(setup.clock_hz),
        from,
        to,
        ..Oscillation::default()
    };
    let rises = || even(setup.clock_hz, rate, steps).take_while(|&rise| rise < to);
    let last = rises().last().unwrap_or(FIRST_STEP);
    trial(setup, rises(), to.saturating_sub(last), &mut observer)?;
    Ok(Resonance {
        peak_to_peak: (observer.max - observer.min).max(0.0),
        loses_steps: observer.slipped.has_slipped,
    })
}

#[derive(Default)]
struct Slipped {
    has_slipped: bool,
}

impl Observer for Slipped {
    fn point(&mut self, _: &Plant) {}

    fn slip(&mut self, _: usize, _: crate::Slip) {
        self.has_slipped = true;
    }
}

/// Measures rate*t - x within a range of cycles.
struct Oscillation {
    per_cycle: f64,
    from: u64,
    to: u64,
    min: f64,
    max: f64,
    slipped: Slipped,
}

impl Default for Oscillation {
    fn default() -> Self {
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { per_cycle: 0.0, from: 0, to: 0, min, max, slipped: Slipped::default() }
    }
}

impl Observer for Oscillation {
    fn point(&mut self, plant: &Plant) {
        let cycle = plant.cycle();
        if let Some(state) = plant.state(0).filter(|_| cycle > self.from && cycle <= self.to) {
            let error = (cycle - FIRST_STEP) as f64 * self.per_cycle - state.x;
            self.min = self.min.min(error);
            self.max = self.max.max(error);
        }
    }

    fn slip(&mut self, channel: usize, slip: crate::Slip) {
        self.slipped.slip(channel, slip);
    }
}
