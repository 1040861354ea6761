//! Generates STEP and DIR from other recorded signals: both edges of STEP, CW and CCW pulses, or an encoder.
//!
//! ```text
//! DEDGE  _____/-----------\______     CW    __/-\__/-\____________     A  __/-----\_____/--
//! STEP   _____/-\_________/-\____     CCW   ____________/-\__/-\__     B  _____/-----\_____
//!                                     STEP  __/-\__/-\__/-\__/-\__     four steps per period,
//!                                     DIR   ------------\________     DIR high where A leads
//! ```
//!
//! DIR changes in the cycle in which STEP rises. Pulses from both edges or from an encoder have no recorded width.

use crate::channel_map::{ChannelMap, Entry, Input, PulseSource};
use stepscope_peripheral::signal::MAX_CHANNELS;

#[derive(Clone, Debug)]
pub(crate) struct GeneratedPulses {
    motors: Vec<Motor>,
    dirs: u64,
    signals: u64,
    begun: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Steps {
    /// STEP signals that get a pulse.
    pub(crate) pulses: u64,
    /// Levels of recorded STEP pulses and of DIR.
    pub(crate) levels: u64,
    /// Steps whose direction is unknown.
    pub(crate) ambiguous: u32,
}

#[derive(Clone, Copy, Debug)]
struct Motor {
    source: PulseSource,
    one: Entry,
    other: Option<Entry>,
    step: u64,
    dir: u64,
    before: (bool, bool),
}

impl GeneratedPulses {
    pub(crate) fn new(map: &ChannelMap) -> Option<Self> {
        let motor = |motor: u8| {
            let source = map.pulses(motor);
            let (one, other) = match source {
                PulseSource::Step => return None,
                PulseSource::BothEdges => (Input::BothEdges, None),
                PulseSource::CwCcw => (Input::Cw, Some(Input::Ccw)),
                PulseSource::Quadrature => (Input::A, Some(Input::B)),
            };
            let entry = |input: Input| map.input(input, motor.into());
            Some(Motor {
                source,
                one: entry(one)?,
                other: other.and_then(entry),
                step: 1 << motor,
                dir: other.map_or(0, |_| 1 << Input::Dir.bit(motor.into())),
                before: (false, false),
            })
        };
        let motors: Vec<Motor> = (0..MAX_CHANNELS as u8).filter_map(motor).collect();
        let dirs = motors.iter().fold(0, |dirs, motor| dirs | motor.dir);
        let signals = motors.iter().fold(dirs, |signals, motor| signals | motor.step);
        (!motors.is_empty()).then_some(Self { motors, dirs, signals, begun: false })
    }

    pub(crate) const fn signals(&self) -> u64 {
        self.signals
    }

    pub(crate) fn take(&mut self, channels: u64) -> Steps {
        let mut steps = Steps::default();
        for motor in &mut self.motors {
            let now = (motor.one.level(channels), motor.other.is_some_and(|other| other.level(channels)));
            let before = core::mem::replace(&mut motor.before, now);
            if motor.source == PulseSource::CwCcw && (now.0 || now.1) {
                steps.levels |= motor.step;
            }
            if !self.begun {
                continue;
            }
            let right = match motor.source {
                PulseSource::Step => None,
                PulseSource::BothEdges => (before != now).then_some(true),
                PulseSource::CwCcw => {
                    let is_new = now.0 && now.1 && before != now;
                    steps.ambiguous += u32::from(is_new);
                    (before == (false, false) && now.0 != now.1).then_some(now.0)
                }
                PulseSource::Quadrature => match (phase(now) + 4 - phase(before)) % 4 {
                    1 => Some(true),
                    3 => Some(false),
                    2 => {
                        steps.ambiguous += 1;
                        None
                    }
                    _ => None,
                },
            };
            if let Some(right) = right {
                self.dirs = self.dirs & !motor.dir | if right { motor.dir } else { 0 };
                if motor.source != PulseSource::CwCcw {
                    steps.pulses |= motor.step;
                }
            }
        }
        self.begun = true;
        steps.levels |= self.dirs;
        steps
    }
}

/// The quarter of the encoder's period; A rises first.
const fn phase((a, b): (bool, bool)) -> u8 {
    match (a, b) {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    }
}
