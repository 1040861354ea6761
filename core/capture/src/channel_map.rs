//! Maps channels of a capture to signals (DESIGN A3).
//!
//! ```text
//! STEP0=CH1,DIR0=#1,EN=!nEN      SIGNAL=CHANNEL; a channel has a name or a number (#0 is the first), ! inverts it
//! STEP0=A,STEP1=B,DIR0=C,DIR1=C  one DIR channel for several motors
//! DEDGE0=CH1,DIR0=CH2            a driver that steps on both edges
//! CW0=CH1,CCW0=CH2               one pulse input per direction
//! A0=CH1,B0=CH2                  a quadrature encoder: one count per edge
//! ```
//!
//! ```
//! use stepscope_capture::{ChannelMap, read::{Limits, read}};
//!
//! let dump = "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0!";
//! let capture = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true).capture;
//! let map = ChannelMap::parse("STEP0=#0", &capture).expect("there is a first channel");
//! assert_eq!((map.entries().len(), map.entries()[0].channel), (1, 0));
//! ```

use crate::capture::{Capture, Channel};
use crate::short_sort::ShortSort as _;
use core::fmt;
use stepscope_peripheral::signal::{self, Levels, MAX_CHANNELS};

/// Number of signals of a bus; larger bits are the inputs from which STEP and DIR are generated.
pub(crate) const BUS_SIGNALS: u32 = 36;
const MOTORS: u32 = MAX_CHANNELS as u32;
/// Channels named in an error.
const MAX_LISTED: usize = 20;

/// A signal that each motor has: STEP and DIR, or an input from which they are generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Input {
    Step,
    BothEdges,
    Cw,
    Ccw,
    A,
    B,
    Dir,
}

impl Input {
    const ALL: [Self; 7] = [Self::Step, Self::Dir, Self::BothEdges, Self::Cw, Self::Ccw, Self::A, Self::B];

    /// The name without the motor's number, and the bit of motor 0.
    const fn name_and_bit(self) -> (&'static str, u32) {
        match self {
            Self::Step => ("STEP", 0),
            Self::Dir => ("DIR", Levels::DIR_SHIFT),
            Self::BothEdges => ("DEDGE", BUS_SIGNALS),
            Self::Cw => ("CW", BUS_SIGNALS + MOTORS),
            Self::Ccw => ("CCW", BUS_SIGNALS + 2 * MOTORS),
            Self::A => ("A", BUS_SIGNALS + 3 * MOTORS),
            Self::B => ("B", BUS_SIGNALS + 4 * MOTORS),
        }
    }

    pub(crate) const fn bit(self, motor: u32) -> u32 {
        self.name_and_bit().1 + motor
    }

    /// The input and its motor.
    pub(crate) fn from_bit(bit: u32) -> Option<(Self, u32)> {
        let motor = |input: Self| bit.checked_sub(input.bit(0)).filter(|motor| *motor < MOTORS);
        Self::ALL.into_iter().find_map(|input| Some((input, motor(input)?)))
    }

    /// The other signal of a pair.
    const fn partner(self) -> Option<Self> {
        match self {
            Self::Cw => Some(Self::Ccw),
            Self::Ccw => Some(Self::Cw),
            Self::A => Some(Self::B),
            Self::B => Some(Self::A),
            Self::Step | Self::BothEdges | Self::Dir => None,
        }
    }
}

fn signal_name(bit: u32) -> String {
    match Input::from_bit(bit) {
        Some((input, motor)) => format!("{}{motor}", input.name_and_bit().0),
        None => signal::name(bit).unwrap_or_default(),
    }
}

/// The source of a motor's STEP pulses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PulseSource {
    /// A STEP channel.
    Step,
    /// A STEP channel with a step at each edge (DEDGE).
    BothEdges,
    /// One pulse input per direction, which also gives DIR.
    CwCcw,
    /// The edges of a quadrature encoder, whose phase gives DIR.
    Quadrature,
}

/// What the edges of a motor's STEP channel indicate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeHint {
    /// Number of the motor, from 0.
    pub motor: u8,
    pub channel: usize,
    /// Rising and falling edges are evenly spaced, as for a driver that steps on both edges.
    pub both_edges: bool,
    /// The channel idles high, with low pulses.
    pub idles_high: bool,
    /// Number of edges; `None` if there are more changes than were inspected.
    pub edges: Option<u64>,
}

