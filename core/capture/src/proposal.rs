//! Proposes a channel map: first from names, then from the levels of channels whose names are unknown.
//!
//! ```text
//! name       STEP and DIR of one axis (names.rs); a DIR without an axis belongs to all motors without a DIR
//! behavior   A, B   edges of two channels that alternate evenly
//!            RX     words of whole bits with a stop bit; inverted if the line idles low
//!            STEP   most pulses; additional motors have pulses of similar width
//!            DIR    few changes, with steps at both levels; preferably not while STEP is high
//! ```

mod behavior;
mod by_behavior;
mod by_name;
mod dir;
mod draft;
mod motor;
mod timing;

use crate::channel_map::{ChannelMap, Entry, Input};
use crate::{capture::Capture, names::Meaning};
use draft::Draft;
use motor::{Motor, Source};
use stepscope_peripheral::signal::MAX_CHANNELS;

impl ChannelMap {
    /// Proposes a map by names and levels. Signals that cannot be identified have no channel.
    ///
    /// ```
    /// use stepscope_capture::{Capture, ChannelMap, capture::{Channel, Format}};
    ///
    /// let channels = ["X_STEP", "X_DIR", "nEN"].map(|name| Channel { name: name.into() });
    /// let capture = Capture { channels: channels.into(), ..Capture::new(Format::Vcd) };
    /// assert_eq!(ChannelMap::proposed(&capture).to_text(&capture), "STEP0=X_STEP,DIR0=X_DIR,EN=!nEN");
    /// ```
    pub fn proposed(capture: &Capture) -> Self {
        propose(Draft::new(capture))
    }
}

fn propose(mut draft: Draft<'_>) -> ChannelMap {
    draft.bus_signals_by_name();
    draft.steps_by_name();
    draft.dirs_by_name();
    let named = draft.motors.len();
    draft.sort_motors();
    // Encoders first: at constant speed, their edges may fit a bit rate.
    draft.encoders_by_behavior();
    draft.lines_by_behavior();
    draft.steps_by_behavior();
    draft.dirs_by_behavior();
    draft.polarity();
    ChannelMap::from_entries(entries(&draft, named))
}

/// Numbers of the motors: those in the names of the first `named` motors if all are valid and rise, otherwise
/// consecutive ones. Motors beyond the maximum have none.
fn numbers(motors: &[Motor], named: usize) -> Vec<u32> {
    let number = |motor: &Motor| if motor.axis.is_empty() { Some(0) } else { motor.axis.parse::<u32>().ok() };
    let mut numbers: Vec<u32> = motors.iter().take(named).map_while(number).collect();
    let do_rise = numbers.windows(2).all(|pair| matches!(pair, [first, next] if first < next));
    let are_valid = numbers.iter().all(|number| *number < MAX_CHANNELS as u32);
    if numbers.len() < named || !do_rise || !are_valid {
        numbers.clear();
    }
    while numbers.len() < motors.len()
        && let Some(free) = (0..MAX_CHANNELS as u32).find(|number| !numbers.contains(number))
    {
        numbers.push(free);
    }
    numbers
}

fn entries(draft: &Draft<'_>, named: usize) -> Vec<Entry> {
    let mut entries = draft.bus_signals.clone();
    for (motor, number) in draft.motors.iter().zip(numbers(&draft.motors, named)) {
        let mut add = |input: Input, channel: usize, inverted: bool| {
            entries.push(Entry { bit: input.bit(number), channel, inverted });
        };
        let is_low = |channel: usize| {
            draft.behavior(channel).idles_high()
                || matches!(draft.meanings.get(channel), Some(Meaning::Signal(named)) if named.inverted)
        };
        match motor.source {
            Source::None => {}
            Source::Step(channel) => add(Input::Step, channel, motor.inverted),
            Source::CwCcw(cw, ccw) => {
                add(Input::Cw, cw, is_low(cw));
                add(Input::Ccw, ccw, is_low(ccw));
            }
            Source::Encoder(a, b) => {
                add(Input::A, a, false);
                add(Input::B, b, false);
            }
        }
        if let Some(channel) = motor.dir {
            add(Input::Dir, channel, false);
        }
    }
    entries
}

#[cfg(test)]
mod tests;
