//! The scenario that reproduces a loaded capture.

use super::LoadedCapture;
use crate::recording::scenario::{self, ByteRequest, NotReproducible, Reproduction, StepRequest};
use crate::trace::timing::Rule;
use alloc::{format, string::String, vec::Vec};
use stepscope_peripheral::{trace::Step, wire::BitTimes};
use stepscope_scenario::{Scenario, SegmentLists, Source};

/// Maximum segments, or fields of sends, of an editable scenario.
const MAX_SHOWN: usize = 20_000;
const MAX_TITLE: usize = 120;

impl LoadedCapture {
    /// The first valid one of [`Self::candidates`].
    pub fn shown_scenario(&self, file: &str, steps: bool) -> Scenario {
        let (reproduced, idle) = self.candidates(file, steps);
        reproduced.filter(|reproduced| reproduced.check().is_ok()).unwrap_or(idle)
    }

    /// The scenarios to show: one that reproduces it, not yet checked, unless it is too long to edit; and for a
    /// reproduction with problems an idle one with its clock, channels and duration.
    pub fn candidates(&self, file: &str, steps: bool) -> (Option<Scenario>, Scenario) {
        let reproduced =
            if self.part.is_none() { self.reproduction(file, steps, 0.0, None).ok() } else { None };
        let run_cycles = Some(self.run_cycles());
        let reproduced = reproduced
            .filter(|reproduced| reproduced.clock_hz == self.clock_hz && entries(reproduced) <= MAX_SHOWN)
            .map(|reproduced| Scenario { run_cycles, ..reproduced });
        let mut idle = Scenario { clock_hz: self.clock_hz, run_cycles, ..Scenario::default() };
        idle.bus.channels = self.channels;
        idle.source = Source::Segments(SegmentLists::default());
        idle.title = title(file);
        idle.note = format!(
            "Recorded in {file}. No editable scenario reproduces it: it is too long, too fast for the bus, or has another clock. stepscope capture --write-scenario reports the reason, or writes a long scenario."
        );
        (reproduced, idle)
    }

    /// Cycles of a run up to its end, its last record and its last byte.
    fn run_cycles(&self) -> u64 {
        let last = self.records.last().map_or(0, |record| record.cycle.0);
        let end = libm::ceil(self.end_s * f64::from(self.clock_hz)) as u64;
        // The last byte ends after the last edge.
        let decoded = self.report.rx().filter(|line| self.part.is_none() && line.baud > 0).and_then(|line| {
            let bit_cycles = BitTimes::new(self.clock_hz, line.baud).bit(1).0;
            Some(scenario::end_of(&line.decoded, bit_cycles)?.0 + bit_cycles)
        });
        end.max(last).max(decoded.unwrap_or(0)) + 1
    }

    /// The scenario that reproduces its bytes for the controllers of `base`, or its steps within `error_us`.
    pub fn scenario(
        &self,
        file: &str,
        steps: bool,
        error_us: f64,
        base: Option<&Scenario>,
    ) -> Result<Scenario, NotReproducible> {
        let scenario = self.reproduction(file, steps, error_us, base)?;
        match scenario.check() {
            Ok(_) => Ok(scenario),
            Err(problems) => {
                Err(problems.into_iter().next().map_or(NotReproducible::NoBytes, NotReproducible::Invalid))
            }
        }
    }

    /// [`Self::scenario`] without its check.
    fn reproduction(
        &self,
        file: &str,
        steps: bool,
        error_us: f64,
        base: Option<&Scenario>,
    ) -> Result<Scenario, NotReproducible> {
        let (clock_hz, channels) = (self.clock_hz, self.channels);
        let within_cycles = (error_us * 1e-6 * f64::from(clock_hz)) as u64;
        let request = StepRequest { clock_hz, channels, within_cycles };
        let rx = self.report.rx().filter(|line| !line.decoded.bytes.is_empty() && !steps);
        let reproduced: Reproduction = match (rx, &self.position_steps) {
            (Some(line), _) => {
                let request = ByteRequest { clock_hz, baud: line.baud, guess: line.guess, channels };
                scenario::of_bytes(&line.decoded, &request, base)
            }
            (None, Some(steps)) => scenario::of_step_times(core::slice::from_ref(steps), &request),
            // Generated pulses have no width of their own.
            (None, None) if self.unchecked().any(|(_, rule)| rule == Rule::StepHigh) => {
                let all: Vec<Vec<Step>> = (0..channels).map(|channel| self.steps_of(channel)).collect();
                scenario::of_step_times(&all, &request)
            }
            (None, None) => scenario::of_steps(&self.records, &request),
        }?;
        let mut scenario = Scenario { note: scenario::note(file, &reproduced), ..reproduced.scenario };
        scenario.title = title(file);
        Ok(scenario)
    }
}

fn entries(scenario: &Scenario) -> usize {
    match &scenario.source {
        Source::Segments(lists) => lists.channels.iter().map(|list| list.segments.len()).sum(),
        // A form has several fields per send.
        Source::Line(script) => script.sends.len() * 8,
        _ => 0,
    }
}

fn title(file: &str) -> String {
    format!("recorded: {file}").chars().take(MAX_TITLE).collect()
}
