//! A run in progress.

use crate::controllers::{Controllers, Generator, RunLimits};
use crate::hosts::framed_host::FramedHost;
use crate::plant::attached::{AttachedPlant, AttachedPlants};
use alloc::{boxed::Box, vec::Vec};
use core::slice;
use stepscope_peripheral::device::{Device, Faults};
use stepscope_peripheral::signal::{Event, MAX_CHANNELS, Record, Sink};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::{ForcedLevel, Line, Schedule};
use stepscope_plant::{Observer, Plant, measures::PlantResult};
use stepscope_scenario::END_OF_TIME;

/// A run in progress, from [`Experiment::start`](crate::Experiment::start). It can run in portions and be cloned.
///
/// ```
/// use stepscope_peripheral::signal::Record;
/// use stepscope_sim::Experiment;
///
/// let mut run = Experiment::from_json("{}").expect("no problems").start();
/// let mut trace: Vec<Record> = Vec::new();
/// while !run.advance(1000, &mut trace) {
///     println!("cycle {}: {} edges", run.cycles().0, trace.len());
/// }
/// assert_eq!(run.positions()[0], 3200);
/// ```
#[derive(Clone, Debug)]
pub struct Run {
    pub(crate) controllers: Controllers,
    pub(crate) plants: Option<Box<AttachedPlants>>,
}

impl Run {
    /// The first controller; without a line, one before cycle 0.
    pub fn device(&self) -> &Device {
        self.controllers.bus.first()
    }

    pub fn devices(&self) -> impl Iterator<Item = &Device> {
        self.controllers.bus.devices()
    }

    /// The host of a framed line; `None` if it does not wait for replies.
    pub const fn host(&self) -> Option<&FramedHost> {
        self.controllers.bus.host()
    }

    /// What the host has sent and, as far as known, will send.
    pub fn schedule(&self) -> &Schedule {
        self.controllers.bus.line().schedule()
    }

    /// The forced levels of the whole run, rising in time. With [`Self::schedule`] they replay the run.
    pub fn forced(&self) -> &[ForcedLevel] {
        self.controllers.bus.line().forced()
    }