/// A signal and its channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Bit of the signal: 0 to 15 STEP, 16 to 31 DIR, 32 EN, 33 RX, 34 TX, 35 DE. Above, 16 each: DEDGE, CW, CCW, A
    /// and B.
    pub bit: u32,
    pub channel: usize,
    /// Active low.
    pub inverted: bool,
}

impl Entry {
    pub(crate) const fn level(&self, channels: u64) -> bool {
        (channels >> self.channel & 1 == 1) != self.inverted
    }
}

/// Signals and their channels. Each is used once, but several motors may share a DIR channel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelMap {
    entries: Vec<Entry>,
}

/// Why a text is not a channel map.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MapError {
    /// An entry without `=`.
    NotAPair(String),
    /// Not a signal's name.
    UnknownSignal(String),
    /// No such channel; the second text lists the channels.
    UnknownChannel(String, String),
    /// Several channels have this name.
    AmbiguousChannel(String),
    /// The signal has two channels.
    DuplicateSignal(String),
    /// The channel already has a signal, the second text.
    ChannelInUse(String, String),
    /// The first signal requires the second one.
    MissingPartner(String, String),
    /// Two signals both give a motor's steps or direction.
    Conflict(String, String),
}

impl fmt::Display for MapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::NotAPair(given) => format!(
                "\"{given}\" is not a pair; use SIGNAL=CHANNEL, separated by commas, such as STEP0=CH1,DIR0=CH2"
            ),
            Self::UnknownSignal(given) => format!(
                "{given} is not a signal; use STEP0 to STEP15, DIR0 to DIR15, EN, RX, TX or DE, or instead of STEP0: DEDGE0 (a \
                 step at both edges), CW0 and CCW0, or A0 and B0 (an encoder)"
            ),
            Self::UnknownChannel(given, channels) => {
                format!("there is no channel {given}; use one of {channels}")
            }
            Self::AmbiguousChannel(given) => {
                format!("more than one channel is named {given}; use its number, #0 for the first")
            }
            Self::DuplicateSignal(signal) => format!("{signal} has two channels; remove one of them"),
            Self::ChannelInUse(channel, signal) => {
                format!("channel {channel} is already {signal}; only DIR signals can share a channel")
            }
            Self::MissingPartner(signal, partner) => {
                format!("{signal} requires {partner}; add {partner}=CHANNEL, or use STEP instead of {signal}")
            }
            Self::Conflict(signal, rival) => {
                format!("{signal} and {rival} cannot be used together; remove one of them")
            }
        };
        f.write_str(&text)
    }
}

impl core::error::Error for MapError {}

impl ChannelMap {
    pub(crate) fn from_entries(mut entries: Vec<Entry>) -> Self {
        entries.sort_short_by_key(|entry| match Input::from_bit(entry.bit) {
            Some((input, motor)) => (0, Some(input), motor),
            None => (1, None, entry.bit),
        });
        Self { entries }
    }

    /// Reads a map as [`Self::to_text`] writes it; ignores blanks and the case of signals.
    /// Errors: [`MapError`] of the first invalid pair.
    pub fn parse(text: &str, capture: &Capture) -> Result<Self, MapError> {
        let mut map = Self::default();
        for pair in text.split(',').map(str::trim).filter(|pair| !pair.is_empty()) {
            let (signal, channel) =
                pair.split_once('=').ok_or_else(|| MapError::NotAPair(pair.to_owned()))?;
            let signal = signal.trim().to_ascii_uppercase();
            let bit = (0..Input::B.bit(MOTORS))
                .find(|bit| signal_name(*bit) == signal)
                .ok_or_else(|| MapError::UnknownSignal(signal.clone()))?;
            let channel = channel.trim();
            let (inverted, name) = match channel.strip_prefix('!') {
                Some(name) => (true, name.trim()),
                None => (false, channel),
            };
            map.add(Entry { bit, channel: find_channel(name, &capture.channels)?, inverted }, capture)?;
        }
        map.check_motors()?;
        Ok(Self::from_entries(map.entries))
    }

    /// The channel names in a map's text, for files with more channels than are read.
    pub fn channel_names(text: &str) -> Vec<String> {
        let name = |pair: &str| {
            let (_, channel) = pair.split_once('=')?;
            Some(channel.trim().trim_start_matches('!').trim().to_owned())
        };
        text.split(',').filter_map(name).collect()
    }

