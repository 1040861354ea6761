//! Which ramps of a move of n steps in T (DESIGN B4) a motor can follow. A short ramp needs much torque to
//! accelerate, a long one a high rate, where there is little:
//!
//! ```text
//! f_max = n/(T - t_s), so t_s <= T - n/f_s keeps it under f_s; the acceleration falls up to t_s = T/2
//! ```
//!
//! (For shapes that are not symmetric f_max has their area in it: `motion::ramp`.)

use crate::motion::torque::Machine;
use serde::Serialize;
use stepscope_motion::{Curve, Profile, bisection::border, cosine::Cosine};

/// Ramps that are tried, evenly from none to half of the time.
const TRIED: u32 = 512;
/// Times within a ramp that are looked at.
const LOOKS: u32 = 128;

/// Which ramps a motor can follow, in s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ramps {
    /// f_s: the greatest rate in steps/s that the motor can do with its load; `None` where nothing limits it.
    pub greatest_rate: Option<f64>,
    /// T - n/f_s: the longest ramp under that rate, which may be more than the move has room for; `None`
    /// where nothing limits it, or where even no ramp is too fast ([`Self::too_fast`]).
    pub longest_s: Option<f64>,
    /// Even at one rate throughout the move is faster than f_s: it needs more time.
    pub too_fast: bool,
    /// T/2: the longest ramp that the move has room for.
    pub room_s: f64,
    /// The shortest and the longest ramp above 0 with which the torque suffices throughout and the stated rate
    /// is kept; `None` where there is none.
    pub enough_s: Option<(f64, f64)>,
    /// Where there is none: those whose torque would suffice, all above the stated rate.
    pub too_fast_s: Option<(f64, f64)>,
    /// Without ramps the torque suffices at the one rate, and the stated rate is kept; the motor has to start
    /// and to stop at it at once.
    pub without_ramps: bool,
}

impl Ramps {
    /// Of a move of B4: a cosine, or ramps of another shape; `None` for any other.
    #[must_use]
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

    /// Of a move, its longest ramp under a rate, and the same move with a ramp of so many s.
    fn with<C: Curve>(
        machine: &Machine,
        curve: &C,
        longest: impl Fn(f64) -> Option<f64>,
        of: impl Fn(f64) -> C,
    ) -> Self {
        let room_s = curve.duration_s() / 2.0;
        let greatest_rate = machine.greatest_rate();
        let longest_s = greatest_rate.and_then(longest);
        let torque = |ramp_s: f64| suffices(machine, &of(ramp_s), ramp_s);
        let enough = |ramp_s: f64| keeps_rate(machine, &of(ramp_s)) && torque(ramp_s);
        let too_fast = greatest_rate.is_some() && longest_s.is_none();
        // Any longer one is too fast.
        let longest_tried_s =
            if too_fast { 0.0 } else { longest_s.map_or(room_s, |most| libm::fmin(most, room_s)) };
        let enough_s = widest(longest_tried_s, enough);
        Self {
            greatest_rate,
            longest_s,
            too_fast,
            room_s,
            enough_s,
            too_fast_s: if enough_s.is_none() { widest(room_s, torque) } else { None },
            without_ramps: enough(0.0),
        }
    }
}

/// Whether the stated rate, if there is one, is kept.
fn keeps_rate(machine: &Machine, curve: &impl Curve) -> bool {
    let top = libm::fabs(curve.speed(curve.duration_s() / 2.0));
    machine.working_rate().is_none_or(|most| top <= most)
}

/// Whether there is enough torque all the way up and on the plateau: on the way down the load helps.
fn suffices(machine: &Machine, curve: &impl Curve, ramp_s: f64) -> bool {
    // The last look is just before the ramp's end, where a straight ramp still accelerates.
    let ramp = (0..=LOOKS).map(|look| ramp_s * (1.0 - 1e-9) * f64::from(look) / f64::from(LOOKS));
    ramp.chain([curve.duration_s() / 2.0]).all(|t| {
        let (speed, acceleration) = (curve.speed(t), curve.acceleration(t));
        machine.needed_mn_m(speed, acceleration) <= machine.available_mn_m(speed)
    })
}

/// The longest run of ramps above 0 and up to `room_s` that are `enough`, its ends found by halving.
fn widest(room_s: f64, enough: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    if room_s <= 0.0 {
        return None;
    }
    let ramp = |index: u32| room_s * f64::from(index) / f64::from(TRIED);
    // The run that is open, and the widest so far: first and last index.
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
    // The end of the run between an index in it and the one beside it.
    let end = |inside: u32, outside: u32| border(ramp(inside), ramp(outside), &enough).0;
    let longest = if last == TRIED { room_s } else { end(last, last + 1) };
    Some((end(first, first - 1), longest))
}
