//! The description of a session: an INI file of sections and `key=value`.

use crate::{
    read::{
        decimal::{Decimal, power_of_ten, whole},
        sigrok::parse_rate,
    },
    timebase::Timebase,
};

/// Most names that are kept, of either kind.
const MAX_NAMES: usize = 1000;

/// What is said of the first device.
pub(super) struct Metadata {
    pub(super) devices: u32,
    rate: Option<Decimal>,
    pub(super) capturefile: String,
    /// Bytes of a sample.
    pub(super) unitsize: usize,
    /// Bit of a sample, and name of its channel, by their bits.
    pub(super) probes: Vec<(usize, String)>,
    pub(super) analogue: Vec<String>,
}

impl Metadata {
    pub(super) fn parse(text: &str) -> Self {
        let mut metadata = Self {
            devices: 0,
            rate: None,
            capturefile: "logic-1".into(),
            unitsize: 1,
            probes: Vec::new(),
            analogue: Vec::new(),
        };
        for line in text.lines().map(str::trim) {
            if line.starts_with("[device") {
                metadata.devices += 1;
            } else if let Some((key, value)) = line.split_once('=')
                && metadata.devices <= 1
            {
                metadata.set(key.trim(), value.trim());
            }
        }
        metadata.probes.sort();
        metadata
    }

    fn set(&mut self, key: &str, value: &str) {
        let number = |digits: &str| whole(digits.as_bytes()).and_then(|number| usize::try_from(number).ok());
        match key {
            "samplerate" => self.rate = parse_rate(value),
            "capturefile" => self.capturefile = value.into(),
            "unitsize" => self.unitsize = number(value).unwrap_or(0),
            _ => {
                if let Some(bit) =
                    key.strip_prefix("probe").and_then(number).and_then(|probe| probe.checked_sub(1))
                {
                    if self.probes.len() < MAX_NAMES {
                        self.probes.push((bit, value.into()));
                    }
                } else if key.strip_prefix("analog").and_then(number).is_some()
                    && self.analogue.len() < MAX_NAMES
                {
                    self.analogue.push(value.into());
                }
            }
        }
    }

    /// How long a sample is.
    pub(super) fn timebase(&self) -> Option<Timebase> {
        let rate = self.rate?;
        Timebase::new(power_of_ten(rate.places)?.try_into().ok()?, rate.mantissa.try_into().ok()?)
    }
}
