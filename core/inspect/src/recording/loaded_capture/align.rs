//! Shifts a recording in time, so that it can be compared with a model.

use super::LoadedCapture;
use crate::recording::{events::Kind, figures::StepFigures, report::ChannelReport};
use core::fmt;
use stepscope_peripheral::units::Instant;

/// Why a recording cannot be aligned with a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Misaligned {
    /// Only a part is loaded, without the recording's first step.
    Part,
    /// There is no such step or byte.
    None { kind: Kind, aligned: usize, count: usize },
    /// The first one would come before cycle 1.
    Early { kind: Kind, aligned: usize, first_s: f64 },
}

impl fmt::Display for Misaligned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Part => f.write_str("a part of a recording cannot be aligned; use a shorter recording"),
            Self::None { kind, aligned, count } => write!(
                f,
                "there is no {} {aligned}; {count} {} were recorded, numbered from 0; use one that both have",
                kind.singular(),
                kind.plural()
            ),
            Self::Early { kind, aligned, first_s } => write!(
                f,
                "aligned by {0} {aligned}, the first {0} would be at {first_s:.6} s, before the start of the experiment; use a later one",
                kind.singular()
            ),
        }
    }
}

impl core::error::Error for Misaligned {}

impl LoadedCapture {
    /// Shifts the recording so that step (or byte) `aligned` of a channel comes at `at_s`. Without steps and bytes
    /// nothing moves. Fails with [`Misaligned`] if the first would come before cycle 1.
    pub fn align(&mut self, channel: u8, aligned: usize, at_s: f64) -> Result<(), Misaligned> {
        if self.part.is_some() {
            return Err(Misaligned::Part);
        }
        let hz = f64::from(self.clock_hz);
        let events = self.events(channel);
        let Some(first_s) = events.at_s(0) else { return Ok(()) };
        let (kind, count) = (events.kind, events.len());
        let now_s = events.at_s(aligned).ok_or(Misaligned::None { kind, aligned, count })?;
        let first_s = first_s + (at_s - now_s);
        // A rise in cycle 0 does not count as a step.
        if libm::round(first_s * hz) < 1.0 {
            return Err(Misaligned::Early { kind, aligned, first_s });
        }
        let by = libm::round((at_s - now_s) * hz) as i64;
        let moved = |cycle: u64| cycle.saturating_add_signed(by);
        for record in &mut self.records {
            record.cycle = Instant(moved(record.cycle.0));
        }
        // Of records at cycle 0 only the last counts.
        let before = self.records.partition_point(|record| record.cycle.0 == 0).saturating_sub(1);
        self.records.drain(..before);
        if let Some(record) = self.records.first_mut() {
            record.cycle = Instant(0);
        }
        for step in self.position_steps.iter_mut().flatten() {
            step.cycle = moved(step.cycle);
        }
        for line in &mut self.report.lines {
            line.decoded.bytes.iter_mut().for_each(|byte| byte.start = Instant(moved(byte.start.0)));
        }
        self.end_s += by as f64 / hz;
        let channels = self.report.channels.iter().map(|channel| channel.channel);
        let figures = |channel| {
            let figures = StepFigures::of(self.steps_of(channel), self.clock_hz)?;
            Some(ChannelReport { channel, figures })
        };
        self.report.channels = channels.filter_map(figures).collect();
        Ok(())
    }
}
