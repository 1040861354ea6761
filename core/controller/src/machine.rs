//! All stand-alone controllers of a bus (CONTROLLER G1), cycle by cycle or event by event.

use crate::{
    checked::CheckedSetup,
    controller::{Controller, NEVER},
    input::Signal,
    limits,
    panel::PanelRecord,
    parameters::Parameters,
    script::{self, Script},
    work::Work,
};
use alloc::{rc::Rc, vec::Vec};
use stepscope_peripheral::{
    signal::{Event, Levels, Record, Sink},
    units::{Cycles, Instant},
};

#[derive(Clone, Debug)]
pub struct StandAlone {
    pub(crate) checked: CheckedSetup,
    pub(crate) controllers: Vec<Controller>,
    pub(crate) due: Vec<u64>,
    pub(crate) now: u64,
    acted: u64,
    levels: Levels,
    pub(crate) begun: u64,
    work: Option<Work>,
}

impl StandAlone {
    /// The controllers before cycle 0.
    #[must_use]
    pub fn new(checked: &CheckedSetup) -> Self {
        let first = checked.controllers().first();
        let shared = first.into_iter().flat_map(|first| first.inputs.iter().copied());
        let shared = script::sorted(shared.filter(|input| script::is_shared(input.change)));
        let make = |(index, parameters): (usize, &Rc<Parameters>)| {
            let own = script::sorted(parameters.inputs.iter().copied());
            // The first controller has the shared entries among its own.
            let script = Script::new(own, if index == 0 { Rc::new([]) } else { shared.clone() });
            Controller::new(checked, parameters, script)
        };
        let controllers: Vec<Controller> = checked.controllers().iter().enumerate().map(make).collect();
        Self {
            checked: checked.clone(),
            due: controllers.iter().map(|_| 0).collect(),
            controllers,
            now: 0,
            acted: 0,
            levels: Levels::RESET,
            begun: 0,
            work: None,
        }
    }

    /// The next cycle to run.
    #[must_use]
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
        (self.now, self.acted) = (now.saturating_add(1), now);
        if self.work.is_none() {
            for (index, (controller, due)) in self.controllers.iter_mut().zip(&mut self.due).enumerate() {
                if *due > now {
                    continue;
                }
                // Cycle 0 reports the switches that the axis closes at reset.
                let before = if now == 0 { 1 << Signal::Power as u32 } else { controller.inputs.all_raw() };
                let (begun, shown) = (controller.begun.count, controller.panel.len());
                controller.cycle(now);
                *due = controller.due().max(self.now);
                self.begun += controller.begun.count - begun;
                report(index as u8, controller, (now, before, shown), sink);
            }
        }
        let levels = self.shown();
        if now == 0 || levels != self.levels {
            self.levels = levels;
            sink.record(Record { cycle: Instant(now), levels });
        }
        if self.begun > limits::MAX_GROUPS_BEGUN && self.work.is_none() {
            self.stop();
        }
    }

    fn stop(&mut self) {
        let most = self.controllers.iter().enumerate().max_by_key(|(_, controller)| controller.begun.count);
        let Some((controller, begun)) = most.map(|(index, controller)| (index, controller.begun)) else {
            return;
        };
        let (first_group, last_group) = begun.range();
        self.work = Some(Work { controller, first_group, last_group, is_endless: begun.is_endless() });
    }

    fn shown(&self) -> Levels {
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

    /// Next cycle in which something can change; `u64::MAX` at the end.
    fn deadline(&self) -> u64 {
        if self.now == 0 {
            return 0;
        }
        if self.work.is_some() {
            return NEVER;
        }
        self.due.iter().copied().min().map_or(NEVER, |due| if due == NEVER { due } else { due.max(self.now) })
    }

    /// Number of cycles without change; `None` for ever.
    #[must_use]
    pub fn cycles_until_event(&self) -> Option<Cycles> {
        match self.deadline() {
            NEVER => None,
            deadline => Some(Cycles(deadline - self.now)),
        }
    }

    /// Skips cycles without change, at most [`Self::cycles_until_event`].
    pub fn advance(&mut self, cycles: Cycles) {
        self.now = self.now.saturating_add(cycles.0).min(self.deadline());
    }

    /// Runs up to cycle `until`; with [`Instant::NEVER`], up to and including the last cycle in which something can
    /// change. Stops early when the sink pauses, and when too many groups have begun ([`Self::work`]).
    pub fn run(&mut self, until: Instant, sink: &mut impl Sink) {
        self.run_events(until, u64::MAX, sink);
    }

    /// The same for at most `events` cycles with changes; returns whether that was enough.
    pub fn run_events(&mut self, until: Instant, events: u64, sink: &mut impl Sink) -> bool {
        for _ in 0..events {
            if sink.is_paused() {
                return true;
            }
            let deadline = self.deadline();
            if deadline >= until.0 {
                if until != Instant::NEVER {
                    self.now = self.now.max(until.0);
                    self.settle();
                }
                return true;
            }
            self.now = deadline;
            self.cycle(sink);
        }
        false
    }

    fn settle(&mut self) {
        for (controller, due) in self.controllers.iter_mut().zip(&mut self.due) {
            controller.eeprom.settle(self.now);
            *due = (*due).min(controller.eeprom.due());
        }
    }

    /// The first cycle after the last in which something could change, once the run has ended.
    #[must_use]
    pub const fn rests_from(&self) -> Instant {
        Instant(self.acted.saturating_add(1))
    }

    /// Whether nothing can change any more. A memory that writes the same record again and again, because its sequence
    /// number is the maximum, does not keep a run from ending.
    #[must_use]
    pub fn at_rest(&self) -> bool {
        self.now > 0
            && (self.work.is_some() || self.controllers.iter().all(|controller| controller.due() == NEVER))
    }

    /// Set if the run ended because too many groups have begun.
    #[must_use]
    pub const fn work(&self) -> Option<Work> {
        self.work
    }
}

/// Reports the changes of cycle `now` besides the bus: raw levels compared with `before`, and the panel record after the
/// first `shown` ones.
fn report(index: u8, controller: &Controller, (now, before, shown): (u64, u32, usize), sink: &mut impl Sink) {
    let raw = controller.inputs.all_raw();
    let changed = |signal: &Signal| (raw ^ before) >> *signal as u32 & 1 != 0;
    if raw != before {
        for signal in Signal::ALL.into_iter().filter(changed) {
            let level = controller.inputs.raw(signal);
            let event = Event::Input { controller: index, input: signal as u8, level };
            sink.event(Instant(now), event);
        }
    }
    if let Some(&PanelRecord { cycle, word, position, display }) = controller.panel.get(shown) {
        sink.event(cycle, Event::Panel { controller: index, word: word.0, position, display });
    }
}
