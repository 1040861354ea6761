//! Runs the same commands under random line faults, one run per seed, and tallies the results.
//!
//! A seed always has the same faults and the same result; the order of seeds does not change the sum of tallies.
//!
//! ```
//! use stepscope_peripheral::config::Protocol;
//! use stepscope_sim::fault_sweep::{FaultSweep, Tally};
//!
//! let sweep = FaultSweep::new(FaultSweep::small(Protocol::Framed)).expect("no problems");
//! let mut sum = Tally::default();
//! for seed in 0..3 {
//!     sum += sweep.run(seed).expect("no problems");
//! }
//! assert_eq!((sum.seeds, sum.wrong_seeds), (3, 0)); // the framed protocol executes no wrong tick
//! ```

mod align;
mod tally;
mod watch;

pub use tally::Tally;

use crate::{Experiment, Run};
use crate::{framed_host::Progress, noise::Random};
use align::Alignment;
use alloc::{format, vec, vec::Vec};
use stepscope_motion::mechanics::Distance;
use stepscope_motion::moves::{Axis, Cosine, Move};
use stepscope_peripheral::config::{Bus, Protocol};
use stepscope_scenario::{Line, Motion, Noise, Problem, Problems, Scenario, Source, ValueError};
use watch::Watch;

/// Maximum noise rates, in the order of the fields: a frame of 30 bytes and its reply still pass once in ten attempts.
const MAX_PPM: [u64; KINDS] = [5_000, 20_000, 20_000, 20_000, 500_000, 200_000];
const KINDS: usize = 6;
/// Rates are the maximum divided by up to 2^OCTAVES.
const OCTAVES: u64 = 6;

/// Deviation from the host's rate, in thousandths, up to which receivers get all bytes.
pub const IN_REACH: u64 = 40;
/// Maximum deviation that is drawn. From 52 on no frame gets through.
const MAX_DEVIATION: u64 = 60;

/// The commands of a scenario under random line faults.
#[derive(Clone, Debug)]
pub struct FaultSweep {
    base: Scenario,
}

impl FaultSweep {
    /// Seeds replace the noise and the receiver rates of `base`. Errors: every problem, and a source without ticks.
    pub fn new(base: Scenario) -> Result<Self, Problems> {
        let experiment = Experiment::new(&base)?;
        if (0..experiment.controllers()).all(|index| experiment.ticks_of(index).is_empty()) {
            let detail = "the scenario has no ticks to disturb; use a source of kind motion or packets";
            return Err(Problem::new("source", ValueError::Conflict { detail }).into());
        }
        Ok(Self { base })
    }

    /// A small scenario: two motors turn in opposite directions for 40 ticks.
    pub fn small(protocol: Protocol) -> Scenario {
        let axis = |steps, ramp_s| {
            let cosine =
                Cosine { distance: Distance::Steps(steps), duration_s: 0.08, ramp_s, ..Cosine::default() };
            Axis { moves: vec![Move::Cosine(cosine)], ..Axis::default() }
        };
        let mut line = Line { protocol, ..Line::default() };
        line.host.max_attempts = u8::MAX;
        Scenario {
            bus: Bus { channels: 2, ..Bus::default() },
            line,
            source: Source::Motion(Motion {
                axes: vec![axis(400.0, 0.04), axis(-300.0, 0.02)],
                ..Motion::default()
            }),
            ..Scenario::default()
        }
    }

