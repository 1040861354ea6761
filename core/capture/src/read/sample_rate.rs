//! Sample rates of files.
//!
//! ```text
//! ; Samplerate: 24 MHz        # Sample rate: 1e+06Hz        samplerate=1.000000007 GHz
//! ```

use super::decimal::{Decimal, power_of_ten};
use super::recorder::quoted;
use crate::timebase::Timebase;

/// Reads `24 MHz`, `1.000000007 GHz` or `1000000`, in Hz.
pub(super) fn parse_rate(text: &str) -> Option<Decimal> {
    let end = text.rfind(|letter: char| letter.is_ascii_digit()).map_or(0, |last| last + 1);
    let (number, unit) = text.split_at(end);
    let exponent = match unit.trim().to_lowercase().as_str() {
        "" | "hz" => 0,
        "khz" | "k" => 3,
        "mhz" | "m" => 6,
        "ghz" | "g" => 9,
        _ => return None,
    };
    Decimal::parse(number.trim().as_bytes())?.shifted(exponent).filter(|rate| rate.mantissa > 0)
}

pub(super) fn period(rate: Decimal) -> Option<Timebase> {
    Timebase::new(power_of_ten(rate.places)?.try_into().ok()?, rate.mantissa.try_into().ok()?)
}

/// The rate that the comments of a table give.
#[derive(Default)]
pub(super) struct SampleRate {
    /// The rate, its text and its line.
    first: Option<(Decimal, String, u64)>,
}

impl SampleRate {
    /// Fails if an earlier comment gives another rate. Ignores text that is not a rate.
    pub(super) fn set(&mut self, text: &str, line: u64) -> Result<(), String> {
        let Some(rate) = parse_rate(text) else { return Ok(()) };
        match &self.first {
            Some((first, first_text, first_line)) if period(*first) != period(rate) => Err(format!(
                "the sample rate {} differs from {} in line {first_line}; delete the wrong line or export again",
                quoted(text.as_bytes()),
                quoted(first_text.as_bytes())
            )),
            Some(_) => Ok(()),
            None => {
                self.first = Some((rate, text.into(), line));
                Ok(())
            }
        }
    }

    pub(super) fn get(&self) -> Option<Decimal> {
        self.first.as_ref().map(|(rate, ..)| *rate)
    }
}