    /// Positions of the first controller or of what replaces it, in steps per channel.
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        self.controllers.positions()
    }

    /// The stand-alone controllers; `None` where a line or segments run the scenario.
    pub fn stand_alone(&self) -> Option<&stepscope_controller::StandAlone> {
        match &self.controllers.generator {
            Generator::StandAlone(machine) => Some(machine),
            _ => None,
        }
    }

    pub(crate) fn stand_alone_mut(&mut self) -> Option<&mut stepscope_controller::StandAlone> {
        match &mut self.controllers.generator {
            Generator::StandAlone(machine) => Some(machine),
            _ => None,
        }
    }

    /// Faults of the first controller, or of the segment engine.
    pub fn faults(&self) -> Faults {
        self.controllers.faults()
    }

    /// Ticks of the first controller that have ended.
    pub fn ticks_done(&self) -> u32 {
        self.device().ticks_done()
    }

    pub fn cycles(&self) -> Cycles {
        if let Some(ended) = self.plants.as_ref().and_then(|plants| plants.ended) {
            return Cycles(ended.0);
        }
        Cycles(self.controllers.furthest_cycle().0)
    }

    pub fn is_done(&self) -> bool {
        if let Some(plants) = &self.plants {
            return plants.ended.is_some();
        }
        self.controllers.is_done()
    }

    /// Runs until the first controller has written `records` more, or to the end; true at the end.
    pub fn advance(&mut self, records: u64, sink: &mut impl Sink) -> bool {
        self.advance_each(records, slice::from_mut(sink))
    }

    /// Runs until a controller has written `records` more, or to the end, with a sink per controller; true at the end.
    pub fn advance_each(&mut self, records: u64, sinks: &mut [impl Sink]) -> bool {
        let limits = RunLimits { records, ..RunLimits::default() };
        self.advance_observed::<_, ()>(limits, sinks, &mut [])
    }

    /// Continues the run while it is idle.
    pub(crate) const fn extend_to_end_of_time(&mut self) {
        self.controllers.end = Some(Instant(END_OF_TIME));
    }

    /// Runs to cycle `end`, with a sink per controller.
    pub(crate) fn run_to(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        if self.plants.is_some() {
            let limits = RunLimits { cycle: end, ..RunLimits::default() };
            self.advance_observed::<_, ()>(limits, sinks, &mut []);
            return;
        }
        self.controllers.run_to(end, sinks);
    }

    pub(crate) const fn line_mut(&mut self) -> &mut Line {
        self.controllers.bus.line_mut()
    }

    /// Whether no event follows without input.
    pub(crate) fn is_idle(&self) -> bool {
        self.controllers.is_idle()
    }

    /// Runs to the limits or to the end, with a sink and an observer of the plant per controller; true at the end.
    pub fn advance_observed<S: Sink, O: Observer>(
        &mut self,
        limits: RunLimits,
        sinks: &mut [S],
        observers: &mut [O],
    ) -> bool {
        if let Some(plants) = &mut self.plants {
            return plants.advance(&mut self.controllers, limits, sinks, observers);
        }
        let mut slices: Vec<_> = sinks.iter_mut().map(|sink| Slice { sink, left: limits.records }).collect();
        let end = self.controllers.end.unwrap_or(Instant::NEVER).min(limits.cycle);
        self.controllers.run_to(end, &mut slices);
        self.is_done()
    }

    pub(crate) fn clock_observed<S: Sink, O: Observer>(&mut self, sinks: &mut [S], observers: &mut [O]) {
        if let Some(plants) = &mut self.plants {
            plants.clock(&mut self.controllers, sinks, observers);
        }
    }

    fn attached(&self, controller: usize) -> Option<&AttachedPlant> {
        self.plants.as_ref()?.plants.get(controller)
    }

    pub fn plant(&self, controller: usize) -> Option<&Plant> {
        self.attached(controller).map(|attached| &attached.plant)
    }

    /// Settling time per channel that the self-test measured, in cycles; empty before the end of the boot.
    pub fn self_test(&self, controller: usize) -> &[Option<u64>] {
        self.attached(controller).map_or(&[], |attached| &attached.settling_times)
    }

    /// Cycle of the last overload of a controller.
    pub fn overload(&self, controller: usize) -> Option<u64> {
        self.attached(controller)?.overload_at
    }

    /// The results of all plants.
    pub fn results(&self) -> Vec<PlantResult> {
        let all = (0..).map_while(|index| self.attached(index));
        all.map(|attached| attached.measures.result(&attached.plant)).collect()
    }

    /// Runs one cycle, with a sink per controller.
    pub fn clock(&mut self, sinks: &mut [impl Sink]) {
        if self.plants.is_some() {
            return self.clock_observed::<_, ()>(sinks, &mut []);
        }
        self.controllers.clock(sinks);
    }
}

/// Pauses after `left` more records.
struct Slice<'a, S> {
    sink: &'a mut S,
    left: u64,
}

impl<S: Sink> Sink for Slice<'_, S> {
    fn record(&mut self, record: Record) {
        self.left = self.left.saturating_sub(1);
        self.sink.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.sink.event(at, event);
    }

    fn is_paused(&self) -> bool {
        self.left == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Experiment;
    use alloc::vec;

    const TWO_PLANTS: &str =
        r#"{ "plant": {}, "line": { "address": 1 }, "controllers": [ { "address": 2, "axes": [ {} ] } ] }"#;

    #[test]
    fn a_part_of_a_run_has_at_most_the_requested_records() {
        for (json, sinks) in [("{}", 1), (r#"{ "plant": {} }"#, 1), (TWO_PLANTS, 2), (TWO_PLANTS, 1)] {
            let experiment = Experiment::from_json(json).expect("no problems");
            let (mut whole, mut parts) =
                (vec![Vec::<Record>::new(); sinks], vec![Vec::<Record>::new(); sinks]);
            let expected = experiment.run_each(&mut whole);
            let (mut run, mut is_done) = (experiment.start(), false);
            while !is_done {
                let before: Vec<usize> = parts.iter().map(Vec::len).collect();
                is_done = run.advance_each(100, &mut parts);
                let added = parts.iter().zip(before).map(|(part, before)| part.len() - before);
                assert!(added.max() <= Some(100), "{json}");
            }
            assert!(parts == whole && run.cycles() == expected.cycles(), "{json}");
            assert_eq!(run.results(), expected.results(), "{json}");
        }
    }

    #[test]
    fn a_run_without_plants_stops_at_its_limits() {
        let mut run = Experiment::from_json("{}").expect("no problems").start();
        let limits = RunLimits { cycle: Instant(5000), ..RunLimits::default() };
        assert!(!run.advance_observed::<_, ()>(limits, &mut [Vec::<Record>::new()], &mut []));
        assert_eq!(run.cycles(), Cycles(5000));
    }
}