    pub fn scenario(&self, seed: u32) -> Scenario {
        // Noise uses the numbers below 2^32 itself.
        let mut random = Random::new(1 << 32 | u64::from(seed));
        let draw = random.below(10) as usize;
        let is_mixture = draw > KINDS;
        let mut rate = |kind: usize, max: u64| {
            let chosen = if is_mixture { random.below(2) == 0 } else { draw == kind };
            let max = if is_mixture { max / 2 } else { max };
            if chosen { max.max(1) >> random.below(OCTAVES) } else { 0 }
        };
        let rates: Vec<u32> = MAX_PPM.iter().enumerate().map(|(kind, &max)| rate(kind, max) as u32).collect();
        let rate = |kind: usize| rates.get(kind).copied().unwrap_or(0);
        let mut scenario = self.base.clone();
        scenario.title = format!("{} seed {seed}", scenario.title).trim_start().chars().take(120).collect();
        scenario.line.noise = Noise {
            seed,
            flipped_bits_ppm: rate(0),
            lost_bytes_ppm: rate(1),
            duplicated_bytes_ppm: rate(2),
            glitches_ppm: rate(3),
            lost_replies_ppm: rate(4),
            host_crashes_ppm: rate(5),
        };
        let clocks_differ = draw == KINDS || is_mixture && random.below(2) == 0;
        if clocks_differ {
            let baud = scenario.line.baud;
            scenario.line.receiver_baud = Some(deviating_rate(baud, &mut random));
            for controller in &mut scenario.controllers {
                controller.receiver_baud = Some(deviating_rate(baud, &mut random));
            }
        }
        scenario
    }

    /// Errors: a receiver rate with too short bits.
    pub fn run(&self, seed: u32) -> Result<Tally, Problems> {
        let scenario = self.scenario(seed);
        let experiment = Experiment::new(&scenario)?;
        let mut watches = vec![Watch::default(); experiment.controllers()];
        let run = experiment.run_each(&mut watches);
        Ok(tally(&scenario, &experiment, &run, &watches))
    }
}

fn deviating_rate(baud: u32, random: &mut Random) -> u32 {
    let max = if random.below(8) == 0 { MAX_DEVIATION } else { IN_REACH };
    let thousandths = 1000 - max + random.below(2 * max + 1);
    (u64::from(baud) * thousandths / 1000) as u32
}

fn in_reach(scenario: &Scenario) -> bool {
    let baud = u64::from(scenario.line.baud);
    let additional = scenario.controllers.iter().map(|controller| controller.receiver_baud);
    let mut rates = additional.chain([scenario.line.receiver_baud]).flatten();
    rates.all(|rate| u64::from(rate).abs_diff(baud) * 1000 <= IN_REACH * baud)
}

fn tally(scenario: &Scenario, experiment: &Experiment, run: &Run, watches: &[Watch]) -> Tally {
    let mut tally = Tally { seeds: 1, ..Tally::default() };
    for (index, (watch, config)) in watches.iter().zip(experiment.configs()).enumerate() {
        let channels = usize::from(config.channels());
        let commanded = experiment.ticks_of(index);
        let executed = watch.executed(channels);
        watch.count(&mut tally);
        tally.commanded += (commanded.len() / channels) as u64;
        tally.executed += (executed.len() / channels) as u64;
        // A framed host has a job per controller; on a raw line everything is sent.
        let reached = experiment.host_progress(run, index);
        let due = match reached {
            None | Some(Progress::Done) => commanded,
            Some(_) => commanded.get(..executed.len()).unwrap_or(commanded),
        };
        tally.unreached += ((commanded.len() - due.len()) / channels) as u64;
        match reached {
            Some(Progress::GivenUp(reason)) => tally.give_up(reason, in_reach(scenario)),
            Some(Progress::Done) | None => {}
            Some(_) => tally.cut += 1,
        }
        tally.add_alignment(&Alignment::of(due, &executed, channels));
        let positions = run.devices().nth(index).map(|device| device.positions()).unwrap_or_default();
        tally.position_error += align::distance(due, channels, positions);
    }
    match run.host() {
        Some(host) => tally.add_host(host.conversation().counts()),
        None => tally.frames += run.schedule().len() as u64,
    }
    tally.wrong_seeds = u64::from(tally.is_wrong());
    tally
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_seed_always_has_the_same_tally() {
        use crate::fault_sweep::FaultSweep;
        use stepscope_peripheral::config::Protocol;

        let sweep = FaultSweep::new(FaultSweep::small(Protocol::Framed)).expect("it commands ticks");
        assert_eq!(sweep.run(3), sweep.run(3));
    }
}
