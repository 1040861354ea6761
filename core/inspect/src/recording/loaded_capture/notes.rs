//! Notes on a loaded capture: generated pulses, rounded times, edges that may count otherwise.

use super::LoadedCapture;
use crate::recording::remedy::{Note, Remedy};
use crate::trace::timing::Rule;
use alloc::{borrow::ToOwned, format, string::ToString};
use stepscope_capture::channel_map::{PulseSource, channel_text};
use stepscope_capture::{Capture, ChannelMap, recorded::Rounding};

impl LoadedCapture {
    /// Notes rounded times, and edges that could not be counted.
    pub(super) fn note_rounding(&mut self, mut rounding: Rounding, others: u64) {
        rounding.rounded += others;
        (self.rounding, self.is_rounded) = (rounding.to_string(), rounding.rounded > 0);
        if rounding.ambiguous > 0 {
            let (s, verb) = if rounding.ambiguous == 1 { ("", "counts") } else { ("s", "count") };
            self.notes.push(Note::from(format!(
                "{} change{s} of an encoder or of CW and CCW {verb} no step, because both lines changed or were high at once; use a higher sample rate or another map",
                rounding.ambiguous
            )));
        }
    }

    /// Notes generated pulses, and edges that may count differently.
    pub(super) fn note_edges(&mut self, capture: &Capture, map: &ChannelMap) {
        let sources = (0..self.channels).map(|motor| (motor, map.pulse_source(motor)));
        self.generated_pulses = sources.filter(|(_, source)| *source != PulseSource::Step).collect();
        for (motor, source) in &self.generated_pulses {
            let note = match source {
                PulseSource::Step => continue,
                PulseSource::BothEdges => format!(
                    "channel {motor} steps on both edges of its STEP line: the timing check excludes pulse width and low time"
                ),
                PulseSource::CwCcw => format!(
                    "channel {motor} has CW and CCW pulses: the timing check excludes DIR set-up and hold time"
                ),
                PulseSource::Quadrature => format!(
                    "channel {motor} counts each edge of an encoder: the timing check excludes its pulses"
                ),
            };
            self.notes.push(note.into());
        }
        for hint in map.edge_hints(capture) {
            let motor = hint.motor;
            let channel = channel_text(hint.channel, &capture.channels);
            if hint.both_edges {
                let steps = hint.edges.map_or("twice as many".to_owned(), |edges| edges.to_string());
                self.notes.push(Note {
                    text: format!(
                        "both edges of STEP{motor} are evenly spaced: a driver that steps on both edges makes {steps} steps of it"
                    ),
                    remedy: Some(Remedy::BothEdges { motor, channel: channel.clone() }),
                });
            }
            if hint.idles_high {
                let entry = map.entries().iter().find(|entry| entry.bit == u32::from(motor));
                let inverted = !entry.is_some_and(|entry| entry.inverted);
                self.notes.push(Note {
                    text: format!(
                        "STEP{motor} idles high and has low pulses: steps are counted where a pulse ends"
                    ),
                    remedy: Some(Remedy::OtherEdge { motor, channel, inverted }),
                });
            }
        }
    }

    /// Timing rules that do not apply, because the edges were generated.
    pub fn unchecked(&self) -> impl Iterator<Item = (u8, Rule)> {
        self.generated_pulses.iter().flat_map(|(channel, source)| {
            let rules: &[Rule] = match source {
                PulseSource::Step => &[],
                PulseSource::BothEdges => &[Rule::StepHigh, Rule::StepLow],
                PulseSource::CwCcw => &[Rule::DirSetup, Rule::DirHold],
                PulseSource::Quadrature => &Rule::ALL,
            };
            rules.iter().map(|rule| (*channel, *rule))
        })
    }
}
