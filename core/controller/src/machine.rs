//! All stand-alone controllers of a bus (CONTROLLER G1), run cycle by cycle or event by event.

use crate::controller::{Controller, NEVER};
use crate::script::{self, Script};
use crate::{
    checked::CheckedSetup, input::Signal, limits, panel::PanelRecord, parameters::Parameters,
    too_many_groups::TooManyGroups,
};
use alloc::{sync::Arc, vec::Vec};
use stepscope_peripheral::signal::{Event, Levels, Record, Sink};
use stepscope_peripheral::units::{Cycles, Instant};

/// [`clock`](Self::clock) runs every cycle; [`run`](Self::run) skips the cycles without events. Both give the same result.
#[derive(Clone, Debug)]
pub struct StandAlone {
    pub(crate) checked: CheckedSetup,
    pub(crate) controllers: Vec<Controller>,
    /// Next cycle with an event of each controller.
    pub(crate) due: Vec<u64>,
    pub(crate) now: u64,
    last_event: u64,
    levels: Levels,
    pub(crate) groups_begun: u64,
    too_many_groups: Option<TooManyGroups>,
}

impl StandAlone {
    /// The controllers before cycle 0.
    pub fn new(checked: &CheckedSetup) -> Self {
        let first_inputs =
            checked.controllers().first().into_iter().flat_map(|first| first.inputs.iter().copied());
        let shared = script::sorted(first_inputs.filter(|input| script::is_shared(input.change)));
        let create = |(index, parameters): (usize, &Arc<Parameters>)| {
            let own = script::sorted(parameters.inputs.iter().copied());
            // The first controller's own entries include the shared ones.
            let script = Script::new(own, if index == 0 { Arc::new([]) } else { shared.clone() });
            Controller::new(checked, parameters, script)
        };
        let controllers: Vec<Controller> = checked.controllers().iter().enumerate().map(create).collect();
        Self {
            checked: checked.clone(),
            due: controllers.iter().map(|_| 0).collect(),
            controllers,
            now: 0,
            last_event: 0,
            levels: Levels::RESET,
            groups_begun: 0,
            too_many_groups: None,
        }
    }

    /// The next cycle to run.
    pub const fn now(&self) -> Instant {
        Instant(self.now)
    }

    /// Runs one cycle and returns the levels of all signals in it.
    pub fn clock(&mut self, sink: &mut impl Sink) -> Levels {
        self.due.fill(0);
        self.cycle(sink);
        self.levels
    }

    fn cycle(&mut self, sink: &mut impl Sink) {
        let now = self.now;
        (self.now, self.last_event) = (now.saturating_add(1), now);
        if self.too_many_groups.is_none() {
            for (index, (controller, due)) in self.controllers.iter_mut().zip(&mut self.due).enumerate() {
                if *due > now {
                    continue;
                }
                // In cycle 0 the switches that are closed at reset are reported, too.
                let raw = if now == 0 { 1 << Signal::Power as u32 } else { controller.inputs.all_raw() };
                let before = Before { raw, panel_records: controller.panel.len() };
                let begun = controller.group_counter.count;
                controller.cycle(now);
                *due = controller.due().max(self.now);
                self.groups_begun += controller.group_counter.count - begun;
                report(Instant(now), index as u8, controller, &before, sink);
            }
        }
        let levels = self.bus_levels();
        if now == 0 || levels != self.levels {
            self.levels = levels;
            sink.record(Record { cycle: Instant(now), levels });
        }
        if self.groups_begun > limits::MAX_GROUPS_BEGUN && self.too_many_groups.is_none() {
            self.stop();
        }
    }

    fn stop(&mut self) {
        let counters = self.controllers.iter().map(|controller| controller.group_counter).enumerate();
        let Some((controller, counter)) = counters.max_by_key(|(_, counter)| counter.count) else { return };
        let ((first_group, last_group), is_endless) = (counter.range(), counter.is_endless());
        self.too_many_groups = Some(TooManyGroups { controller, first_group, last_group, is_endless });
    }

