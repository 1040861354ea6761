//! Reads a session's description: an INI file.

use crate::read::decimal::{Decimal, whole};
use crate::read::sample_rate::{parse_rate, period};
use crate::timebase::Timebase;
use std::collections::BTreeSet;

const MAX_NAMES: usize = 1000;

pub(super) struct Metadata {
    pub(super) devices: u32,
    rate: Option<Decimal>,
    pub(super) capturefile: String,
    pub(super) unitsize: usize,
    /// Bit of a sample, and the channel's name.
    pub(super) probes: Vec<(usize, String)>,
    pub(super) analog: Vec<String>,
}

impl Metadata {
    /// Errors on a repeated value: readers differ in which one they use.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut given = BTreeSet::new();
        let mut metadata = Self {
            devices: 0,
            rate: None,
            capturefile: "logic-1".into(),
            unitsize: 1,
            probes: Vec::new(),
            analog: Vec::new(),
        };
        for line in text.lines().map(str::trim) {
            if line.starts_with("[device") {
                metadata.devices += 1;
            } else if let Some((key, value)) = line.split_once('=')
                && metadata.devices <= 1
            {
                let key = key.trim();
                if metadata.set(key, value.trim()) && !given.insert(key) {
                    return Err(format!("“metadata” contains {key} twice; save the session again"));
                }
            }
        }
        metadata.probes.sort();
        let same = |pair: &[(usize, String)]| match pair {
            [(one, _), (other, _)] if one == other => Some(one + 1),
            _ => None,
        };
        if let Some(probe) = metadata.probes.windows(2).find_map(same) {
            return Err(format!("“metadata” contains probe{probe} twice; save the session again"));
        }
        Ok(metadata)
    }

    /// Returns whether the key must be unique.
    fn set(&mut self, key: &str, value: &str) -> bool {
        let number = |digits: &str| whole(digits.as_bytes()).and_then(|number| usize::try_from(number).ok());
        let numbered = |prefix| key.strip_prefix(prefix).and_then(number);
        match key {
            "samplerate" => self.rate = parse_rate(value),
            "capturefile" => self.capturefile = value.into(),
            "unitsize" => self.unitsize = number(value).unwrap_or(0),
            _ => {
                if let Some(bit) = numbered("probe").and_then(|probe| probe.checked_sub(1)) {
                    if self.probes.len() < MAX_NAMES {
                        self.probes.push((bit, value.into()));
                    }
                } else if numbered("analog").is_some() && self.analog.len() < MAX_NAMES {
                    self.analog.push(value.into());
                }
                return false;
            }
        }
        true
    }

    pub(super) fn timebase(&self) -> Option<Timebase> {
        self.rate.and_then(period)
    }
}
