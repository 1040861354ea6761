//! Which channel of a capture is which signal of the bus.
//!
//! ```text
//! STEP0=CH1,DIR0=CH2,EN=!nEN     a signal, a channel by its name or its place (#0, #1, …), ! where it is inverted
//! ```
//!
//! ```
//! use stepscope_capture::{capture::{Capture, Channel, Format}, channel_map::ChannelMap};
//!
//! let mut capture = Capture::new(Format::Vcd);
//! capture.channels = ["X_STEP", "X_DIR", "nEN"].map(|name| Channel { name: name.into() }).into();
//! let map = ChannelMap::proposed(&capture);
//! assert_eq!(map.to_text(&capture), "STEP0=X_STEP,DIR0=X_DIR,EN=!nEN");
//! assert_eq!(ChannelMap::parse(&map.to_text(&capture), &capture), Ok(map));
//! ```

use crate::capture::{Capture, Channel};
use core::fmt;
use stepscope_peripheral::signal::{self, MAX_CHANNELS};

/// Bits of the signals (DESIGN A3).
pub(crate) const SIGNALS: u32 = 36;

/// A signal and the channel that it was recorded on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Bit of the signal (DESIGN A3): 0 to 15 STEP, 16 to 31 DIR, 32 EN, 33 RX, 34 TX, 35 DE.
    pub bit: u32,
    /// Index of the channel.
    pub channel: usize,
    /// Whether the channel has the other level, as an enable that is active low.
    pub inverted: bool,
}

/// Signals and their channels, by the signals' bits; each signal, and each channel, at most once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelMap {
    entries: Vec<Entry>,
}

/// Why a text is no map.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MapError {
    /// An entry without `=`.
    NoPair(String),
    /// No such signal.
    Signal(String),
    /// No such channel, and those that there are.
    Channel(String, String),
    /// More than one channel has this name.
    Ambiguous(String),
    /// A signal that has a channel already.
    Twice(String),
    /// A channel that is another signal already.
    Taken(String, String),
}

impl fmt::Display for MapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPair(given) => {
                write!(f, "\"{given}\" is no pair; write SIGNAL=CHANNEL, several with commas between")
            }
            Self::Signal(given) => {
                write!(f, "{given} is no signal; there are STEP0 to STEP15, DIR0 to DIR15, EN, RX, TX and DE")
            }
            Self::Channel(given, there) => write!(f, "there is no channel {given}; the file has {there}"),
            Self::Ambiguous(given) => {
                write!(f, "more than one channel is called {given}; write its place, #0 for the first")
            }
            Self::Twice(signal) => write!(f, "{signal} has two channels; give it one"),
            Self::Taken(channel, signal) => {
                write!(f, "channel {channel} is {signal} already; a channel is one signal")
            }
        }
    }
}

impl core::error::Error for MapError {}

impl ChannelMap {
    pub(crate) fn of(mut entries: Vec<Entry>) -> Self {
        entries.sort_unstable_by_key(|entry| entry.bit);
        Self { entries }
    }

    /// Reads a map as [`Self::to_text`] writes it; blanks and the case of signals do not count.
    ///
    /// # Errors
    /// [`MapError`] with what is wrong with the first pair that cannot be used.
    pub fn parse(text: &str, capture: &Capture) -> Result<Self, MapError> {
        let mut map = Self::default();
        for pair in text.split(',').map(str::trim).filter(|pair| !pair.is_empty()) {
            let (signal, channel) = pair.split_once('=').ok_or_else(|| MapError::NoPair(pair.to_owned()))?;
            let signal = signal.trim().to_ascii_uppercase();
            let bit = (0..SIGNALS)
                .find(|bit| signal::name(*bit).is_some_and(|name| name == signal))
                .ok_or_else(|| MapError::Signal(signal.clone()))?;
            let channel = channel.trim();
            let (inverted, name) = match channel.strip_prefix('!') {
                Some(name) => (true, name.trim()),
                None => (false, channel),
            };
            map.add(Entry { bit, channel: place(name, &capture.channels)?, inverted }, capture)?;
        }
        Ok(Self::of(map.entries))
    }

    fn add(&mut self, entry: Entry, capture: &Capture) -> Result<(), MapError> {
        for other in &self.entries {
            let signal = signal::name(other.bit).unwrap_or_default();
            if other.bit == entry.bit {
                return Err(MapError::Twice(signal));
            }
            if other.channel == entry.channel {
                return Err(MapError::Taken(capture.channels[entry.channel].name.clone(), signal));
            }
        }
        self.entries.push(entry);
        Ok(())
    }

