//! Finds changes in unpacked samples.

use super::metadata::Metadata;
use crate::read::recorder::{Recorder, grouped};
use crate::read::{reading::ReadError, selection::select, source::WATCH_EVERY};

/// Bytes per sample: sigrok has at most 512 channels.
const MAX_SAMPLE_BYTES: usize = 64;
/// A file may have this many samples per allowed row. This limits the reading time of idle signals.
const SAMPLES_PER_ROW: u64 = 10_000;

pub(super) struct SampleStream<'a> {
    recorder: &'a mut Recorder,
    /// Receives the packed bytes so far; false cancels.
    progress: &'a mut dyn FnMut(u64) -> bool,
    sample_size: usize,
    selected: Vec<Selected>,
    last: Vec<u8>,
    partial: Vec<u8>,
    samples: u64,
    max_samples: u64,
    packed_bytes: u64,
    /// Unpacked bytes since the last call of `progress`.
    unreported_bytes: u64,
}

/// A bit of each sample that is read.
struct Selected {
    bit: usize,
    /// Channel of the capture.
    channel: u8,
}

impl<'a> SampleStream<'a> {
    pub(super) fn new(
        metadata: &Metadata,
        recorder: &'a mut Recorder,
        progress: &'a mut dyn FnMut(u64) -> bool,
    ) -> Result<Self, String> {
        let sample_size = metadata.unitsize;
        if !(1..=MAX_SAMPLE_BYTES).contains(&sample_size) {
            return Err(format!("unitsize: {sample_size} is out of range; use 1 to {MAX_SAMPLE_BYTES}"));
        }
        for (bit, name) in &metadata.probes {
            if *bit >= 8 * sample_size {
                return Err(format!(
                    "{name} is bit {bit}, but samples have {} bits; save the session again",
                    8 * sample_size
                ));
            }
        }
        let channels = select(metadata.probes.iter().map(|(_, name)| name.as_str()), recorder);
        let bits = metadata.probes.iter().map(|(bit, _)| *bit).zip(channels);
        let selected: Vec<Selected> =
            bits.filter_map(|(bit, channel)| channel.map(|channel| Selected { bit, channel })).collect();
        if selected.is_empty() {
            return Err("the session has no logic channels; record STEP and DIR as logic channels".into());
        }
        let max_samples = (recorder.max_rows() as u64).saturating_mul(SAMPLES_PER_ROW);
        Ok(Self {
            recorder,
            progress,
            sample_size,
            selected,
            last: Vec::new(),
            partial: Vec::new(),
            samples: 0,
            max_samples,
            packed_bytes: 0,
            unreported_bytes: 0,
        })
    }

    pub(super) fn feed(&mut self, bytes: &[u8]) -> Result<(), String> {
        let mut rest = bytes;
        if !self.partial.is_empty() {
            let (missing, after) = rest.split_at(rest.len().min(self.sample_size - self.partial.len()));
            self.partial.extend_from_slice(missing);
            rest = after;
            if self.partial.len() == self.sample_size {
                let sample = core::mem::take(&mut self.partial);
                self.process(&sample)?;
            }
        }
        let whole = rest.len() - rest.len() % self.sample_size;
        let (samples, partial) = rest.split_at(whole);
        self.process(samples)?;
        self.partial.extend_from_slice(partial);
        self.report_progress(bytes.len() as u64)
    }

    fn process(&mut self, samples: &[u8]) -> Result<(), String> {
        let mut rest = samples;
        while !rest.is_empty() {
            let unchanged = self.count_unchanged(rest);
            self.samples += unchanged as u64;
            rest = rest.get(unchanged * self.sample_size..).unwrap_or_default();
            let Some((sample, after)) = rest.split_at_checked(self.sample_size) else { break };
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

    /// Number of samples at the start that are equal to the last one.
    fn count_unchanged(&self, samples: &[u8]) -> usize {
        match self.last.as_slice() {
            [] => 0,
            // Fast path: one byte per sample.
            &[last] => samples.iter().position(|sample| *sample != last).unwrap_or(samples.len()),
            last => {
                let mut samples = samples.chunks_exact(self.sample_size);
                let count = samples.len();
                samples.position(|sample| sample != last).unwrap_or(count)
            }
        }
    }

    fn levels(&self) -> u64 {
        let high = |bit: usize| self.last.get(bit / 8).is_some_and(|byte| byte >> (bit % 8) & 1 == 1);
        self.selected.iter().fold(0, |levels, each| levels | (u64::from(high(each.bit)) << each.channel))
    }

    pub(super) const fn add_packed(&mut self, packed_bytes: u64) {
        self.packed_bytes += packed_bytes;
    }

    fn report_progress(&mut self, bytes: u64) -> Result<(), String> {
        self.unreported_bytes += bytes;
        if self.unreported_bytes < WATCH_EVERY {
            return Ok(());
        }
        self.unreported_bytes = 0;
        if (self.progress)(self.packed_bytes) { Ok(()) } else { Err(ReadError::CANCELED.into()) }
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
