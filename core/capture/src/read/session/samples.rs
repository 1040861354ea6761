//! Finds changes in unpacked samples.

use super::metadata::Metadata;
use crate::read::recorder::{Recorder, grouped};
use crate::read::{reading::ReadError, selection::select, source::WATCH_EVERY};

/// sigrok has no device with more than 512 channels.
const MAX_UNIT: usize = 64;
/// Samples per allowed change, which also bounds the time for samples without changes.
const MAX_IDLE: u64 = 10_000;

pub(super) struct SampleStream<'a> {
    recorder: &'a mut Recorder,
    watch: &'a mut dyn FnMut(u64) -> bool,
    sample_size: usize,
    bits: Vec<(usize, u8)>,
    last: Vec<u8>,
    partial: Vec<u8>,
    samples: u64,
    max_samples: u64,
    /// Packed bytes, and unpacked bytes since the last call of `watch`.
    packed: u64,
    unreported: u64,
}

impl<'a> SampleStream<'a> {
    pub(super) fn new(
        metadata: &Metadata,
        recorder: &'a mut Recorder,
        watch: &'a mut dyn FnMut(u64) -> bool,
    ) -> Result<Self, String> {
        let unit = metadata.unitsize;
        if !(1..=MAX_UNIT).contains(&unit) {
            return Err(format!("unitsize: {unit} is out of range; use 1 to {MAX_UNIT}"));
        }
        let mut bits = Vec::new();
        for (bit, name) in &metadata.probes {
            if *bit >= 8 * unit {
                return Err(format!(
                    "{name} is bit {bit}, but samples have {} bits; save the session again",
                    8 * unit
                ));
            }
        }
        let channels = select(metadata.probes.iter().map(|(_, name)| name.as_str()), recorder);
        for ((bit, _), channel) in metadata.probes.iter().zip(channels) {
            bits.extend(channel.map(|channel| (*bit, channel)));
        }
        if bits.is_empty() {
            return Err("the session has no logic channels; record STEP and DIR as logic channels".into());
        }
        let max_samples = (recorder.max_rows() as u64).saturating_mul(MAX_IDLE);
        let (last, partial) = (Vec::new(), Vec::new());
        Ok(Self {
            recorder,
            watch,
            sample_size: unit,
            bits,
            last,
            partial,
            samples: 0,
            max_samples,
            packed: 0,
            unreported: 0,
        })
    }

    pub(super) fn take(&mut self, bytes: &[u8]) -> Result<(), String> {
        let mut rest = bytes;
        if !self.partial.is_empty() {
            let (missing, after) = rest.split_at(rest.len().min(self.sample_size - self.partial.len()));
            self.partial.extend_from_slice(missing);
            rest = after;
            if self.partial.len() == self.sample_size {
                let sample = core::mem::take(&mut self.partial);
                self.run(&sample)?;
            }
        }
        let whole = rest.len() - rest.len() % self.sample_size;
        let (samples, partial) = rest.split_at(whole);
        self.run(samples)?;
        self.partial.extend_from_slice(partial);
        self.report_progress(bytes.len() as u64)
    }

    fn run(&mut self, samples: &[u8]) -> Result<(), String> {
        let unit = self.sample_size;
        let mut rest = samples;
        while !rest.is_empty() {
            let same = match (self.last.as_slice(), unit) {
                ([], _) => 0,
                (&[last], 1) => rest.iter().position(|sample| *sample != last).unwrap_or(rest.len()),
                (last, _) => {
                    let units = rest.chunks_exact(unit);
                    let count = units.len();
                    units.enumerate().find(|(_, sample)| *sample != last).map_or(count, |(at, _)| at)
                }
            };
            self.samples += same as u64;
            rest = rest.get(same * unit..).unwrap_or_default();
            let Some((sample, after)) = rest.split_at_checked(unit) else { break };
            self.last.clear();
            self.last.extend_from_slice(sample);
            self.recorder.levels(self.samples, self.levels())?;
            self.samples += 1;
            rest = after;
        }
        self.recorder.capture.end = self.samples.saturating_sub(1);
        if self.samples > self.max_samples {
            return Err(format!("more than {} samples; record a shorter time", grouped(self.max_samples)));
        }
        Ok(())
    }

    fn levels(&self) -> u64 {
        let high = |bit: usize| self.last.get(bit / 8).is_some_and(|byte| byte >> (bit % 8) & 1 == 1);
        self.bits.iter().fold(0, |levels, (bit, channel)| levels | u64::from(high(*bit)) << channel)
    }

    pub(super) const fn add_packed(&mut self, packed: u64) {
        self.packed += packed;
    }

    fn report_progress(&mut self, bytes: u64) -> Result<(), String> {
        self.unreported += bytes;
        if self.unreported < WATCH_EVERY {
            return Ok(());
        }
        self.unreported = 0;
        if (self.watch)(self.packed) { Ok(()) } else { Err(ReadError::CANCELLED.into()) }
    }

    pub(super) fn finish(self) -> Result<(), String> {
        if self.samples == 0 {
            return Err("the session has no samples; record again".into());
        }
        if self.partial.is_empty() {
            return Ok(());
        }
        Err(format!(
            "the session is incomplete: its last sample has {} of {} bytes; save it again",
            self.partial.len(),
            self.sample_size
        ))
    }
}
