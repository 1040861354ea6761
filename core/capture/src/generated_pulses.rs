//! Generates STEP and DIR from other recorded signals: both edges of STEP, CW and CCW pulses, or an encoder.
//!
//! ```text
//! DEDGE  _____/-----------\______     CW    __/-\__/-\____________     A  __/-----\_____/--
//! STEP   _____/-\_________/-\____     CCW   ____________/-\__/-\__     B  _____/-----\_____
//!                                     STEP  __/-\__/-\__/-\__/-\__     four steps per period,
//!                                     DIR   ------------\________     DIR high where A leads
//! ```
//!
//! DIR changes in the cycle in which STEP rises. Pulses of both edges or of an encoder have no recorded width.

use crate::channel_map::{ChannelMap, Entry, Input, PulseSource};
use stepscope_peripheral::signal::MAX_CHANNELS;

#[derive(Clone, Debug)]
pub(crate) struct GeneratedPulses {
    motors: Vec<Motor>,
    /// Levels of DIR.
    dirs: u64,
    /// All generated signals.
    signals: u64,
    has_previous: bool,
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
    first: Entry,
    second: Option<Entry>,
    /// Masks of its STEP, and of its DIR if that is generated.
    step: u64,
    dir: u64,
    /// Latest levels of both inputs.
    inputs: (bool, bool),
}

enum Direction {
    Right,
    Left,
    Unknown,
}

impl GeneratedPulses {
    pub(crate) fn new(map: &ChannelMap) -> Option<Self> {
        let motor = |motor: u8| {
            let source = map.pulse_source(motor);
            let (first, second) = match source {
                PulseSource::Step => return None,
                PulseSource::BothEdges => (Input::BothEdges, None),
                PulseSource::CwCcw => (Input::Cw, Some(Input::Ccw)),
                PulseSource::Quadrature => (Input::A, Some(Input::B)),
            };
            let entry = |input: Input| map.input(input, motor.into());
            Some(Motor {
                source,
                first: entry(first)?,
                second: second.and_then(entry),
                step: 1 << motor,
                dir: second.map_or(0, |_| 1 << Input::Dir.bit(motor.into())),
                inputs: (false, false),
            })
        };
        let motors: Vec<Motor> = (0..MAX_CHANNELS as u8).filter_map(motor).collect();
        let dirs = motors.iter().fold(0, |dirs, motor| dirs | motor.dir);
        let signals = motors.iter().fold(dirs, |signals, motor| signals | motor.step);
        (!motors.is_empty()).then_some(Self { motors, dirs, signals, has_previous: false })
    }

    pub(crate) const fn signals(&self) -> u64 {
        self.signals
    }

    /// Steps of a change to these levels of channels. The first levels are no steps.
    pub(crate) fn update(&mut self, channels: u64) -> Steps {
        let mut steps = Steps::default();
        for motor in &mut self.motors {
            let now =
                (motor.first.level(channels), motor.second.is_some_and(|second| second.level(channels)));
            let before = core::mem::replace(&mut motor.inputs, now);
            if motor.source == PulseSource::CwCcw && (now.0 || now.1) {
                steps.levels |= motor.step;
            }
            let step = if self.has_previous { direction(motor.source, before, now) } else { None };
            match step {
                Some(Direction::Right) => self.dirs |= motor.dir,
                Some(Direction::Left) => self.dirs &= !motor.dir,
                Some(Direction::Unknown) => steps.ambiguous += 1,
                None => {}
            }
            let is_step = matches!(step, Some(Direction::Right | Direction::Left));
            if is_step && motor.source != PulseSource::CwCcw {
                steps.pulses |= motor.step;
            }
        }
        self.has_previous = true;
        steps.levels |= self.dirs;
        steps
    }
}

/// Direction of the step between two levels of the inputs; `None` without a step.
fn direction(source: PulseSource, before: (bool, bool), now: (bool, bool)) -> Option<Direction> {
    match source {
        PulseSource::BothEdges if before != now => Some(Direction::Right),
        PulseSource::CwCcw if now == (true, true) && before != now => Some(Direction::Unknown),
        PulseSource::CwCcw if before == (false, false) && now == (true, false) => Some(Direction::Right),
        PulseSource::CwCcw if before == (false, false) && now == (false, true) => Some(Direction::Left),
        PulseSource::Quadrature => match (phase(now) + 4 - phase(before)) % 4 {
            1 => Some(Direction::Right),
            2 => Some(Direction::Unknown),
            3 => Some(Direction::Left),
            _ => None,
        },
        PulseSource::Step | PulseSource::BothEdges | PulseSource::CwCcw => None,
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