    fn check_motors(&self) -> Result<(), MapError> {
        for entry in &self.entries {
            let Some((input, motor)) = Input::from_bit(entry.bit) else { continue };
            if let Some(partner) = input.partner().filter(|partner| !self.has(partner.bit(motor))) {
                return Err(MapError::MissingPartner(
                    signal_name(entry.bit),
                    signal_name(partner.bit(motor)),
                ));
            }
            let rivals: &[Input] = match input {
                Input::Step => &[Input::BothEdges, Input::Cw, Input::A],
                Input::BothEdges => &[Input::Cw, Input::A],
                Input::Cw => &[Input::A, Input::Dir],
                Input::A => &[Input::Dir],
                Input::Ccw | Input::B | Input::Dir => &[],
            };
            if let Some(rival) = rivals.iter().find(|rival| self.has(rival.bit(motor))) {
                return Err(MapError::Conflict(signal_name(entry.bit), signal_name(rival.bit(motor))));
            }
        }
        Ok(())
    }

    /// The same map with DEDGE instead of STEP.
    pub fn with_both_edges(self) -> Self {
        let both = |entry: Entry| match Input::from_bit(entry.bit) {
            Some((Input::Step, motor)) => Entry { bit: Input::BothEdges.bit(motor), ..entry },
            _ => entry,
        };
        Self::from_entries(self.entries.into_iter().map(both).collect())
    }

    /// The source of a motor's STEP pulses.
    pub fn pulse_source(&self, motor: u8) -> PulseSource {
        let has = |input: Input| self.has(input.bit(motor.into()));
        match () {
            () if has(Input::BothEdges) => PulseSource::BothEdges,
            () if has(Input::Cw) => PulseSource::CwCcw,
            () if has(Input::A) => PulseSource::Quadrature,
            () => PulseSource::Step,
        }
    }

    /// Whether pulses of a motor are generated from edges: DEDGE or an encoder.
    pub fn generates_pulses(&self) -> bool {
        let is_edge = |source| matches!(source, PulseSource::BothEdges | PulseSource::Quadrature);
        (0..self.bus_channels()).any(|motor| is_edge(self.pulse_source(motor)))
    }

    /// Whether a motor's direction is recorded.
    pub fn has_direction(&self, motor: u8) -> bool {
        self.has(Input::Dir.bit(motor.into()))
            || matches!(self.pulse_source(motor), PulseSource::CwCcw | PulseSource::Quadrature)
    }

    pub(crate) fn input(&self, input: Input, motor: u32) -> Option<Entry> {
        self.entries.iter().copied().find(|entry| entry.bit == input.bit(motor))
    }

    fn add(&mut self, entry: Entry, capture: &Capture) -> Result<(), MapError> {
        let is_dir = |entry: &Entry| matches!(Input::from_bit(entry.bit), Some((Input::Dir, _)));
        for other in &self.entries {
            let signal = signal_name(other.bit);
            if other.bit == entry.bit {
                return Err(MapError::DuplicateSignal(signal));
            }
            if other.channel == entry.channel && !(is_dir(other) && is_dir(&entry)) {
                let name = capture.channels.get(entry.channel).map(|channel| channel.name.clone());
                return Err(MapError::ChannelInUse(name.unwrap_or_default(), signal));
            }
        }
        self.entries.push(entry);
        Ok(())
    }

    /// The entries: sources of steps, then DIR, then the other signals.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Whether a signal, by its bit, has a channel.
    pub fn has(&self, bit: u32) -> bool {
        self.entries.iter().any(|entry| entry.bit == bit)
    }

    /// Channels of the bus up to the map's last motor; at least 1.
    pub fn bus_channels(&self) -> u8 {
        let motors = self.entries.iter().filter_map(|entry| Input::from_bit(entry.bit));
        motors.map(|(_, motor)| motor as u8 + 1).max().unwrap_or(1)
    }

    /// The map as text, for [`Self::parse`].
    pub fn to_text(&self, capture: &Capture) -> String {
        let pair = |entry: &Entry| {
            let signal = signal_name(entry.bit);
            let mark = if entry.inverted { "!" } else { "" };
            format!("{signal}={mark}{}", channel_text(entry.channel, &capture.channels))
        };
        self.entries.iter().map(pair).collect::<Vec<_>>().join(",")
    }
}

/// A channel's name, or `#` and its index if the name is ambiguous or could not be read back.
pub fn channel_text(index: usize, channels: &[Channel]) -> String {
    let name = channels.get(index).map_or("", |channel| channel.name.as_str());
    if find_channel(name, channels) == Ok(index) && !name.contains([',', '!']) && name.trim() == name {
        name.to_owned()
    } else {
        format!("#{index}")
    }
}

