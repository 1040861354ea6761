//! Proposes a channel map: first from names, then from the levels of channels whose names are unknown.
//!
//! ```text
//! name       STEP and DIR of one motor belong together (names.rs); one DIR without an axis is that of all motors without
//! behavior   A, B   edges of two channels alternate, evenly
//!            RX     pulses are whole bits of words with a stop bit; inverted where the line is low when idle
//!            STEP   the most pulses; more motors have pulses of about this width
//!            DIR    changes seldom: at both levels there are steps, and not while STEP is high, where one does so
//! ```

mod behavior;
mod by_behavior;
mod by_name;
mod dir;
mod draft;
mod motor;
mod timing;

use crate::{
    capture::Capture,
    channel_map::{ChannelMap, Entry, Input},
    names::Meaning,
};
use draft::Draft;
use motor::{Motor, Source};
use std::collections::BTreeSet;
use stepscope_peripheral::signal::MAX_CHANNELS;

impl ChannelMap {
    /// The map that names and levels suggest; signals without evidence have no channel.
    #[must_use]
    pub fn proposed(capture: &Capture) -> Self {
        propose(Draft::new(capture))
    }
}

fn propose(mut draft: Draft<'_>) -> ChannelMap {
    draft.others_by_name();
    draft.steps_by_name();
    draft.dirs_by_name();
    let named = draft.motors.len();
    draft.sort_motors();
    // Encoders come first: a bit rate may fit one at constant speed.
    draft.encoders_by_behavior();
    draft.lines_by_behavior();
    draft.steps_by_behavior();
    draft.dirs_by_behavior();
    draft.polarity();
    entries(&draft, named)
}

fn entries(draft: &Draft<'_>, named: usize) -> ChannelMap {
    let number = |motor: &Motor| if motor.axis.is_empty() { Ok(0) } else { motor.axis.parse::<u32>() };
    let numbers: Vec<u32> = draft.motors.iter().take(named).filter_map(|motor| number(motor).ok()).collect();
    let is_distinct = numbers.windows(2).all(|pair| matches!(pair, [one, next] if one < next));
    let keep =
        numbers.len() == named && is_distinct && numbers.iter().all(|number| *number < MAX_CHANNELS as u32);
    let mut taken = BTreeSet::new();
    let mut entries = draft.others.clone();
    for (at, motor) in draft.motors.iter().enumerate() {
        let own = numbers.get(at).copied().filter(|_| keep && at < named);
        let Some(place) = own.or_else(|| (0..MAX_CHANNELS as u32).find(|place| !taken.contains(place)))
        else {
            break;
        };
        taken.insert(place);
        let mut add = |input: Input, channel: usize, inverted: bool| {
            entries.push(Entry { bit: input.bit(place), channel, inverted });
        };
        let is_low = |channel: usize| {
            draft.behavior(channel).idles_high()
                || matches!(draft.meanings.get(channel), Some(Meaning::Signal(named)) if named.inverted)
        };
        match motor.source {
            Source::None => {}
            Source::Step(channel) => add(Input::Step, channel, motor.inverted),
            Source::CwCcw(one, other) => {
                add(Input::Cw, one, is_low(one));
                add(Input::Ccw, other, is_low(other));
            }
            Source::Encoder(one, other) => {
                add(Input::A, one, false);
                add(Input::B, other, false);
            }
        }
        if let Some(channel) = motor.dir {
            add(Input::Dir, channel, false);
        }
    }
    ChannelMap::of(entries)
}

#[cfg(test)]
mod tests;