    /// The pairs, by the signals' bits.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Whether a signal has a channel.
    #[must_use]
    pub fn has(&self, bit: u32) -> bool {
        self.entries.iter().any(|entry| entry.bit == bit)
    }

    /// Channels of the bus up to the last one that STEP or DIR has a channel for; at least 1.
    #[must_use]
    pub fn bus_channels(&self) -> u8 {
        let motor = self.entries.iter().map(|entry| entry.bit).filter(|bit| *bit < 2 * MAX_CHANNELS as u32);
        motor.map(|bit| bit as u8 % MAX_CHANNELS as u8 + 1).max().unwrap_or(1)
    }

    /// As [`Self::parse`] reads it.
    #[must_use]
    pub fn to_text(&self, capture: &Capture) -> String {
        let pair = |entry: &Entry| {
            let signal = signal::name(entry.bit).unwrap_or_default();
            let mark = if entry.inverted { "!" } else { "" };
            format!("{signal}={mark}{}", written(entry.channel, &capture.channels))
        };
        self.entries.iter().map(pair).collect::<Vec<_>>().join(",")
    }
}

/// A channel by its name, unless that is another's too or would not be read back; else by its place.
fn written(index: usize, channels: &[Channel]) -> String {
    let name = channels.get(index).map_or("", |channel| channel.name.as_str());
    if place(name, channels) == Ok(index) && !name.contains([',', '!']) && name.trim() == name {
        name.to_owned()
    } else {
        format!("#{index}")
    }
}

/// The channel of a name: the whole name; or its last part; or its place after `#`.
fn place(name: &str, channels: &[Channel]) -> Result<usize, MapError> {
    let unknown = || {
        let names: Vec<&str> = channels.iter().map(|channel| channel.name.as_str()).collect();
        MapError::Channel(name.to_owned(), names.join(", "))
    };
    if let Some(index) = name.strip_prefix('#').and_then(|digits| digits.parse::<usize>().ok()) {
        return if index < channels.len() { Ok(index) } else { Err(unknown()) };
    }
    let last = |channel: &Channel| channel.name.rsplit('.').next().map(str::to_owned).unwrap_or_default();
    let whole = |channel: &Channel| channel.name == name;
    let ends = |channel: &Channel| last(channel) == name;
    let loose = |channel: &Channel| last(channel).eq_ignore_ascii_case(name);
    for matches in [&whole as &dyn Fn(&Channel) -> bool, &ends, &loose] {
        let mut found = channels.iter().enumerate().filter(|(_, channel)| matches(channel));
        match (found.next(), found.next()) {
            (Some((index, _)), None) => return Ok(index),
            (Some(_), Some(_)) => return Err(MapError::Ambiguous(name.to_owned())),
            _ => {}
        }
    }
    Err(unknown())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::Format;

    fn capture(names: &[&str]) -> Capture {
        let channels = names.iter().map(|name| Channel { name: (*name).into() }).collect();
        Capture { channels, ..Capture::new(Format::Vcd) }
    }

    #[test]
    fn a_text_gives_each_signal_a_channel_or_says_what_is_wrong() {
        let capture = capture(&["top.A", "top.B", "B", "C", "C"]);
        for (text, expected) in [
            ("STEP0=A, dir0 = !B", "STEP0=top.A,DIR0=!B"),
            ("EN=#4,STEP3=top.B", "STEP3=top.B,EN=#4"),
            ("", ""),
        ] {
            let map = ChannelMap::parse(text, &capture).expect("a map");
            assert_eq!(map.to_text(&capture), expected);
            assert_eq!(ChannelMap::parse(expected, &capture), Ok(map));
        }
        for (text, expected) in [
            ("STEP0", "\"STEP0\" is no pair"),
            ("STEP16=A", "STEP16 is no signal; there are STEP0 to STEP15"),
            ("STEP0=D", "there is no channel D; the file has top.A, top.B, B, C, C"),
            ("STEP0=#5", "there is no channel #5"),
            ("STEP0=C", "more than one channel is called C; write its place"),
            ("STEP0=A,STEP0=B", "STEP0 has two channels"),
            ("STEP0=A,DIR0=A", "channel top.A is STEP0 already"),
        ] {
            let error = ChannelMap::parse(text, &capture).expect_err("no map").to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