    fn bus_levels(&self) -> Levels {
        let mut bits = Levels::RESET.0;
        for (channel, controller) in self.controllers.iter().enumerate() {
            let pins = &controller.pins;
            bits |= u64::from(pins.step) << channel;
            bits |= u64::from(pins.dir) << (Levels::DIR_SHIFT as usize + channel);
            if !pins.en {
                bits &= !Levels::EN;
            }
        }
        Levels(bits)
    }

    /// The next cycle with an event; [`NEVER`] at the end.
    fn deadline(&self) -> u64 {
        if self.now == 0 {
            return 0;
        }
        if self.too_many_groups.is_some() {
            return NEVER;
        }
        self.due.iter().copied().min().map_or(NEVER, |due| if due == NEVER { due } else { due.max(self.now) })
    }

    /// Number of cycles before the next event; `None` if there is none.
    pub fn cycles_until_event(&self) -> Option<Cycles> {
        match self.deadline() {
            NEVER => None,
            deadline => Some(Cycles(deadline - self.now)),
        }
    }

    /// Skips cycles without events, at most [`Self::cycles_until_event`].
    pub fn advance(&mut self, cycles: Cycles) {
        self.now = self.now.saturating_add(cycles.0).min(self.deadline());
    }

    /// Runs until cycle `until`, exclusive; with [`Instant::NEVER`], up to and including the last event. Stops early when
    /// the sink pauses, and when [`Self::too_many_groups`] have begun.
    pub fn run(&mut self, until: Instant, sink: &mut impl Sink) {
        self.run_events(until, u64::MAX, sink);
    }

    /// As [`Self::run`], but for at most `events` cycles with events. Returns whether the run got to its end or a pause.
    pub fn run_events(&mut self, until: Instant, events: u64, sink: &mut impl Sink) -> bool {
        for _ in 0..events {
            if sink.is_paused() {
                return true;
            }
            let deadline = self.deadline();
            if deadline >= until.0 {
                if until != Instant::NEVER {
                    self.now = self.now.max(until.0);
                    self.catch_up_memory();
                }
                return true;
            }
            self.now = deadline;
            self.cycle(sink);
        }
        false
    }

    fn catch_up_memory(&mut self) {
        for (controller, due) in self.controllers.iter_mut().zip(&mut self.due) {
            controller.eeprom.catch_up(self.now);
            *due = (*due).min(controller.eeprom.due());
        }
    }

    /// The cycle after the last event, once the run has ended.
    pub const fn idle_since(&self) -> Instant {
        Instant(self.last_event.saturating_add(1))
    }

    /// Whether no event follows. A memory that writes the same record again and again, because its sequence number is the
    /// maximum, has no events.
    pub fn is_idle(&self) -> bool {
        self.now > 0
            && (self.too_many_groups.is_some()
                || self.controllers.iter().all(|controller| controller.due() == NEVER))
    }

    /// Why the run ended, if too many groups have begun.
    pub const fn too_many_groups(&self) -> Option<TooManyGroups> {
        self.too_many_groups
    }
}

struct Before {
    raw: u32,
    panel_records: usize,
}

/// Reports the changed inputs and the new panel record of cycle `now`.
fn report(now: Instant, index: u8, controller: &Controller, before: &Before, sink: &mut impl Sink) {
    let raw = controller.inputs.all_raw();
    let changed = |signal: &Signal| (raw ^ before.raw) >> *signal as u32 & 1 != 0;
    if raw != before.raw {
        for signal in Signal::ALL.into_iter().filter(changed) {
            let level = controller.inputs.raw(signal);
            sink.event(now, Event::Input { controller: index, input: signal as u8, level });
        }
    }
    if let Some(&PanelRecord { cycle, word, position, display }) = controller.panel.get(before.panel_records)
    {
        sink.event(cycle, Event::Panel { controller: index, word: word.0, position, display });
    }
}
