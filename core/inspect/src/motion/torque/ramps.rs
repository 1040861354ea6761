//! Ramps with which a motor can follow a move of n steps in T (Song 2021; DESIGN B4).
//!
//! A short ramp needs torque to accelerate; a long one has a high rate, where torque is low: f_max = n/(T - t_s).

use crate::motion::torque::Machine;
use serde::Serialize;
use stepscope_motion::{Curve, Profile, bisection::border, curves::Cosine};

/// Ramps to try, and samples per ramp.
const TRIED: u32 = 512;
const SAMPLES: u32 = 128;

/// Ramps that a motor can follow, in s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ramps {
    /// f_s, the motor's maximum rate in steps/s; `None` without a limit.
    #[serde(rename = "greatest_rate")]
    pub max_rate: Option<f64>,
    /// T - n/f_s: the longest ramp below that rate; may exceed [`Self::room_s`].
    pub longest_s: Option<f64>,
    /// Even without ramps the rate exceeds f_s.
    pub too_fast: bool,
    /// The longest ramp of the move: half of its duration.
    pub room_s: f64,
    /// The widest range of ramps above 0 with enough torque and within the working rate.
    pub enough_s: Option<(f64, f64)>,
    /// If there is none: ramps with enough torque, but above the working rate.
    pub too_fast_s: Option<(f64, f64)>,
    /// Torque and rate suffice without ramps, except for the jump.
    pub without_ramps: bool,
}

impl Ramps {
    /// `None` unless the move has ramps of a shape.
    pub fn of(machine: &Machine, profile: &Profile) -> Option<Self> {
        match profile {
            Profile::Cosine(curve) => {
                let (steps, duration_s) = (curve.steps(), curve.duration_s());
                let of = |ramp_s| Cosine::new(steps, duration_s, ramp_s);
                Some(Self::with(machine, curve, |rate| curve.longest_ramp_s(rate), of))
            }
            Profile::Ramps(curve) => {
                let of = |ramp_s| curve.with_ramp_s(ramp_s);
                Some(Self::with(machine, curve, |rate| curve.longest_ramp_s(rate), of))
            }
            _ => None,
        }
    }

    fn with<C: Curve>(
        machine: &Machine,
        curve: &C,
        longest: impl Fn(f64) -> Option<f64>,
        of: impl Fn(f64) -> C,
    ) -> Self {
        let room_s = curve.duration_s() / 2.0;
        let max_rate = machine.max_rate();
        let longest_s = max_rate.and_then(longest);
        let torque = |ramp_s: f64| suffices(machine, &of(ramp_s), ramp_s);
        let enough = |ramp_s: f64| keeps_rate(machine, &of(ramp_s)) && torque(ramp_s);
        let too_fast = max_rate.is_some() && longest_s.is_none();
        let longest_tried_s =
            if too_fast { 0.0 } else { longest_s.map_or(room_s, |max| libm::fmin(max, room_s)) };
        let enough_s = widest(longest_tried_s, enough);
        Self {
            max_rate,
            longest_s,
            too_fast,
            room_s,
            enough_s,
            too_fast_s: if enough_s.is_none() { widest(room_s, torque) } else { None },
            without_ramps: enough(0.0),
        }
    }
}

fn keeps_rate(machine: &Machine, curve: &impl Curve) -> bool {
    let top = libm::fabs(curve.speed(curve.duration_s() / 2.0));
    machine.working_rate().is_none_or(|max| top <= max)
}

/// Checks acceleration and plateau; during deceleration the load helps.
fn suffices(machine: &Machine, curve: &impl Curve, ramp_s: f64) -> bool {
    // The last sample is just before the ramp's end, where a straight ramp still accelerates.
    let ramp = (0..=SAMPLES).map(|sample| ramp_s * (1.0 - 1e-9) * f64::from(sample) / f64::from(SAMPLES));
    ramp.chain([curve.duration_s() / 2.0]).all(|t| {
        let (speed, acceleration) = (curve.speed(t), curve.acceleration(t));
        machine.needed_mn_m(speed, acceleration) <= machine.available_mn_m(speed)
    })
}

/// The widest range of ramps that are `enough`, with bisected ends.
fn widest(room_s: f64, enough: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    if room_s <= 0.0 {
        return None;
    }
    let ramp = |index: u32| room_s * f64::from(index) / f64::from(TRIED);
    let (mut open, mut widest): (Option<u32>, Option<(u32, u32)>) = (None, None);
    for index in 1..=TRIED {
        if !enough(ramp(index)) {
            open = None;
            continue;
        }
        let first = *open.get_or_insert(index);
        if widest.is_none_or(|(from, to)| index - first > to - from) {
            widest = Some((first, index));
        }
    }
    let (first, last) = widest?;
    let end = |inside: u32, outside: u32| border(ramp(inside), ramp(outside), &enough).0;
    let longest = if last == TRIED { room_s } else { end(last, last + 1) };
    Some((end(first, first - 1), longest))
}