/// Finds a channel by its whole name, the last part of its name, or the index after `#`.
fn find_channel(name: &str, channels: &[Channel]) -> Result<usize, MapError> {
    let unknown = || {
        let names: Vec<&str> =
            channels.iter().take(MAX_LISTED).map(|channel| channel.name.as_str()).collect();
        let more = match channels.len() - names.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        MapError::UnknownChannel(name.to_owned(), names.join(", ") + &more)
    };
    if let Some(index) = name.strip_prefix('#').and_then(|digits| digits.parse::<usize>().ok()) {
        return if index < channels.len() { Ok(index) } else { Err(unknown()) };
    }
    let last_part = |full: &str| full.rsplit('.').next().map(str::to_owned).unwrap_or_default();
    let is_full_name = |full: &str| full == name;
    let is_last_part = |full: &str| last_part(full) == name;
    let is_last_part_in_any_case = |full: &str| last_part(full).eq_ignore_ascii_case(name);
    for is_match in [&is_full_name as &dyn Fn(&str) -> bool, &is_last_part, &is_last_part_in_any_case] {
        let mut found = channels.iter().enumerate().filter(|(_, channel)| is_match(&channel.name));
        match (found.next(), found.next()) {
            (Some((index, _)), None) => return Ok(index),
            (Some(_), Some(_)) => return Err(MapError::AmbiguousChannel(name.to_owned())),
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
    fn maps_are_parsed_and_invalid_ones_have_a_message() {
        let capture = capture(&["top.A", "top.B", "B", "C", "C"]);
        for (text, expected) in [
            ("STEP0=A, dir0 = !B", "STEP0=top.A,DIR0=!B"),
            ("EN=#4,STEP3=top.B", "STEP3=top.B,EN=#4"),
            ("", ""),
            ("DIR1=A,DIR0=A,STEP1=B,STEP0=#3", "STEP0=#3,STEP1=B,DIR0=top.A,DIR1=top.A"),
            ("dedge0=A,DIR0=!B", "DEDGE0=top.A,DIR0=!B"),
            ("CCW0=A,CW0=B,A15=#3,b15=#4", "CW0=B,CCW0=top.A,A15=#3,B15=#4"),
        ] {
            let map = ChannelMap::parse(text, &capture).expect("a map");
            assert_eq!(map.to_text(&capture), expected);
            assert_eq!(ChannelMap::parse(expected, &capture), Ok(map));
        }
        for (text, expected) in [
            ("STEP0", "\"STEP0\" is not a pair"),
            ("STEP16=A", "STEP16 is not a signal; use STEP0 to STEP15"),
            ("STEP0=D", "there is no channel D; use one of top.A, top.B, B, C, C"),
            ("STEP0=#5", "there is no channel #5"),
            ("STEP0=C", "more than one channel is named C; use its number"),
            ("STEP0=A,STEP0=B", "STEP0 has two channels"),
            ("STEP0=A,DIR0=A", "channel top.A is already STEP0; only DIR signals can share a channel"),
            ("DIR0=A,STEP1=A", "channel top.A is already DIR0"),
            ("CW0=A", "CW0 requires CCW0; add CCW0=CHANNEL"),
            ("B3=A", "B3 requires A3; add A3=CHANNEL"),
            ("STEP0=A,DEDGE0=B", "STEP0 and DEDGE0 cannot be used together; remove one of them"),
            ("CW0=A,CCW0=B,DIR0=#3", "CW0 and DIR0 cannot be used together"),
            ("A1=A,B1=B,STEP1=#3", "STEP1 and A1 cannot be used together"),
        ] {
            let error = ChannelMap::parse(text, &capture).expect_err("no map").to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn a_map_is_proposed_and_read_back() {
        use crate::{
            capture::{Capture, Channel, Format},
            channel_map::ChannelMap,
        };

        let mut capture = Capture::new(Format::Vcd);
        capture.channels = ["X_STEP", "X_DIR", "nEN"].map(|name| Channel { name: name.into() }).into();
        let map = ChannelMap::proposed(&capture);
        assert_eq!(map.to_text(&capture), "STEP0=X_STEP,DIR0=X_DIR,EN=!nEN");
        assert_eq!(ChannelMap::parse(&map.to_text(&capture), &capture), Ok(map));
    }
}
