//! A run in progress.

use crate::plant::behind::{Behind, PlantsBehind};
use crate::{
    controllers::{Controllers, Generator},
    hosts::framed_host::FramedHost,
};
use alloc::{boxed::Box, vec::Vec};
use core::slice;
use stepscope_peripheral::{
    device::{Device, Faults},
    signal::{Event, MAX_CHANNELS, Record, Sink},
    units::{Cycles, Instant},
    wire::{ForcedLevel, Line, Schedule},
};
use stepscope_plant::{Observer, Plant, measures::PlantResult};
use stepscope_scenario::END_OF_TIME;

#[derive(Clone, Debug)]
pub struct Run {
    pub(crate) controllers: Controllers,
    pub(crate) plants: Option<Box<PlantsBehind>>,
}

impl Run {
    /// The first controller; without a line, one before cycle 0.
    pub fn device(&self) -> &Device {
        self.controllers.bus.first()
    }

    /// All controllers in the order of the scenario.
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

    /// Position counters of the first controller or its replacement.
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
        Cycles(self.controllers.reached().0)
    }

    pub fn is_done(&self) -> bool {
        if let Some(plants) = &self.plants {
            return plants.ended.is_some();
        }
        self.controllers.are_done()
    }

    /// Runs until the first controller has written `records` more or to the end; true at the end.
    pub fn advance(&mut self, records: u64, sink: &mut impl Sink) -> bool {
        self.advance_each(records, slice::from_mut(sink))
    }

    /// Runs until one controller has written `records` more, with a sink per controller; true at the end.
    pub fn advance_each(&mut self, records: u64, sinks: &mut [impl Sink]) -> bool {
        if self.plants.is_some() {
            return self.advance_observed::<_, ()>((Instant::NEVER, records), sinks, &mut []);
        }
        let mut slices: Vec<_> = sinks.iter_mut().map(|sink| Slice { sink, left: records }).collect();
        let end = self.controllers.end.unwrap_or(Instant::NEVER);
        self.controllers.run_to(end, &mut slices);
        self.is_done()
    }

    /// Lets the run continue when it is idle.
    pub(crate) const fn without_end(&mut self) {
        self.controllers.end = Some(Instant(END_OF_TIME));
    }

    /// Runs to cycle `end`, with a sink per controller.
    pub(crate) fn run_to(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        if self.plants.is_some() {
            self.advance_observed::<_, ()>((end, u64::MAX), sinks, &mut []);
            return;
        }
        self.controllers.run_to(end, sinks);
    }

    pub(crate) const fn line_mut(&mut self) -> &mut Line {
        self.controllers.bus.line_mut()
    }

    /// Whether nothing changes without input.
    pub(crate) fn is_idle(&self) -> bool {
        self.controllers.at_rest()
    }

    /// Runs to a cycle, or until a controller has written that many records more, with a sink and an observer per
    /// controller; true at the end. Does nothing without plants.
    pub fn advance_observed<S: Sink, O: Observer>(
        &mut self,
        until: (Instant, u64),
        sinks: &mut [S],
        observers: &mut [O],
    ) -> bool {
        let Self { controllers, plants } = self;
        plants.as_mut().is_none_or(|plants| plants.advance(controllers, until, sinks, observers))
    }

    pub(crate) fn clock_observed<S: Sink, O: Observer>(&mut self, sinks: &mut [S], observers: &mut [O]) {
        if let Some(plants) = &mut self.plants {
            plants.clock(&mut self.controllers, sinks, observers);
        }
    }

    fn behind(&self, controller: usize) -> Option<&Behind> {
        self.plants.as_ref()?.behind.get(controller)
    }

    pub fn plant(&self, controller: usize) -> Option<&Plant> {
        self.behind(controller).map(|behind| &behind.plant)
    }

    /// Settling time per channel found by the self-test, in cycles; empty before the end of the boot.
    pub fn self_test(&self, controller: usize) -> &[Option<u64>] {
        self.behind(controller).map_or(&[], |behind| &behind.found)
    }

    /// Cycle of the last overload of a controller.
    pub fn overload(&self, controller: usize) -> Option<u64> {
        self.behind(controller)?.overload_at
    }

    pub fn results(&self) -> Vec<PlantResult> {
        let all = (0..).map_while(|index| self.behind(index));
        all.map(|behind| behind.measures.result(&behind.plant)).collect()
    }

    pub fn clock(&mut self, sinks: &mut [impl Sink]) {
        if self.plants.is_some() {
            return self.clock_observed::<_, ()>(sinks, &mut []);
        }
        self.controllers.clock(sinks);
    }
}

/// Pauses after so many records.
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
