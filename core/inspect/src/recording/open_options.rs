//! Options for opening a capture, and the errors.

use super::{remedy::Remedy, serial::LineOptions};
use alloc::{borrow::ToOwned, string::String, vec::Vec};
use core::fmt;
use stepscope_capture::{capture::Format, channel_map::MapError, recorded::TooLate, timebase::Timebase};
use stepscope_peripheral::config::limits::CLOCK_HZ;

pub(super) const DEFAULT_CLOCK_HZ: u32 = 16_000_000;
/// Cycles per tick of the file that an edge needs to become a pulse.
const CYCLES_PER_EDGE: u64 = 4;

/// How to open a capture. Missing values are proposed, measured or taken from the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpenOptions {
    pub map: Option<String>,
    pub clock_hz: Option<u32>,
    pub sample_rate_hz: Option<u64>,
    pub baud: Option<u32>,
    /// Drivers step on both edges: STEP of the map becomes DEDGE.
    pub both_edges: bool,
    /// Data bits, parity and stop bits such as `8E1`; 8N1 by default.
    pub uart: Option<String>,
}

impl OpenOptions {
    pub(super) fn lines(&self) -> Result<LineOptions, OpenError> {
        let format = self
            .uart
            .as_deref()
            .map(|text| text.trim().parse().map_err(|allowed| OpenError::Uart(text.to_owned(), allowed)));
        Ok(LineOptions { baud: self.baud, format: format.transpose()?.unwrap_or_default() })
    }

    /// The requested clock, or the slowest with whole cycles per tick. Position rows and single edges need a finer one.
    pub(super) fn clock(
        &self,
        base: Timebase,
        positions: bool,
        makes_pulses: bool,
    ) -> Result<u32, OpenError> {
        let (min_hz, max) = (*CLOCK_HZ.start(), *CLOCK_HZ.end());
        let own = || {
            if positions && base.is_exact(DEFAULT_CLOCK_HZ) {
                return DEFAULT_CLOCK_HZ;
            }
            let (_, denominator) = base.parts();
            let min_hz =
                if makes_pulses { min_hz.max(denominator.saturating_mul(CYCLES_PER_EDGE)) } else { min_hz };
            let clock_hz = min_hz.div_ceil(denominator).checked_mul(denominator);
            clock_hz.map_or(max, |hz| hz.min(max)) as u32
        };
        valid_clock(self.clock_hz.unwrap_or_else(own))
    }
}

/// Why a capture cannot be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OpenError {
    Map(MapError),
    /// No map, and none can be proposed.
    NoMap {
        names: Vec<String>,
        example: String,
    },
    Clock(u32),
    SampleRate,
    /// Samples or ticks have no duration.
    NoSampleRate(Format),
    NoBaud,
    Baud,
    Uart(String, &'static str),
    /// No steps, and a line cannot be decoded: the reason and remedies.
    NoRate(String, Vec<Remedy>),
    TooLate(TooLate),
    TooManySteps(u64),
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Map(error) => write!(f, "the channel map: {error}"),
            Self::NoMap { .. } => f.write_str("no channel has a known signal"),
            Self::Clock(given) => {
                write!(f, "the clock: {given} Hz is out of range; use {} to {} Hz", CLOCK_HZ.start(), CLOCK_HZ.end())
            }
            Self::SampleRate => f.write_str("the sample rate is 0; use the samples per second, in Hz"),
            Self::NoSampleRate(format) => f.write_str(match format {
                Format::Klipper => {
                    "the log has no CLOCK_FREQ; use the clock of its controller as the sample rate, in Hz, such as 16000000"
                }
                Format::Annotations => {
                    "the annotations have no sample rate; use the sample rate of the recording, in Hz"
                }
                Format::Vcd | Format::SigrokSession | Format::SigrokCsv => {
                    "the file has no sample rate; use its sample rate in Hz"
                }
                Format::Trace | Format::EdgesCsv => {
                    "the file has no clock; use its clock as the sample rate in Hz"
                }
                _ => {
                    "the file has no unit of time; use a sample rate in Hz, such as 1000000 for times in µs, or a table header with the unit, such as time_us"
                }
            }),
            Self::NoBaud => f.write_str(
                "the bytes have no times; use a bit rate, so that they count as sent back to back",
            ),
            Self::Baud => f.write_str("the bit rate is 0; use the bits per second"),
            Self::Uart(given, allowed) => write!(f, "the UART format \"{given}\" is not supported; {allowed}"),
            Self::NoRate(why, _) => f.write_str(why),
            Self::TooLate(error) => error.fmt(f),
            Self::TooManySteps(max) => write!(
                f,
                "the positions need more than {max} steps, or exceed 2^31; use a shorter table"
            ),
        }
    }
}

impl core::error::Error for OpenError {}

pub(super) fn valid_clock(clock_hz: u32) -> Result<u32, OpenError> {
    if CLOCK_HZ.contains(&clock_hz.into()) { Ok(clock_hz) } else { Err(OpenError::Clock(clock_hz)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    #[test]
    fn a_clock_out_of_range_is_an_error() {
        assert_eq!(valid_clock(16_000_000), Ok(16_000_000));
        let error = valid_clock(7).expect_err("it is too slow").to_string();
        assert!(error.starts_with("the clock: 7 Hz is out of range; use "), "{error}");
    }
}
